/* shade.h: points become light on the film, and new rays. */
#ifndef RTC_SHADE_H
#define RTC_SHADE_H

#include "trace/worker.h"

/* Points that are shaded together: all of one group. */
struct batch {
    struct points at;                   /* index: the number of the ray */
    uint16_t slot[BATCH];               /* in the table of shadows */
    float share[BATCH];                 /* of a texture map's entry, of a face's texture */
    const struct program *program[BATCH];
    double sx[BATCH], sy[BATCH], sz[BATCH];     /* as textures see it; not set for a plain colour */
    double u[BATCH], v[BATCH];
};

/* The points where n <= BATCH rays of the wave met something: all of one
 * group, or all of surfaces whose program depends on the point. */
void shade_hits(struct worker *w, int n, const struct wave_hit hit[]);

/* What a layer reflects, kept until it is known whether the ray gets through at all. */
struct mirror_layer {
    float r[BATCH], g[BATCH], b[BATCH];
    float adc[BATCH];                   /* weight above it times its largest reflection */
    float power;
};

/* bounce.c: the rays that leave the points of a batch. */
struct leaving {
    const float *fr, *fg, *fb;          /* what the layers let through */
    const float *trans;                 /* 0: nothing is followed; NULL: nowhere */
    const struct mirror_layer *mirror;
    int n_mirror;
};
void bounce(struct worker *w, const struct batch *b, const struct leaving *l);

/* The relative index for Fresnel's law (facts shading.md 3.3, last but one rule). */
double fresnel_index(const struct worker *w, uint32_t ray, const struct surface *s);

static inline double surface_ior(const struct surface *s)
{
    return s->interior && s->interior->ior > 0 ? s->interior->ior : 1;
}

#endif
