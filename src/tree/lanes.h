/* lanes.h: eight floats at once, for boxes; and four, for a point.
 *
 * lanes_max(a, b) and lanes_min(a, b) give b where either is NaN, whatever
 * the instruction set. */
#ifndef RTC_LANES_H
#define RTC_LANES_H

#include <stdint.h>

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
INLINE lanes lanes_div(lanes a, lanes b) { return _mm256_div_ps(a, b); }
INLINE lanes lanes_max(lanes a, lanes b) { return _mm256_max_ps(a, b); }
INLINE lanes lanes_min(lanes a, lanes b) { return _mm256_min_ps(a, b); }

/* a * b - c and a * b + c, rounded once or twice. */
#ifdef __FMA__
INLINE lanes lanes_mul_sub(lanes a, lanes b, lanes c) { return _mm256_fmsub_ps(a, b, c); }
INLINE lanes lanes_mul_add(lanes a, lanes b, lanes c) { return _mm256_fmadd_ps(a, b, c); }
#else
INLINE lanes lanes_mul_sub(lanes a, lanes b, lanes c) { return lanes_sub(lanes_mul(a, b), c); }
INLINE lanes lanes_mul_add(lanes a, lanes b, lanes c) { return lanes_add(lanes_mul(a, b), c); }
#endif

/* Bit i: a[i] <= b[i]. */
INLINE unsigned lanes_not_above(lanes a, lanes b)
{
    return (unsigned)_mm256_movemask_ps(_mm256_cmp_ps(a, b, _CMP_LE_OQ));
}

/* yes where a <= b, no elsewhere. */
INLINE lanes lanes_where_not_above(lanes a, lanes b, lanes yes, lanes no)
{
    return _mm256_blendv_ps(no, yes, _mm256_cmp_ps(a, b, _CMP_LE_OQ));
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
INLINE lanes lanes_div(lanes a, lanes b) { return LANES_BOTH(_mm_div_ps); }
INLINE lanes lanes_max(lanes a, lanes b) { return LANES_BOTH(_mm_max_ps); }
INLINE lanes lanes_min(lanes a, lanes b) { return LANES_BOTH(_mm_min_ps); }
#undef LANES_BOTH
INLINE lanes lanes_mul_sub(lanes a, lanes b, lanes c) { return lanes_sub(lanes_mul(a, b), c); }
INLINE lanes lanes_mul_add(lanes a, lanes b, lanes c) { return lanes_add(lanes_mul(a, b), c); }

INLINE __m128 lanes_half_where(__m128 which, __m128 yes, __m128 no)
{
    return _mm_or_ps(_mm_and_ps(which, yes), _mm_andnot_ps(which, no));
}
INLINE lanes lanes_where_not_above(lanes a, lanes b, lanes yes, lanes no)
{
    return (lanes) { lanes_half_where(_mm_cmple_ps(a.a, b.a), yes.a, no.a),
                     lanes_half_where(_mm_cmple_ps(a.b, b.b), yes.b, no.b) };
}

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
INLINE lanes lanes_div(lanes a, lanes b) { LANES_EACH(a.a[i] / b.a[i]); }
INLINE lanes lanes_max(lanes a, lanes b) { LANES_EACH(a.a[i] > b.a[i] ? a.a[i] : b.a[i]); }
INLINE lanes lanes_min(lanes a, lanes b) { LANES_EACH(a.a[i] < b.a[i] ? a.a[i] : b.a[i]); }
INLINE lanes lanes_mul_sub(lanes a, lanes b, lanes c) { LANES_EACH(a.a[i] * b.a[i] - c.a[i]); }
INLINE lanes lanes_mul_add(lanes a, lanes b, lanes c) { LANES_EACH(a.a[i] * b.a[i] + c.a[i]); }
INLINE lanes lanes_where_not_above(lanes a, lanes b, lanes yes, lanes no)
{
    LANES_EACH(a.a[i] <= b.a[i] ? yes.a[i] : no.a[i]);
}
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

#ifdef __SSE2__

typedef __m128 quad;

INLINE quad quad_of(float a) { return _mm_set1_ps(a); }
INLINE quad quad_load(const float a[4]) { return _mm_loadu_ps(a); }
INLINE void quad_store(float to[4], quad a) { _mm_storeu_ps(to, a); }
INLINE quad quad_add(quad a, quad b) { return _mm_add_ps(a, b); }
INLINE quad quad_sub(quad a, quad b) { return _mm_sub_ps(a, b); }
INLINE quad quad_mul(quad a, quad b) { return _mm_mul_ps(a, b); }
INLINE quad quad_max(quad a, quad b) { return _mm_max_ps(a, b); }
INLINE quad quad_min(quad a, quad b) { return _mm_min_ps(a, b); }
INLINE quad quad_turn(quad a) { return _mm_shuffle_ps(a, a, _MM_SHUFFLE(3, 0, 2, 1)); }
INLINE void quad_whole(int32_t to[4], quad a)
{
    _mm_storeu_si128((__m128i *)to, _mm_cvttps_epi32(a));
}

#else

typedef struct { float a[4]; } quad;

#define QUAD_EACH(expression) \
    quad to; \
    for (int i = 0; i < 4; i++) \
        to.a[i] = (expression); \
    return to

INLINE quad quad_of(float a) { QUAD_EACH(a); }
INLINE quad quad_load(const float a[4]) { QUAD_EACH(a[i]); }
INLINE quad quad_add(quad a, quad b) { QUAD_EACH(a.a[i] + b.a[i]); }
INLINE quad quad_sub(quad a, quad b) { QUAD_EACH(a.a[i] - b.a[i]); }
INLINE quad quad_mul(quad a, quad b) { QUAD_EACH(a.a[i] * b.a[i]); }
INLINE quad quad_max(quad a, quad b) { QUAD_EACH(a.a[i] > b.a[i] ? a.a[i] : b.a[i]); }
INLINE quad quad_min(quad a, quad b) { QUAD_EACH(a.a[i] < b.a[i] ? a.a[i] : b.a[i]); }
INLINE quad quad_turn(quad a) { QUAD_EACH(a.a[i == 3 ? 3 : (i + 1) % 3]); }
#undef QUAD_EACH

INLINE void quad_store(float to[4], quad a)
{
    for (int i = 0; i < 4; i++)
        to[i] = a.a[i];
}

INLINE void quad_whole(int32_t to[4], quad a)
{
    for (int i = 0; i < 4; i++)
        to[i] = (int32_t)a.a[i];
}

#endif
#endif
