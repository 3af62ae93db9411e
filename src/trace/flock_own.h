/* flock_own.h: what the parts of a flock share: rays that go down the world's
 * tree together. */
#ifndef RTC_FLOCK_OWN_H
#define RTC_FLOCK_OWN_H

#include "trace/flock.h"
#include "trace/volley.h"

struct flock {
    struct search search;               /* of the ray whose turn it is */
    const struct rays *rays;
    const uint8_t *mask;
    struct meeting *out;
    double far[STREAM];
    uint64_t *barrier;                  /* of shadow rays */
    struct blocker *last;
    uint32_t row;                       /* of the first's tallies, or NO_TALLY */
};

INLINE struct search *flock_turn(struct flock *f, int i)
{
    struct search *s = &f->search;

    s->ray = rays_at(f->rays, i);
    s->far = f->far[i];
    return s;
}

INLINE void flock_set_far(struct flock *f, int i, double far)
{
    f->far[i] = far;
    stream_set_far(f->search.s->stream, i, far);
}

INLINE void flock_block(struct flock *f, int i)
{
    f->barrier[i] = BARRIER_OPAQUE;
    stream_end(f->search.s->stream, i);
}

/* What any of a leaf's rays asks about. */
INLINE unsigned any_of(const uint8_t bits[], int n)
{
    unsigned any = 0;

    for (int k = 0; k < n; k++)
        any |= bits[k];
    return any;
}

/* ---- errands: rays that go to instances, which wait until there are many ---- */

void flock_errands_begin(const struct flock *f);

/* Takes the instances among a leaf's items off the rays' lists. */
void flock_send(struct flock *f, const uint32_t item[], const uint8_t ray[], uint8_t bits[], int n);

/* What still waits at the end. */
void flock_errands_end(struct flock *f);

/* Asks one instance about all rays that are not blocked yet. */
void flock_blocked_by_instance(struct flock *f, uint32_t number);

#endif
