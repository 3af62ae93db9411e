/* world.h: what searches walk: trees whose items are leaves, meshes, CSG
 * roots and instances. */
#ifndef RTC_WORLD_H
#define RTC_WORLD_H

#include "tree/bvh.h"
#include "trace/csg.h"
#include "trace/few.h"
#include "trace/geometry.h"
#include "trace/mesh.h"

/* An item: its kind in the upper two bits, its number below. */
enum item_kind { ITEM_LEAF, ITEM_CSG, ITEM_INSTANCE };
enum { ITEM_BITS = 30 };

INLINE uint32_t item_of(enum item_kind kind, uint32_t number)
{
    return (uint32_t)kind << ITEM_BITS | number;
}

INLINE enum item_kind item_kind(uint32_t item) { return (enum item_kind)(item >> ITEM_BITS); }
INLINE uint32_t item_number(uint32_t item) { return item & ((1u << ITEM_BITS) - 1); }

/* The world, or what an instance places. */
struct space {
    struct bvh tree;                    /* its items are these items */
    uint32_t *unbounded;                /* planes and the like */
    size_t n_unbounded;
    struct few *few;                    /* all of it, if it is so little; else NULL */
    uint64_t opaque, clear;             /* bits of few: may block light, may filter it */
    uint32_t *filled;                   /* items that may have an interior */
    size_t n_filled;
    struct candidate *candidate;        /* of each item of the tree, for beams; NULL: too many */
};

struct candidate {
    struct bounds bounds;
    bool is_opaque, is_clear;           /* may block light, may filter it */
};

struct geometry {
    struct space *space;                /* the first is the world */
    size_t n_space;
    struct csg *csg;
    size_t n_csg;
};

/* A ray as the shape in a leaf sees it; t is the same. */
INLINE struct ray placed_ray(const struct transform *place, struct ray ray)
{
    return (struct ray) { mat_point(&place->from, ray.origin),
                          mat_direction(&place->from, ray.dir) };
}

INLINE struct ray leaf_ray(const struct leaf *l, struct ray ray)
{
    return l->placement ? placed_ray(&l->placement->place, ray) : ray;
}

/* The slack of a hit in the space that the leaf is placed in.  Beyond the
 * shape's own: the way into the leaf's space and back rounds coordinates. */
INLINE double placed_slack(const struct transform *place, double stretch, double fuzz, double slack,
                           struct ray ray, double t)
{
    const mat34 *to = &place->to;
    double size = fabs(to->m[0][3]) + fabs(to->m[1][3]) + fabs(to->m[2][3])
                  + 2 * (fabs(ray.origin.x) + fabs(ray.origin.y) + fabs(ray.origin.z))
                  + fabs(t) * (fabs(ray.dir.x) + fabs(ray.dir.y) + fabs(ray.dir.z));

    return slack * stretch + fuzz * size;
}

INLINE double leaf_slack(const struct leaf *l, struct ray ray, const struct hit *h)
{
    const struct placement *p = l->placement;

    return p ? placed_slack(&p->place, p->stretch, p->fuzz, h->slack, ray, h->t) : h->slack;
}

/* The shape's outward normal, of any length, in the leaf's outer space;
 * turned for inverse leaves. */
vec3 leaf_normal(const struct leaf *l, struct ray ray, const struct hit *h);
bool leaf_inside(const struct leaf *l, vec3 p);         /* inverse is taken into account */
struct bounds leaf_bounds(const struct leaf *l);        /* in the leaf's outer space, padded */
struct bounds leaf_crust(const struct leaf *l);         /* the same of its surface alone */

#endif
