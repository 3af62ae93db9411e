/* bvh.h: a tree of boxes, eight to a node.
 *
 * Boxes are floats in the tree's own unit: relative to its middle, scaled by
 * a power of two so that all of them lie in -1..1, rounded outwards.  Neither
 * the distance from the world's origin nor the scene's scale costs accuracy. */
#ifndef RTC_BVH_H
#define RTC_BVH_H

#include <float.h>
#include <stdint.h>

#include "base/arena.h"
#include "math/kernel.h"
#include "shape/shape.h"
#include "tree/lanes.h"

/* child: an inner node's number, or the first of count in item[]. */
struct bvh_node {
    float side[2][3][LANES];            /* low and high */
    uint32_t child[LANES];
    uint32_t count[LANES];              /* 0: an inner node */
};

struct bvh {
    vec3 middle;
    double scale;                       /* tree units a world unit: a power of two */
    struct bounds bounds;               /* of all items */
    vec3 half;                          /* the whole tree reaches from -half to half, in tree units */
    struct bvh_node *node;
    size_t n_node;
    uint32_t *item;                     /* in the order of the leaves */
    size_t n_item;
    float *ball[4];                     /* of each item: centre and radius in tree units; NULL: none */
    float (*brick)[LANES];              /* other boxes that hold the items: brick.h; NULL: none */
};

enum { BVH_STACK = 384 };               /* see MOST_DEPTH in bvh.c */

/* The tree over n boxes, none of them empty or infinite.  The same for any
 * number of threads.  whole: of all boxes; NULL: it is worked out.
 * leaf_size: the most items in a leaf, 8 at most; enough: as many are not
 * divided even where nodes have slots left. */
void bvh_build(struct bvh *b, size_t n, struct bounds (*box)(const void *of, size_t i),
               const void *of, const struct bounds *whole, unsigned leaf_size, unsigned enough,
               unsigned threads, struct arena *mem);

/* Neighbours in the tree stand anywhere in memory: what they are made of is
 * asked for while others are worked on, and what that leads to (is_near) a
 * little later. */
typedef void bvh_fetch(const void *of, uint32_t item, bool is_near);

INLINE void bvh_fetch_ahead(const struct bvh *b, size_t i, bvh_fetch *fetch, const void *of)
{
    enum { AHEAD = 8 };

    if (i + 2 * AHEAD < b->n_item)
        fetch(of, b->item[i + 2 * AHEAD], false);
    if (i + AHEAD < b->n_item)
        fetch(of, b->item[i + AHEAD], true);
}

/* Gives the items balls that hold them, in their order in the tree; those of
 * which ball says false have none.  Spheres far from the ray are then passed
 * over eight at a time, before anything of theirs is read. */
void bvh_add_balls(struct bvh *b, bool (*ball)(const void *of, uint32_t item, vec3 *centre, double *radius),
                   bvh_fetch *fetch, const void *of, struct arena *mem);

/* A ray as the boxes see it. */
struct bvh_ray {
    lanes inverse[3];
    lanes origin[2][3];                 /* moved back for entering, forth for leaving: all rounding is in it */
    int enter[3];                       /* the side where the ray enters: 0 low, 1 high */
    float at[3], dir[3];                /* the same origin in the middle; the largest of dir is 1 */
    float apart;                        /* how far off all this may be */
    double start, unit, slop;           /* tree t = t * unit - start, give or take slop */
};

/* False: the ray misses all of it between near and far. */
bool bvh_aim(const struct bvh *b, struct ray ray, double near, double far, struct bvh_ray *out);

/* Calls visit for each item in whose box p may lie; ends when it returns true,
 * and returns that. */
bool bvh_at(const struct bvh *b, vec3 p, bool (*visit)(void *arg, uint32_t item), void *arg);

/* What aiming leaves uncertain, in tree units: see bvh.c. */
static const double bvh_step_error = 0x1p-45, bvh_float_error = 0x1p-23;
static const double bvh_ball_error = 0x1p-19;   /* of a centre's distance from the line */
static const double bvh_flat = 1e-30;   /* a ray does not move at all along such an axis */

