/* superellipsoid.c: superellipsoid { <E, N> }: where
 * (|x|^(2/E) + |y|^(2/E))^(E/N) + |z|^(2/N) = 1. */
#include "shape/shapes.h"
#include "shape/unit.h"

struct superellipsoid {
    double exponent[2];                 /* E around z, N along z */
    double round, ratio, high;          /* 2/E, E/N, 2/N */
    double doubt;                       /* rounding of the value, as a distance */
    bool is_convex;                     /* and so is the value: along a line it falls, then rises */
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
    s->is_convex = s->round >= 1 && s->high >= 1;
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

struct value { double f, slope; };      /* along a line */

/* x^exponent, for x not below 0, and its slope. */
INLINE struct value power_at(double x, double dx, double exponent)
{
    double size = fabs(x), power = pow(size, exponent);

    return (struct value) { power, x != 0 ? exponent * power / x * dx : 0 };
}

static struct value both_on(const struct superellipsoid *s, const struct chord *c, double at)
{
    vec3 p = vec_fma(c->p, at, c->e);
    struct value x = power_at(p.x, c->e.x, s->round), y = power_at(p.y, c->e.y, s->round);
    struct value z = power_at(p.z, c->e.z, s->high);
    double across = x.f + y.f, outer = s->ratio == 1 ? across : pow(across, s->ratio);
    double slope = across > 0 ? s->ratio * outer / across * (x.slope + y.slope) : 0;

    return (struct value) { outer + z.f - 1, slope + z.slope };
}

/* The crossing between a and b: Newton's steps, made sure by bisection. */
static double solve(const struct superellipsoid *s, const struct chord *c, double a, double fa,
                    double b, double fb)
{
    double x = a - fa * ((b - a) / (fb - fa));

    for (int i = 0; i < 120; i++) {
        if (!(x > a && x < b))
            x = a + (b - a) / 2;
        if (!(x > a && x < b))
            break;
        struct value y = both_on(s, c, x);
        if ((y.f < 0) == (fa < 0))
            a = x, fa = y.f;
        else
            b = x, fb = y.f;
        double step = y.f / y.slope;
        if (y.f == 0 || fabs(step) <= 0x1p-53)
            return x;
        x -= step;
    }
    return fabs(fa) < fabs(fb) ? a : b;
}

/* What of the line is within the box: the ends are outside of what lies in it. */
struct ends { double near, far; };

static bool may_meet(const struct chord *c, struct ends *out)
{
    const double size = 1 + 0x1p-20;

    *out = (struct ends) { -INFINITY, INFINITY };
    for (int i = 0; i < 3; i++) {
        double p = vec_get(c->p, i), inverse = 1 / vec_get(c->e, i);
        double a = (-size - p) * inverse, b = (size - p) * inverse;
        out->near = fmax(out->near, fmin(a, b));
        out->far = fmin(out->far, fmax(a, b));
    }
    return out->near <= out->far;
}

struct place { double at; struct value y; };

static struct place place_on(const struct superellipsoid *s, const struct chord *c, double at)
{
    return (struct place) { at, both_on(s, c, at) };
}

/* Both ends lie on one side: is there a place between on the other? */
static bool turns_over(const struct superellipsoid *s, const struct chord *c, struct place a,
                       struct place b, struct place *out)
{
    bool in = a.y.f < 0;
    double side = in ? -1 : 1;          /* then a low point below 0 is looked for */

    if (!(side * a.y.slope < 0 && side * b.y.slope > 0))
        return false;
    for (int i = 0; i < 40; i++) {
        *out = place_on(s, c, a.at + (b.at - a.at) / 2);
        if ((out->y.f < 0) != in)
            return true;
        if (side * out->y.slope < 0)
            a = *out;
        else
            b = *out;
    }
    return false;
}

/* Between the planes of symmetry and of equal coordinates the surface is
 * smooth, and turns at most once. */
static int cuts(const struct chord *c, struct ends ends, double at[12])
{
    vec3 p = c->p, e = c->e;
    const double plane[9][2] = {
        { p.x, e.x }, { p.y, e.y }, { p.z, e.z },
        { p.x - p.y, e.x - e.y }, { p.x + p.y, e.x + e.y }, { p.x - p.z, e.x - e.z },
        { p.x + p.z, e.x + e.z }, { p.y - p.z, e.y - e.z }, { p.y + p.z, e.y + e.z } };
    int n = 0;

    at[n++] = ends.near;
    for (int i = 0; i < 9; i++) {
        double x = -plane[i][0] / plane[i][1];
        if (!(x > ends.near && x < ends.far))
            continue;
        int k = n++;
        for (; at[k - 1] > x; k--)
            at[k] = at[k - 1];
        at[k] = x;
    }
    at[n++] = ends.far;
    return n;
}

/* Between two neighbouring cuts. */
static int crossings_between(const struct superellipsoid *s, const struct chord *c, const struct place *a,
                             const struct place *b, double root[])
{
    struct place m;

    if ((a->y.f < 0) != (b->y.f < 0)) {
        root[0] = solve(s, c, a->at, a->y.f, b->at, b->y.f);
        return 1;
    }
    if (!turns_over(s, c, *a, *b, &m))
        return 0;
    root[0] = solve(s, c, a->at, a->y.f, m.at, m.y.f);
    root[1] = solve(s, c, m.at, m.y.f, b->at, b->y.f);
    return 2;
}

/* Those beyond from, and perhaps some before; is_first: others than the first of them may lack. */
static int crossings(const struct superellipsoid *s, const struct chord *c, struct ends ends, double from,
                     bool is_first, double root[])
{
    const double outside = 1e-3;        /* what rounding may say of an end */
    const double doubt = 1e-9 * (1 + fabs(from));       /* far above rounding: who asks looks closely */
    double at[12];
    int n = cuts(c, ends, at), found = 0;
    struct place before = place_on(s, c, at[0]);

    before.y.f = fmax(before.y.f, outside);
    for (int i = 1; i < n; i++) {
        struct place after = place_on(s, c, at[i]);
        if (i == n - 1)
            after.y.f = fmax(after.y.f, outside);
        if (!(at[i] <= from - doubt))
            found += crossings_between(s, c, &before, &after, root + found);
        if (is_first && found > 0 && root[found - 1] > from + doubt)
            break;
        before = after;
    }
    return found;
}

/* ---- convex ones: Newton's steps from outside ---- */

enum finding { MISSED, FOUND, UNSURE };

/* From a, outside, to where the line enters.  The steps never pass it, so a
 * value that rises says that nothing is entered; tangents are left to crossings(). */
static enum finding enter(const struct superellipsoid *s, const struct chord *c, double a, double *at)
{
    const double steep = 0x1p-12;

