/* sphere.c: sphere { CENTRE, RADIUS } */
#include "shape/shapes.h"
#include "math/dd.h"
#include "shape/packet.h"

/* There may be millions, so what follows from the radius is not kept: working
 * it out takes less time than reading more memory. */
struct sphere {
    vec3 centre;
    double radius;
};

static const struct sphere defaults = { .radius = 1 };

static const struct field args[] = {
    { "", FIELD_POINT, offsetof(struct sphere, centre), ANY, "centre", NULL },
    { "", FIELD_NUM, offsetof(struct sphere, radius), ANY, "radius", NULL },
    FIELD_END
};

static const char *prepare(void *self, struct arena *mem)
{
    struct sphere *s = self;

    (void)mem;
    s->radius = fabs(s->radius);        /* as POV-Ray, which only squares it */
    if (!(s->radius > 0))
        return "zero radius";
    if (!isfinite(s->radius) || !vec_is_finite(s->centre))
        return "not finite";
    return NULL;
}

struct measure {
    vec3 centre;
    double unit, size;                  /* a power of two and its reciprocal */
    double r;                           /* radius * unit: 1 to 2 */
};

INLINE struct measure measure_of(const struct sphere *s)
{
    double unit = unit_for(s->radius);

    return (struct measure) { s->centre, unit, 1 / unit, s->radius * unit };
}

static struct bounds bounds(const void *self)
{
    const struct sphere *s = self;
    vec3 r = vec(s->radius, s->radius, s->radius);

    return bounds_pad((struct bounds) { vec_sub(s->centre, r), vec_add(s->centre, r) });
}

/* The same in double-double, about the point at mid, which need not be the
 * closest one: decides what the error bound of cut() leaves open. */
static __attribute__((noinline)) bool cut_closely(const struct measure *s, struct ray ray,
                                                  double mid, struct span *out)
{
    dd a = dd_of(0), b = dd_of(0), c = dd_neg(dd_product(s->r, s->r));

    for (int i = 0; i < 3; i++) {
        double d = vec_get(ray.dir, i);
        dd from = dd_sum(vec_get(ray.origin, i), -vec_get(s->centre, i));
        dd p = dd_add(dd_scale(from, s->unit), dd_product(mid, d));

        a = dd_add(a, dd_product(d, d));
        b = dd_add(b, dd_mul(p, dd_of(d)));
        c = dd_add(c, dd_mul(p, p));
    }
    dd left = dd_sub(dd_mul(b, b), dd_mul(a, c));
    if (!(left.hi > 0))
        return false;
    double half = sqrt(left.hi);
    *out = (struct span) { (mid - (b.hi + half) / a.hi) * s->size,
                           (mid + (half - b.hi) / a.hi) * s->size, 0, 0 };
    return true;
}

/* The ray re-centred at its closest approach, so that the error grows with
 * distance and not with its square. */
struct approach {
    double mid, inverse;                /* its t, in units; one over the square of dir */
    double left;                        /* the square of half the chord, times that of dir */
    bool is_close;                      /* to touching the sphere: left may have either sign */
};

INLINE struct approach approach_of(const struct measure *s, struct ray ray)
{
    vec3 from = vec_scale(vec_sub(ray.origin, s->centre), s->unit);
    double inverse = 1 / vec_dot(ray.dir, ray.dir);
    double mid = -vec_dot(from, ray.dir) * inverse;
    vec3 c = vec_fma(from, mid, ray.dir);
    double left = fma(s->r, s->r, -vec_dot(c, c));
    double error = 4 * ROUNDING * (vec_sum_abs(from) + s->r);   /* of c */

    return (struct approach) { mid, inverse, left, fabs(left) <= error * (4 * s->r + error) };
}

INLINE bool cut(const void *self, struct ray ray, struct span *out)
{
    struct measure s = measure_of(self);
    struct approach a = approach_of(&s, ray);

    if (UNLIKELY(a.is_close)) {
        struct measure copy = s;        /* so that neither need live in memory */
        struct span close;
        bool meets = cut_closely(&copy, ray, a.mid, &close);
        if (meets)
            *out = close;
        return meets;
    }
    if (!(a.left > 0))
        return false;
    double half = sqrt(a.left * a.inverse);
    *out = (struct span) { (a.mid - half) * s.size, (a.mid + half) * s.size, 0, 0 };
    return true;
}

