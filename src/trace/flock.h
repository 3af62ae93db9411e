/* flock.h: many rays that go down the world's tree together. */
#ifndef RTC_FLOCK_H
#define RTC_FLOCK_H

#include "trace/search.h"

INLINE struct rays rays_from(const struct rays *r, int at, int most)
{
    int n = r->n - at < most ? r->n - at : most;

    return (struct rays) { n, r->x + at, r->y + at, r->z + at,
                           r->dx + at, r->dy + at, r->dz + at };
}

void nearest_of_streams(const struct plan *p, struct scratch *s, const struct rays *rays,
                        const uint8_t *mask, struct meeting *out);
void blocked_by_streams(const struct plan *p, struct scratch *s, const struct rays *rays,
                        const double *far, struct blocker *last, uint64_t *barrier);

#endif
