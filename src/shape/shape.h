/* shape.h: what every primitive is.
 *
 * A shape lives in its own space: no matrix, texture or light reaches it.
 * A row of shapes[] holds its words and its functions.  A newcomer writes
 * NAME.c, a row in shapes.c and a line in Makefile.am. */
#ifndef RTC_SHAPE_H
#define RTC_SHAPE_H

#include <stdbool.h>
#include <stdint.h>

#include "base/arena.h"
#include "base/field.h"
#include "math/vec.h"

struct ray { vec3 origin, dir; };       /* dir of any length but 0; t counts in its lengths */

static inline vec3 ray_at(struct ray r, double t) { return vec_fma(r.origin, t, r.dir); }

/* Rays in arrays. */
struct rays {
    int n;
    const double *x, *y, *z, *dx, *dy, *dz;
};

static inline struct ray rays_at(const struct rays *r, int i)
{
    return (struct ray) { { r->x[i], r->y[i], r->z[i] }, { r->dx[i], r->dy[i], r->dz[i] } };
}

/* Where a line meets a surface.  slack bounds the distance between the
 * computed point ray_at(t) and the true surface, in the shape's own units: a
 * ray that starts there starts outside of it. */
struct hit {
    double t;
    double slack;
    float u, v;                         /* the shape's own: barycentric, segment and the like */
    uint32_t part;                      /* the shape's own: face, cap, segment */
};

struct bounds { vec3 low, high; };      /* may be infinite; low > high: empty */

enum { SHAPE_MOST_HITS = 64 };          /* the largest most_hits of any row */

/* All points p with normal . p <= distance. */
struct half_space { vec3 normal; double distance; };

struct packet;
struct crossings;

struct shape_ops {
    const char *name;                   /* the word of the language */
    const char *help;                   /* one line */
    size_t size;                        /* of the shape's struct */
    const void *defaults;               /* of that size */
    const struct field *args;           /* values of the header, in order; NULL name ends */
    size_t n_required;                  /* how many of args must be there */
    const struct field *words;          /* words of the body, NULL: none */
    bool is_solid;                      /* has an inside: hits alternate in and out */
    bool is_infinite;                   /* no finite bounds */
    bool is_ball;                       /* the ball inside its bounds holds it */
    int most_hits;                      /* that hits() ever returns */

    /* Checks and completes the struct once, so that the other functions
     * check nothing.  NULL: fine.  Otherwise what is wrong ("zero radius");
     * the caller then warns and leaves the shape out. */
    const char *(*prepare)(void *self, struct arena *mem);

    struct bounds (*bounds)(const void *self);

    /* Bounds of the surface alone; NULL: no better ones than bounds(). */
    struct bounds (*crust)(const void *self);

    /* What is inside of a plane; NULL: the shape is none. */
    struct half_space (*half_space)(const void *self);

    /* A slanted box that fits better than bounds(): its centre, and the ways
     * from there to three of its faces.  NULL: none does. */
    void (*hold)(const void *self, vec3 *centre, vec3 edge[3]);

    /* Every crossing of the whole line, t of either sign, in increasing t;
     * for a solid they alternate, and starts_inside tells whether the line
     * comes from the inside at t = -infinity (only infinite solids do). */
    int (*hits)(const void *self, struct ray ray, struct hit out[]);
    bool (*starts_inside)(const void *self, vec3 dir);      /* NULL: never; without hits ask inside(origin) */

    /* NULL: never.  True: the hits need not alternate although there is an
     * inside (an open cylinder, a spindle torus): CSG must ask inside(). */
    bool (*is_leaky)(const void *self);

    bool (*inside)(const void *self, vec3 p);               /* NULL: nothing is inside */
    vec3 (*normal)(const void *self, vec3 p, const struct hit *h);   /* outward; any length */
    vec2 (*uv)(const void *self, vec3 p, const struct hit *h);       /* NULL: (x, y) of the world */

    /* The nearest crossing with near < t < far: what hits() would say, found
     * faster; the ray by address, since a copy of a struct just written stalls.
     * NULL: the caller uses hits(). */
    bool (*nearest)(const void *self, const struct ray *along, double near, double far,
                    struct hit *out);

    /* For convex solids that are not leaky: what of each ray's whole line
     * lies inside, between the very t that hits() says; near > far: nothing.
     * Both NaN: this ray is left to hits().  No array overlaps another.
     * NULL: nobody wrote it. */
    void (*spans)(const void *self, const struct rays *rays, double near[], double far[]);

    /* What hits() says, for many rays at once (packet.h); may: a byte a
     * register, a bit a lane that is asked for.  NULL: ask one by one.  For
     * shapes of one or two hits. */
    void (*hits_many)(const void *self, const struct packet *p, const uint8_t may[],
                      struct crossings *out);
    /* Where nearest() is a little before hits(): moves the first crossings there.  NULL: it is not. */
    void (*lead)(const void *self, const struct packet *p, struct crossings *c);
    bool many_is_first;                 /* it says no more than nearest() does with 0 < t */
    bool has_slabs;                     /* hits_many wants a prepared packet */
    bool is_quick;                      /* it takes no longer than trying the bounds would */
};

extern const struct shape_ops *const shapes[];      /* NULL ends */
const struct shape_ops *shape_find(const char *name);

#define BOUNDS_EMPTY ((struct bounds) { { INFINITY, INFINITY, INFINITY }, \
                                        { -INFINITY, -INFINITY, -INFINITY } })
#define BOUNDS_ALL ((struct bounds) { { -INFINITY, -INFINITY, -INFINITY }, \
                                      { INFINITY, INFINITY, INFINITY } })

static inline struct bounds bounds_join(struct bounds a, struct bounds b)
{
    return (struct bounds) {
        { smaller(a.low.x, b.low.x), smaller(a.low.y, b.low.y), smaller(a.low.z, b.low.z) },
        { larger(a.high.x, b.high.x), larger(a.high.y, b.high.y), larger(a.high.z, b.high.z) } };
}

static inline struct bounds bounds_meet(struct bounds a, struct bounds b)
{
    return (struct bounds) {
        { larger(a.low.x, b.low.x), larger(a.low.y, b.low.y), larger(a.low.z, b.low.z) },
        { smaller(a.high.x, b.high.x), smaller(a.high.y, b.high.y), smaller(a.high.z, b.high.z) } };
}

#endif
