/* stream.h: many rays go down a tree together.
 *
 * At each node all rays that came there are tried in a row: the node stays in
 * registers, no ray waits for another, and what is hard to foresee (which
 * child is next) happens once for all of them. */
#ifndef RTC_STREAM_H
#define RTC_STREAM_H

#include "tree/bvh.h"

enum { STREAM = 128 };                  /* rays at a time; a byte must hold their numbers */

/* A node or a leaf that some rays wait for; which ones is on the pile. */
struct stream_waiting { uint32_t child, count; int first, n; };

struct stream_pile {
    struct stream_waiting entry[BVH_STACK];
    int n, used;
    uint8_t ray[(BVH_STACK + 1) * STREAM];
};

/* Rays as the boxes see them: struct bvh_ray has the words. */
struct stream {
    int n;
    float inverse[3][STREAM];
    float turn[3][STREAM];              /* origin * inverse */
    float at[3][STREAM], dir[3][STREAM];
    float over[STREAM];                 /* one over the square of dir */
    float limit[STREAM];                /* how far a ray goes; below 0: nowhere any more */
    double start[STREAM], unit[STREAM], slop[STREAM];
    float apart, ball_apart;            /* how far off any of them may be */
    struct stream_pile pile;
};

/* Rays that miss all of the tree before far get a limit below 0. */
void stream_aim(struct stream *s, const struct bvh *b, const struct rays *r, const double far[]);

INLINE void stream_set_far(struct stream *s, int i, double far)
{
    s->limit[i] = bvh_limit(far * s->unit[i] - s->start[i] + s->slop[i]);
}

INLINE void stream_end(struct stream *s, int i) { s->limit[i] = -1; }

/* Calls visit(arg, first, ray, bits, n) for the leaves on the way of some
 * rays: bit k of bits[i] means that ray[i] may meet item[first + k].  visit
 * may shorten limits and use up bits.  in_order: about the nearest leaves first. */
typedef void stream_visit(void *arg, uint32_t first, const uint8_t ray[], uint8_t bits[], int n);
void stream_walk(struct stream *s, const struct bvh *b, bool in_order, stream_visit *visit, void *arg,
                 unsigned long long *box_tests);

#endif
