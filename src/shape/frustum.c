/* frustum.c: a piece of a cone between two discs. */
#include "shape/frustum.h"

/* Two axes at right angles to z; exact axes if z is one. */
static void complete_axes(struct frustum *s)
{
    vec3 z = s->z;
    double x = fabs(z.x), y = fabs(z.y), w = fabs(z.z);
    vec3 least = x <= y && x <= w ? vec(1, 0, 0) : y <= w ? vec(0, 1, 0) : vec(0, 0, 1);

    s->x = direction_of(vec_cross(least, z));
    s->y = vec_cross(z, s->x);
}

const char *frustum_prepare(struct frustum *s, vec3 base, double base_radius, vec3 cap,
                            double cap_radius, bool is_open)
{
    double wide = fmax(base_radius, cap_radius);
    vec3 axis = vec_sub(cap, base);
    double height = length_of(axis);

    if (!vec_is_finite(base) || !isfinite(height) || !isfinite(base_radius + cap_radius))
        return "not finite";
    if (!(height > 0))
        return "zero length";
    if (!(wide > 0))
        return "zero radius";
    s->base = base;
    s->z = direction_of(axis);
    complete_axes(s);
    s->unit = unit_for(wide);
    s->size = 1 / s->unit;
    s->r = base_radius * s->unit;
    s->height = height * s->unit;
    s->slope = (cap_radius - base_radius) * s->unit / s->height;
    s->reach = height + wide;
    s->is_open = is_open;
    return NULL;
}

/* A disc reaches r sin(angle between axis and coordinate) along each. */
static struct bounds disc_bounds(vec3 centre, vec3 axis, double r)
{
    vec3 by = vec(r * sqrt((1 - fabs(axis.x)) * (1 + fabs(axis.x))),
                  r * sqrt((1 - fabs(axis.y)) * (1 + fabs(axis.y))),
                  r * sqrt((1 - fabs(axis.z)) * (1 + fabs(axis.z))));

    return (struct bounds) { vec_sub(centre, by), vec_add(centre, by) };
}

struct bounds frustum_bounds(const struct frustum *s)
{
    vec3 cap = vec_fma(s->base, s->height * s->size, s->z);
    double cap_radius = fmax(0, fma(s->slope, s->height, s->r)) * s->size;

    return bounds_pad(bounds_join(disc_bounds(s->base, s->z, s->r * s->size),
                                  disc_bounds(cap, s->z, cap_radius)));
}

INLINE vec3 turn(const struct frustum *s, vec3 v)
{
    return vec(vec_dot(v, s->x), vec_dot(v, s->y), vec_dot(v, s->z));
}

INLINE vec3 to_own(const struct frustum *s, vec3 p)
{
    return turn(s, vec_scale(vec_sub(p, s->base), s->unit));
}

/* Where the line p + t d is inside of the infinite cone's nappe of positive
 * radius.  With rho the radius at the line's height, that is
 * x^2 + y^2 - rho^2 < 0, a quadratic form whose discriminant is the Gram
 * determinant of p and d: three 2x2 determinants, each right to 1.5 ulp. */
