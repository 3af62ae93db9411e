/* wide.h: as many doubles at once as a register holds.
 *
 * wide_max(a, b) and wide_min(a, b) give b where either is NaN, whatever the
 * instruction set. */
#ifndef RTC_WIDE_H
#define RTC_WIDE_H

#include <stdint.h>

#include "math/kernel.h"

#if defined __AVX__ || defined __SSE2__
#include <immintrin.h>
#endif

#if defined __AVX512F__ && defined __AVX512DQ__
enum { WIDE = 8 };
typedef __m512d wide;
INLINE wide wide_max(wide a, wide b) { return _mm512_max_pd(a, b); }
INLINE wide wide_min(wide a, wide b) { return _mm512_min_pd(a, b); }
INLINE uint32_t wide_not_above(wide a, wide b) { return _mm512_cmp_pd_mask(a, b, _CMP_LE_OQ); }
#elif defined __AVX__
enum { WIDE = 4 };
typedef __m256d wide;
INLINE wide wide_max(wide a, wide b) { return _mm256_max_pd(a, b); }
INLINE wide wide_min(wide a, wide b) { return _mm256_min_pd(a, b); }
INLINE uint32_t wide_not_above(wide a, wide b)
{
    return (uint32_t)_mm256_movemask_pd(_mm256_cmp_pd(a, b, _CMP_LE_OQ));
}
#elif defined __SSE2__
enum { WIDE = 2 };
typedef __m128d wide;
INLINE wide wide_max(wide a, wide b) { return _mm_max_pd(a, b); }
INLINE wide wide_min(wide a, wide b) { return _mm_min_pd(a, b); }
INLINE uint32_t wide_not_above(wide a, wide b)
{
    return (uint32_t)_mm_movemask_pd(_mm_cmple_pd(a, b));
}
#else
enum { WIDE = 2 };
typedef double wide __attribute__((vector_size(WIDE * sizeof(double))));
INLINE wide wide_max(wide a, wide b)
{
    return (wide) { a[0] > b[0] ? a[0] : b[0], a[1] > b[1] ? a[1] : b[1] };
}
INLINE wide wide_min(wide a, wide b)
{
    return (wide) { a[0] < b[0] ? a[0] : b[0], a[1] < b[1] ? a[1] : b[1] };
}
INLINE uint32_t wide_not_above(wide a, wide b)
{
    return (uint32_t)(a[0] <= b[0]) | (uint32_t)(a[1] <= b[1]) << 1;
}
#endif

INLINE wide wide_of(double a) { return (wide) { 0 } + a; }

#endif
