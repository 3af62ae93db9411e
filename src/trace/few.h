/* few.h: small scenes, whose boxes are all tried at once.
 *
 * A tree pays for itself from some thirty things on; below, a plain loop over
 * their boxes says what rays may meet: a register of boxes for one ray, or a
 * register of rays for one box after the other. */
#ifndef RTC_FEW_H
#define RTC_FEW_H

#include <stdint.h>

#include "base/arena.h"
#include "shape/packet.h"

enum { FEW = 32 };                      /* things: a bit each */

struct few {
    int n;
    uint32_t item[FEW];                 /* as in a tree */
    double side[2][3][FEW];             /* low and high, padded; infinite where there is no end */
};

void few_add(struct few *f, uint32_t item, const struct bounds *box);   /* n < FEW */

/* Bit k: the ray may meet item k with 0 <= t < far. */
uint32_t few_aim(const struct few *f, const struct ray *ray, double far);

/* Bit k: some ray of the packet may meet item k; rough.  far NULL: any t;
 * else filled up as the packet is. */
uint32_t few_on_the_way(const struct few *f, const struct packet *p, const double *far);

/* Leaves in may (a byte a register, a bit a lane) the rays that may meet item
 * k with 0 <= t < far[i].  The packet is prepared.  False: none. */
bool few_meet(const struct few *f, int k, const struct packet *p, const double *far, uint8_t may[]);

#endif
