/* internal.h: the functions of space that internal(N) stands for, by number
 * (facts sdl.md 5.4, patterns.md 8.1). */
#ifndef RTC_INTERNAL_H
#define RTC_INTERNAL_H

#include <stdbool.h>

enum { INTERNAL_MOST_OCTAVES = 64 };

/* f_ridged_mf's weights: POV-Ray works them out at a function's first call
 * and keeps them for all later ones. */
struct octave_weights {
    bool known;
    double weight[INTERNAL_MOST_OCTAVES];
};

/* What is behind a function and is none of its arguments. */
struct internal_setting {
    int noise_generator;                /* the scene's */
    struct octave_weights *weights;     /* NULL: worked out anew at each call */
};

struct internal {
    const char *name;                   /* as functions.inc calls it; NULL: there is no such number */
    int parameters;                     /* x, y and z among them */
    double (*at)(double x, double y, double z, const double *p, const struct internal_setting *s);
};

const struct internal *internal_find(double number);    /* NULL: none */

#endif
