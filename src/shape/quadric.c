/* quadric.c: quadric { <A, E, H>, <B, C, F>, <D, G, I>, J }: where
 * A x^2 + E y^2 + H z^2 + B xy + C xz + F yz + D x + G y + I z + J = 0. */
#include "math/dd.h"
#include "shape/shapes.h"
#include "shape/unit.h"

struct quadric {
    vec3 square, mixed, linear;
    double constant;
};

static const struct quadric defaults = { { 1, 1, 1 }, { 0, 0, 0 }, { 0, 0, 0 }, -1 };

static const struct field args[] = {
    { "", FIELD_POINT, offsetof(struct quadric, square), ANY, "factors of xx, yy, zz", NULL },
    { "", FIELD_POINT, offsetof(struct quadric, mixed), ANY, "factors of xy, xz, yz", NULL },
    { "", FIELD_POINT, offsetof(struct quadric, linear), ANY, "factors of x, y, z", NULL },
    { "", FIELD_NUM, offsetof(struct quadric, constant), ANY, "constant", NULL },
    FIELD_END
};

static const char *prepare(void *self, struct arena *mem)
{
    const struct quadric *s = self;

    (void)mem;
    if (!vec_is_finite(s->square) || !vec_is_finite(s->mixed) || !vec_is_finite(s->linear)
        || !isfinite(s->constant))
        return "not finite";
    if (vec_largest(s->square) == 0 && vec_largest(s->mixed) == 0 && vec_largest(s->linear) == 0)
        return "no surface";
    return NULL;
}

static struct bounds bounds(const void *self)
{
    (void)self;
    return BOUNDS_ALL;
}

/* Half of the form's gradient: the matrix times p. */
INLINE vec3 times(const struct quadric *s, vec3 p)
{
    vec3 q = s->square, m = vec_scale(s->mixed, 0.5);

    return vec(q.x * p.x + m.x * p.y + m.y * p.z, m.x * p.x + q.y * p.y + m.z * p.z,
               m.y * p.x + m.z * p.y + q.z * p.z);
}

INLINE double value_at(const struct quadric *s, vec3 p)
{
    return vec_dot(vec_add(times(s, p), s->linear), p) + s->constant;
}

/* How far a computed point may be from the surface: the value's rounding by
 * its slope there, and the point's own. */
static double slack_of(const struct quadric *s, struct ray ray, double t, double form)
{
    vec3 p = ray_at(ray, t);
    double reach = vec_sum_abs(p), slope = vec_length(vec_add(vec_scale(times(s, p), 2),
                                                              s->linear));
    double rounding = (form * reach + vec_sum_abs(s->linear)) * reach + fabs(s->constant);
    double own = slack_at(ray, t, 0);

    /* Near a cone's tip the slope is nothing: there the distance is as the
     * root of the value. */
    return own + fmin(8 * ROUNDING * rounding / slope,
                      sqrt(8 * ROUNDING * rounding / fmax(form, 1e-300)));
}

/* About the point nearest to the origin, around which the coefficients say
 * most. */
static int hits(const void *self, struct ray ray, struct hit out[])
{
    const struct quadric *s = self;
    struct ray tame = ray;
    double stretch = LIKELY(ray_is_tame(ray)) ? 1 : ray_tame(&tame);
    vec3 d = tame.dir;
    double mid = -vec_dot(tame.origin, d) / vec_dot(d, d);
    vec3 p = vec_fma(tame.origin, mid, d), m = times(s, d);
    double a = vec_dot(m, d), b = vec_dot(m, p) + vec_dot(s->linear, d) / 2, c = value_at(s, p);
    double left = difference_of_products(b, b, a, c), t[2];
    int n = 0;

    if (a == 0) {
        if (b == 0)
            return 0;
        t[n++] = -c / (2 * b);
    } else {
        if (!(left > 0))
            return 0;
        double q = -(b + copysign(sqrt(left), b)), x = q / a, y = c / q;
        t[n++] = fmin(x, y);
        t[n++] = fmax(x, y);
    }
    double form = vec_sum_abs(s->square) + vec_sum_abs(s->mixed);
    int kept = 0;
    for (int i = 0; i < n; i++) {
        double at = (mid + t[i]) * stretch;
        if (fabs(at) < INFINITY)
            out[kept++] = (struct hit) { .t = at, .slack = slack_of(s, ray, at, form) };
    }
    return kept;
}

static bool starts_inside(const void *self, vec3 dir)
{
    const struct quadric *s = self;
    double a = vec_dot(times(s, dir), dir);

    return a != 0 ? a < 0 : vec_dot(s->linear, dir) > 0;
}

static bool inside(const void *self, vec3 p) { return value_at(self, p) <= 0; }

static vec3 normal(const void *self, vec3 p, const struct hit *h)
{
    const struct quadric *s = self;
    vec3 n = vec_add(vec_scale(times(s, p), 2), s->linear);

    (void)h;
    return vec_largest(n) > 0 ? n : vec(1, 0, 0);
}

const struct shape_ops shape_quadric = {
    .name = "quadric", .help = "a surface of order 2",
    .size = sizeof(struct quadric), .defaults = &defaults, .args = args, .n_required = 4,
    .is_solid = true, .is_infinite = true, .most_hits = 2,
    .prepare = prepare, .bounds = bounds, .hits = hits, .starts_inside = starts_inside,
    .inside = inside, .normal = normal,
};
