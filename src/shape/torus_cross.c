/* torus_cross.c: all crossings of a line and a torus. */
#include "math/dd.h"
#include "math/poly.h"
#include "shape/torus.h"

INLINE double t_at(const struct torus_chord *c, double at)
{
    return (c->mid + at / c->length) * c->stretch;
}

/* rho is the distance from the axis. */
struct value { double f, slope; };

/* (rho - ring)^2 + y^2 - tube^2, not expanded: expanded, a thin tube drowns
 * in the rounding of ring^4.  Negative ring: the inner sheet. */
INLINE struct value sheet_at(double ring, double tube, double rho, double rho_slope,
                             double y, double y_slope)
{
    double across = rho - ring;

    return (struct value) { fma(across, across, (y - tube) * (y + tube)),
                            2 * fma(across, rho_slope, y * y_slope) };
}

/* Negative inside of the tube; of a spindle, where only one sheet is around. */
INLINE struct value value_at(const struct torus *s, const struct torus_chord *c, double at)
{
    vec3 q = vec_fma(c->p, at, c->e);
    double rho = sqrt(q.x * q.x + q.z * q.z);
    double rho_slope = rho > 0 ? (q.x * c->e.x + q.z * c->e.z) / rho : 0;
    struct value outer = sheet_at(s->ring, s->tube, rho, rho_slope, q.y, c->e.y);

    if (LIKELY(!s->has_inner))
        return outer;
    struct value inner = sheet_at(-s->ring, s->tube, rho, rho_slope, q.y, c->e.y);
    return (struct value) { outer.f * inner.f, outer.f * inner.slope + outer.slope * inner.f };
}

/* Near to the root between a and b, on the quartic: its slope is cheap. */
static double guess(const double c[5], double a, double b, bool rising)
{
    double x = a + (b - a) / 2;

    for (int i = 0; i < 20; i++) {
        double slope = 4 * c[4] * x + 3 * c[3], y = c[4] * x + c[3];
        slope = (slope * x + 2 * c[2]) * x + c[1];
        y = ((y * x + c[2]) * x + c[1]) * x + c[0];
        if ((y > 0) == rising)
            b = x;
        else
            a = x;
        double next = x - y / slope;
        if (!(next > a && next < b))
            next = a + (b - a) / 2;
        if (fabs(next - x) < 0x1p-20)
            return next;
        x = next;
    }
    return x;
}

/* Bisection between a and b, made quick by Newton's steps. */
static double solve(const struct torus *s, const struct torus_chord *c, double a, double b, bool rising)
{
    double x = rising ? NAN : torus_entry(s, c, a, b);

    if (!isnan(x))
        return x;
    x = guess(c->quartic, a, b, rising);
    for (int i = 0; i < 100; i++) {
        struct value y = value_at(s, c, x);
        if (y.f == 0)
            return x;
        if ((y.f > 0) == rising)
            b = x;
        else
            a = x;
        double next = x - y.f / y.slope, step = next - x;
        if (!(next > a && next < b))
            next = a + (b - a) / 2;
        else if (step * step <= 0x1p-58 * fabs(y.slope))
            return next;                /* what is left is of the order of step^2 / slope */
        if (next <= a || next >= b || fabs(next - x) <= 0x1p-54)
            return next;
        x = next;
    }
    return x;
}

/* Where the line is within the ring's outer sphere and between the planes
 * that enclose the tube; a little more, as beyond the ends it is taken for
 * outside without asking. */
INLINE bool clip(const struct torus *s, struct torus_chord *c)
{
    double out = s->ring + s->tube, left = out * out - vec_dot(c->p, c->p);
    const double margin = TORUS_MARGIN;

    if (left < -margin)
        return false;
    c->high = sqrt(fmax(left, 0)) + margin;
    c->low = -c->high;
    if (fabs(c->e.y) < margin)
        return fabs(c->p.y) <= s->tube + 2 * margin;
    double a = (-s->tube - c->p.y) / c->e.y, b = (s->tube - c->p.y) / c->e.y;
    c->low = fmax(c->low, fmin(a, b) - margin);
    c->high = fmin(c->high, fmax(a, b) + margin);
    return c->low < c->high;
}

static void expand(const struct torus *s, struct torus_chord *c)
{
    vec3 p = c->p, e = c->e;
    double rr = s->ring * s->ring;
    double k = vec_dot(p, p) + (s->ring - s->tube) * (s->ring + s->tube), b = vec_dot(p, e);
    double ee = e.x * e.x + e.z * e.z, pe = p.x * e.x + p.z * e.z, pp = p.x * p.x + p.z * p.z;

    c->quartic[0] = k * k - 4 * rr * pp;
    c->quartic[1] = 4 * b * k - 8 * rr * pe;
    c->quartic[2] = 4 * b * b + 2 * k - 4 * rr * ee;
    c->quartic[3] = 4 * b;
    c->quartic[4] = 1;
}