KERNEL static void chords(const struct sphere *s, int n, const double *restrict x,
                          const double *restrict y, const double *restrict z,
                          const double *restrict dx, const double *restrict dy,
                          const double *restrict dz, double *restrict near, double *restrict far)
{
    const struct measure own = measure_of(s);

    for (int i = 0; i < n; i++) {
        struct ray ray = { { x[i], y[i], z[i] }, { dx[i], dy[i], dz[i] } };
        struct approach a = approach_of(&own, ray);
        bool is_left = a.is_close || !ray_is_tame(ray);
        double half = sqrt(a.left * a.inverse);
        double first = a.left > 0 ? (a.mid - half) * own.size : INFINITY;
        double last = a.left > 0 ? (a.mid + half) * own.size : -INFINITY;
        near[i] = is_left ? NAN : first;
        far[i] = is_left ? NAN : last;
    }
}

static void spans(const void *self, const struct rays *r, double near[], double far[])
{
    chords(self, r->n, r->x, r->y, r->z, r->dx, r->dy, r->dz, near, far);
}

static int hits(const void *self, struct ray ray, struct hit out[])
{
    return span_hits(cut, self, ((const struct sphere *)self)->radius, ray, out);
}

static bool nearest(const void *self, const struct ray *along, double near, double far,
                    struct hit *out)
{
    struct ray ray = *along;

    return span_nearest(cut, self, ((const struct sphere *)self)->radius, ray, near, far, out);
}

/* As cut(), for a register of rays. */
INLINE wide_mask cut_many(const void *self, const struct wide_ray *r, struct wide_span *out,
                          wide_mask *unsure)
{
    struct measure s = measure_of(self);
    struct wide3 from = wide3_scale(wide3_sub_vec(r->o, s.centre), s.unit);
    wide inverse = 1 / wide_dot(r->d, r->d);
    wide mid = -wide_dot(from, r->d) * inverse;
    struct wide3 c = wide3_fma(from, mid, r->d);
    wide left = wide_fma(wide_of(s.r), wide_of(s.r), -wide_dot(c, c));
    wide error = 4 * ROUNDING * (wide3_sum_abs(from) + s.r);
    wide_mask met = wide_below(wide_of(0), left);

    *unsure |= wide_at_most(wide_abs(left), error * (4 * s.r + error));
    if (!wide_bits(met))
        return met;
    wide half = wide_sqrt(left * inverse);
    *out = (struct wide_span) { (mid - half) * s.size, (mid + half) * s.size,
                                wide_ints_of(0), wide_ints_of(0) };
    return met;
}

static void hits_many(const void *self, const struct packet *p, const uint8_t may[],
                      struct crossings *out)
{
    packet_spans(cut_many, self, ((const struct sphere *)self)->radius, p, may, out);
}

static bool inside(const void *self, vec3 p)
{
    struct measure s = measure_of(self);
    vec3 q = vec_scale(vec_sub(p, s.centre), s.unit);

    return vec_dot(q, q) < s.r * s.r;
}

static vec3 normal(const void *self, vec3 p, const struct hit *h)
{
    (void)h;
    return vec_sub(p, ((const struct sphere *)self)->centre);
}

static vec2 uv(const void *self, vec3 p, const struct hit *h)
{
    const struct sphere *s = self;
    vec3 q = vec_scale(vec_sub(p, s->centre), 1 / s->radius);
    double y = fmax(-1, fmin(1, q.y));

    (void)h;
    return (vec2) { q.x == 0 && q.z == 0 ? 0 : longitude(q.x, q.z), 0.5 + asin(y) / M_PI };
}

const struct shape_ops shape_sphere = {
    .name = "sphere", .help = "all points nearer to a centre than a radius",
    .size = sizeof(struct sphere), .defaults = &defaults, .args = args, .n_required = 2,
    .is_solid = true, .is_ball = true, .most_hits = 2,
    .prepare = prepare, .bounds = bounds, .hits = hits, .nearest = nearest, .spans = spans,
    .hits_many = hits_many, .is_quick = true, .inside = inside, .normal = normal, .uv = uv,
};
