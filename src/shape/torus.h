/* torus.h: what torus.c, torus_cross.c and torus_first.c share. */
#ifndef RTC_TORUS_H
#define RTC_TORUS_H

#include "shape/packet.h"
#include "shape/unit.h"

struct torus {
    double major, minor;
    double unit, size;                  /* a power of two and its reciprocal */
    double ring, tube;                  /* major and minor in units */
    bool has_inner;                     /* a spindle: the sheet inside is drawn too */
};

/* A line about its point nearest to the centre, along a unit direction. */
struct torus_chord {
    vec3 p, e;
    double low, high;                   /* outside of the torus beyond these */
    double quartic[5];                  /* (|q|^2 + ring^2 - tube^2)^2 - 4 ring^2 rho^2 */
    struct ray own;                     /* the ray in units */
    double mid, length, stretch;        /* t = (mid + at / length) * stretch */
};

/* How much further than the torus a chord's ends are. */
#define TORUS_MARGIN 0x1p-30

/* The crossings with near < t < far in increasing t, at most so many. */
int torus_cross(const struct torus *s, struct ray ray, double near, double far, int most, double t[]);

/* Where the line enters, between a and b where it enters once; NaN: this way
 * is not sure of it. */
double torus_entry(const struct torus *s, const struct torus_chord *c, double a, double b);

/* Of one ray: the first crossing with near < t < far, into t. */
enum torus_first { TORUS_MISSED, TORUS_MET, TORUS_UNSURE };
enum torus_first torus_first(const struct torus *s, const struct ray *ray, double near, double far, double *t);

/* Of many: that with t > 0. */
void torus_first_many(const void *self, const struct packet *p, const uint8_t may[],
                      struct crossings *out);

#endif
