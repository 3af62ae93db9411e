/* shade.h: points become light on the film, and new rays. */
#ifndef RTC_SHADE_H
#define RTC_SHADE_H

#include "trace/worker.h"

/* Points that are shaded together: all of one group. */
struct batch {
    int n;
    uint32_t hit[BATCH];                /* number of the ray */
    uint16_t slot[BATCH];               /* in the table of shadows */
    float share[BATCH];                 /* of a texture map's entry, of a face's texture */
    const struct program *program[BATCH];
    const struct surface *surface[BATCH];
    double x[BATCH], y[BATCH], z[BATCH];                /* world */
    double sx[BATCH], sy[BATCH], sz[BATCH];             /* as textures see it */
    double u[BATCH], v[BATCH];
    double nx[BATCH], ny[BATCH], nz[BATCH];             /* unit, turned to the viewer */
    double dx[BATCH], dy[BATCH], dz[BATCH];             /* of the ray that came, unit */
};

void shade_tasks(struct worker *w, const struct task *task, int n);     /* n <= BATCH */

/* What a layer reflects, kept until it is known whether the ray gets through at all. */
struct mirror_layer {
    float r[BATCH], g[BATCH], b[BATCH];
    float adc[BATCH];                   /* weight above it times its largest reflection */
    float power;
};

/* bounce.c: the rays that leave the points of a batch. */
struct leaving {
    const float *fr, *fg, *fb;          /* what the layers let through */
    const float *trans;                 /* 0: nothing is followed */
    const struct mirror_layer *mirror;
    int n_mirror;
};
void bounce(struct worker *w, const struct batch *b, const struct leaving *l);

/* The relative index for Fresnel's law (facts shading.md 3.3, last but one rule). */
double fresnel_index(const struct worker *w, uint32_t hit, const struct surface *s);

static inline double surface_ior(const struct surface *s)
{
    return s->interior && s->interior->ior > 0 ? s->interior->ior : 1;
}

#endif
