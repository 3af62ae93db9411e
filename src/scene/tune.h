/* tune.h: from a pattern's number to a place in its map (facts patterns.md 3.1,
 * 4.1, 5.3); inline, since the tracer does this for every point. */
#ifndef RTC_TUNE_H
#define RTC_TUNE_H

#include "math/noise.h"
#include "scene/pigment.h"

struct map_place { int before, after; float share; };   /* of the entry after */

/* Stirs a point by the vector noise; the numbers are single precision (patterns.md 0, 5.3). */
static inline void stir(const struct turbulence *t, double *x, double *y, double *z)
{
    vec3 d = noise_vector_turbulence(vec(*x, *y, *z), t->octaves, (float)t->omega,
                                     (float)t->lambda);

    *x += t->amount.x * d.x;
    *y += t->amount.y * d.y;
    *z += t->amount.z * d.z;
}

/* The sine wave of patterns.md 3.1, where the sign of v counts. */
static inline double wave_sine(double v)
{
    double w = fabs(v), s = sin(2 * M_PI * (w - floor(w)));

    return v >= 0 ? s : -s;
}

static inline double wave_triangle(double v)
{
    double o = v >= 0 ? v - floor(v) : v + 1 + floor(fabs(v));

    return o >= 0.5 ? 2 * (1 - o) : 2 * o;
}

static inline double wave_of(enum wave_type type, double exponent, double v)
{
    switch (type) {
    case WAVE_RAMP: return v;
    case WAVE_TRIANGLE: return wave_triangle(v);
    case WAVE_SINE: return (1 + wave_sine(v)) / 2;
    case WAVE_SCALLOP: return fabs(wave_sine(v / 2));
    case WAVE_CUBIC: return v * v * (3 - 2 * v);
    case WAVE_POLY: return pow(v, (float)exponent);
    }
    return v;
}

/* 1.00001: POV-Ray's period, so that a value of exactly 1 stays at the end of its map. */
static inline double tune(const struct pattern_use *use, double v)
{
    float frequency = (float)use->frequency, phase = (float)use->phase;

    if (frequency != 0 && (frequency != 1 || phase != 0 || v > 1.00001 || v < -1.00001))
        v = fmod(v * (double)frequency + (double)phase, 1.00001);
    if (v < 0)
        v -= floor(v);
    return use->wave == WAVE_RAMP ? v : wave_of(use->wave, use->exponent, v);
}

/* Patterns.md 4.1: keys are used in the order written, never sorted. */
static inline struct map_place look_up(const float *key, int n, double v)
{
    int c = 0;

    if (n == 0 || v >= (double)key[n - 1])
        return (struct map_place) { n - 1, n - 1, 0 };
    while ((double)key[c] < v)
        c++;
    if (c == 0 || (double)key[c] == v)
        return (struct map_place) { c, c, 0 };
    double low = key[c - 1];
    return (struct map_place) { c - 1, c, (float)((v - low) / ((double)key[c] - low)) };
}

static inline colour colour_between(colour a, colour b, float t)
{
    return (colour) { a.r + t * (b.r - a.r), a.g + t * (b.g - a.g), a.b + t * (b.b - a.b),
                      a.f + t * (b.f - a.f), a.t + t * (b.t - a.t) };
}

#endif
