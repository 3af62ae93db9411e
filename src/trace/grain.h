/* grain.h: random numbers that belong to places: the same in whatever order,
 * and by however many threads, points are looked at. */
#ifndef RTC_GRAIN_H
#define RTC_GRAIN_H

#include <stdint.h>
#include <string.h>

#include "math/kernel.h"
#include "math/vec.h"

/* 0 <= result < 1; for one point another one for each salt. */
INLINE float grain_at(vec3 p, uint64_t salt)
{
    uint64_t bits[3], h = 0x9e3779b97f4a7c15 * (salt + 1);
    const double at[] = { p.x, p.y, p.z };

    memcpy(bits, at, sizeof bits);
    for (int k = 0; k < 3; k++) {
        h = (h ^ bits[k]) * 0xbf58476d1ce4e5b9;
        h ^= h >> 29;
    }
    return (float)(h >> 40) / (float)(1 << 24);
}

#endif
