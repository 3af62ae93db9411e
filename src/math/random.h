/* random.h: POV-Ray's streams of random numbers. */
#ifndef RTC_RANDOM_H
#define RTC_RANDOM_H

#include <stdint.h>

/* rand(), seed(): the next number of a stream is worked out from its state,
 * which any 32 bits may be. */
static inline uint32_t random_step(uint32_t state) { return 1812433253u * state + 12345u; }
static inline double random_of(uint32_t state) { return (double)state / 4294967295.0; }
uint32_t random_seed(double seed);      /* the fraction is dropped; negative ones wrap around */
double random_next(uint32_t *state);    /* 0..1, both ends possible */

/* The first n outputs of a Mersenne twister with its usual seed, 5489. */
void random_twister(uint32_t out[], int n);

#endif
