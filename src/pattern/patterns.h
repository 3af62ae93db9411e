/* patterns.h: the list of all patterns, and what they share. */
#ifndef RTC_PATTERNS_H
#define RTC_PATTERNS_H

#include "math/kernel.h"
#include "math/noise.h"
#include "pattern/pattern.h"

/* Adding a pattern is adding a row: pattern_NAME is defined in its file. */
#define PATTERNS(P) \
    P(agate) \
    P(boxed) \
    P(bozo) \
    P(brick) \
    P(bumps) \
    P(cells) \
    P(checker) \
    P(crackle) \
    P(cubic) \
    P(cylindrical) \
    P(dents) \
    P(function) \
    P(gradient) \
    P(granite) \
    P(hexagon) \
    P(leopard) \
    P(marble) \
    P(onion) \
    P(planar) \
    P(quilted) \
    P(radial) \
    P(ripples) \
    P(spherical) \
    P(spiral1) \
    P(spiral2) \
    P(spotted) \
    P(square) \
    P(triangular) \
    P(waves) \
    P(wood) \
    P(wrinkles)

#define PATTERN_DECLARE(name) extern const struct pattern_ops pattern_##name;
PATTERNS(PATTERN_DECLARE)
#undef PATTERN_DECLARE

/* POV-Ray's guard at the borders of cells; part of the patterns' definition. */
#define BORDER 1e-10

/* values() from a function of one point. */
#define POINTWISE(values, at) \
    static void values(const void *self, int n, const double *restrict x, \
                       const double *restrict y, const double *restrict z, \
                       double *restrict value) \
    { \
        for (int i = 0; i < n; i++) \
            value[i] = at(self, vec(x[i], y[i], z[i])); \
    }

INLINE double fraction(double v) { return v - floor(v); }
INLINE double unit_clamp(double v) { return v < 0 ? 0 : v > 1 ? 1 : v; }

/* A sine of period 1, odd about 0. */
INLINE double cycle(double v)
{
    return v >= 0 ? sin(2 * M_PI * fraction(v)) : -sin(2 * M_PI * fraction(-v));
}

/* The triangle wave of period 1. */
INLINE double triangle(double v)
{
    double part = v >= 0 ? fraction(v) : v + 1 + floor(fabs(v));
    return part >= 0.5 ? 2 * (1 - part) : 2 * part;
}

static inline int generator_of(const struct pattern_block *b)
{
    return b->noise_generator ? b->noise_generator : NOISE_DEFAULT;
}

/* POV-Ray keeps omega and lambda in single precision. */
static inline double block_turbulence(const struct pattern_block *b, vec3 p)
{
    return noise_turbulence(generator_of(b), p, b->octaves, (double)(float)b->omega,
                            (double)(float)b->lambda);
}

static inline vec3 block_vector_turbulence(const struct pattern_block *b, vec3 p)
{
    return noise_vector_turbulence(p, b->octaves, (double)(float)b->omega,
                                   (double)(float)b->lambda);
}

/* Rows of patterns whose struct is the block alone. */
extern const struct pattern_block pattern_block_default;
extern const struct field pattern_noise_words[];

#endif
