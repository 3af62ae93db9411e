/* wide.h: as many doubles at once as a register holds.
 *
 * Every operation gives each lane the bits that the plain one gives.
 * wide_max(a, b) and wide_min(a, b) give b where either is NaN, whatever the
 * instruction set.  A wide_mask says yes or no a lane; & and | join masks. */
#ifndef RTC_WIDE_H
#define RTC_WIDE_H

#include <math.h>
#include <stdint.h>
#include <string.h>

#include "math/kernel.h"

#if defined __AVX__ || defined __SSE2__
#include <immintrin.h>
#endif

/* Vectors go between inlined functions only: there is no ABI to break. */
#pragma GCC diagnostic ignored "-Wpsabi"

#if defined __AVX512F__ && defined __AVX512DQ__
enum { WIDE = 8 };
typedef __m512d wide;
INLINE wide wide_max(wide a, wide b) { return _mm512_max_pd(a, b); }
INLINE wide wide_min(wide a, wide b) { return _mm512_min_pd(a, b); }
INLINE uint32_t wide_not_above(wide a, wide b) { return _mm512_cmp_pd_mask(a, b, _CMP_LE_OQ); }
INLINE wide wide_sqrt(wide a) { return _mm512_sqrt_pd(a); }
INLINE wide wide_fma(wide a, wide b, wide c) { return _mm512_fmadd_pd(a, b, c); }
#elif defined __AVX2__ && defined __FMA__
enum { WIDE = 4 };
typedef __m256d wide;
INLINE wide wide_max(wide a, wide b) { return _mm256_max_pd(a, b); }
INLINE wide wide_min(wide a, wide b) { return _mm256_min_pd(a, b); }
INLINE uint32_t wide_not_above(wide a, wide b)
{
    return (uint32_t)_mm256_movemask_pd(_mm256_cmp_pd(a, b, _CMP_LE_OQ));
}
INLINE wide wide_sqrt(wide a) { return _mm256_sqrt_pd(a); }
INLINE wide wide_fma(wide a, wide b, wide c) { return _mm256_fmadd_pd(a, b, c); }
#elif defined __SSE2__
enum { WIDE = 2 };
typedef __m128d wide;
INLINE wide wide_max(wide a, wide b) { return _mm_max_pd(a, b); }
INLINE wide wide_min(wide a, wide b) { return _mm_min_pd(a, b); }
INLINE uint32_t wide_not_above(wide a, wide b)
{
    return (uint32_t)_mm_movemask_pd(_mm_cmple_pd(a, b));
}
INLINE wide wide_sqrt(wide a) { return _mm_sqrt_pd(a); }
INLINE wide wide_fma(wide a, wide b, wide c)
{
    return (wide) { fma(a[0], b[0], c[0]), fma(a[1], b[1], c[1]) };
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
INLINE wide wide_sqrt(wide a) { return (wide) { sqrt(a[0]), sqrt(a[1]) }; }
INLINE wide wide_fma(wide a, wide b, wide c)
{
    return (wide) { fma(a[0], b[0], c[0]), fma(a[1], b[1], c[1]) };
}
#endif

typedef int64_t wide_ints __attribute__((vector_size(WIDE * sizeof(int64_t))));

#if defined __AVX512F__ && defined __AVX512DQ__
typedef __mmask8 wide_mask;
INLINE wide_mask wide_below(wide a, wide b) { return _mm512_cmp_pd_mask(a, b, _CMP_LT_OQ); }
INLINE wide_mask wide_at_most(wide a, wide b) { return _mm512_cmp_pd_mask(a, b, _CMP_LE_OQ); }
INLINE wide_mask wide_equal(wide a, wide b) { return _mm512_cmp_pd_mask(a, b, _CMP_EQ_OQ); }
INLINE wide_mask wide_signs(wide a) { return _mm512_movepi64_mask((__m512i)a); }
INLINE wide_mask wide_ints_below(wide_ints a, wide_ints b)
{
    return _mm512_cmplt_epi64_mask((__m512i)a, (__m512i)b);
}
INLINE wide_mask wide_not(wide_mask m) { return (wide_mask)~m; }
INLINE wide wide_pick(wide_mask m, wide yes, wide no) { return _mm512_mask_blend_pd(m, no, yes); }
INLINE uint32_t wide_bits(wide_mask m) { return m; }
INLINE wide_mask wide_mask_of(uint32_t bits) { return (wide_mask)bits; }
#else
typedef wide_ints wide_mask;
INLINE wide_mask wide_below(wide a, wide b) { return (wide_mask)(a < b); }
INLINE wide_mask wide_at_most(wide a, wide b) { return (wide_mask)(a <= b); }
INLINE wide_mask wide_equal(wide a, wide b) { return (wide_mask)(a == b); }
INLINE wide_mask wide_signs(wide a) { return (wide_mask)a < 0; }
INLINE wide_mask wide_ints_below(wide_ints a, wide_ints b) { return a < b; }
INLINE wide_mask wide_not(wide_mask m) { return ~m; }
#if defined __AVX2__
INLINE wide wide_pick(wide_mask m, wide yes, wide no)
{
    return _mm256_blendv_pd(no, yes, (wide)m);
}
INLINE uint32_t wide_bits(wide_mask m) { return (uint32_t)_mm256_movemask_pd((wide)m); }
INLINE wide_mask wide_mask_of(uint32_t bits)
{
    const wide_ints one = { 1, 2, 4, 8 };
    return (((wide_ints) { 0 } + (int64_t)bits) & one) == one;
}
#else
INLINE wide wide_pick(wide_mask m, wide yes, wide no)
{
    return (wide)(((wide_ints)yes & m) | ((wide_ints)no & ~m));
}
INLINE uint32_t wide_bits(wide_mask m) { return (uint32_t)((m[0] & 1) | (m[1] & 2)); }
INLINE wide_mask wide_mask_of(uint32_t bits)
{
    return (wide_mask) { -(int64_t)(bits & 1), -(int64_t)(bits >> 1 & 1) };
}
#endif
#endif

INLINE wide wide_of(double a) { return (wide) { 0 } + a; }
INLINE wide_ints wide_ints_of(int64_t a) { return (wide_ints) { 0 } + a; }

INLINE wide_ints wide_pick_ints(wide_mask m, wide_ints yes, wide_ints no)
{
    return (wide_ints)wide_pick(m, (wide)yes, (wide)no);
}

INLINE wide wide_load(const double *p)
{
    wide v;

    memcpy(&v, p, sizeof v);
    return v;
}

INLINE wide_ints wide_load_ints(const int64_t *p)
{
    wide_ints v;

    memcpy(&v, p, sizeof v);
    return v;
}

INLINE void wide_store(double *p, wide v) { memcpy(p, &v, sizeof v); }
INLINE void wide_store_ints(int64_t *p, wide_ints v) { memcpy(p, &v, sizeof v); }

INLINE wide wide_abs(wide a) { return (wide)((wide_ints)a & INT64_MAX); }

/* The bits of a and the sign of b. */
INLINE wide wide_copysign(wide a, wide b)
{
    return (wide)(((wide_ints)a & INT64_MAX) | ((wide_ints)b & INT64_MIN));
}

INLINE wide_mask wide_is_finite(wide a) { return wide_below(wide_abs(a), wide_of(INFINITY)); }

#endif