INLINE bool cut_wall(const struct frustum *s, vec3 p, vec3 d, double *near, double *far)
{
    double rho = fma(s->slope, p.z, s->r), grow = s->slope * d.z;
    double u = difference_of_products(p.x, grow, rho, d.x);
    double v = difference_of_products(p.y, grow, rho, d.y);
    double w = difference_of_products(p.x, d.y, p.y, d.x);
    double left = u * u + v * v - w * w;
    double a = d.x * d.x + d.y * d.y - grow * grow;
    double b = p.x * d.x + p.y * d.y - rho * grow;
    double c = p.x * p.x + p.y * p.y - rho * rho;

    if (UNLIKELY(a == 0 && grow == 0)) {        /* along a cylinder's axis */
        *near = -INFINITY;
        *far = INFINITY;
        return dd_sub(dd_add(dd_product(p.x, p.x), dd_product(p.y, p.y)),
                      dd_product(rho, rho)).hi < 0;
    }
    if (a > 0 && !(left > 0))
        return false;
    double root = sqrt(fmax(left, 0)), q = -(b + copysign(root, b));
    double t = a != 0 ? q / a : b < 0 ? -INFINITY : INFINITY;
    double o = q != 0 ? c / q : t;

    if (a > 0) {                                /* one nappe, twice: which? */
        *near = fmin(t, o);
        *far = fmax(t, o);
        return rho * a - grow * b >= 0;
    }
    *near = grow > 0 ? fmax(t, o) : -INFINITY;  /* each nappe once */
    *far = grow > 0 ? INFINITY : fmin(t, o);
    return true;
}

/* Re-centred at the closest approach to the base's centre.  Wall and slab
 * are cut with each other, so a rim is crossed once, and the other nappe,
 * which the slab excludes, never. */
INLINE bool cut(const void *self, struct ray ray, struct span *out)
{
    const struct frustum *s = self;
    vec3 from = to_own(s, ray.origin), d = turn(s, ray.dir);
    double mid = -vec_dot(from, d) / vec_dot(d, d);
    vec3 p = vec_fma(from, mid, d);
    double near, far;

    if (!cut_wall(s, p, d, &near, &far))
        return false;
    double a = (0 - p.z) / d.z, b = (s->height - p.z) / d.z;
    bool down = signbit(d.z);
    double enter = down ? b : a, leave = down ? a : b;      /* NaN: in a cap's plane */
    uint32_t first = FRUSTUM_WALL, last = FRUSTUM_WALL;

    if (enter > near) {
        near = enter;
        first = down ? FRUSTUM_CAP : FRUSTUM_BASE;
    }
    if (leave < far) {
        far = leave;
        last = down ? FRUSTUM_BASE : FRUSTUM_CAP;
    }
    if (!(near <= far))
        return false;
    *out = (struct span) { (mid + near) * s->size, (mid + far) * s->size, first, last };
    return true;
}

int frustum_hits(const struct frustum *s, struct ray ray, struct hit out[])
{
    int n = span_hits(cut, s, s->reach, ray, out), kept = 0;

    if (!s->is_open)
        return n;
    for (int i = 0; i < n; i++)
        if (out[i].part == FRUSTUM_WALL)
            out[kept++] = out[i];
    return kept;
}

bool frustum_nearest(const struct frustum *s, struct ray ray, double near, double far,
                     struct hit *out)
{
    if (LIKELY(!s->is_open))
        return span_nearest(cut, s, s->reach, ray, near, far, out);

    struct hit h[2];
    int n = frustum_hits(s, ray, h);
    for (int i = 0; i < n; i++)
        if (h[i].t > near && h[i].t < far) {
            *out = h[i];
            return true;
        }
    return false;
}

bool frustum_inside(const struct frustum *s, vec3 p)
{
    vec3 q = to_own(s, p);
    double rho = fma(s->slope, q.z, s->r);

    return q.z >= 0 && q.z <= s->height && q.x * q.x + q.y * q.y < rho * rho;
}

/* Of the wall: the gradient of (x^2 + y^2 - rho^2) / 2; the apex has none. */
vec3 frustum_normal(const struct frustum *s, vec3 p, const struct hit *h)
{
    if (h->part != FRUSTUM_WALL)
        return h->part == FRUSTUM_CAP ? s->z : vec_neg(s->z);

    vec3 q = to_own(s, p);
    double across = sqrt(q.x * q.x + q.y * q.y);
    if (across == 0)
        return s->slope < 0 ? s->z : vec_neg(s->z);
    return vec_add(vec_add(vec_scale(s->x, q.x), vec_scale(s->y, q.y)),
                   vec_scale(s->z, -s->slope * across));
}
