/* cone.c: cone { BASE, RADIUS, CAP, RADIUS [open] } */
#include "shape/frustum.h"
#include "shape/shapes.h"

struct cone {
    vec3 base, cap;
    double base_radius, cap_radius;
    bool is_open;
    struct frustum frustum;
};

static const struct cone defaults = { .cap = { 0, 1, 0 }, .base_radius = 1 };

static const struct field args[] = {
    { "", FIELD_POINT, offsetof(struct cone, base), ANY, "centre of the base", NULL },
    { "", FIELD_NUM, offsetof(struct cone, base_radius), ANY, "radius of the base", NULL },
    { "", FIELD_POINT, offsetof(struct cone, cap), ANY, "centre of the cap", NULL },
    { "", FIELD_NUM, offsetof(struct cone, cap_radius), ANY, "radius of the cap", NULL },
    FIELD_END
};

static const struct field words[] = {
    { "open", FIELD_FLAG, offsetof(struct cone, is_open), ANY, "without its two discs", NULL },
    FIELD_END
};

static const char *prepare(void *self, struct arena *mem)
{
    struct cone *s = self;

    (void)mem;
    if (s->base_radius * s->cap_radius < 0)     /* POV-Ray: an hourglass */
        return "radii of opposite signs";
    return frustum_prepare(&s->frustum, s->base, fabs(s->base_radius), s->cap,
                           fabs(s->cap_radius), s->is_open);
}

static const struct frustum *of(const void *self) { return &((const struct cone *)self)->frustum; }
static struct bounds bounds(const void *self) { return frustum_bounds(of(self)); }

static void hold(const void *self, vec3 *centre, vec3 edge[3])
{
    frustum_hold(of(self), centre, edge);
}

static int hits(const void *self, struct ray ray, struct hit out[])
{
    return frustum_hits(of(self), ray, out);
}

static bool nearest(const void *self, const struct ray *along, double near, double far,
                    struct hit *out)
{
    struct ray ray = *along;

    return frustum_nearest(of(self), ray, near, far, out);
}

static void spans(const void *self, const struct rays *rays, double near[], double far[])
{
    frustum_spans(of(self), rays, near, far);
}

static void hits_many(const void *self, const struct packet *p, const uint8_t may[],
                      struct crossings *out)
{
    frustum_hits_many(of(self), p, may, out);
}

static bool is_leaky(const void *self) { return of(self)->is_open; }
static bool inside(const void *self, vec3 p) { return frustum_inside(of(self), p); }

static vec3 normal(const void *self, vec3 p, const struct hit *h)
{
    return frustum_normal(of(self), p, h);
}

const struct shape_ops shape_cone = {
    .name = "cone", .help = "a piece of a cone between two discs; a radius of 0 is a point",
    .size = sizeof(struct cone), .defaults = &defaults, .args = args, .n_required = 4,
    .words = words, .is_solid = true, .most_hits = 2,
    .prepare = prepare, .bounds = bounds, .hold = hold, .hits = hits, .nearest = nearest, .spans = spans,
    .hits_many = hits_many, .is_leaky = is_leaky, .inside = inside, .normal = normal,
};
