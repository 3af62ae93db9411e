/* box.c: box { CORNER, CORNER } */
#include "shape/shapes.h"
#include "shape/unit.h"

struct box {
    vec3 low, high;
    double size;                        /* largest coordinate */
};

enum face { LOW_X, HIGH_X, LOW_Y, HIGH_Y, LOW_Z, HIGH_Z };

static const struct box defaults = { .high = { 1, 1, 1 } };

static const struct field args[] = {
    { "", FIELD_POINT, offsetof(struct box, low), ANY, "a corner", NULL },
    { "", FIELD_POINT, offsetof(struct box, high), ANY, "the opposite corner", NULL },
    FIELD_END
};

static const char *prepare(void *self, struct arena *mem)
{
    struct box *s = self;
    vec3 a = s->low, b = s->high;

    (void)mem;
    if (!vec_is_finite(a) || !vec_is_finite(b))
        return "not finite";
    s->low = vec(fmin(a.x, b.x), fmin(a.y, b.y), fmin(a.z, b.z));
    s->high = vec(fmax(a.x, b.x), fmax(a.y, b.y), fmax(a.z, b.z));
    s->size = fmax(vec_largest(a), vec_largest(b));
    return NULL;
}

static struct bounds bounds(const void *self)
{
    const struct box *s = self;
    return (struct bounds) { s->low, s->high };
}

/* Narrows the span to one slab.  A line in a face's plane makes 0 * inf: the
 * comparisons are written so that a NaN leaves the span as it is, and the
 * line counts as inside. */
INLINE void clip(struct span *s, double low, double high, double origin, double inverse,
                 uint32_t low_face)
{
    double a = (low - origin) * inverse, b = (high - origin) * inverse;
    bool down = signbit(inverse);
    double enter = down ? b : a, leave = down ? a : b;

    s->near_part = enter > s->near ? low_face + down : s->near_part;
    s->near = enter > s->near ? enter : s->near;
    s->far_part = leave < s->far ? low_face + !down : s->far_part;
    s->far = leave < s->far ? leave : s->far;
}

/* Each slab's t has three roundings, so a line through an edge may seem to
 * leave before it enters by twice that: it still hits. */
INLINE bool cut(const void *self, struct ray ray, struct span *out)
{
    const struct box *s = self;
    struct span span = { -INFINITY, INFINITY, 0, 0 };

    clip(&span, s->low.x, s->high.x, ray.origin.x, 1 / ray.dir.x, LOW_X);
    clip(&span, s->low.y, s->high.y, ray.origin.y, 1 / ray.dir.y, LOW_Y);
    clip(&span, s->low.z, s->high.z, ray.origin.z, 1 / ray.dir.z, LOW_Z);
    if (!(span.near - 8 * ROUNDING * fabs(span.near) <= span.far))
        return false;
    if (span.far < span.near)
        span.far = span.near;
    *out = span;
    return true;
}

static int hits(const void *self, struct ray ray, struct hit out[])
{
    return span_hits(cut, self, ((const struct box *)self)->size, ray, out);
}

static bool nearest(const void *self, struct ray ray, double near, double far, struct hit *out)
{
    return span_nearest(cut, self, ((const struct box *)self)->size, ray, near, far, out);
}

static bool inside(const void *self, vec3 p)
{
    const struct box *s = self;

    return p.x >= s->low.x && p.x <= s->high.x && p.y >= s->low.y && p.y <= s->high.y
           && p.z >= s->low.z && p.z <= s->high.z;
}

static vec3 normal(const void *self, vec3 p, const struct hit *h)
{
    double side = h->part & 1 ? 1 : -1;

    (void)self;
    (void)p;
    return h->part < LOW_Y ? vec(side, 0, 0) : h->part < LOW_Z ? vec(0, side, 0) : vec(0, 0, side);
}

/* How far c is from low to high, 0 to 1. */
static double share(double c, double low, double high)
{
    return high > low ? (c - low) / (high - low) : 0;
}

/* The faces unfolded to a cross (facts shading.md 7.13). */
static vec2 uv(const void *self, vec3 p, const struct hit *h)
{
    const struct box *s = self;
    double x = share(p.x, s->low.x, s->high.x);
    double y = share(p.y, s->low.y, s->high.y);
    double z = share(p.z, s->low.z, s->high.z);

    switch ((enum face)h->part) {
    case LOW_X:  return (vec2) { z / 4, (1 + y) / 3 };
    case HIGH_X: return (vec2) { (3 - z) / 4, (1 + y) / 3 };
    case LOW_Y:  return (vec2) { (1 + x) / 4, z / 3 };
    case HIGH_Y: return (vec2) { (1 + x) / 4, 1 - z / 3 };
    case LOW_Z:  return (vec2) { 1 - x / 4, (1 + y) / 3 };
    case HIGH_Z: return (vec2) { (1 + x) / 4, (1 + y) / 3 };
    }
    return (vec2) { 0, 0 };
}

const struct shape_ops shape_box = {
    .name = "box", .help = "a block between two opposite corners, along the axes",
    .size = sizeof(struct box), .defaults = &defaults, .args = args, .n_required = 2,
    .is_solid = true, .most_hits = 2,
    .prepare = prepare, .bounds = bounds, .hits = hits, .nearest = nearest,
    .inside = inside, .normal = normal, .uv = uv,
};
