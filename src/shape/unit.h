/* unit.h: what primitives share: their own unit space, and error bounds.
 *
 * Lengths are multiplied by a power of two that brings the shape to a size
 * of 1 to 2.  That changes no bit of a mantissa, so a scene scaled by 2^k
 * gives the same picture, and squares never overflow or underflow. */
#ifndef RTC_SHAPE_UNIT_H
#define RTC_SHAPE_UNIT_H

#include "math/kernel.h"
#include "shape/shape.h"

#define ROUNDING 0x1p-53                /* largest relative error of one operation */

/* A power of two that brings size to [1, 2): from the bits of its exponent. */
static inline double unit_for(double size)
{
    enum { BIAS = 1023, MOST = 1000 };
    union { double value; int64_t bits; } u = { .value = fabs(size) };
    int64_t e = (u.bits >> 52) - BIAS;

    e = e < -MOST ? -MOST : e > MOST ? MOST : e;
    u.bits = (BIAS - e) << 52;
    return u.value;
}

static inline double vec_sum_abs(vec3 a) { return fabs(a.x) + fabs(a.y) + fabs(a.z); }

static inline double length_of(vec3 a)
{
    double big = vec_largest(a);

    if (!(big > 0) || isinf(big))
        return big;
    double unit = unit_for(big);
    return vec_length(vec_scale(a, unit)) / unit;
}

/* Unit length by division: an axis-parallel vector becomes an exact axis. */
static inline vec3 direction_of(vec3 a)
{
    double big = vec_largest(a);

    if (!(big > 0) || isinf(big))
        return vec(0, 0, 0);
    a = vec_scale(a, unit_for(big));
    double length = vec_length(a);
    return vec(a.x / length, a.y / length, a.z / length);
}

/* How far ray_at(t) may be from the surface that was solved for: the ray's
 * own rounding, the re-centred solution's, and the evaluation's.  The suite
 * in tests/check_shape.c finds at most half of it. */
static inline double slack_at(struct ray ray, double t, double size)
{
    return 4 * ROUNDING * (vec_sum_abs(ray.origin) + fabs(t) * vec_sum_abs(ray.dir) + size);
}

/* Member by member: a struct put together and copied at once stalls. */
static inline void hit_put(struct hit *out, struct ray ray, double t, double size, uint32_t part)
{
    out->t = t;
    out->slack = slack_at(ray, t, size);
    out->u = out->v = 0;
    out->part = part;
}

static inline struct hit hit_at(struct ray ray, double t, double size, uint32_t part)
{
    return (struct hit) { .t = t, .slack = slack_at(ray, t, size), .part = part };
}

/* Bounds that rounding cannot push the surface out of. */
static inline struct bounds bounds_pad(struct bounds b)
{
    double pad = 8 * ROUNDING * larger(vec_largest(b.low), vec_largest(b.high));
    vec3 by = vec(pad, pad, pad);

    return (struct bounds) { vec_sub(b.low, by), vec_add(b.high, by) };
}

/* May dir be squared? */
static inline bool ray_is_tame(struct ray ray)
{
    double dd = vec_dot(ray.dir, ray.dir);
    return dd > 0x1p-400 && dd < 0x1p400;
}

/* Makes it so; t of the old ray is t of the new one times the result. */
static inline double ray_tame(struct ray *ray)
{
    double stretch = unit_for(vec_largest(ray->dir));

    ray->dir = vec_scale(ray->dir, stretch);
    return stretch;
}

/* The part of a line inside a convex solid. */
struct span {
    double near, far;
    uint32_t near_part, far_part;       /* what it enters and leaves by */
};

typedef bool span_cut(const void *self, struct ray ray, struct span *out);

static __attribute__((noinline, unused)) bool span_of_wild(span_cut *cut, const void *self,
                                                           struct ray ray, struct span *out)
{
    double stretch = ray_tame(&ray);

    if (!cut(self, ray, out))
        return false;
    out->near *= stretch;
    out->far *= stretch;
    return true;
}

INLINE bool span_of(span_cut *cut, const void *self, struct ray ray, struct span *out)
{
    if (LIKELY(ray_is_tame(ray)))
        return cut(self, ray, out);

    struct span wild;                   /* so that out need not live in memory */
    bool meets = span_of_wild(cut, self, ray, &wild);
    if (meets)
        *out = wild;
    return meets;
}

/* hits() of a convex solid.  A span without ends (a tube looked along) has
 * no crossings. */
INLINE int span_hits(span_cut *cut, const void *self, double size, struct ray ray,
                     struct hit out[])
{
    struct span s;

    if (!span_of(cut, self, ray, &s) || !(fabs(s.near) < INFINITY && fabs(s.far) < INFINITY))
        return 0;
    hit_put(&out[0], ray, s.near, size, s.near_part);
    hit_put(&out[1], ray, s.far, size, s.far_part);
    return 2;
}

INLINE bool span_nearest(span_cut *cut, const void *self, double size, struct ray ray,
                         double near, double far, struct hit *out)
{
    struct span s;

    if (!span_of(cut, self, ray, &s) || !(fabs(s.near) < INFINITY && fabs(s.far) < INFINITY))
        return false;
    bool first = s.near > near;
    double t = first ? s.near : s.far;
    if (!(t > near && t < far))
        return false;
    hit_put(out, ray, t, size, first ? s.near_part : s.far_part);
    return true;
}

/* u of the surfaces of revolution about y: 0..1 from +x toward +z (facts
 * shading.md 7.13). */
static inline double longitude(double x, double z)
{
    double r = sqrt(x * x + z * z);

    if (z == 0 || r == 0)
        return x > 0 ? 0 : 0.5;
    double angle = acos(fmax(-1, fmin(1, x / r))) / (2 * M_PI);
    return z < 0 ? 1 - angle : angle;
}

#endif
