/* plane.c: plane { NORMAL, DISTANCE }: all behind it is inside. */
#include "shape/shapes.h"
#include "shape/packet.h"

struct plane {
    vec3 normal;                        /* made unit length */
    double distance;                    /* along that */
};

static const struct plane defaults = { .normal = { 0, 1, 0 } };

static const struct field args[] = {
    { "", FIELD_POINT, offsetof(struct plane, normal), ANY, "normal", NULL },
    { "", FIELD_NUM, offsetof(struct plane, distance), ANY, "distance from the origin", NULL },
    FIELD_END
};

static const char *prepare(void *self, struct arena *mem)
{
    struct plane *s = self;

    (void)mem;
    if (!vec_is_finite(s->normal) || !isfinite(s->distance))
        return "not finite";
    s->normal = direction_of(s->normal);
    return vec_largest(s->normal) > 0 ? NULL : "zero normal";
}

static struct bounds bounds(const void *self)
{
    (void)self;
    return BOUNDS_ALL;
}

/* Thin if the normal is an axis: then a ray is at the distance exactly where
 * that coordinate is. */
static struct bounds crust(const void *self)
{
    const struct plane *s = self;
    const vec3 n = s->normal;
    struct bounds b = BOUNDS_ALL;

    if (fabs(n.x) == 1)
        b.low.x = b.high.x = n.x * s->distance;
    if (fabs(n.y) == 1)
        b.low.y = b.high.y = n.y * s->distance;
    if (fabs(n.z) == 1)
        b.low.z = b.high.z = n.z * s->distance;
    return b;
}

static struct half_space half_space(const void *self)
{
    const struct plane *s = self;
    return (struct half_space) { s->normal, s->distance };
}

/* Multiplied and not divided, as a box does it: a face in the plane of an axis
 * has then the plane's very t, and the same of the two is seen everywhere. */
INLINE bool cross(const struct plane *s, struct ray ray, double *t)
{
    *t = (s->distance - vec_dot(s->normal, ray.origin)) * (1 / vec_dot(s->normal, ray.dir));
    return fabs(*t) < INFINITY;         /* parallel: infinite, or 0 / 0 */
}

static int hits(const void *self, struct ray ray, struct hit out[])
{
    const struct plane *s = self;
    double t;

    if (!cross(s, ray, &t))
        return 0;
    out[0] = hit_at(ray, t, fabs(s->distance), 0);
    return 1;
}

/* What comes first is the plane, where the face of something else lies in it:
 * glass that stands on a floor shows the floor, and not the void below in
 * spots.  The face, turned and moved, is off by as many roundings. */
enum { LEAD = 4 };                      /* slacks */

static bool nearest(const void *self, const struct ray *along, double near, double far,
                    struct hit *out)
{
    struct ray ray = *along;
    const struct plane *s = self;
    double t;

    if (!cross(s, ray, &t) || !(t > near))
        return false;
    hit_put(out, ray, t, fabs(s->distance), 0);
    if (t > 0)
        out->t = larger(t - LEAD * out->slack * fabs(1 / vec_dot(s->normal, ray.dir)), 0.5 * t);
    out->slack *= 1 + LEAD;
    return out->t < far;
}

KERNEL static void halves(const struct plane *s, int n, const double *restrict x,
                          const double *restrict y, const double *restrict z,
                          const double *restrict dx, const double *restrict dy,
                          const double *restrict dz, double *restrict near, double *restrict far)
{
    const struct plane own = *s;

    for (int i = 0; i < n; i++) {
        struct ray ray = { { x[i], y[i], z[i] }, { dx[i], dy[i], dz[i] } };
        double t;
        bool crosses = cross(&own, ray, &t), from_inside = vec_dot(own.normal, ray.dir) > 0;
        double first = from_inside ? -INFINITY : t, last = from_inside ? t : INFINITY;
        near[i] = crosses ? first : NAN;
        far[i] = crosses ? last : NAN;
    }
}

static void spans(const void *self, const struct rays *r, double near[], double far[])
{
    halves(self, r->n, r->x, r->y, r->z, r->dx, r->dy, r->dz, near, far);
}

INLINE wide_mask cross_many(const void *self, const struct wide_ray *r, wide_mask asked, wide *t,
                            wide_mask *unsure)
{
    (void)asked, (void)unsure;          /* none ever is */
    const struct plane *s = self;

    *t = (s->distance - wide_dot_vec(r->o, s->normal)) * (1 / wide_dot_vec(r->d, s->normal));
    return wide_is_finite(*t);
}

static void hits_many(const void *self, const struct packet *p, const uint8_t may[],
                      struct crossings *out)
{
    packet_crosses(cross_many, self, fabs(((const struct plane *)self)->distance), p, may, out);
}

static void lead(const void *self, const struct packet *p, struct crossings *c)
{
    const struct plane *s = self;

    for (int at = 0; at < p->n; at += WIDE) {
        wide t = wide_load(c->t[0] + at), slack = wide_load(c->slack[0] + at);
        wide slant = wide_abs(1 / wide_dot_vec(packet_rays(p, at).d, s->normal));
        wide_store(c->t[0] + at, wide_max(t - LEAD * slack * slant, 0.5 * t));
        wide_store(c->slack[0] + at, slack * (1 + LEAD));
    }
}

static bool starts_inside(const void *self, vec3 dir)
{
    return vec_dot(((const struct plane *)self)->normal, dir) > 0;
}

static bool inside(const void *self, vec3 p)
{
    const struct plane *s = self;
    return vec_dot(s->normal, p) < s->distance;
}

static vec3 normal(const void *self, vec3 p, const struct hit *h)
{
    (void)p;
    (void)h;
    return ((const struct plane *)self)->normal;
}

const struct shape_ops shape_plane = {
    .name = "plane", .help = "an infinite plane; the side away from its normal is inside",
    .size = sizeof(struct plane), .defaults = &defaults, .args = args, .n_required = 2,
    .is_solid = true, .is_infinite = true, .most_hits = 1,
    .prepare = prepare, .bounds = bounds, .crust = crust, .half_space = half_space, .hits = hits, .nearest = nearest, .spans = spans,
    .hits_many = hits_many, .lead = lead, .is_quick = true, .starts_inside = starts_inside, .inside = inside, .normal = normal,
};
