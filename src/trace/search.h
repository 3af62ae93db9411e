/* search.h: one ray through a space and the instances in it. */
#ifndef RTC_SEARCH_H
#define RTC_SEARCH_H

#include "trace/scratch.h"

/* ---- the leaf ---- */

/* Where hits() is all that the shape has. */
bool nearest_by_hits(const struct leaf *l, struct ray ray, double near, double far,
                     struct hit *out);

/* Rays go by address: copying a struct that was just written stalls. */
INLINE bool shape_nearest(const struct leaf *l, struct scratch *s, const struct ray *ray,
                          double near, double far, struct hit *out)
{
    if (LIKELY(l->ops != NULL && l->ops->nearest != NULL))
        return l->ops->nearest(l->shape, ray, near, far, out);
    if (!l->ops)
        return mesh_nearest(l->mesh, *ray, near, far, out, &s->counts.box_tests);
    return nearest_by_hits(l, *ray, near, far, out);
}

INLINE bool leaf_nearest(const struct leaf *l, struct scratch *s, const struct ray *ray,
                         double near, double far, struct hit *out)
{
    s->counts.leaf_tests++;
    if (!l->placement)
        return shape_nearest(l, s, ray, near, far, out);
    struct ray inner = placed_ray(&l->placement->place, *ray);
    return shape_nearest(l, s, &inner, near, far, out);
}

/* ---- the search ---- */

struct search {
    const struct plan *plan;
    struct scratch *s;
    struct ray ray;                     /* in the space */
    uint32_t instance;
    uint8_t mask;
    double far;                         /* all of it: t < far */
    struct meeting *best;               /* its t is the far that is left */
    /* for crossings only */
    bool asks_opaque;                   /* what is opaque ends the search */
    unsigned *tally;                    /* where crossings are counted, not kept; or NULL */
    double after_t;
    int64_t after;                      /* rank of the last one that was visited */
    size_t n_crossing;
    bool is_full;
};

INLINE uint32_t surface_of_leaf(const struct search *s, const struct leaf *l)
{
    return l->surface != NO_LEAF ? l->surface : s->plan->instance[s->instance].surface;
}

INLINE bool is_opaque(const struct search *s, const struct leaf *l)
{
    return !s->plan->has_transparency || s->plan->surface[surface_of_leaf(s, l)].is_opaque;
}

/* The items of a space: those of the tree on the way, and the unbounded. */
typedef bool visit_items(void *arg, const uint32_t item[], uint32_t bits, double *far);

INLINE bool search_space(struct search *s, const struct space *space, visit_items *visit)
{
    double far = s->far;

    if (space->few) {
        s->s->counts.box_tests += (unsigned)space->few->n;
        return visit(s, space->few->item, few_aim(space->few, &s->ray, far), &far);
    }
    for (size_t i = 0; i < space->n_unbounded; i++)
        if (visit(s, space->unbounded + i, 1, &far))
            return true;
    return bvh_walk(&space->tree, s->ray, 0, far, visit, s, &s->s->counts.box_tests);
}

struct search search_instance(const struct search *s, uint32_t number);

INLINE const struct space *instance_space(const struct search *s, uint32_t number)
{
    return &s->plan->geometry->space[s->plan->instance[number].root];
}

/* ---- the nearest ---- */

/* Of equal t the first listed wins, whatever the order of the visits; so a
 * search goes just beyond the best t. */
INLINE bool is_better(const struct search *s, double t, uint32_t leaf)
{
    const struct meeting *b = s->best;

    if (b->leaf == NO_LEAF || t != b->t)
        return t < b->t;
    return rank_of(s->instance, leaf) < rank_of(b->instance, b->leaf);
}

INLINE double beyond(double t) { return t * (1 + 0x1p-52); }

void search_take(struct search *s, const struct hit *h, uint32_t leaf, bool flipped);

INLINE void meet_leaf(struct search *s, uint32_t number)
{
    const struct leaf *l = &s->plan->leaf[number];
    struct hit h;

    if ((l->mask & s->mask) && leaf_nearest(l, s->s, &s->ray, 0, s->far, &h)
        && is_better(s, h.t, number))
        search_take(s, &h, number, l->inverse);
}

struct csg_search { struct search *search; const struct csg *csg; };

void meet_csg(struct search *s, uint32_t number);
void meet_instance(struct search *s, uint32_t number);

INLINE bool visit_nearest(void *arg, const uint32_t item[], uint32_t bits, double *far)
{
    struct search *s = arg;

    for (; bits; bits &= bits - 1) {
        uint32_t one = item[__builtin_ctz(bits)], number = item_number(one);
        switch (item_kind(one)) {
        case ITEM_LEAF:     meet_leaf(s, number); break;
        case ITEM_CSG:      meet_csg(s, number); break;
        case ITEM_INSTANCE: meet_instance(s, number); break;
        }
    }
    *far = s->far;
    return false;
}

/* Tallies what light passes through of an item, or keeps it.  True: it is
 * opaque, and that was asked. */
bool keep_item(struct search *s, uint32_t item);

/* ---- the order of meetings ---- */

INLINE bool comes_after(const struct meeting *m, const struct hit *h, int64_t rank)
{
    return m->t > h->t || (m->t == h->t && rank_of(m->instance, m->leaf) > rank);
}

/* ---- what blocks light ---- */

bool blocks_csg(struct search *s, uint32_t number);
bool blocks_instance(struct search *s, uint32_t number);
bool still_blocks(struct search *s, const struct blocker *b);   /* false: not known, or no longer */

INLINE bool blocks_leaf(struct search *s, uint32_t number)
{
    const struct leaf *l = &s->plan->leaf[number];
    struct hit h;

    return (l->mask & RAY_SHADOW) && is_opaque(s, l)
           && leaf_nearest(l, s->s, &s->ray, 0, s->far, &h);
}

INLINE bool blocks(struct search *s, uint32_t item)
{
    switch (item_kind(item)) {
    case ITEM_LEAF: return blocks_leaf(s, item_number(item));
    case ITEM_CSG:  return blocks_csg(s, item_number(item));
    default:        return blocks_instance(s, item_number(item));
    }
}

/* Goes through items until one ends the search; it and where it is go into
 * best, for the cache. */
INLINE bool first_of(struct search *s, const uint32_t item[], uint32_t bits,
                     bool ends(struct search *s, uint32_t item))
{
    for (; bits; bits &= bits - 1) {
        uint32_t one = item[__builtin_ctz(bits)];
        if (!ends(s, one))
            continue;
        if (item_kind(one) == ITEM_INSTANCE)
            return true;                /* what of it was noted within */
        s->best->leaf = one;
        s->best->instance = s->instance;
        return true;
    }
    return false;
}

INLINE bool visit_blocked(void *arg, const uint32_t item[], uint32_t bits, double *far)
{
    (void)far;
    return first_of(arg, item, bits, blocks);
}

#endif
