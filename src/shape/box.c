/* box.c: box { CORNER, CORNER } */
#include "shape/shapes.h"
#include "shape/packet.h"

struct box {
    vec3 corner[2];                     /* low, high */
    double size;                        /* largest coordinate */
};

enum face { LOW_X, HIGH_X, LOW_Y, HIGH_Y, LOW_Z, HIGH_Z };

static const struct box defaults = { .corner = { { 0, 0, 0 }, { 1, 1, 1 } } };

static const struct field args[] = {
    { "", FIELD_POINT, offsetof(struct box, corner), ANY, "a corner", NULL },
    { "", FIELD_POINT, offsetof(struct box, corner) + sizeof(vec3), ANY, "the opposite corner", NULL },
    FIELD_END
};

static const char *prepare(void *self, struct arena *mem)
{
    struct box *s = self;
    vec3 a = s->corner[0], b = s->corner[1];

    (void)mem;
    if (!vec_is_finite(a) || !vec_is_finite(b))
        return "not finite";
    s->corner[0] = vec(fmin(a.x, b.x), fmin(a.y, b.y), fmin(a.z, b.z));
    s->corner[1] = vec(fmax(a.x, b.x), fmax(a.y, b.y), fmax(a.z, b.z));
    s->size = fmax(vec_largest(a), vec_largest(b));
    return NULL;
}

static struct bounds bounds(const void *self)
{
    const struct box *s = self;
    return (struct bounds) { s->corner[0], s->corner[1] };
}

struct slab { double enter, leave; };

/* The ends are picked by the sign and not by comparing: no branch, and a
 * line in a face's plane, which makes 0 * inf, leaves a NaN at the end where
 * it belongs. */
INLINE struct slab slab_of(double low, double high, double origin, double inverse)
{
    bool down = inverse < 0;            /* -inf, for a direction of -0 */
    double first = down ? high : low, last = down ? low : high;

    return (struct slab) { (first - origin) * inverse, (last - origin) * inverse };
}

/* A NaN never wins: such a line counts as inside of the slab. */
INLINE double later(double a, double b) { return a > b ? a : b; }
INLINE double sooner(double a, double b) { return a < b ? a : b; }

struct slabs { struct slab x, y, z, all; bool meets; };

/* Each slab's t has three roundings, so a line through an edge may seem to
 * leave before it enters by twice that: it still hits. */
INLINE struct slabs slabs_of(const struct box *s, struct ray ray)
{
    const vec3 low = s->corner[0], high = s->corner[1];
    struct slab x = slab_of(low.x, high.x, ray.origin.x, 1 / ray.dir.x);
    struct slab y = slab_of(low.y, high.y, ray.origin.y, 1 / ray.dir.y);
    struct slab z = slab_of(low.z, high.z, ray.origin.z, 1 / ray.dir.z);
    double near = later(z.enter, later(y.enter, later(x.enter, -INFINITY)));
    double far = sooner(z.leave, sooner(y.leave, sooner(x.leave, INFINITY)));

    return (struct slabs) { x, y, z, { near, later(far, near) },
                            near - 8 * ROUNDING * fabs(near) <= far };
}

/* Which face was crossed at t by a line that comes from there or goes there. */
INLINE uint32_t face_of(double t, double x, double y, vec3 from)
{
    return t == x ? LOW_X + signbit(from.x) : t == y ? LOW_Y + signbit(from.y)
                                                     : LOW_Z + signbit(from.z);
}

INLINE bool cut(const void *self, struct ray ray, struct span *out)
{
    struct slabs s = slabs_of(self, ray);

    if (!s.meets)
        return false;
    out->near_part = face_of(s.all.enter, s.x.enter, s.y.enter, ray.dir);
    out->far_part = face_of(s.all.leave, s.x.leave, s.y.leave, vec_neg(ray.dir));
    out->near = s.all.enter;
    out->far = s.all.leave;
    return true;
}

