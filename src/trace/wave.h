/* wave.h: rays under way, an array a member. */
#ifndef RTC_WAVE_H
#define RTC_WAVE_H

#include <stdint.h>

#include "shape/shape.h"

/* What a ray carries, a row each: recursion becomes a loop over waves. */
#define WAVE_COLUMNS(C)                                                         \
    C(double, x)        C(double, y)        C(double, z)        /* origin */    \
    C(double, dx)       C(double, dy)       C(double, dz)       /* unit */      \
    C(float, red)       C(float, green)     C(float, blue)      /* weight */    \
    C(float, alpha)     /* weight of what is seen through, for transmit */      \
    C(float, adc)       /* POV-Ray's scalar weight, for adc_bailout */          \
    C(uint32_t, pixel)  /* of the film */                                       \
    C(uint32_t, inside) /* list of interiors it travels in: insides.h */        \
    C(uint16_t, depth)  C(uint8_t, mask)

struct wave {
    int n, room;
#define C(type, name) type *name;
    WAVE_COLUMNS(C)
#undef C
};

/* One of them. */
struct wave_ray {
    struct ray ray;
    rgb weight;
    float alpha, adc;
    uint32_t pixel, inside;
    uint16_t depth;
    uint8_t mask;
};

void wave_reserve(struct wave *w, int room);
void wave_release(struct wave *w);

static inline void wave_push(struct wave *w, const struct wave_ray *r)
{
    if (w->n == w->room)
        wave_reserve(w, w->n + 1);
    int i = w->n++;
    w->x[i] = r->ray.origin.x;
    w->y[i] = r->ray.origin.y;
    w->z[i] = r->ray.origin.z;
    w->dx[i] = r->ray.dir.x;
    w->dy[i] = r->ray.dir.y;
    w->dz[i] = r->ray.dir.z;
    w->red[i] = r->weight.r;
    w->green[i] = r->weight.g;
    w->blue[i] = r->weight.b;
    w->alpha[i] = r->alpha;
    w->adc[i] = r->adc;
    w->pixel[i] = r->pixel;
    w->inside[i] = r->inside;
    w->depth[i] = r->depth;
    w->mask[i] = r->mask;
}

static inline struct ray wave_at(const struct wave *w, int i)
{
    return (struct ray) { { w->x[i], w->y[i], w->z[i] }, { w->dx[i], w->dy[i], w->dz[i] } };
}

#endif
