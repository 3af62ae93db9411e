/* pattern.h: what every pattern is: a number at each point.
 *
 * A row of patterns[] holds its word and its function.  A newcomer writes
 * NAME.c, a row in patterns.c and a line in Makefile.am. */
#ifndef RTC_PATTERN_H
#define RTC_PATTERN_H

#include <stdbool.h>

#include "base/arena.h"
#include "base/field.h"
#include "math/vec.h"

/* What the rest of the block says that enters some formulas. */
struct pattern_block {
    vec3 turbulence;                    /* amount; 0: none */
    int octaves;
    double omega, lambda;
    double frequency, phase;
    int noise_generator;                /* 0: the scene's */
    int number_of_waves;
};

#define PATTERN_BLOCK { .octaves = 6, .omega = 0.5, .lambda = 2, .frequency = 1, \
                        .number_of_waves = 10 }

struct pattern_ops {
    const char *name;                   /* the word of the language */
    const char *help;                   /* one line */
    size_t size;                        /* of the pattern's struct; 0: it has none */
    const void *defaults;
    const struct field *args;           /* values right after the word (gradient V); NULL: none */
    const struct field *words;          /* words anywhere in the block (brick_size V) */

    /* 0: a value for a map.  n > 0: chooses one of n in a list (checker 2). */
    int n_list;

    /* The struct begins with a struct pattern_block: whoever has read the
     * whole block fills it in, with the scene's noise generator and number of
     * waves, before prepare(). */
    bool takes_block;
    bool keeps_point;                   /* turbulence is in the formula and does not move the point */

    const char *(*prepare)(void *self, struct arena *mem);     /* NULL, or what is wrong */

    /* Values at n points: 0..1 before frequency and phase, or a list's
     * index.  Arrays, so that a wave pays the call once. */
    void (*values)(const void *self, int n, const double *x, const double *y, const double *z,
                   double *value);
};

extern const struct pattern_ops *const patterns[];      /* NULL ends */
const struct pattern_ops *pattern_find(const char *name);

#endif
