/* vec.h: points, directions, colours; by value. */
#ifndef RTC_VEC_H
#define RTC_VEC_H

#include <math.h>
#include <stdbool.h>

typedef struct { double x, y, z; } vec3;
typedef struct { double u, v; } vec2;
typedef struct { float r, g, b; } rgb;              /* linear in the scene's working space */
typedef struct { float r, g, b, f, t; } colour;     /* with filter and transmit */

static inline vec3 vec(double x, double y, double z) { return (vec3) { x, y, z }; }
static inline vec3 vec_add(vec3 a, vec3 b) { return vec(a.x + b.x, a.y + b.y, a.z + b.z); }
static inline vec3 vec_sub(vec3 a, vec3 b) { return vec(a.x - b.x, a.y - b.y, a.z - b.z); }
static inline vec3 vec_mul(vec3 a, vec3 b) { return vec(a.x * b.x, a.y * b.y, a.z * b.z); }
static inline vec3 vec_scale(vec3 a, double s) { return vec(a.x * s, a.y * s, a.z * s); }
static inline vec3 vec_neg(vec3 a) { return vec(-a.x, -a.y, -a.z); }
static inline double vec_dot(vec3 a, vec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
static inline double vec_length(vec3 a) { return sqrt(vec_dot(a, a)); }

/* a + s * b with one rounding an axis. */
static inline vec3 vec_fma(vec3 a, double s, vec3 b)
{
    return vec(fma(s, b.x, a.x), fma(s, b.y, a.y), fma(s, b.z, a.z));
}

static inline vec3 vec_cross(vec3 a, vec3 b)
{
    return vec(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
}

static inline double vec_get(vec3 a, int axis) { return axis == 0 ? a.x : axis == 1 ? a.y : a.z; }

/* One instruction each, where fmax and fmin are calls; b if either is NaN. */
static inline double larger(double a, double b) { return a > b ? a : b; }
static inline double smaller(double a, double b) { return a < b ? a : b; }
static inline float largerf(float a, float b) { return a > b ? a : b; }
static inline float smallerf(float a, float b) { return a < b ? a : b; }

static inline double vec_largest(vec3 a)            /* of the absolute components */
{
    return larger(fabs(a.x), larger(fabs(a.y), fabs(a.z)));
}

/* Unit length at any scale: divides by the largest component first, so that
 * 1e-200 and 1e200 do not underflow or overflow.  Zero stays zero. */
static inline vec3 vec_unit(vec3 a)
{
    double big = vec_largest(a);

    if (!(big > 0) || isinf(big))
        return vec(0, 0, 0);
    if (big < 1e-100 || big > 1e100)
        a = vec_scale(a, 1 / big);
    return vec_scale(a, 1 / vec_length(a));
}

/* For what is of unit length but for rounding: one step of Newton's method,
 * without a root or a division. */
static inline vec3 vec_unit_again(vec3 a)
{
    double square = vec_dot(a, a);

    return fabs(square - 1) < 1e-8 ? vec_scale(a, 1.5 - 0.5 * square) : vec_unit(a);
}

static inline bool vec_is_finite(vec3 a) { return isfinite(a.x) && isfinite(a.y) && isfinite(a.z); }

static inline rgb rgb_of(float r, float g, float b) { return (rgb) { r, g, b }; }
static inline rgb rgb_add(rgb a, rgb b) { return rgb_of(a.r + b.r, a.g + b.g, a.b + b.b); }
static inline rgb rgb_mul(rgb a, rgb b) { return rgb_of(a.r * b.r, a.g * b.g, a.b * b.b); }
static inline rgb rgb_scale(rgb a, float s) { return rgb_of(a.r * s, a.g * s, a.b * s); }
static inline float rgb_max(rgb a) { return largerf(a.r, largerf(a.g, a.b)); }

/* POV-Ray's brightness (facts shading.md, notation). */
static inline float rgb_grey(rgb a) { return 0.297f * a.r + 0.589f * a.g + 0.114f * a.b; }
static inline rgb colour_rgb(colour c) { return rgb_of(c.r, c.g, c.b); }

#endif
