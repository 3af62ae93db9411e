/* triangle.c: triangle { A, B, C } and smooth_triangle { A, NA, B, NB, C, NC } */
#include "shape/shapes.h"
#include "shape/triangle.h"

struct triangle {
    vec3 corner[3];
    vec3 bend[3];                       /* normals of a smooth one */
    vec3 normal;                        /* (c - a) x (b - a) */
};

static const struct triangle defaults = { .corner = { { 0, 0, 0 }, { 1, 0, 0 }, { 0, 1, 0 } } };

#define CORNER(i) (offsetof(struct triangle, corner) + (i) * sizeof(vec3))
#define BEND(i) (offsetof(struct triangle, bend) + (i) * sizeof(vec3))

static const struct field args[] = {
    { "", FIELD_POINT, CORNER(0), ANY, "first corner", NULL },
    { "", FIELD_POINT, CORNER(1), ANY, "second corner", NULL },
    { "", FIELD_POINT, CORNER(2), ANY, "third corner", NULL },
    FIELD_END
};

static const struct field smooth_args[] = {
    { "", FIELD_POINT, CORNER(0), ANY, "first corner", NULL },
    { "", FIELD_POINT, BEND(0), ANY, "normal there", NULL },
    { "", FIELD_POINT, CORNER(1), ANY, "second corner", NULL },
    { "", FIELD_POINT, BEND(1), ANY, "normal there", NULL },
    { "", FIELD_POINT, CORNER(2), ANY, "third corner", NULL },
    { "", FIELD_POINT, BEND(2), ANY, "normal there", NULL },
    FIELD_END
};

/* Edges are brought to unit size first: the cross product of tiny ones
 * would underflow. */
static const char *prepare(void *self, struct arena *mem)
{
    struct triangle *s = self;
    vec3 ab = vec_sub(s->corner[1], s->corner[0]), ac = vec_sub(s->corner[2], s->corner[0]);

    (void)mem;
    if (!vec_is_finite(s->corner[0]) || !vec_is_finite(ab) || !vec_is_finite(ac))
        return "not finite";
    if (vec_largest(ab) == 0 || vec_largest(ac) == 0)
        return "degenerate triangle";
    ab = vec_scale(ab, unit_for(vec_largest(ab)));
    ac = vec_scale(ac, unit_for(vec_largest(ac)));
    s->normal = vec(difference_of_products(ac.y, ab.z, ac.z, ab.y),
                    difference_of_products(ac.z, ab.x, ac.x, ab.z),
                    difference_of_products(ac.x, ab.y, ac.y, ab.x));
    return vec_largest(s->normal) > 0 ? NULL : "degenerate triangle";
}

/* POV-Ray drops a smooth triangle whose normals do not all lie on one side
 * of it (facts shading.md 7.3). */
static const char *prepare_smooth(void *self, struct arena *mem)
{
    struct triangle *s = self;
    const char *wrong = prepare(self, mem);
    int up = 0, down = 0;

    if (wrong)
        return wrong;
    for (int i = 0; i < 3; i++) {
        s->bend[i] = direction_of(s->bend[i]);
        double side = vec_dot(s->bend[i], s->normal);
        up += side > 0;
        down += side < 0;
    }
    return up == 3 || down == 3 ? NULL : "degenerate triangle: its normals point to both sides";
}

static struct bounds bounds(const void *self)
{
    const struct triangle *s = self;
    struct bounds b = BOUNDS_EMPTY;

    for (int i = 0; i < 3; i++)
        b = bounds_join(b, (struct bounds) { s->corner[i], s->corner[i] });
    return b;
}

static bool nearest(const void *self, const struct ray *along, double near, double far,
                    struct hit *out)
{
    struct ray ray = *along;
    const struct triangle *s = self;
    struct triangle_ray r = triangle_ray(ray);
    struct triangle_hit h;

    if (!triangle_cross(&r, s->corner[0], s->corner[1], s->corner[2], &h)
        || !(h.t > near && h.t < far))
        return false;
    *out = (struct hit) { .t = h.t, .u = (float)h.u, .v = (float)h.v,
                          .slack = triangle_slack(&r, s->corner[0], s->corner[1], s->corner[2]) };
    return true;
}

static int hits(const void *self, struct ray ray, struct hit out[])
{
    return nearest(self, &ray, -INFINITY, INFINITY, out);
}

static void hits_many(const void *self, const struct packet *p, const uint8_t may[],
                      struct crossings *out)
{
    const struct triangle *s = self;
    const vec3 *c = s->corner;

    out->most = 1;
    out->has_weights = true;
    for (int at = 0, k = 0; at < p->n; at += WIDE, k++) {
        out->met[k] = out->unsure[k] = 0;
        if (!may[k])
            continue;
        struct wide_ray ray = packet_rays(p, at);
        struct wide_triangle_ray r = wide_triangle_ray(&ray);
        struct wide_triangle_hit h;
        wide_mask unsure = wide_mask_of(0);
        wide_mask met = wide_triangle_cross(&r, c[0], c[1], c[2], &h, &unsure);
        met &= wide_is_finite(h.t) & wide_not(unsure);
        out->unsure[k] = (uint8_t)(wide_bits(unsure) & may[k]);
        out->met[k] = (uint8_t)(wide_bits(met) & may[k]);
        if (!out->met[k])
            continue;
        crossings_put(out, 0, at, h.t, wide_triangle_slack(&r, c[0], c[1], c[2]), wide_ints_of(0));
        wide_store(out->u + at, h.u);
        wide_store(out->v + at, h.v);
    }
}

static vec3 normal(const void *self, vec3 p, const struct hit *h)
{
    (void)p;
    (void)h;
    return ((const struct triangle *)self)->normal;
}

static vec3 normal_smooth(const void *self, vec3 p, const struct hit *h)
{
    const struct triangle *s = self;
    double u = (double)h->u, v = (double)h->v;

    (void)p;
    return vec_fma(vec_fma(vec_scale(s->bend[0], 1 - u - v), u, s->bend[1]), v, s->bend[2]);
}

const struct shape_ops shape_triangle = {
    .name = "triangle", .help = "a flat triangle",
    .size = sizeof(struct triangle), .defaults = &defaults, .args = args, .n_required = 3,
    .most_hits = 1,
    .prepare = prepare, .bounds = bounds, .hits = hits, .nearest = nearest,
    .hits_many = hits_many, .is_quick = true, .normal = normal,
};

static const struct triangle smooth_defaults = {
    .corner = { { 0, 0, 0 }, { 1, 0, 0 }, { 0, 1, 0 } },
    .bend = { { 0, 0, -1 }, { 0, 0, -1 }, { 0, 0, -1 } },
};

const struct shape_ops shape_smooth_triangle = {
    .name = "smooth_triangle", .help = "a triangle shaded as if it were bent",
    .size = sizeof(struct triangle), .defaults = &smooth_defaults, .args = smooth_args,
    .n_required = 6, .most_hits = 1,
    .prepare = prepare_smooth, .bounds = bounds, .hits = hits, .nearest = nearest,
    .hits_many = hits_many, .is_quick = true, .normal = normal_smooth,
};
