/* few.h: small scenes, whose boxes are all tried at once for arrays of rays.
 *
 * A tree pays for itself from some thirty things on; below, a plain loop over
 * their boxes, a register of rays at a time, says for each ray what it may meet. */
#ifndef RTC_FEW_H
#define RTC_FEW_H

#include <stdint.h>

#include "base/arena.h"
#include "shape/shape.h"

enum { FEW = 32 };                      /* things: a bit each */

struct few {
    int n;
    uint32_t item[FEW];                 /* as in a tree */
    double side[2][3][FEW];             /* low and high, padded; infinite for planes */
};

void few_add(struct few *f, uint32_t item, const struct bounds *box);   /* n < FEW */

/* Bit k of may[i]: ray i may meet item k with 0 <= t < far[i] (far NULL: any). */
void few_aim(const struct few *f, const struct rays *r, const double *far, uint64_t *may);

#endif
