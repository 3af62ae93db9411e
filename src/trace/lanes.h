/* lanes.h: eight floats at once, for boxes.
 *
 * lanes_max(a, b) and lanes_min(a, b) give b where either is NaN, whatever
 * the instruction set. */
#ifndef RTC_LANES_H
#define RTC_LANES_H

#include "math/kernel.h"

enum { LANES = 8 };

#ifdef __AVX__
#include <immintrin.h>

typedef __m256 lanes;

INLINE lanes lanes_of(float a) { return _mm256_set1_ps(a); }
INLINE lanes lanes_load(const float a[LANES]) { return _mm256_loadu_ps(a); }
INLINE void lanes_store(float to[LANES], lanes a) { _mm256_storeu_ps(to, a); }
INLINE lanes lanes_sub(lanes a, lanes b) { return _mm256_sub_ps(a, b); }
INLINE lanes lanes_mul(lanes a, lanes b) { return _mm256_mul_ps(a, b); }
INLINE lanes lanes_max(lanes a, lanes b) { return _mm256_max_ps(a, b); }
INLINE lanes lanes_min(lanes a, lanes b) { return _mm256_min_ps(a, b); }

/* Bit i: a[i] <= b[i]. */
INLINE unsigned lanes_not_above(lanes a, lanes b)
{
    return (unsigned)_mm256_movemask_ps(_mm256_cmp_ps(a, b, _CMP_LE_OQ));
}

#else

typedef struct { float a[LANES]; } lanes;

#define LANES_EACH(expression) \
    lanes to; \
    for (int i = 0; i < LANES; i++) \
        to.a[i] = (expression); \
    return to

INLINE lanes lanes_of(float a) { LANES_EACH(a); }
INLINE lanes lanes_load(const float a[LANES]) { LANES_EACH(a[i]); }
INLINE lanes lanes_sub(lanes a, lanes b) { LANES_EACH(a.a[i] - b.a[i]); }
INLINE lanes lanes_mul(lanes a, lanes b) { LANES_EACH(a.a[i] * b.a[i]); }
INLINE lanes lanes_max(lanes a, lanes b) { LANES_EACH(a.a[i] > b.a[i] ? a.a[i] : b.a[i]); }
INLINE lanes lanes_min(lanes a, lanes b) { LANES_EACH(a.a[i] < b.a[i] ? a.a[i] : b.a[i]); }
#undef LANES_EACH

INLINE void lanes_store(float to[LANES], lanes a)
{
    for (int i = 0; i < LANES; i++)
        to[i] = a.a[i];
}

INLINE unsigned lanes_not_above(lanes a, lanes b)
{
    unsigned bits = 0;

    for (int i = 0; i < LANES; i++)
        bits |= (unsigned)(a.a[i] <= b.a[i]) << i;
    return bits;
}

#endif
#endif
