/* beam.h: what some rays that lie close together may meet, found in one walk
 * down a tree. */
#ifndef RTC_BEAM_H
#define RTC_BEAM_H

#include "tree/bvh.h"
#include "trace/few.h"

enum {
    BEAM_TOO_MUCH = -1,
    BEAM_LEAST = 8,                     /* rays */
};

/* Numbers (not items) of the tree's items on the way of any of the rays, about
 * the nearest first: places in b->item.  far NULL: any.  BEAM_TOO_MUCH: more
 * than room (FEW at most), or the walk would not be worth it. */
int beam_walk(const struct bvh *b, const struct rays *r, const double *far, uint32_t place[],
              int room, unsigned long long *box_tests);

#endif
