/* many.h: one leaf after the other against a packet of rays. */
#ifndef RTC_MANY_H
#define RTC_MANY_H

#include "shape/packet.h"
#include "trace/plan.h"

/* What is asked of a packet's rays: a byte a register, a bit a lane. */
struct lanes_asked { uint8_t bits[PACKET_REGISTERS]; };

/* The nearest meeting of each ray so far. */
struct found {
    _Alignas(64) double t[PACKET], slack[PACKET], u[PACKET], v[PACKET];
    int64_t part[PACKET], rank[PACKET];
};

/* Of meetings at the same t the one of lowest rank counts: the world before
 * instances, first listed first.  NO_RANK: none. */
#define NO_RANK INT64_MAX
INLINE int64_t rank_of(uint32_t instance, uint32_t leaf)
{
    return (int64_t)((uint64_t)(uint32_t)(instance + 1) << 32 | leaf);
}
INLINE uint32_t rank_leaf(int64_t rank) { return (uint32_t)rank; }
INLINE uint32_t rank_instance(int64_t rank) { return (uint32_t)((uint64_t)rank >> 32) - 1; }

void packet_fill(struct packet *p, const struct rays *r);       /* r->n <= PACKET */
struct lanes_asked packet_all(const struct packet *p);
bool lanes_any(const struct lanes_asked *a, const struct packet *p);

INLINE bool lanes_has(const struct lanes_asked *a, int i) { return a->bits[i / WIDE] >> i % WIDE & 1; }
INLINE void lanes_drop(struct lanes_asked *a, int i)
{
    a->bits[i / WIDE] &= (uint8_t)~(1 << i % WIDE);
}

/* Sets bit k of of[i] for each ray i. */
void lanes_note(const struct lanes_asked *a, const struct packet *p, int k, uint64_t of[]);

/* Room for a leaf's own way of looking at a packet. */
struct leaf_view { struct packet placed; struct crossings crossings; };

/* Can it be asked about many rays?  Of meshes, the smallest, for their
 * nearest crossing with t > 0 only. */
bool leaf_takes_many(const struct leaf *l);
/* Is trying its box no quicker than asking it? */
bool leaf_is_quick(const struct leaf *l);

/* The packet in the leaf's own space: itself, or in view. */
const struct packet *leaf_packet(const struct leaf *l, const struct packet *p,
                                 const struct lanes_asked *asked, struct leaf_view *view);

/* What the leaf says: into view->crossings, none of them unsure. */
void leaf_hits_many(const struct leaf *l, struct packet *p, const struct lanes_asked *asked,
                    struct leaf_view *view);

/* far NULL: infinite. */
void found_start(struct found *f, const struct packet *p, const double *far);
void found_take(struct found *f, const struct packet *p, const struct crossings *c, int64_t rank);
/* The same of a leaf that has just been asked. */
void found_take_leaf(struct found *f, const struct packet *p, const struct leaf *l, struct leaf_view *view,
                     int64_t rank);

/* Takes out of open the rays with a crossing of 0 < t < far[i]. */
void crossings_close(const struct crossings *c, const struct packet *p, const double far[],
                     struct lanes_asked *open);

/* The crossings of ray i in increasing t, as hits() lists them. */
int crossings_at(const struct crossings *c, int i, struct hit out[2]);

#endif
