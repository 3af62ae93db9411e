/* split.h: dividing boxes in two so that rays meet few of them: the surface
 * area heuristic, over bins. */
#ifndef RTC_SPLIT_H
#define RTC_SPLIT_H

#include <stdbool.h>
#include <stdint.h>

#include "tree/lanes.h"

/* Low x, y, z and, from 4 on, the negatives of high: joining two boxes is
 * taking the least of each.  The third and seventh are free. */
struct box { float side[LANES]; };

struct ref {
    struct box box;
    uint32_t item;
    uint32_t weight;                    /* how many items it stands for */
};

/* ref[first] to ref[first + n - 1] */
struct range {
    struct box box;
    uint32_t first, n;
    uint32_t weight;                    /* of them all */
};

static const struct box box_empty = { { 3e38f, 3e38f, 3e38f, 0, 3e38f, 3e38f, 3e38f, 0 } };

INLINE void box_join(struct box *to, const struct box *b)
{
    lanes_store(to->side, lanes_min(lanes_load(b->side), lanes_load(to->side)));
}

/* Half the surface. */
INLINE float box_area(const struct box *b)
{
    quad across = quad_add(quad_load(b->side), quad_load(b->side + 4));
    float face[4];

    quad_store(face, quad_mul(across, quad_turn(across)));
    return face[0] + face[1] + face[2];
}

void range_measure(struct range *r, const struct ref ref[]);   /* its box and weight */

/* Divides a range of two or more; spare has room for as many.  evenly: by
 * their number, whatever the cost. */
void range_split(const struct range *r, struct ref ref[], struct ref spare[], bool evenly,
                 struct range out[2]);

#endif
