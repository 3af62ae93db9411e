/* tone.h: from the scene's numbers to the file's, as POV-Ray encodes them. */
#ifndef RTC_TONE_H
#define RTC_TONE_H

#include <stdint.h>

#include "image/image.h"

/* The file value, 0..1 and beyond, not clipped yet. */
float tone_encode(const struct tone *t, float value);

/* The nearest of 0..top. */
unsigned tone_level(float encoded, unsigned top);

enum { TONE_OCTAVES = 16, TONE_STEPS = 128, TONE_BUCKETS = TONE_OCTAVES * TONE_STEPS };

/* The 8-bit level of any value without a power function: encoding never
 * decreases, so a level is known by the least value that reaches it. */
struct tone_table {
    float least[257];                   /* of each level; [256]: never reached */
    uint8_t first[TONE_BUCKETS];        /* level of the least value of a bucket */
};
void tone_table_init(struct tone_table *table, const struct tone *t);
unsigned tone_table_level(const struct tone_table *table, float value);

/* Of n pixels: four floats each, of which three become bytes. */
void tone_table_row(const struct tone_table *table, unsigned n, const float *pixel, uint8_t *out);

#endif
