/* film.h: where light arrives; the film only adds. */
#ifndef RTC_FILM_H
#define RTC_FILM_H

#include <stdint.h>

#include "math/vec.h"

/* The pixels of a tile, and behind them hidden ones: what a reflection with
 * an exponent sees is gathered in one of those until it is whole, because a
 * power of a sum is no sum of powers. */
struct film {
    double (*sum)[4];                   /* red, green, blue, transmit */
    struct film_branch {
        uint32_t parent;                /* of smaller number */
        rgb weight;
        float power;
    } *branch;                          /* of the pixels from n_pixel on */
    uint32_t n, n_pixel, room;
};

void film_start(struct film *f, uint32_t n_pixel);      /* all black */
uint32_t film_branch(struct film *f, uint32_t parent, rgb weight, float power);
void film_settle(struct film *f, uint32_t first);       /* hidden pixels from first on, into their parents */
void film_release(struct film *f);

/* The pixel of the tile that a pixel, hidden or not, is for. */
static inline uint32_t film_root(const struct film *f, uint32_t pixel)
{
    while (pixel >= f->n_pixel)
        pixel = f->branch[pixel].parent;
    return pixel;
}

static inline void film_add(struct film *f, uint32_t pixel, rgb c)
{
    f->sum[pixel][0] += c.r;
    f->sum[pixel][1] += c.g;
    f->sum[pixel][2] += c.b;
}

#endif