KERNEL static void slices(const struct box *s, int n, const double *restrict x,
                          const double *restrict y, const double *restrict z,
                          const double *restrict dx, const double *restrict dy,
                          const double *restrict dz, double *restrict near, double *restrict far)
{
    const struct box own = *s;

    for (int i = 0; i < n; i++) {
        struct ray ray = { { x[i], y[i], z[i] }, { dx[i], dy[i], dz[i] } };
        struct slabs all = slabs_of(&own, ray);
        bool is_tame = ray_is_tame(ray);
        double first = all.meets ? all.all.enter : INFINITY;
        double last = all.meets ? all.all.leave : -INFINITY;
        near[i] = is_tame ? first : NAN;
        far[i] = is_tame ? last : NAN;
    }
}

static void spans(const void *self, const struct rays *r, double near[], double far[])
{
    slices(self, r->n, r->x, r->y, r->z, r->dx, r->dy, r->dz, near, far);
}

static int hits(const void *self, struct ray ray, struct hit out[])
{
    return span_hits(cut, self, ((const struct box *)self)->size, ray, out);
}

static bool nearest(const void *self, const struct ray *along, double near, double far,
                    struct hit *out)
{
    struct ray ray = *along;

    return span_nearest(cut, self, ((const struct box *)self)->size, ray, near, far, out);
}

/* The same for a register of rays. */
struct wide_slab { wide enter, leave; wide_mask back; };

INLINE struct wide_slab wide_slab_of(double low, double high, wide origin, wide inverse)
{
    wide_mask back = wide_signs(inverse);
    wide a = (low - origin) * inverse, b = (high - origin) * inverse;

    return (struct wide_slab) { wide_pick(back, b, a), wide_pick(back, a, b), back };
}

INLINE wide_ints side_of(wide_mask is_high, enum face low)
{
    return wide_pick_ints(is_high, wide_ints_of((int64_t)low + 1), wide_ints_of(low));
}

INLINE wide_mask cut_many(const void *self, const struct wide_ray *r, struct wide_span *out,
                          wide_mask *unsure)
{
    const struct box *s = self;
    vec3 low = s->corner[0], high = s->corner[1];
    struct wide_slab x = wide_slab_of(low.x, high.x, r->o.x, r->inverse.x);
    struct wide_slab y = wide_slab_of(low.y, high.y, r->o.y, r->inverse.y);
    struct wide_slab z = wide_slab_of(low.z, high.z, r->o.z, r->inverse.z);
    wide near = wide_max(z.enter, wide_max(y.enter, wide_max(x.enter, wide_of(-INFINITY))));
    wide far = wide_min(z.leave, wide_min(y.leave, wide_min(x.leave, wide_of(INFINITY))));
    wide_mask met = wide_at_most(near - 8 * ROUNDING * wide_abs(near), far);

    (void)unsure;
    if (!wide_bits(met))
        return met;
    out->near = near;
    out->far = wide_max(far, near);
    out->near_part = wide_pick_ints(wide_equal(near, x.enter), side_of(x.back, LOW_X),
                     wide_pick_ints(wide_equal(near, y.enter), side_of(y.back, LOW_Y),
                                    side_of(z.back, LOW_Z)));
    out->far_part = wide_pick_ints(wide_equal(far, x.leave), side_of(wide_not(x.back), LOW_X),
                    wide_pick_ints(wide_equal(far, y.leave), side_of(wide_not(y.back), LOW_Y),
                                   side_of(wide_not(z.back), LOW_Z)));
    return met;
}

static void hits_many(const void *self, const struct packet *p, const uint8_t may[],
                      struct crossings *out)
{
    packet_spans(cut_many, self, ((const struct box *)self)->size, p, may, out);
}

static bool inside(const void *self, vec3 p)
{
    const struct box *s = self;
    vec3 low = s->corner[0], high = s->corner[1];

    return p.x >= low.x && p.x <= high.x && p.y >= low.y && p.y <= high.y && p.z >= low.z
           && p.z <= high.z;
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
    vec3 low = s->corner[0], high = s->corner[1];
    double x = share(p.x, low.x, high.x), y = share(p.y, low.y, high.y);
    double z = share(p.z, low.z, high.z);

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
    .prepare = prepare, .bounds = bounds, .hits = hits, .nearest = nearest, .spans = spans,
    .hits_many = hits_many, .has_slabs = true, .is_quick = true, .inside = inside, .normal = normal, .uv = uv,
};
