/* disc.c: disc { CENTRE, NORMAL, RADIUS [, HOLE] } */
#include "math/dd.h"
#include "shape/shapes.h"
#include "shape/packet.h"

struct disc {
    vec3 centre, normal;
    double radius, hole;
    double unit, size;                  /* a power of two and its reciprocal */
    double r, h;                        /* radius and hole in units */
};

static const struct disc defaults = { .normal = { 0, 1, 0 }, .radius = 1 };

static const struct field args[] = {
    { "", FIELD_POINT, offsetof(struct disc, centre), ANY, "centre", NULL },
    { "", FIELD_POINT, offsetof(struct disc, normal), ANY, "normal", NULL },
    { "", FIELD_NUM, offsetof(struct disc, radius), ANY, "radius", NULL },
    { "", FIELD_NUM, offsetof(struct disc, hole), ANY, "radius of the hole", NULL },
    FIELD_END
};

static const char *prepare(void *self, struct arena *mem)
{
    struct disc *s = self;

    (void)mem;
    s->radius = fabs(s->radius);
    s->hole = fabs(s->hole);
    if (!vec_is_finite(s->centre) || !vec_is_finite(s->normal) || !isfinite(s->radius))
        return "not finite";
    s->normal = direction_of(s->normal);
    if (vec_largest(s->normal) == 0)
        return "zero normal";
    if (!(s->radius > 0))
        return "zero radius";
    s->unit = unit_for(s->radius);
    s->size = 1 / s->unit;
    s->r = s->radius * s->unit;
    s->h = s->hole * s->unit;
    return NULL;
}

static struct bounds bounds(const void *self)
{
    const struct disc *s = self;
    vec3 n = s->normal;
    vec3 by = vec(s->radius * sqrt((1 - fabs(n.x)) * (1 + fabs(n.x))),
                  s->radius * sqrt((1 - fabs(n.y)) * (1 + fabs(n.y))),
                  s->radius * sqrt((1 - fabs(n.z)) * (1 + fabs(n.z))));

    return bounds_pad((struct bounds) { vec_sub(s->centre, by), vec_add(s->centre, by) });
}

/* Rim and hole are inclusive.  The point is re-centred: its distance from
 * the centre is worked out from the ray's difference to it. */
INLINE bool cross(const struct disc *s, struct ray ray, double *out)
{
    vec3 from = vec_scale(vec_sub(ray.origin, s->centre), s->unit);
    double t = -vec_dot(s->normal, from) * (1 / vec_dot(s->normal, ray.dir));   /* as plane.c */
    vec3 q = vec_fma(from, t, ray.dir);
    double rr = vec_dot(q, q);

    *out = t * s->size;
    return rr <= s->r * s->r && rr >= s->h * s->h && fabs(*out) < INFINITY;
}

static bool nearest(const void *self, const struct ray *along, double near, double far,
                    struct hit *out)
{
    struct ray ray = *along;
    const struct disc *s = self;
    double t;

    if (!cross(s, ray, &t) || !(t > near && t < far))
        return false;
    hit_put(out, ray, t, s->radius, 0);
    return true;
}

static int hits(const void *self, struct ray ray, struct hit out[])
{
    return nearest(self, &ray, -INFINITY, INFINITY, out);
}

INLINE wide_mask cross_many(const void *self, const struct wide_ray *r, wide_mask asked, wide *t,
                            wide_mask *unsure)
{
    (void)asked, (void)unsure;          /* none ever is */
    const struct disc *s = self;
    struct wide3 from = wide3_scale(wide3_sub_vec(r->o, s->centre), s->unit);
    wide at = -wide_dot_vec(from, s->normal) * (1 / wide_dot_vec(r->d, s->normal));
    struct wide3 q = wide3_fma(from, at, r->d);
    wide rr = wide_dot(q, q);

    *t = at * s->size;
    return wide_at_most(rr, wide_of(s->r * s->r)) & wide_at_most(wide_of(s->h * s->h), rr)
           & wide_is_finite(*t);
}

static void hits_many(const void *self, const struct packet *p, const uint8_t may[],
                      struct crossings *out)
{
    packet_crosses(cross_many, self, ((const struct disc *)self)->radius, p, may, out);
}

/* All behind the disc, whatever its radius (facts shading.md 7.2). */
static bool inside(const void *self, vec3 p)
{
    const struct disc *s = self;
    return vec_dot(s->normal, vec_sub(p, s->centre)) < 0;
}

static vec3 normal(const void *self, vec3 p, const struct hit *h)
{
    (void)p;
    (void)h;
    return ((const struct disc *)self)->normal;
}

const struct shape_ops shape_disc = {
    .name = "disc", .help = "a flat round disc, perhaps with a hole",
    .size = sizeof(struct disc), .defaults = &defaults, .args = args, .n_required = 3,
    .most_hits = 1,
    .prepare = prepare, .bounds = bounds, .hits = hits, .nearest = nearest,
    .hits_many = hits_many, .is_quick = true, .inside = inside, .normal = normal,
};