/* A tree t as a float, not below it. */
INLINE float bvh_limit(double t)
{
    return t < FLT_MAX / 4 ? (float)t * (1 + 8 * FLT_EPSILON) + FLT_MIN : FLT_MAX;
}

/* A world t as a tree t, not below it. */
INLINE float bvh_far(const struct bvh_ray *r, double t)
{
    return bvh_limit(t * r->unit - r->start + r->slop);
}

INLINE void bvh_slab(const struct bvh_node *n, const struct bvh_ray *r, int axis, lanes *begin,
                     lanes *end)
{
    int enter = r->enter[axis];
    lanes in = lanes_load(n->side[enter][axis]), out = lanes_load(n->side[!enter][axis]);

    in = lanes_mul(lanes_sub(in, r->origin[0][axis]), r->inverse[axis]);
    out = lanes_mul(lanes_sub(out, r->origin[1][axis]), r->inverse[axis]);
    *begin = lanes_max(in, *begin);
    *end = lanes_min(out, *end);
}

/* Which of a node's boxes lie on the way, and where they begin. */
INLINE unsigned bvh_test(const struct bvh_node *n, const struct bvh_ray *r, float far, float near[])
{
    lanes begin = lanes_of(0), end = lanes_of(FLT_MAX);

    bvh_slab(n, r, 0, &begin, &end);
    bvh_slab(n, r, 1, &begin, &end);
    bvh_slab(n, r, 2, &begin, &end);
    end = lanes_mul(end, lanes_of(1 + 8 * FLT_EPSILON));
    end = lanes_min(end, lanes_of(far));
    lanes_store(near, begin);
    return lanes_not_above(begin, end);
}

/* Which balls from first on the line may meet between 0 and far.  The
 * distance of a centre from the line is compared with the radius; positions
 * here are of size 1, so rounding is a matter of float's unit. */
INLINE unsigned bvh_test_balls(const struct bvh *b, const struct bvh_ray *r, uint32_t first,
                               float far)
{
    lanes x = lanes_sub(lanes_load(b->ball[0] + first), lanes_of(r->at[0]));
    lanes y = lanes_sub(lanes_load(b->ball[1] + first), lanes_of(r->at[1]));
    lanes z = lanes_sub(lanes_load(b->ball[2] + first), lanes_of(r->at[2]));
    lanes radius = lanes_add(lanes_load(b->ball[3] + first), lanes_of(r->apart));
    lanes dx = lanes_of(r->dir[0]), dy = lanes_of(r->dir[1]), dz = lanes_of(r->dir[2]);
    float inverse = 1 / (r->dir[0] * r->dir[0] + r->dir[1] * r->dir[1] + r->dir[2] * r->dir[2]);
    lanes t = lanes_add(lanes_add(lanes_mul(x, dx), lanes_mul(y, dy)), lanes_mul(z, dz));

    t = lanes_mul(t, lanes_of(inverse));
    x = lanes_sub(x, lanes_mul(t, dx));
    y = lanes_sub(y, lanes_mul(t, dy));
    z = lanes_sub(z, lanes_mul(t, dz));
    lanes apart = lanes_add(lanes_add(lanes_mul(x, x), lanes_mul(y, y)), lanes_mul(z, z));
    return lanes_not_above(apart, lanes_mul(radius, radius))
           & lanes_not_above(lanes_sub(t, radius), lanes_of(far))
           & lanes_not_above(lanes_of(0), lanes_add(t, radius));
}

unsigned bvh_test_bricks(const struct bvh *b, const struct bvh_ray *r, uint32_t first, uint32_t count,
                         float far);    /* brick.c */

struct bvh_entry { uint32_t child, count; float near; };

INLINE struct bvh_entry bvh_entry(const struct bvh_node *n, int i, const float near[])
{
    return (struct bvh_entry) { n->child[i], n->count[i], near[i] };
}

/* Pushes the children that bits names, the nearest last. */
INLINE int bvh_push(struct bvh_entry stack[], int top, const struct bvh_node *n, unsigned bits,
                    const float near[])
{
    int base = top;

    for (; bits; bits &= bits - 1) {
        int i = __builtin_ctz(bits), at = top++;
        for (; at > base && stack[at - 1].near < near[i]; at--)
            stack[at] = stack[at - 1];
        stack[at] = bvh_entry(n, i, near);
    }
    return top;
}

