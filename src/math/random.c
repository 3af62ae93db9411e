/* random.c: POV-Ray's streams of random numbers (facts patterns.md 0, 2). */
#include "math/random.h"

#include <math.h>

uint32_t random_seed(double seed)
{
    if (!isfinite(seed))
        return 0;
    double wrapped = fmod(trunc(seed), 4294967296.0);
    return (uint32_t)(int64_t)wrapped;
}

double random_next(uint32_t *state)
{
    *state = random_step(*state);
    return random_of(*state);
}

/* MT19937, Matsumoto and Nishimura 1998. */
enum { TWIST = 624, SHIFT = 397 };

static void twist(uint32_t s[TWIST])
{
    for (int i = 0; i < TWIST; i++) {
        uint32_t y = (s[i] & 0x80000000u) | (s[(i + 1) % TWIST] & 0x7fffffffu);
        s[i] = s[(i + SHIFT) % TWIST] ^ y >> 1 ^ (y & 1 ? 0x9908b0dfu : 0);
    }
}

void random_twister(uint32_t out[], int n)
{
    uint32_t s[TWIST] = { 5489 };

    for (uint32_t i = 1; i < TWIST; i++)
        s[i] = 1812433253u * (s[i - 1] ^ s[i - 1] >> 30) + i;
    for (int i = 0; i < n; i++) {
        if (i % TWIST == 0)
            twist(s);
        uint32_t y = s[i % TWIST];
        y ^= y >> 11;
        y ^= y << 7 & 0x9d2c5680u;
        y ^= y << 15 & 0xefc60000u;
        out[i] = y ^ y >> 18;
    }
}