/* Points that part the chord into pieces with at most one crossing each:
 * where the quartic turns. */
static int turns(const struct torus_chord *c, double at[3])
{
    double slope[4] = { c->quartic[1] / 4, c->quartic[2] / 2, 3 * c->quartic[3] / 4, 1 };
    return poly_roots(3, slope, c->low, c->high, at);
}

/* The turn of the quartic is one of the distance only where that is zero;
 * near a tangent that is all but so, and two of Newton's steps on the
 * distance's slope make the decision there as exact as the distance is. */
static double settle(const struct torus *s, const struct torus_chord *c, double at)
{
    for (int i = 0; i < 2; i++) {
        vec3 q = vec_fma(c->p, at, c->e);
        double rho = sqrt(q.x * q.x + q.z * q.z);
        double cross = (q.x * c->e.z - q.z * c->e.x) / rho;
        double rho_slope = (q.x * c->e.x + q.z * c->e.z) / rho;
        double slope = (rho - s->ring) * rho_slope + q.y * c->e.y;
        double bend = rho_slope * rho_slope + (rho - s->ring) * cross * cross / rho
                      + c->e.y * c->e.y;
        double step = slope / bend;
        if (!(fabs(step) < s->tube) || !(at - step > c->low && at - step < c->high))
            break;
        at -= step;
    }
    return at;
}

/* Outside of the tube at a place where the distance turns?  Again in
 * double-double, about the ray's own origin. */
static __attribute__((noinline)) bool is_out_closely(const struct torus *s,
                                                     const struct torus_chord *c, double at)
{
    double t = c->mid + at / c->length;
    vec3 o = c->own.origin, d = c->own.dir;
    dd x = dd_add(dd_of(o.x), dd_product(t, d.x));
    dd y = dd_add(dd_of(o.y), dd_product(t, d.y));
    dd z = dd_add(dd_of(o.z), dd_product(t, d.z));
    dd across = dd_sub(dd_sqrt(dd_add(dd_mul(x, x), dd_mul(z, z))), dd_of(s->ring));
    dd f = dd_sub(dd_add(dd_mul(across, across), dd_mul(y, y)), dd_product(s->tube, s->tube));

    return f.hi >= 0;
}

/* Outside of the torus where the quartic turns?  The place is made better
 * where it matters, but stays between its neighbours. */
static bool is_out(const struct torus *s, const struct torus_chord *c, double from, double *at,
                   double to)
{
    double y = value_at(s, c, *at).f;

    if (LIKELY(fabs(y) > 0x1p-10 * s->tube * s->tube) || s->has_inner)
        return y >= 0;
    double better = settle(s, c, *at);
    if (better > from && better < to) {
        *at = better;
        y = value_at(s, c, better).f;
    }
    if (fabs(y) < 32 * ROUNDING * s->tube)
        return is_out_closely(s, c, *at);
    return y >= 0;
}

/* The crossings with near < t < far, at most so many. */
static int crossings(const struct torus *s, const struct torus_chord *c, double near, double far,
                     int most, double t[])
{
    double at[4], from = c->low;
    int n = turns(c, at), found = 0;
    bool out = true;

    at[n] = c->high;
    for (int i = 0; i <= n && found < most; i++) {
        bool out_there = i == n || is_out(s, c, from, &at[i], at[i + 1]);
        if (out_there != out && t_at(c, at[i]) > near && t_at(c, from) < far) {
            t[found] = t_at(c, solve(s, c, from, at[i], out_there));
            found += t[found] > near && t[found] < far;
        }
        out = out_there;
        from = at[i];
    }
    return found;
}

int torus_cross(const struct torus *s, struct ray ray, double near, double far, int most,
                double t[])
{
    double stretch = LIKELY(ray_is_tame(ray)) ? 1 : ray_tame(&ray);
    vec3 from = vec_scale(ray.origin, s->unit);
    double square = vec_dot(ray.dir, ray.dir), mid = -vec_dot(from, ray.dir) / square;
    double length = sqrt(square);
    struct torus_chord c = { .p = vec_fma(from, mid, ray.dir), .own = { from, ray.dir },
                       .mid = mid, .length = length, .stretch = s->size * stretch };
    double out = s->ring + s->tube + 0x1p-20;

    if (!(vec_dot(c.p, c.p) < out * out))
        return 0;
    c.e = vec_scale(ray.dir, 1 / length);
    if (!clip(s, &c))
        return 0;
    expand(s, &c);
    return crossings(s, &c, near, far, most, t);
}