/* Goes down to the nearest child of n on the way, the others on the stack;
 * false: there is none. */
INLINE bool bvh_descend(const struct bvh_node *n, const struct bvh_ray *r, float limit,
                        struct bvh_entry stack[], int *top, struct bvh_entry *e)
{
    float near[LANES];
    unsigned bits = bvh_test(n, r, limit, near);

    if (bits == 0)
        return false;
    int i = __builtin_ctz(bits);
    bits &= bits - 1;
    *e = bvh_entry(n, i, near);
    if (bits == 0)
        return true;
    int k = __builtin_ctz(bits);
    if ((bits & (bits - 1)) == 0) {
        struct bvh_entry other = bvh_entry(n, k, near);
        bool swap = other.near < e->near;
        stack[(*top)++] = swap ? *e : other;
        if (swap)
            *e = other;
        return true;
    }
    *top = bvh_push(stack, *top, n, bits | 1u << i, near);
    *e = stack[--*top];
    return true;
}

/* What bvh_walk asks and calls.  sift: which of count items from first on the
 * ray may meet before limit, a tree t; bit i means first + i.  visit is told
 * the same bits, may shorten far, and ends the walk by returning true. */
struct bvh_visitor {
    uint32_t (*sift)(void *arg, const struct bvh_ray *r, uint32_t first, uint32_t count, float limit);
    bool (*visit)(void *arg, const uint32_t item[], uint32_t bits, double *far);
};

/* For the leaves on the way, about nearest first.  Leaves wholly beyond far
 * are left out.  r: the ray, aimed. */
INLINE bool bvh_walk_aimed(const struct bvh *b, const struct bvh_ray *r, double far,
                           struct bvh_visitor v, void *arg, unsigned long long *box_tests)
{
    struct bvh_entry stack[BVH_STACK], e = { 0, 0, 0 };
    int top = 0;
    float limit = bvh_far(r, far);

    for (;;) {
        if (e.count == 0) {
            *box_tests += LANES;
            if (bvh_descend(&b->node[e.child], r, limit, stack, &top, &e))
                continue;
        } else {
            double before = far;
            uint32_t bits = v.sift(arg, r, e.child, e.count, limit);
            if (bits && v.visit(arg, b->item + e.child, bits, &far))
                return true;
            if (far != before)
                limit = bvh_far(r, far);
        }
        do {
            if (top == 0)
                return false;
            e = stack[--top];
        } while (e.near > limit);
    }
}

struct bvh_ball_walk {
    const struct bvh *tree;
    bool (*visit)(void *arg, const uint32_t item[], uint32_t bits, double *far);
    void *arg;
};

INLINE uint32_t bvh_sift_balls(void *arg, const struct bvh_ray *r, uint32_t first, uint32_t count,
                               float limit)
{
    const struct bvh *b = ((const struct bvh_ball_walk *)arg)->tree;
    uint32_t bits = (1u << count) - 1;

    if (b->ball[0])
        return bits & bvh_test_balls(b, r, first, limit);
    return b->brick ? bvh_test_bricks(b, r, first, count, limit) : bits;
}

INLINE bool bvh_visit_ball(void *arg, const uint32_t item[], uint32_t bits, double *far)
{
    const struct bvh_ball_walk *w = arg;

    return w->visit(w->arg, item, bits, far);
}

/* The same for visit alone: all items of a leaf whose balls may be met. */
INLINE bool bvh_walk(const struct bvh *b, struct ray ray, double near, double far,
                     bool (*visit)(void *arg, const uint32_t item[], uint32_t bits, double *far),
                     void *arg, unsigned long long *box_tests)
{
    struct bvh_ball_walk w = { b, visit, arg };
    struct bvh_ray r;

    return b->n_node && bvh_aim(b, ray, near, far, &r)
           && bvh_walk_aimed(b, &r, far, (struct bvh_visitor) { bvh_sift_balls, bvh_visit_ball },
                             &w, box_tests);
}

#endif
