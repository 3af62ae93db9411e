/* bitmap.h: the pixels of a picture file, as they stand in the file. */
#ifndef RTC_BITMAP_H
#define RTC_BITMAP_H

#include <stdbool.h>
#include <stdint.h>

#include "base/arena.h"

struct bitmap {
    unsigned width, height;             /* pixels */
    unsigned channels;                  /* 1 grey, 2 grey + alpha, 3 RGB, 4 RGB + alpha */
    unsigned bits;                      /* 8 or 16: of the file; smaller depths are widened to 8 */
    bool is_linear;                     /* samples are linear light (HDR formats; pixel_float) */
    bool has_srgb, has_gamma;           /* what the file says of its encoding (PNG chunks) */
    double gamma;                       /* encoding exponent of gAMA: 0.45455 for 2.2 */
    bool is_indexed;                    /* came with a palette */
    uint8_t *index;                     /* palette number of each pixel, if is_indexed */
    unsigned n_palette;
    uint8_t (*palette)[4];              /* red, green, blue, alpha */
    uint16_t *pixel16;                  /* width * height * channels, top row first; if bits is 16 */
    uint8_t *pixel8;                    /* the same for 8 bits */
    float *pixel_float;                 /* the same for float formats */
    enum { BITMAP_PNG, BITMAP_JPEG, BITMAP_GIF, BITMAP_TGA, BITMAP_BMP, BITMAP_PPM, BITMAP_PGM,
           BITMAP_TIFF, BITMAP_HDR, BITMAP_EXR, BITMAP_SYS } format;
};

/* A sample as 0..1 (more for float formats), not decoded. */
static inline float bitmap_sample(const struct bitmap *b, unsigned x, unsigned y, unsigned channel)
{
    unsigned long long i = ((unsigned long long)y * b->width + x) * b->channels + channel;

    if (b->pixel_float)
        return b->pixel_float[i];
    return b->bits == 16 ? (float)b->pixel16[i] / 65535.0f : (float)b->pixel8[i] / 255.0f;
}

#endif
