/* superellipsoid.c: superellipsoid { <E, N> }: where
 * (|x|^(2/E) + |y|^(2/E))^(E/N) + |z|^(2/N) = 1. */
#include "shape/shapes.h"
#include "shape/unit.h"

struct superellipsoid {
    double exponent[2];                 /* E around z, N along z */
    double round, ratio, high;          /* 2/E, E/N, 2/N */
    double doubt;                       /* rounding of the value, as a distance */
};

static const struct superellipsoid defaults = { .exponent = { 1, 1 } };

static const struct field args[] = {
    { "", FIELD_POINT2, offsetof(struct superellipsoid, exponent), ANY,
      "exponents around and along z", NULL },
    FIELD_END
};

/* The value + 1 is homogeneous of degree 2/N, so its slope on the surface is
 * at least 2/N over the point's distance, and that at most sqrt 3. */
static const char *prepare(void *self, struct arena *mem)
{
    struct superellipsoid *s = self;
    double e = s->exponent[0], n = s->exponent[1];

    (void)mem;
    if (!(e > 0 && n > 0) || !isfinite(e + n))
        return "an exponent is not above 0";
    s->round = 2 / e;
    s->ratio = e / n;
    s->high = 2 / n;
    s->doubt = 4 * ROUNDING * (2 + s->ratio * (s->round + 4) + s->high) / s->high;
    return NULL;
}

static struct bounds bounds(const void *self)
{
    (void)self;
    return bounds_pad((struct bounds) { { -1, -1, -1 }, { 1, 1, 1 } });
}

static double value_at(const struct superellipsoid *s, vec3 p)
{
    double across = pow(fabs(p.x), s->round) + pow(fabs(p.y), s->round);
    return pow(across, s->ratio) + pow(fabs(p.z), s->high) - 1;
}

static double power_slope(double x, double exponent)
{
    return x == 0 ? 0 : copysign(exponent * pow(fabs(x), exponent - 1), x);
}

static vec3 gradient_at(const struct superellipsoid *s, vec3 p)
{
    double across = pow(fabs(p.x), s->round) + pow(fabs(p.y), s->round);
    double outer = across > 0 ? s->ratio * pow(across, s->ratio - 1) : 0;

    return vec(outer * power_slope(p.x, s->round), outer * power_slope(p.y, s->round),
               power_slope(p.z, s->high));
}

struct chord { vec3 p, e; };            /* about the point nearest to the centre; unit direction */

static double value_on(const struct superellipsoid *s, const struct chord *c, double at)
{
    return value_at(s, vec_fma(c->p, at, c->e));
}

static double slope_on(const struct superellipsoid *s, const struct chord *c, double at)
{
    return vec_dot(gradient_at(s, vec_fma(c->p, at, c->e)), c->e);
}

/* The crossing between a and b: regula falsi, made sure by bisection. */
static double solve(const struct superellipsoid *s, const struct chord *c, double a, double fa,
                    double b, double fb)
{
    for (int i = 0; i < 120; i++) {
        double x = i % 3 == 2 ? a + (b - a) / 2 : a - fa * ((b - a) / (fb - fa));
        if (!(x > a && x < b))
            x = a + (b - a) / 2;
        if (!(x > a && x < b))
            break;
        double f = value_on(s, c, x);
        if ((f < 0) == (fa < 0))
            a = x, fa = f;
        else
            b = x, fb = f;
    }
    return fabs(fa) < fabs(fb) ? a : b;
}

/* Both ends lie on one side: is there a place between on the other? */
static bool turns_over(const struct superellipsoid *s, const struct chord *c, double a, double b,
                       bool in, double *at)
{
    double side = in ? -1 : 1;          /* then a low point below 0 is looked for */

    if (!(side * slope_on(s, c, a) < 0 && side * slope_on(s, c, b) > 0))
        return false;
    for (int i = 0; i < 40; i++) {
        *at = a + (b - a) / 2;
        if ((value_on(s, c, *at) < 0) != in)
            return true;
        if (side * slope_on(s, c, *at) < 0)
            a = *at;
        else
            b = *at;
    }
    return false;
}