    for (int i = 0; i < 60; i++) {
        struct value y = both_on(s, c, a);
        if (y.slope > -steep)
            return y.f > steep ? MISSED : UNSURE;
        double next = a - y.f / y.slope;
        if (y.f <= 0 || !(next - a > 0x1p-53)) {
            *at = next;
            return FOUND;
        }
        a = next;
    }
    return UNSURE;
}

static enum finding leave(const struct superellipsoid *s, const struct chord *c, double b, double *at)
{
    const struct chord back = { c->p, vec_neg(c->e) };
    enum finding f = enter(s, &back, -b, at);

    *at = -*at;
    return f;
}

/* ---- a ray ---- */

enum { MOST = 22 };                     /* two in each of eleven pieces */

/* t = (mid + at / length) * stretch */
struct line { struct chord chord; struct ends ends; double mid, length, stretch; };

INLINE double t_at(const struct line *l, double at) { return (l->mid + at / l->length) * l->stretch; }

INLINE bool line_of(struct ray ray, struct line *out)
{
    out->stretch = LIKELY(ray_is_tame(ray)) ? 1 : ray_tame(&ray);
    double dd = vec_dot(ray.dir, ray.dir);
    out->mid = -vec_dot(ray.origin, ray.dir) / dd;
    out->length = sqrt(dd);
    out->chord = (struct chord) { vec_fma(ray.origin, out->mid, ray.dir), vec_scale(ray.dir, 1 / out->length) };
    return vec_dot(out->chord.p, out->chord.p) < 3.001 && may_meet(&out->chord, &out->ends);
}

static void put(const struct superellipsoid *s, struct ray ray, double t, struct hit *out)
{
    *out = hit_at(ray, t, 1, 0);
    out->slack += s->doubt;
}

/* What enter() and leave() are sure of is theirs, so that nearest() may do without the rest. */
static int roots_of(const struct superellipsoid *s, const struct line *l, double root[])
{
    double in = 0, out = 0;
    enum finding enters = s->is_convex ? enter(s, &l->chord, l->ends.near, &in) : UNSURE;

    if (enters == MISSED)
        return 0;
    enum finding leaves = s->is_convex ? leave(s, &l->chord, l->ends.far, &out) : UNSURE;
    int n = enters == FOUND && leaves == FOUND ? 2 : crossings(s, &l->chord, l->ends, -INFINITY, false, root);
    if (enters == FOUND && n > 0)
        root[0] = in;
    if (leaves == FOUND && n > 0)
        root[n - 1] = out;
    return n;
}

static int hits(const void *self, struct ray ray, struct hit out[])
{
    const struct superellipsoid *s = self;
    struct line line;
    double root[MOST];

    if (!line_of(ray, &line))
        return 0;
    int n = roots_of(s, &line, root);
    for (int i = 0; i < n; i++)
        put(s, ray, t_at(&line, root[i]), &out[i]);
    return n;
}

/* As hits() has it: t of the first crossing beyond near; NAN: there is none. */
static double first_of_all(const struct superellipsoid *s, const struct line *l, double near)
{
    double root[MOST], from = (near / l->stretch - l->mid) * l->length;
    int n = s->is_convex ? roots_of(s, l, root)
            : crossings(s, &l->chord, l->ends, from, true, root);

    for (int i = 0; i < n; i++)
        if (t_at(l, root[i]) > near)
            return t_at(l, root[i]);
    return NAN;
}

static double first_beyond(const struct superellipsoid *s, const struct line *l, double near)
{
    double start = (near / l->stretch - l->mid) * l->length, at;

    if (!s->is_convex)
        return first_of_all(s, l, near);
    if (start > l->ends.near) {         /* it comes from inside, or goes away? */
        struct value y = both_on(s, &l->chord, start);
        if (y.f > 16 * s->doubt && y.slope > 0)
            return NAN;
    }
    enum finding enters = enter(s, &l->chord, l->ends.near, &at);
    if (enters == MISSED)
        return NAN;
    if (enters == FOUND && t_at(l, at) > near)
        return t_at(l, at);
    if (enters == FOUND && leave(s, &l->chord, l->ends.far, &at) == FOUND)
        return t_at(l, at) > near ? t_at(l, at) : NAN;
    return first_of_all(s, l, near);
}

static bool nearest(const void *self, const struct ray *along, double near, double far, struct hit *out)
{
    const struct superellipsoid *s = self;
    struct line line;

    if (!line_of(*along, &line))
        return false;
    double t = first_beyond(s, &line, near);
    if (!(t > near && t < far))
        return false;
    put(s, *along, t, out);
    return true;
}

static bool inside(const void *self, vec3 p) { return value_at(self, p) <= 0; }

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
    .prepare = prepare, .bounds = bounds, .hits = hits, .nearest = nearest, .inside = inside, .normal = normal,
};
