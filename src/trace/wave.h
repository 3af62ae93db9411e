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

void wave_reserve(struct wave *w, int room);
void wave_release(struct wave *w);

/* The i-th of another wave becomes the last; room is reserved. */
static inline void wave_move(struct wave *to, const struct wave *from, int i)
{
#define C(type, name) to->name[to->n] = from->name[i];
    WAVE_COLUMNS(C)
#undef C
    to->n++;
}

static inline struct ray wave_at(const struct wave *w, int i)
{
    return (struct ray) { { w->x[i], w->y[i], w->z[i] }, { w->dx[i], w->dy[i], w->dz[i] } };
}

#endif