/* Between the planes of symmetry and of equal coordinates the surface is
 * smooth, and turns at most once. */
static int cuts(const struct chord *c, double at[12])
{
    vec3 p = c->p, e = c->e;
    const double plane[9][2] = {
        { p.x, e.x }, { p.y, e.y }, { p.z, e.z },
        { p.x - p.y, e.x - e.y }, { p.x + p.y, e.x + e.y }, { p.x - p.z, e.x - e.z },
        { p.x + p.z, e.x + e.z }, { p.y - p.z, e.y - e.z }, { p.y + p.z, e.y + e.z } };
    double reach = sqrt(3 - fmin(3, vec_dot(p, p))) + 0x1p-10;
    int n = 0;

    at[n++] = -reach;
    for (int i = 0; i < 9; i++) {
        double x = -plane[i][0] / plane[i][1];
        if (!(x > -reach && x < reach))
            continue;
        int k = n++;
        for (; at[k - 1] > x; k--)
            at[k] = at[k - 1];
        at[k] = x;
    }
    at[n++] = reach;
    return n;
}

static bool may_meet(const struct chord *c)
{
    double near = -INFINITY, far = INFINITY;
    const double size = 1 + 0x1p-20;

    for (int i = 0; i < 3; i++) {
        double p = vec_get(c->p, i), inverse = 1 / vec_get(c->e, i);
        double a = (-size - p) * inverse, b = (size - p) * inverse;
        near = fmax(near, fmin(a, b));
        far = fmin(far, fmax(a, b));
    }
    return near <= far;
}

static int crossings(const struct superellipsoid *s, const struct chord *c, double root[])
{
    double at[12], middle;
    int n = cuts(c, at), found = 0;
    double before = 1;                  /* the ends are outside */

    for (int i = 1; i < n; i++) {
        double after = i == n - 1 ? fmax(value_on(s, c, at[i]), 1e-3) : value_on(s, c, at[i]);
        if ((before < 0) != (after < 0))
            root[found++] = solve(s, c, at[i - 1], before, at[i], after);
        else if (turns_over(s, c, at[i - 1], at[i], before < 0, &middle)) {
            double there = value_on(s, c, middle);
            root[found++] = solve(s, c, at[i - 1], before, middle, there);
            root[found++] = solve(s, c, middle, there, at[i], after);
        }
        before = after;
    }
    return found;
}

enum { MOST = 22 };                     /* two in each of eleven pieces */

static int hits(const void *self, struct ray ray, struct hit out[])
{
    const struct superellipsoid *s = self;
    struct ray tame = ray;
    double stretch = LIKELY(ray_is_tame(ray)) ? 1 : ray_tame(&tame);
    double dd = vec_dot(tame.dir, tame.dir), mid = -vec_dot(tame.origin, tame.dir) / dd;
    double length = sqrt(dd), root[MOST];
    struct chord c = { vec_fma(tame.origin, mid, tame.dir), vec_scale(tame.dir, 1 / length) };

    if (!(vec_dot(c.p, c.p) < 3.001) || !may_meet(&c))
        return 0;
    int n = crossings(s, &c, root);
    for (int i = 0; i < n; i++) {
        out[i] = hit_at(ray, (mid + root[i] / length) * stretch, 1, 0);
        out[i].slack += s->doubt;
    }
    return n;
}

static bool inside(const void *self, vec3 p) { return value_at(self, p) < 0; }

static vec3 normal(const void *self, vec3 p, const struct hit *h)
{
    vec3 n = gradient_at(self, p);

    (void)h;
    return vec_is_finite(n) && vec_largest(n) > 0 ? n : p;
}

const struct shape_ops shape_superellipsoid = {
    .name = "superellipsoid", .help = "between a box, a ball and a star",
    .size = sizeof(struct superellipsoid), .defaults = &defaults, .args = args, .n_required = 1,
    .is_solid = true, .most_hits = MOST,
    .prepare = prepare, .bounds = bounds, .hits = hits, .inside = inside, .normal = normal,
};
