/* torus.c: torus { MAJOR, MINOR }: around the y axis. */
#include "shape/shapes.h"
#include "shape/torus.h"

static const struct torus defaults = { .major = 1, .minor = 0.25 };

static const struct field args[] = {
    { "", FIELD_NUM, offsetof(struct torus, major), ANY, "radius of the ring", NULL },
    { "", FIELD_NUM, offsetof(struct torus, minor), ANY, "radius of the tube", NULL },
    FIELD_END
};

static const char *prepare(void *self, struct arena *mem)
{
    struct torus *s = self;

    (void)mem;
    s->major = fabs(s->major);
    s->minor = fabs(s->minor);
    if (!isfinite(s->major + s->minor))
        return "not finite";
    if (!(s->minor > 0))
        return "zero radius";
    s->unit = unit_for(s->major + s->minor);
    s->size = 1 / s->unit;
    s->ring = s->major * s->unit;
    s->tube = s->minor * s->unit;
    s->has_inner = s->major < s->minor && s->major > 0;
    return NULL;
}

static struct bounds bounds(const void *self)
{
    const struct torus *s = self;
    vec3 by = vec(s->major + s->minor, s->minor, s->major + s->minor);

    return bounds_pad((struct bounds) { vec_neg(by), by });
}

static int hits(const void *self, struct ray ray, struct hit out[])
{
    const struct torus *s = self;
    double t[4];
    int n = torus_cross(s, ray, -INFINITY, INFINITY, 4, t);

    for (int i = 0; i < n; i++)
        out[i] = hit_at(ray, t[i], s->major + s->minor, 0);
    return n;
}

static bool nearest(const void *self, const struct ray *along, double near, double far,
                    struct hit *out)
{
    const struct torus *s = self;
    double t;
    enum torus_first first = torus_first(s, along, near, far, &t);

    if (first == TORUS_MISSED || (first == TORUS_UNSURE && !torus_cross(s, *along, near, far, 1, &t)))
        return false;
    *out = hit_at(*along, t, s->major + s->minor, 0);
    return true;
}

static bool is_leaky(const void *self) { return ((const struct torus *)self)->has_inner; }

/* Of a spindle both parts, as in POV-Ray. */
static bool inside(const void *self, vec3 p)
{
    const struct torus *s = self;
    vec3 q = vec_scale(p, s->unit);
    double rho = sqrt(q.x * q.x + q.z * q.z);

    double across = rho - s->ring;

    return fma(across, across, (q.y - s->tube) * (q.y + s->tube)) <= 0;
}

/* From the nearest point of the ring. */
static vec3 normal(const void *self, vec3 p, const struct hit *h)
{
    const struct torus *s = self;
    vec3 q = vec_scale(p, s->unit);
    double rho = sqrt(q.x * q.x + q.z * q.z), across = rho - s->ring;

    (void)h;
    return rho > 0 ? vec(q.x / rho * across, q.y, q.z / rho * across) : vec(0, q.y, 0);
}

static vec2 uv(const void *self, vec3 p, const struct hit *h)
{
    const struct torus *s = self;
    double rho = sqrt(p.x * p.x + p.z * p.z);

    (void)h;
    return (vec2) { 1 - (atan2(p.z, p.x) + M_PI) / (2 * M_PI),
                    (atan2(p.y, rho - s->major) + M_PI) / (2 * M_PI) };
}

const struct shape_ops shape_torus = {
    .name = "torus", .help = "a ring around the y axis",
    .size = sizeof(struct torus), .defaults = &defaults, .args = args, .n_required = 2,
    .is_solid = true, .most_hits = 4,
    .prepare = prepare, .bounds = bounds, .hits = hits, .nearest = nearest,
    .hits_many = torus_first_many, .many_is_first = true, .is_leaky = is_leaky,
    .inside = inside, .normal = normal, .uv = uv,
};
