/* errand.h: rays of a stream on their way to things that are placed often.
 *
 * Copies of one thing look alike from within: rays to different copies make
 * one packet in the space of what is placed. */
#ifndef RTC_ERRAND_H
#define RTC_ERRAND_H

#include "trace/geometry.h"
#include "trace/stream.h"
#include "trace/world.h"

struct blocker;

enum { ERRANDS = 128, ERRAND_QUEUES = 8 };

struct errands {
    uint32_t root;                      /* the space */
    int n;
    uint8_t ray[ERRANDS];               /* of the stream */
    uint32_t instance[ERRANDS];
    double column[6][ERRANDS];          /* the rays in the space */
};

/* Those of one stream: a queue for each of the spaces asked last. */
struct post {
    struct errands queue[ERRAND_QUEUES];
    uint8_t waiting[STREAM];            /* of each ray: how many of its errands wait */
};

INLINE struct errands *post_queue(struct post *p, uint32_t root)
{
    return &p->queue[root % ERRAND_QUEUES];
}

/* Is there room for one more to this space? */
INLINE bool errands_have_room(const struct errands *e, uint32_t root)
{
    return e->n == 0 || (e->root == root && e->n < ERRANDS);
}

void errands_add(struct errands *e, const struct instance *to, uint32_t number, int i, const struct ray *ray);

INLINE struct ray errands_ray(const struct errands *e, int k)
{
    return (struct ray) { { e->column[0][k], e->column[1][k], e->column[2][k] },
                          { e->column[3][k], e->column[4][k], e->column[5][k] } };
}

/* What each meets first in the space, below far, which is filled up to a
 * register as packets are.  Nothing: leaf is NO_LEAF. */
void errands_nearest(const struct plan *p, struct scratch *s, const struct errands *e, double far[],
                     const uint8_t mask[], struct meeting met[]);

/* Which are blocked, where all is opaque: BARRIER_OPAQUE, else 0.  last: by what, if any is. */
void errands_blocked(const struct plan *p, struct scratch *s, const struct errands *e, double far[],
                     uint64_t barrier[], struct blocker *last);

INLINE struct rays errands_rays(const struct errands *e)
{
    return (struct rays) { e->n, e->column[0], e->column[1], e->column[2],
                           e->column[3], e->column[4], e->column[5] };
}

#endif
