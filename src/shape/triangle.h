/* triangle.h: rays against triangles, watertight: a line through a closed
 * mesh's edge or vertex crosses exactly one of the triangles that meet there.
 *
 * Woop, Benthin and Wald 2013: the ray's frame is sheared so that the ray
 * runs along z from the origin; each vertex is moved once, the same way for
 * all triangles that share it.  The sign of each edge function is exact, and
 * a zero is decided as if the ray were moved by (e, e^2) for an infinitely
 * small e, so every point belongs to one triangle. */
#ifndef RTC_TRIANGLE_H
#define RTC_TRIANGLE_H

#include "math/dd.h"
#include "math/kernel.h"
#include "shape/packet.h"

struct triangle_ray {                   /* prepared once a ray */
    vec3 origin;
    double shear_x, shear_y, scale;
    int x, y, z;                        /* axes; z: the ray's largest */
    double reach;                       /* of the origin, for slack */
};

struct triangle_hit {
    double t, u, v;                     /* weights: 1 - u - v, u, v of a, b, c */
};

INLINE struct triangle_ray triangle_ray(struct ray ray)
{
    vec3 d = ray.dir;
    double ax = fabs(d.x), ay = fabs(d.y), az = fabs(d.z);
    int z = ax >= ay && ax >= az ? 0 : ay >= az ? 1 : 2;
    int x = z == 2 ? 0 : z + 1, y = x == 2 ? 0 : x + 1;
    double along = vec_get(d, z);

    return (struct triangle_ray) { ray.origin, vec_get(d, x) / along, vec_get(d, y) / along,
                                   1 / along, x, y, z, vec_sum_abs(ray.origin) };
}

struct triangle_corner { double x, y, z; };

INLINE struct triangle_corner triangle_corner(const struct triangle_ray *r, vec3 p)
{
    vec3 q = vec_sub(p, r->origin);
    double z = vec_get(q, r->z);

    return (struct triangle_corner) { fma(-r->shear_x, z, vec_get(q, r->x)),
                                      fma(-r->shear_y, z, vec_get(q, r->y)), z };
}

/* The side of edge pq on which the moved ray lies, when it lies on the edge
 * itself; antisymmetric in p and q.  0: no edge at all. */
INLINE double triangle_tie(struct triangle_corner p, struct triangle_corner q)
{
    return p.y != q.y ? p.y - q.y : q.x - p.x;
}

/* Does the whole line cross triangle abc?  t may have either sign. */
INLINE bool triangle_cross(const struct triangle_ray *r, vec3 a, vec3 b, vec3 c,
                           struct triangle_hit *out)
{
    struct triangle_corner p = triangle_corner(r, a), q = triangle_corner(r, b),
                           s = triangle_corner(r, c);
    double u = difference_of_products(s.x, p.y, s.y, p.x);      /* b's weight, edge ca */
    double v = difference_of_products(p.x, q.y, p.y, q.x);      /* c's, edge ab */
    double w = difference_of_products(q.x, s.y, q.y, s.x);      /* a's, edge bc */
    double su = u, sv = v, sw = w;

    if (UNLIKELY(u == 0))
        su = triangle_tie(s, p);
    if (UNLIKELY(v == 0))
        sv = triangle_tie(p, q);
    if (UNLIKELY(w == 0))
        sw = triangle_tie(q, s);
    if (!((su > 0 && sv > 0 && sw > 0) || (su < 0 && sv < 0 && sw < 0)))
        return false;
    double all = u + v + w;
    if (all == 0)                       /* seen exactly from its edge */
        return false;
    double inverse = 1 / all;
    *out = (struct triangle_hit) { (w * p.z + u * q.z + v * s.z) * inverse * r->scale,
                                   u * inverse, v * inverse };
    return true;
}

/* The point found is the same mix of vertices that are off by their own
 * rounding, so even a needle's error is that of its vertices. */
INLINE double triangle_slack(const struct triangle_ray *r, vec3 a, vec3 b, vec3 c)
{
    double reach = fmax(vec_sum_abs(a), fmax(vec_sum_abs(b), vec_sum_abs(c)));
    return 5 * ROUNDING * (r->reach + reach);
}

/* ---- the same for a register of rays ---- */

struct wide_triangle_ray {
    struct wide3 o;
    wide_mask along_x, along_y;         /* which axis is the ray's largest; else z */
    wide shear_x, shear_y, scale, reach;
};

/* Axes in the order that makes the largest the last. */
INLINE struct wide3 wide_triangle_turn(const struct wide_triangle_ray *r, struct wide3 v)
{
    return (struct wide3) { wide_pick(r->along_x, v.y, wide_pick(r->along_y, v.z, v.x)),
                            wide_pick(r->along_x, v.z, wide_pick(r->along_y, v.x, v.y)),
                            wide_pick(r->along_x, v.x, wide_pick(r->along_y, v.y, v.z)) };
}

INLINE struct wide_triangle_ray wide_triangle_ray(const struct wide_ray *ray)
{
    wide ax = wide_abs(ray->d.x), ay = wide_abs(ray->d.y), az = wide_abs(ray->d.z);
    struct wide_triangle_ray r = { .o = ray->o, .reach = wide3_sum_abs(ray->o) };

    r.along_x = wide_at_most(ay, ax) & wide_at_most(az, ax);
    r.along_y = wide_not(r.along_x) & wide_at_most(az, ay);
    struct wide3 d = wide_triangle_turn(&r, ray->d);
    r.shear_x = d.x / d.z;
    r.shear_y = d.y / d.z;
    r.scale = 1 / d.z;
    return r;
}

INLINE struct wide3 wide_triangle_corner(const struct wide_triangle_ray *r, vec3 p)
{
    struct wide3 q = wide_triangle_turn(r, (struct wide3) { p.x - r->o.x, p.y - r->o.y,
                                                            p.z - r->o.z });

    return (struct wide3) { wide_fma(-r->shear_x, q.z, q.x), wide_fma(-r->shear_y, q.z, q.y),
                            q.z };
}

struct wide_triangle_hit { wide t, u, v; };

/* A ray through an edge is unsure. */
INLINE wide_mask wide_triangle_cross(const struct wide_triangle_ray *r, vec3 a, vec3 b, vec3 c,
                                     struct wide_triangle_hit *out, wide_mask *unsure)
{
    const wide none = wide_of(0);
    struct wide3 p = wide_triangle_corner(r, a), q = wide_triangle_corner(r, b),
                 s = wide_triangle_corner(r, c);
    wide u = wide_difference_of_products(s.x, p.y, s.y, p.x);
    wide v = wide_difference_of_products(p.x, q.y, p.y, q.x);
    wide w = wide_difference_of_products(q.x, s.y, q.y, s.x);
    wide all = u + v + w;
    wide_mask met = (wide_below(none, u) & wide_below(none, v) & wide_below(none, w))
                    | (wide_below(u, none) & wide_below(v, none) & wide_below(w, none));

    *unsure |= wide_equal(u, none) | wide_equal(v, none) | wide_equal(w, none);
    wide inverse = 1 / all;
    *out = (struct wide_triangle_hit) { (w * p.z + u * q.z + v * s.z) * inverse * r->scale,
                                        u * inverse, v * inverse };
    return met & wide_not(wide_equal(all, none));
}

INLINE wide wide_triangle_slack(const struct wide_triangle_ray *r, vec3 a, vec3 b, vec3 c)
{
    double reach = fmax(vec_sum_abs(a), fmax(vec_sum_abs(b), vec_sum_abs(c)));
    return 5 * ROUNDING * (r->reach + reach);
}

#endif
