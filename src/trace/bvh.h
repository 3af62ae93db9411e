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
#include "trace/lanes.h"

/* child: an inner node's number, or the first of count in item[]. */
struct bvh_node {
    float side[2][3][LANES];            /* low and high */
    uint32_t child[LANES];
    uint32_t count[LANES];              /* 0: an inner node */
};

struct bvh {
    vec3 middle;
    double scale;                       /* tree units a world unit: a power of two */
    vec3 half;                          /* the whole tree reaches from -half to half, in tree units */
    struct bvh_node *node;
    size_t n_node;
    uint32_t *item;                     /* in the order of the leaves */
    size_t n_item;
};

enum { BVH_STACK = 384 };               /* see MOST_DEPTH in bvh.c */

/* The tree over n boxes, none of them empty or infinite.  The same for any
 * number of threads.  leaf_size: the most items in a leaf. */
void bvh_build(struct bvh *b, size_t n, struct bounds (*box)(const void *of, size_t i),
               const void *of, unsigned leaf_size, unsigned threads, struct arena *mem);

/* A ray as the boxes see it. */
struct bvh_ray {
    lanes inverse[3];
    lanes origin[2][3];                 /* moved back for entering, forth for leaving: all rounding is in it */
    int enter[3];                       /* the side where the ray enters: 0 low, 1 high */
    double start, unit, slop;           /* tree t = (t - start) * unit, give or take slop */
};

/* False: the ray misses all of it between near and far. */
bool bvh_aim(const struct bvh *b, struct ray ray, double near, double far, struct bvh_ray *out);

/* A world t as a tree t, not below it. */
INLINE float bvh_far(const struct bvh_ray *r, double t)
{
    double far = (t - r->start) * r->unit + r->slop;

    return far < FLT_MAX / 4 ? (float)far * (1 + 8 * FLT_EPSILON) + FLT_MIN : FLT_MAX;
}

/* Which of a node's boxes lie on the way, and where they begin. */
INLINE unsigned bvh_test(const struct bvh_node *n, const struct bvh_ray *r, float far, float near[])
{
    lanes begin = lanes_of(0), end = lanes_of(FLT_MAX);

    for (int axis = 0; axis < 3; axis++) {
        int enter = r->enter[axis];
        lanes in = lanes_load(n->side[enter][axis]), out = lanes_load(n->side[!enter][axis]);
        in = lanes_mul(lanes_sub(in, r->origin[0][axis]), r->inverse[axis]);
        out = lanes_mul(lanes_sub(out, r->origin[1][axis]), r->inverse[axis]);
        begin = lanes_max(in, begin);
        end = lanes_min(out, end);
    }
    end = lanes_mul(end, lanes_of(1 + 8 * FLT_EPSILON));
    end = lanes_min(end, lanes_of(far));
    lanes_store(near, begin);
    return lanes_not_above(begin, end);
}

struct bvh_entry { uint32_t child, count; float near; };

/* Pushes the children that bits names, the nearest last. */
INLINE int bvh_push(struct bvh_entry stack[], int top, const struct bvh_node *n, unsigned bits,
                    const float near[])
{
    int base = top;

    for (; bits; bits &= bits - 1) {
        int i = __builtin_ctz(bits), at = top++;
        for (; at > base && stack[at - 1].near < near[i]; at--)
            stack[at] = stack[at - 1];
        stack[at] = (struct bvh_entry) { n->child[i], n->count[i], near[i] };
    }
    return top;
}

/* Calls visit(arg, item, count, &far) for the leaves on the way, about
 * nearest first; visit may shorten far, and ends the walk by returning true.
 * Leaves wholly beyond far are left out. */
INLINE bool bvh_walk(const struct bvh *b, struct ray ray, double near, double far,
                     bool (*visit)(void *arg, const uint32_t item[], uint32_t count, double *far),
                     void *arg, unsigned long long *box_tests)
{
    struct bvh_ray r;
    struct bvh_entry stack[BVH_STACK];
    float entry[LANES];
    int top = 0;

    if (!b->n_node || !bvh_aim(b, ray, near, far, &r))
        return false;
    float limit = bvh_far(&r, far);
    stack[top++] = (struct bvh_entry) { 0, 0, 0 };
    while (top > 0) {
        struct bvh_entry e = stack[--top];
        if (e.near > limit)
            continue;
        if (e.count == 0) {
            const struct bvh_node *n = &b->node[e.child];
            *box_tests += LANES;
            top = bvh_push(stack, top, n, bvh_test(n, &r, limit, entry), entry);
        } else {
            double before = far;
            if (visit(arg, b->item + e.child, e.count, &far))
                return true;
            if (far != before)
                limit = bvh_far(&r, far);
        }
    }
    return false;
}

#endif
