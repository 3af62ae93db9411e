/* tone.c: from the scene's numbers to the file's (facts shading.md 5.2). */
#include "image/tone.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

static float srgb_encode(float x)
{
    return x <= 0.0031308f ? x * 12.92f : 1.055f * powf(x, 1.0f / 2.4f) - 0.055f;
}

/* Exponents within 1% of 1 are neutral: no power is taken. */
static float power_decode(float x, float gamma)
{
    if (fabsf(1.0f - gamma) <= 0.01f)
        return x;
    return powf(fmaxf(x, 0.0f), gamma);
}

float tone_encode(const struct tone *t, float value)
{
    switch (t->working) {
    case TONE_LINEAR:
        return srgb_encode(value);
    case TONE_POWER:
        return srgb_encode(power_decode(value, (float)t->gamma));
    default:                            /* written as it is */
        return value;
    }
}

/* Clips after encoding; NaN is black. */
unsigned tone_level(float encoded, unsigned top)
{
    if (!(encoded > 0.0f))
        return 0;
    if (encoded >= 1.0f)
        return top;
    return (unsigned)floorf(encoded * (float)top + 0.5f);
}

static uint32_t float_bits(float x)
{
    uint32_t bits;

    memcpy(&bits, &x, sizeof bits);
    return bits;
}

static float bits_float(uint32_t bits)
{
    float x;

    memcpy(&x, &bits, sizeof x);
    return x;
}

/* Positive floats are ordered as their bits are, so halving the range of
 * bits finds the least one that reaches a level. */
static float least_of(const struct tone *t, unsigned level)
{
    uint32_t below = 0, reached = float_bits(2.0f);

    while (reached - below > 1) {
        uint32_t middle = below + (reached - below) / 2;
        if (tone_level(tone_encode(t, bits_float(middle)), 255) >= level)
            reached = middle;
        else
            below = middle;
    }
    return bits_float(reached);
}

/* Buckets are the floats from 2^-16 to 1 by their exponent and the first
 * seven bits of their fraction. */
enum { FRACTION_SHIFT = 23 - 7 };
static const uint32_t first_bucket = (127u - TONE_OCTAVES) << 7;

void tone_table_init(struct tone_table *table, const struct tone *t)
{
    unsigned level = 0;

    table->least[0] = -INFINITY;
    for (unsigned i = 1; i < 256; i++)
        table->least[i] = least_of(t, i);
    table->least[256] = INFINITY;       /* never reached: values from 1 on are not looked up */
    for (uint32_t i = 0; i < TONE_BUCKETS; i++) {
        float low = bits_float((i + first_bucket) << FRACTION_SHIFT);
        while (low >= table->least[level + 1])
            level++;
        table->first[i] = (uint8_t)level;
    }
}

/* Few buckets hold more than one limit: the first is not worth a branch. */
static inline unsigned level_of(const struct tone_table *table, float value)
{
    unsigned level = 0;

    if (value >= 1.0f)
        return 255;
    if (value >= 0x1p-16f)
        level = table->first[(float_bits(value) >> FRACTION_SHIFT) - first_bucket];
    level += value >= table->least[level + 1];
    while (value >= table->least[level + 1])
        level++;
    return level;
}

unsigned tone_table_level(const struct tone_table *table, float value)
{
    return level_of(table, value);
}

void tone_table_row(const struct tone_table *table, unsigned n, const float *pixel, uint8_t *out)
{
    for (; n > 0; n--, pixel += 4, out += 3)
        for (int i = 0; i < 3; i++)
            out[i] = (uint8_t)level_of(table, pixel[i]);
}
