/* packet.h: some rays in columns, and what one shape says of all of them.
 *
 * A hot shape has hits_many beside hits: the same answers to the bit, a
 * register of rays at a time.  Lanes that need a rarer way than the usual one
 * (doubtful, or of a wild length) are left to hits(). */
#ifndef RTC_PACKET_H
#define RTC_PACKET_H

#include "math/wide.h"
#include "shape/unit.h"

enum { PACKET = 128, PACKET_REGISTERS = PACKET / WIDE };

struct packet {
    int n;                              /* rays; columns are filled up to a whole register */
    bool has_inverse;                   /* packet_prepare() was called */
    _Alignas(64) double o[3][PACKET], d[3][PACKET], inverse[3][PACKET];     /* the last: 1 / d */
};

/* The crossings of each ray, as hits() would list them.  A byte of met and of
 * unsure is a register, a bit of it a lane; other lanes hold anything. */
struct crossings {
    int most;                           /* a ray: 1 or 2; then t[1], slack[1], part[1] are set */
    bool has_weights;                   /* u and v of the first are set; else they are 0 */
    uint8_t met[PACKET / 2];            /* t[0] or t[1] is a crossing: NaN where one is not */
    uint8_t unsure[PACKET / 2];         /* ask hits(); not in met */
    _Alignas(64) double t[2][PACKET], slack[2][PACKET], u[PACKET], v[PACKET];
    int64_t part[2][PACKET];
};

/* One register of rays. */
struct wide3 { wide x, y, z; };
struct wide_ray { struct wide3 o, d, inverse; };    /* inverse: of a prepared packet */

INLINE struct wide_ray packet_rays(const struct packet *p, int at)
{
    return (struct wide_ray) {
        { wide_load(p->o[0] + at), wide_load(p->o[1] + at), wide_load(p->o[2] + at) },
        { wide_load(p->d[0] + at), wide_load(p->d[1] + at), wide_load(p->d[2] + at) },
        { wide_load(p->inverse[0] + at), wide_load(p->inverse[1] + at),
          wide_load(p->inverse[2] + at) } };
}

/* For what has slabs: 1 / 0 is infinite, as it should be. */
INLINE void packet_prepare(struct packet *p)
{
    for (int axis = 0; axis < 3 && !p->has_inverse; axis++)
        for (int i = 0; i < p->n; i += WIDE)
            wide_store(p->inverse[axis] + i, 1 / wide_load(p->d[axis] + i));
    p->has_inverse = true;
}

INLINE struct ray packet_ray(const struct packet *p, int i)
{
    return (struct ray) { { p->o[0][i], p->o[1][i], p->o[2][i] },
                          { p->d[0][i], p->d[1][i], p->d[2][i] } };
}

/* In the order of vec.h's operations, so that the bits are the same. */
INLINE wide wide_dot(struct wide3 a, struct wide3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
INLINE wide wide_dot_vec(struct wide3 a, vec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

INLINE struct wide3 wide3_sub_vec(struct wide3 a, vec3 b)
{
    return (struct wide3) { a.x - b.x, a.y - b.y, a.z - b.z };
}

INLINE struct wide3 wide3_scale(struct wide3 a, double s)
{
    return (struct wide3) { a.x * s, a.y * s, a.z * s };
}

INLINE struct wide3 wide3_fma(struct wide3 a, wide s, struct wide3 b)
{
    return (struct wide3) { wide_fma(s, b.x, a.x), wide_fma(s, b.y, a.y), wide_fma(s, b.z, a.z) };
}

INLINE wide wide3_sum_abs(struct wide3 a) { return wide_abs(a.x) + wide_abs(a.y) + wide_abs(a.z); }

INLINE wide wide_difference_of_products(wide a, wide b, wide c, wide d)
{
    wide cd = c * d;

    return wide_fma(a, b, -cd) + wide_fma(-c, d, cd);
}

/* ray_is_tame of unit.h; square: of the direction. */
INLINE wide_mask wide_is_tame(wide square)
{
    return wide_below(wide_of(0x1p-400), square) & wide_below(square, wide_of(0x1p400));
}

/* slack_at of unit.h. */
INLINE wide wide_slack(const struct wide_ray *r, wide t, double size)
{
    return 4 * ROUNDING * (wide3_sum_abs(r->o) + wide_abs(t) * wide3_sum_abs(r->d) + size);
}

INLINE void crossings_put(struct crossings *out, int which, int at, wide t, wide slack,
                          wide_ints part)
{
    wide_store(out->t[which] + at, t);
    wide_store(out->slack[which] + at, slack);
    wide_store_ints(out->part[which] + at, part);
}

/* ---- shapes with two hits: the span of unit.h ---- */

struct wide_span { wide near, far; wide_ints near_part, far_part; };

/* Where the lines are inside; unsure: lanes for which the plain way decides. */
typedef wide_mask wide_cut(const void *self, const struct wide_ray *r, struct wide_span *out,
                           wide_mask *unsure);

INLINE void packet_spans(wide_cut *cut, const void *self, double size, const struct packet *p,
                         const uint8_t may[], struct crossings *out)
{
    out->most = 2;
    out->has_weights = false;
    for (int at = 0, k = 0; at < p->n; at += WIDE, k++) {
        out->met[k] = out->unsure[k] = 0;
        if (!may[k])
            continue;
        struct wide_ray r = packet_rays(p, at);
        struct wide_span s = { .near = wide_of(0) };
        wide_mask unsure = wide_not(wide_is_tame(wide_dot(r.d, r.d)));
        wide_mask met = cut(self, &r, &s, &unsure);
        met &= wide_is_finite(s.near) & wide_is_finite(s.far);
        out->unsure[k] = (uint8_t)(wide_bits(unsure) & may[k]);
        out->met[k] = (uint8_t)(wide_bits(met & wide_not(unsure)) & may[k]);
        if (!out->met[k])
            continue;
        crossings_put(out, 0, at, s.near, wide_slack(&r, s.near, size), s.near_part);
        crossings_put(out, 1, at, s.far, wide_slack(&r, s.far, size), s.far_part);
    }
}

/* ---- shapes of which one crossing is told: flat ones, and the first of others ---- */

/* unsure: lanes for which the plain way decides; of the asked ones. */
typedef wide_mask wide_cross(const void *self, const struct wide_ray *r, wide_mask asked, wide *t,
                             wide_mask *unsure);

INLINE void packet_crosses(wide_cross *cross, const void *self, double size,
                           const struct packet *p, const uint8_t may[], struct crossings *out)
{
    out->most = 1;
    out->has_weights = false;
    for (int at = 0, k = 0; at < p->n; at += WIDE, k++) {
        out->met[k] = out->unsure[k] = 0;
        if (!may[k])
            continue;
        struct wide_ray r = packet_rays(p, at);
        wide t;
        wide_mask unsure = wide_mask_of(0);
        wide_mask met = cross(self, &r, wide_mask_of(may[k]), &t, &unsure) & wide_is_finite(t);
        out->unsure[k] = (uint8_t)(wide_bits(unsure) & may[k]);
        out->met[k] = (uint8_t)(wide_bits(met) & may[k]);
        if (out->met[k])
            crossings_put(out, 0, at, t, wide_slack(&r, t, size), wide_ints_of(0));
    }
}

#endif
