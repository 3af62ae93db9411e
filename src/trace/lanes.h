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
INLINE lanes lanes_add(lanes a, lanes b) { return _mm256_add_ps(a, b); }
INLINE lanes lanes_sub(lanes a, lanes b) { return _mm256_sub_ps(a, b); }
INLINE lanes lanes_mul(lanes a, lanes b) { return _mm256_mul_ps(a, b); }
INLINE lanes lanes_max(lanes a, lanes b) { return _mm256_max_ps(a, b); }
INLINE lanes lanes_min(lanes a, lanes b) { return _mm256_min_ps(a, b); }

/* Bit i: a[i] <= b[i]. */
INLINE unsigned lanes_not_above(lanes a, lanes b)
{
    return (unsigned)_mm256_movemask_ps(_mm256_cmp_ps(a, b, _CMP_LE_OQ));
}

#elif defined __SSE2__
#include <emmintrin.h>

typedef struct { __m128 a, b; } lanes;

#define LANES_BOTH(f) ((lanes) { f(a.a, b.a), f(a.b, b.b) })

INLINE lanes lanes_of(float a) { return (lanes) { _mm_set1_ps(a), _mm_set1_ps(a) }; }
INLINE lanes lanes_load(const float a[LANES])
{
    return (lanes) { _mm_loadu_ps(a), _mm_loadu_ps(a + 4) };
}
INLINE void lanes_store(float to[LANES], lanes a)
{
    _mm_storeu_ps(to, a.a);
    _mm_storeu_ps(to + 4, a.b);
}
INLINE lanes lanes_add(lanes a, lanes b) { return LANES_BOTH(_mm_add_ps); }
INLINE lanes lanes_sub(lanes a, lanes b) { return LANES_BOTH(_mm_sub_ps); }
INLINE lanes lanes_mul(lanes a, lanes b) { return LANES_BOTH(_mm_mul_ps); }
INLINE lanes lanes_max(lanes a, lanes b) { return LANES_BOTH(_mm_max_ps); }
INLINE lanes lanes_min(lanes a, lanes b) { return LANES_BOTH(_mm_min_ps); }
#undef LANES_BOTH

INLINE unsigned lanes_not_above(lanes a, lanes b)
{
    return (unsigned)_mm_movemask_ps(_mm_cmple_ps(a.a, b.a))
           | (unsigned)_mm_movemask_ps(_mm_cmple_ps(a.b, b.b)) << 4;
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
INLINE lanes lanes_add(lanes a, lanes b) { LANES_EACH(a.a[i] + b.a[i]); }
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
