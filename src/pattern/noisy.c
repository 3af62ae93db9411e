/* noisy.c: bozo, bumps, spotted, dents, granite, wrinkles: noise, and sums
 * of it (facts patterns.md 3.6, 3.13, 3.16, 3.36). */
#include "pattern/patterns.h"

static double noise(const void *self, vec3 p) { return noise_at(generator_of(self), p); }

static double dents(const void *self, vec3 p)
{
    double v = noise(self, p);
    return v * v * v;
}

static double granite(const void *self, vec3 p)
{
    bool original = generator_of(self) == 1;
    double sum = 0, scale = 1;

    for (int i = 0; i < 6; i++, scale *= 2) {
        double v = noise(self, vec_scale(p, 4 * scale));
        sum += (original ? fabs(0.5 - v) : fmin(0.5, fabs(1 - 2 * v))) / scale;
    }
    return sum;
}

static double wrinkles(const void *self, vec3 p)
{
    bool original = generator_of(self) == 1;
    double sum = 0, scale = 1;

    for (int i = 0; i < 10; i++, scale *= 2) {
        double v = noise(self, vec_scale(p, scale));
        sum += (original ? v : unit_clamp(2 * v - 0.5)) / scale;
    }
    return sum / 2;
}

POINTWISE(noise_values, noise)
POINTWISE(dents_values, dents)
POINTWISE(granite_values, granite)
POINTWISE(wrinkles_values, wrinkles)

#define NOISY(word, about, function) \
    const struct pattern_ops pattern_##word = { \
        .name = #word, .help = about, .size = sizeof(struct pattern_block), \
        .defaults = &pattern_block_default, .words = pattern_noise_words, .takes_block = true, \
        .values = function, \
    };

NOISY(bozo, "smooth noise", noise_values)
NOISY(bumps, "smooth noise", noise_values)
NOISY(spotted, "smooth noise", noise_values)
NOISY(dents, "smooth noise, mostly low", dents_values)
NOISY(granite, "rough noise, like stone", granite_values)
NOISY(wrinkles, "rough noise, like crumpled paper", wrinkles_values)
