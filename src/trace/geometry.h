/* geometry.h: rays against everything: trees, CSG, meshes, instances. */
#ifndef RTC_GEOMETRY_H
#define RTC_GEOMETRY_H

#include "math/kernel.h"
#include "trace/few.h"
#include "trace/plan.h"

/* What a ray met.  leaf NO_LEAF: nothing. */
struct meeting {
    double t;                           /* along the world ray, in lengths of its direction */
    struct hit hit;                     /* the shape's own words, t and slack in its own space */
    uint32_t leaf;
    uint32_t instance;                  /* NO_INSTANCE: the leaf is in the world */
    bool flipped;                       /* the outward normal is turned by CSG or inverse */
};

/* Per thread: spans, statistics, the last blocker per light.  All of it is
 * allocated by scratch_new. */
struct scratch;
struct scratch *scratch_new(const struct plan *p, struct arena *mem);

/* Makes plan->leaf and plan->geometry from the scene's objects, whose list is
 * given up; surface_of (surface.c) is called once for each distinct look and
 * returns its number. */
void geometry_build(struct plan *p, struct scene *s, unsigned threads);

/* The nearest meeting with 0 < t < far that mask may see. */
bool geometry_nearest(const struct plan *p, struct scratch *s, struct ray ray, double far,
                      uint8_t mask, struct meeting *out);

/* Does an opaque caster stand between?  light: which light asks (for its
 * last-blocker cache).  Casters that let light through are not counted. */
bool geometry_blocked(const struct plan *p, struct scratch *s, struct ray ray, double far,
                      uint32_t light);

/* The same for arrays of rays; out[i].leaf is NO_LEAF where nothing is met. */
void geometry_nearest_many(const struct plan *p, struct scratch *s, const struct rays *rays,
                           const uint8_t *mask, struct meeting *out);

/* What stands between points and a light: BARRIER_OPAQUE, nothing (0), or
 * perhaps things that filter light, for geometry_crossings to look at until
 * the next call of geometry_blocked_many. */
#define BARRIER_OPAQUE UINT64_MAX
#define BARRIER_CLEAR ((uint64_t)1 << 63)   /* nothing opaque; else all may be there */
#define BARRIER_ANY ((uint64_t)1 << 62)     /* nothing is known at all */
void geometry_blocked_many(const struct plan *p, struct scratch *s, const struct rays *rays,
                           const double *far, uint32_t light, uint64_t *barrier);

/* All meetings with casters that are not opaque, 0 < t < far, nearest first;
 * calls visit for each until it returns false.  barrier: as was said, or
 * BARRIER_ANY.  False: something opaque stands in the way of the light. */
bool geometry_crossings(const struct plan *p, struct scratch *s, struct ray ray, double far,
                        uint32_t light, uint64_t barrier,
                        bool (*visit)(void *arg, const struct meeting *m), void *arg);

/* The same where plan->n_tally is not 0: how many times it crosses each of
 * the plan's tallies, in no order. */
bool geometry_tally(const struct plan *p, struct scratch *s, struct ray ray, double far,
                    uint32_t light, uint64_t barrier, unsigned count[]);

/* Those counts where they were found ahead; NULL: they were not. */
const unsigned *geometry_tallied(const struct scratch *s, uint64_t barrier);

/* Solids with an interior that contain p: their surfaces, in order of
 * declaration.  For cameras inside things. */
size_t geometry_inside(const struct plan *p, struct scratch *s, vec3 point, uint32_t surface[],
                       size_t room);

/* The surface at a meeting, in the world.  slack: a new ray starts at
 * point +- slack * unit normal, on the side it goes to. */
struct surface_point {
    vec3 point;                         /* world */
    vec3 local;                         /* where the texture's place applies: in the instance's space
                                           if the look is the instance's own, else equals point */
    vec3 normal;                        /* world, of any length, outward as the solid sees it */
    vec2 uv;
    double slack;                       /* world units */
    uint32_t surface;                   /* of plan->surface */
    uint32_t texture[3];                /* of a mesh face: MESH_NONE mostly */
    float weight[3];                    /* barycentric, with texture[] */
};
void geometry_point(const struct plan *p, const struct ray *ray, const struct meeting *m,
                    struct surface_point *out);

/* The same for n <= BATCH rays, without uv and a mesh's textures: what they
 * met is m[index[i]].  Up to whole(n) the arrays are copies of the last. */
struct points {
    int n;
    uint32_t index[BATCH];
    double dx[BATCH], dy[BATCH], dz[BATCH];     /* of the ray, unit */
    double x[BATCH], y[BATCH], z[BATCH];        /* world */
    double nx[BATCH], ny[BATCH], nz[BATCH];     /* unit, turned to where the ray came from */
    double slack[BATCH];
    const struct surface *surface[BATCH];
    bool from_inside[BATCH];                    /* the normal was turned */
};
void geometry_points(const struct plan *p, const struct rays *rays, const struct meeting *m,
                     struct points *out);

static inline const struct surface *surface_met(const struct plan *p, const struct meeting *m)
{
    uint32_t own = p->leaf[m->leaf].surface;

    return &p->surface[own != NO_LEAF ? own : p->instance[m->instance].surface];
}

struct geometry_counts { unsigned long long rays, shadow_rays, box_tests, leaf_tests, csg_tests; };
struct geometry_counts scratch_counts(const struct scratch *s);

#endif
