/* check_geometry.c: what must hold of trees, CSG, meshes and instances.
 *
 * The oracles: every leaf asked one after the other, and points asked by
 * object_inside(, NULL), which knows nothing of the tracer. */
#include <check.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "trace/surface.h"
#include "trace/world.h"

static struct arena mem;
static struct scene scene;
static uint64_t state;

static void setup(void)
{
    arena_init(&mem, NULL);
    scene_init(&scene, &mem);
    state = 1;
}

static void teardown(void) { arena_free(&mem); }

static double uniform(double low, double high)      /* splitmix64 */
{
    uint64_t z = (state += 0x9e3779b97f4a7c15u);

    z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9u;
    z = (z ^ z >> 27) * 0x94d049bb133111ebu;
    return low + (high - low) * (double)((z ^ z >> 31) >> 11) * 0x1p-53;
}

static int below(int n) { return (int)uniform(0, n); }

static vec3 in_cube(double side)
{
    double x = uniform(-side, side), y = uniform(-side, side), z = uniform(-side, side);
    return vec(x, y, z);
}

static vec3 on_sphere(void)
{
    for (;;) {
        vec3 v = in_cube(1);
        if (vec_length(v) > 0.1 && vec_length(v) < 1)
            return vec_unit(v);
    }
}

static struct ray random_ray(double from, double to)
{
    vec3 o = vec_scale(on_sphere(), from);
    return (struct ray) { o, vec_sub(in_cube(to), o) };
}

/* --- making objects -------------------------------------------------------- */

static struct object *new_object(enum object_kind kind)
{
    return object_new(&mem, kind);
}

/* value: numbers for the arguments in order; a point takes three. */
static struct object *shape(const char *name, const double value[])
{
    struct object *o = new_object(OBJECT_SHAPE);
    void *self;

    o->ops = shape_find(name);
    self = arena_copy(&mem, o->ops->defaults, o->ops->size);
    for (const struct field *f = o->ops->args; f && f->name && value; f++) {
        int n = f->type == FIELD_POINT ? 3 : 1;
        if (f - o->ops->args < (ptrdiff_t)o->ops->n_required)
            memcpy((char *)self + f->offset, value, (size_t)n * sizeof *value);
        value += n;
    }
    ck_assert_ptr_null(o->ops->prepare(self, &mem));
    o->shape = self;
    return o;
}

#define SHAPE(name, ...) shape(name, (const double[]) { __VA_ARGS__ })

static struct object *sphere(vec3 c, double r) { return SHAPE("sphere", c.x, c.y, c.z, r); }

static struct object *box(vec3 a, vec3 b)
{
    return SHAPE("box", a.x, a.y, a.z, b.x, b.y, b.z);
}

static struct object *group(enum object_kind kind, struct object *const child[], size_t n)
{
    struct object *o = new_object(kind);

    o->child = arena_copy(&mem, child, n * sizeof *child);
    o->n_child = (uint32_t)n;
    return o;
}

#define GROUP(kind, ...) group(kind, (struct object *const[]) { __VA_ARGS__ }, \
                               sizeof((struct object *[]) { __VA_ARGS__ }) / sizeof(void *))

static struct object *moved(struct object *o, struct transform t)
{
    struct object *copy = object_copy(&mem, o);

    object_move(&mem, copy, &t);
    return copy;
}

static struct transform turned(vec3 degrees, vec3 by)
{
    struct transform r = transform_rotate(degrees), t = transform_translate(by);
    return transform_compose(&t, &r);
}

static struct object *random_shape(double spread, double size)
{
    vec3 c = in_cube(spread), d = vec_add(c, vec_scale(on_sphere(), size));
    double r = size * uniform(0.1, 1);

    switch (below(5)) {
    case 0:  return sphere(c, r);
    case 1:  return box(c, d);
    case 2:  return SHAPE("cone", c.x, c.y, c.z, r, d.x, d.y, d.z, r / 3);
    case 3:  return SHAPE("cylinder", c.x, c.y, c.z, d.x, d.y, d.z, r);
    default: return moved(SHAPE("torus", size, size / 3), turned(in_cube(180), c));
    }
}

static struct object *triangle(double spread, double size)
{
    vec3 a = in_cube(spread), b = vec_add(a, in_cube(size)), c = vec_add(a, in_cube(size));
    return SHAPE("triangle", a.x, a.y, a.z, b.x, b.y, b.z, c.x, c.y, c.z);
}

/* A closed mesh of n x 2n steps about the origin. */
static struct mesh *mesh_ball(int n, double radius)
{
    struct mesh *m = arena_alloc(&mem, sizeof *m);
    int columns = 2 * n;
    vec3 *v = arena_array(&mem, (size_t)(n + 1) * (size_t)columns, sizeof *v);

    m->face = arena_array(&mem, (size_t)(2 * n * columns), sizeof *m->face);
    m->vertex = v;
    m->n_vertex = (size_t)(n + 1) * (size_t)columns;
    m->inside_vector = vec(0.3, 1, 0.2);
    for (int i = 0; i <= n; i++)
        for (int k = 0; k < columns; k++) {
            double polar = M_PI * i / n, around = 2 * M_PI * k / columns;
            double s = i == 0 || i == n ? 0 : sin(polar);
            v[i * columns + k] = vec(radius * s * cos(around), radius * cos(polar),
                                     radius * s * sin(around));
        }
    for (int i = 0; i < n; i++)
        for (int k = 0; k < columns; k++) {
            uint32_t a = (uint32_t)(i * columns + k), b = (uint32_t)(i * columns + (k + 1) % columns);
            uint32_t c = a + (uint32_t)columns, d = b + (uint32_t)columns;
            if (i < n - 1)
                m->face[m->n_face++] = (struct three) { { a, c, d } };
            if (i > 0)
                m->face[m->n_face++] = (struct three) { { a, d, b } };
        }
    m->box = (struct bounds) { vec(-radius, -radius, -radius), vec(radius, radius, radius) };
    return m;
}

static struct object *mesh_object(const struct mesh *m)
{
    struct object *o = new_object(OBJECT_MESH);

    o->mesh = m;
    return o;
}

/* --- oracles --------------------------------------------------------------- */

static void try_leaf(const struct plan *p, struct ray ray, uint32_t number, uint32_t instance,
                     double far, struct meeting *best)
{
    const struct leaf *l = &p->leaf[number];
    struct hit h[SHAPE_MOST_HITS];
    unsigned long long unused = 0;
    struct ray r = leaf_ray(l, ray);
    int n = l->ops ? l->ops->hits(l->shape, r, h)
                   : mesh_nearest(l->mesh, r, 0, INFINITY, h, &unused);

    for (int i = 0; i < n; i++)
        if (h[i].t > 0 && h[i].t < far && (best->leaf == NO_LEAF || h[i].t < best->t)) {
            *best = (struct meeting) { h[i].t, h[i], number, instance, l->inverse };
            return;
        }
}

static void try_item(const struct plan *p, struct ray ray, uint32_t item, double far,
                     struct meeting *best)
{
    if (item_kind(item) == ITEM_LEAF) {
        try_leaf(p, ray, item_number(item), NO_INSTANCE, far, best);
        return;
    }
    ck_assert_int_eq(item_kind(item), ITEM_INSTANCE);
    const struct instance *in = &p->instance[item_number(item)];
    const struct space *s = &p->geometry->space[in->root];
    struct ray inner = placed_ray(&in->place, ray);
    for (size_t i = 0; i < s->tree.n_item; i++)
        try_leaf(p, inner, item_number(s->tree.item[i]), item_number(item), far, best);
}

/* Every leaf, one after the other. */
static struct meeting brute(const struct plan *p, struct ray ray, double far)
{
    struct meeting best = { .leaf = NO_LEAF };
    const struct space *s = &p->geometry->space[0];

    for (size_t i = 0; i < s->n_unbounded; i++)
        try_item(p, ray, s->unbounded[i], far, &best);
    for (size_t i = 0; i < s->tree.n_item; i++)
        try_item(p, ray, s->tree.item[i], far, &best);
    return best;
}

static void same_as_brute(const struct plan *p, int rays, double from, double to)
{
    struct scratch *s = scratch_new(p, &mem);

    for (int i = 0; i < rays; i++) {
        struct ray ray = random_ray(from, to);
        double far = i % 3 ? INFINITY : 1;
        struct meeting m, b = brute(p, ray, far);
        bool met = geometry_nearest(p, s, ray, far, RAY_PRIMARY, &m);
        ck_assert_int_eq(met, b.leaf != NO_LEAF);
        if (met)
            ck_assert_msg(m.t == b.t, "ray %d: %.17g, not %.17g", i, m.t, b.t);
        ck_assert_int_eq(geometry_blocked(p, s, ray, far, 0), met);
    }
}

/* Of a copy, so that there may be several. */
static struct plan *plan(void)
{
    return plan_new(arena_copy(&mem, &scene, sizeof scene), &mem, 2);
}

/* --- trees ----------------------------------------------------------------- */

START_TEST(test_the_tree_finds_what_asking_every_leaf_finds)
{
    static const int sizes[] = { 1, 2, 7, 8, 9, 33, 300, 2000 };
    static const double origins[] = { 0, 1e6, -1e12 };

    for (size_t k = 0; k < sizeof sizes / sizeof *sizes; k++) {
        teardown();
        setup();
        double far_off = origins[k % 3], size = 2 / cbrt(sizes[k]);
        for (int i = 0; i < sizes[k]; i++) {
            struct object *o = i % 3 ? random_shape(1, size) : triangle(1, size);
            scene_add(&scene, moved(o, transform_translate(vec(far_off, 0, far_off / 3))));
        }
        struct plan *p = plan();
        struct scratch *s = scratch_new(p, &mem);
        for (int i = 0; i < 3000; i++) {
            struct ray ray = random_ray(4, 1);
            ray.origin = vec_add(ray.origin, vec(far_off, 0, far_off / 3));
            struct meeting m, b = brute(p, ray, INFINITY);
            geometry_nearest(p, s, ray, INFINITY, RAY_PRIMARY, &m);
            ck_assert_uint_eq(m.leaf, b.leaf);
            if (m.leaf != NO_LEAF)
                ck_assert(m.t == b.t);
        }
    }
}
END_TEST

START_TEST(test_a_ray_of_any_length_and_origin_meets_the_same)
{
    for (int i = 0; i < 200; i++)
        scene_add(&scene, random_shape(1, 0.2));
    struct plan *p = plan();
    struct scratch *s = scratch_new(p, &mem);
    for (int i = 0; i < 3000; i++) {
        struct ray ray = random_ray(pow(10, uniform(0, 9)), 1);
        ray.dir = vec_scale(ray.dir, ldexp(1, below(200) - 100));
        if (i % 5 == 0)
            ray.dir = vec(i % 2 ? 0.0 : -0.0, ray.dir.y, 0);
        struct meeting m, b = brute(p, ray, INFINITY);
        geometry_nearest(p, s, ray, INFINITY, RAY_PRIMARY, &m);
        ck_assert_uint_eq(m.leaf, b.leaf);
    }
}
END_TEST

enum { MOST_RAYS = 300 };

struct many {
    double x[MOST_RAYS], y[MOST_RAYS], z[MOST_RAYS], dx[MOST_RAYS], dy[MOST_RAYS], dz[MOST_RAYS];
    double far[MOST_RAYS];
    uint8_t mask[MOST_RAYS];
};

static void many_put(struct many *m, int i, struct ray ray)
{
    m->x[i] = ray.origin.x;
    m->y[i] = ray.origin.y;
    m->z[i] = ray.origin.z;
    m->dx[i] = ray.dir.x;
    m->dy[i] = ray.dir.y;
    m->dz[i] = ray.dir.z;
}

/* As cameras, mirrors and lamps make them, and as nobody should. */
static struct ray odd_ray(int i)
{
    struct ray ray = random_ray(i % 3 ? uniform(0, 2) : pow(10, uniform(0, 9)), 1);

    ray.dir = vec_scale(ray.dir, ldexp(1, i % 2 ? 0 : below(200) - 100));
    if (i % 11 == 0)
        ray.dir = vec(i % 2 ? 0.0 : -0.0, ray.dir.y, 0);
    if (i % 53 == 0)
        ray.dir = i % 2 ? vec(0, 0, 0) : vec(NAN, 0, 1);
    return ray;
}

static void many_as_one_by_one(const struct plan *p, struct scratch *s, const struct many *m, int n)
{
    const struct rays rays = { n, m->x, m->y, m->z, m->dx, m->dy, m->dz };
    struct meeting all[MOST_RAYS], one;
    uint64_t barrier[MOST_RAYS];

    struct geometry_counts before = scratch_counts(s);
    geometry_nearest_many(p, s, &rays, m->mask, all);
    geometry_blocked_many(p, s, &rays, m->far, 0, barrier);
    ck_assert_uint_eq(scratch_counts(s).rays - before.rays, (unsigned)n);
    ck_assert_uint_eq(scratch_counts(s).shadow_rays - before.shadow_rays, (unsigned)n);
    for (int i = 0; i < n; i++) {
        struct ray ray = rays_at(&rays, i);
        bool met = geometry_nearest(p, s, ray, INFINITY, m->mask[i], &one);
        ck_assert_uint_eq(all[i].leaf, one.leaf);
        ck_assert(!met || all[i].t == one.t);
        ck_assert(!met || all[i].instance == one.instance);
        ck_assert_int_eq(barrier[i] == BARRIER_OPAQUE, geometry_blocked(p, s, ray, m->far[i], 1));
    }
}

START_TEST(test_many_rays_meet_what_each_meets_alone)
{
    static const int sizes[] = { 3, 40, 300, 3000, 20000 };

    for (size_t k = 0; k < 2 * sizeof sizes / sizeof *sizes; k++) {
        teardown();
        setup();
        int n = sizes[k / 2];
        for (int i = 0; i < n; i++)
            scene_add(&scene, k % 2 ? random_shape(1, 2 / cbrt(n)) : sphere(in_cube(1), 1 / cbrt(n)));
        scene_add(&scene, SHAPE("plane", 0.6, 0.8, 0, -2));
        struct plan *p = plan();
        struct scratch *s = scratch_new(p, &mem);
        for (int round = 0; round < 20; round++) {
            struct many m;
            int n_ray = 1 + below(MOST_RAYS);
            for (int i = 0; i < n_ray; i++) {
                many_put(&m, i, odd_ray(i + round));
                m.far[i] = i % 3 ? INFINITY : uniform(0, 2);
                m.mask[i] = RAY_PRIMARY;
            }
            many_as_one_by_one(p, s, &m, n_ray);
        }
    }
}
END_TEST

START_TEST(test_scaling_by_two_to_the_k_changes_no_bit)
{
    static const int exponents[] = { -100, -7, 1, 100 };
    struct object *o[100];
    struct meeting met[500];

    for (int i = 0; i < 100; i++)
        o[i] = random_shape(1, 0.3);
    for (int k = -1; k < 4; k++) {
        double by = k < 0 ? 1 : ldexp(1, exponents[k]);
        scene_init(&scene, &mem);
        for (int i = 0; i < 100; i++)
            scene_add(&scene, moved(o[i], transform_scale(vec(by, by, by))));
        struct plan *p = plan();
        struct scratch *s = scratch_new(p, &mem);
        state = 7;
        for (int i = 0; i < 500; i++) {
            struct ray ray = random_ray(3, 1);
            struct meeting m;
            ray.origin = vec_scale(ray.origin, by);
            ray.dir = vec_scale(ray.dir, by);
            geometry_nearest(p, s, ray, INFINITY, RAY_PRIMARY, &m);
            if (k >= 0) {
                ck_assert_uint_eq(m.leaf, met[i].leaf);
                ck_assert(m.leaf == NO_LEAF || m.t == met[i].t);
            }
            met[i] = m;
        }
    }
}
END_TEST

START_TEST(test_rays_at_edges_and_corners_of_stacked_boxes_never_slip_through)
{
    enum { N = 6 };
    struct meeting m;

    for (int i = 0; i < N * N * N; i++) {
        vec3 a = vec(i % N, i / N % N, i / N / N);
        scene_add(&scene, box(vec_scale(a, 0.1), vec_scale(vec_add(a, vec(1, 1, 1)), 0.1)));
    }
    struct plan *p = plan();
    struct scratch *s = scratch_new(p, &mem);
    for (int i = 0; i < 100000; i++) {
        vec3 to = vec(0.1 * (1 + below(N - 1)), 0.1 * (1 + below(N - 1)), 0.1 * (1 + below(N - 1)));
        if (i % 2)
            to.x = uniform(0.1, 0.5);
        vec3 from = vec_add(vec(0.3, 0.3, 0.3), vec_scale(on_sphere(), 3));
        if (i % 7 == 0)
            from = vec(to.x, to.y, -2);
        struct ray ray = { from, vec_sub(to, from) };
        ck_assert(geometry_nearest(p, s, ray, INFINITY, RAY_PRIMARY, &m));
        ck_assert(m.t < 1);
    }
}
END_TEST

START_TEST(test_small_spheres_are_met_at_their_very_edge)
{
    enum { N = 400 };
    vec3 centre[N];
    double radius[N];

    for (int i = 0; i < N; i++) {
        centre[i] = in_cube(1);
        radius[i] = pow(10, uniform(-9, -3));
        scene_add(&scene, sphere(centre[i], radius[i]));
    }
    struct plan *p = plan();
    struct scratch *s = scratch_new(p, &mem);
    ck_assert_ptr_nonnull(p->geometry->space[0].tree.ball[0]);
    for (int i = 0; i < 20000; i++) {
        int k = below(N);
        vec3 from = vec_scale(on_sphere(), pow(10, uniform(0, 4)));
        vec3 across = vec_unit(vec_cross(on_sphere(), vec_sub(centre[k], from)));
        vec3 to = vec_fma(centre[k], radius[k] * uniform(0.99, 1.001), across);
        struct ray ray = { from, vec_sub(to, from) };
        struct meeting m, b = brute(p, ray, INFINITY);
        geometry_nearest(p, s, ray, INFINITY, RAY_PRIMARY, &m);
        ck_assert_uint_eq(m.leaf, b.leaf);
    }
}
END_TEST

/* Long and thin, short and flat, askew. */
START_TEST(test_slanted_things_are_met_at_their_very_edge)
{
    enum { N = 400 };
    vec3 on[N];

    for (int i = 0; i < N; i++) {
        double size = pow(10, uniform(-6, -1)), thin = size * pow(10, uniform(-4, 0));
        vec3 at = in_cube(1), to = vec_fma(at, size, on_sphere()), half = vec(size, thin, thin / 2);
        struct transform turn = turned(in_cube(180), at);
        bool is_tube = i % 2;
        scene_add(&scene, is_tube ? SHAPE("cylinder", at.x, at.y, at.z, to.x, to.y, to.z, thin)
                                  : moved(box(vec_neg(half), half), turn));
        on[i] = is_tube ? at : mat_point(&turn.to, half);
    }
    struct plan *p = plan();
    struct scratch *s = scratch_new(p, &mem);
    ck_assert_ptr_nonnull(p->geometry->space[0].tree.brick);
    for (int i = 0; i < 20000; i++) {
        vec3 from = vec_scale(on_sphere(), pow(10, uniform(0, 4)));
        vec3 to = vec_fma(on[below(N)], pow(10, uniform(-12, -2)), on_sphere());
        struct ray ray = { from, vec_sub(to, from) };
        struct meeting m, b = brute(p, ray, INFINITY);
        geometry_nearest(p, s, ray, INFINITY, RAY_PRIMARY, &m);
        ck_assert_uint_eq(m.leaf, b.leaf);
    }
}
END_TEST

static struct plan *plan_of_many(unsigned threads)
{
    state = 1;
    scene_init(&scene, &mem);
    for (int i = 0; i < 20000; i++)
        scene_add(&scene, sphere(in_cube(1), 0.01));
    return plan_new(&scene, &mem, threads);
}

START_TEST(test_any_number_of_threads_builds_the_same_tree)
{
    struct plan *one = plan_of_many(1), *five = plan_of_many(5);
    const struct bvh *a = &one->geometry->space[0].tree, *b = &five->geometry->space[0].tree;
    ck_assert_uint_eq(a->n_node, b->n_node);
    ck_assert_int_eq(memcmp(a->node, b->node, a->n_node * sizeof *a->node), 0);
    ck_assert_int_eq(memcmp(a->item, b->item, a->n_item * sizeof *a->item), 0);
}
END_TEST

/* Ways to lie about: everywhere, in one place, ever closer together, on a
 * line, most of them in one small clump. */
static vec3 place_of(int way, int i)
{
    switch (way) {
    case 0: return in_cube(1);
    case 1: return vec(3, 4, 5);
    case 2: return vec_scale(vec(1, 2, 1), ldexp(1, -(i % 900)));
    case 3: return vec(1e6 + i, 2, 3);
    default: return vec_scale(in_cube(1), i % 100 ? 1e-7 : 1);
    }
}

static struct bounds nth_box(const void *of, size_t i) { return ((const struct bounds *)of)[i]; }

struct found { const struct bvh *tree; const struct bounds *box; int *times; };

static void look_into(const struct found *s, const struct bvh_node *n, int slot)
{
    for (uint32_t k = n->child[slot]; k < n->child[slot] + n->count[slot]; k++) {
        struct bounds b = s->box[s->tree->item[k]];
        s->times[s->tree->item[k]]++;
        for (int axis = 0; axis < 3; axis++) {
            double middle = vec_get(s->tree->middle, axis), scale = s->tree->scale;
            ck_assert((double)n->side[0][axis][slot] <= (vec_get(b.low, axis) - middle) * scale);
            ck_assert((double)n->side[1][axis][slot] >= (vec_get(b.high, axis) - middle) * scale);
        }
    }
}

static void look_below(const struct found *s, uint32_t number, int depth)
{
    const struct bvh_node *n = &s->tree->node[number];

    ck_assert_int_lt(depth * (LANES - 1), BVH_STACK);
    for (int slot = 0; slot < LANES; slot++) {
        if (n->count[slot])
            look_into(s, n, slot);
        else if (n->side[0][0][slot] < INFINITY)
            look_below(s, n->child[slot], depth + 1);
    }
}

/* Once for each way. */
START_TEST(test_each_item_is_once_in_the_tree_within_its_box)
{
    static const int sizes[] = { 1, 2, 9, 4096, 4097, 30000 };

    for (size_t k = 0; k < sizeof sizes / sizeof *sizes; k++) {
        size_t n = (size_t)sizes[k];
        struct bounds *box = arena_array(&mem, n, sizeof *box);
        struct bvh tree;
        for (size_t i = 0; i < n; i++) {
            box[i].low = place_of(_i, (int)i);
            box[i].high = vec_add(box[i].low, vec(1e-3, 0, uniform(0, 1e-2)));
        }
        bvh_build(&tree, n, nth_box, box, NULL, 4, k % 2 ? 4 : 1, 2, &mem);
        struct found s = { &tree, box, arena_array(&mem, n, sizeof(int)) };
        look_below(&s, 0, 1);
        for (size_t i = 0; i < n; i++)
            ck_assert_int_eq(s.times[i], 1);
    }
}
END_TEST

START_TEST(test_a_sphere_costs_at_most_80_bytes)
{
    enum { N = 100000 };

    for (int i = 0; i < N; i++)
        scene_add(&scene, sphere(in_cube(1), 0.005));
    struct arena own;
    arena_init(&own, NULL);
    plan_new(&scene, &own, 1);
    size_t size = arena_size(&own);
    arena_free(&own);
    ck_assert_msg(size <= 80 * N, "%zu bytes a sphere", size / N);
}
END_TEST

START_TEST(test_a_triangle_costs_at_most_64_bytes_beyond_its_corners)
{
    const struct mesh *ball = mesh_ball(350, 1);
    struct arena own;

    arena_init(&own, NULL);
    scene_add(&scene, mesh_object(ball));
    plan_new(&scene, &own, 1);
    size_t size = arena_size(&own);
    arena_free(&own);
    ck_assert_msg(size <= 64 * ball->n_face, "%zu bytes a triangle", size / ball->n_face);
}
END_TEST

START_TEST(test_equal_things_are_met_in_the_order_of_their_listing)
{
    struct meeting m;

    for (int i = 0; i < 40; i++)
        scene_add(&scene, sphere(vec(0, 0, 0), 1));
    struct plan *p = plan();
    struct scratch *s = scratch_new(p, &mem);
    struct ray ray = { vec(0, 0, -3), vec(0, 0, 1) };
    ck_assert(geometry_nearest(p, s, ray, INFINITY, RAY_PRIMARY, &m));
    ck_assert_uint_eq(m.leaf, 0);
}
END_TEST

/* --- instances and inheritance --------------------------------------------- */

START_TEST(test_a_union_placed_often_is_stored_once)
{
    struct object *child[50], *copy;

    for (int i = 0; i < 50; i++)
        child[i] = random_shape(1, 0.2);
    struct object *u = group(OBJECT_UNION, child, 50);
    for (int i = 0; i < 60; i++) {
        copy = moved(u, turned(in_cube(180), in_cube(5)));
        scene_add(&scene, copy);
    }
    struct plan *p = plan();
    ck_assert_uint_eq(p->n_instance, 60);
    ck_assert_uint_eq(p->n_leaf, 50);
    same_as_brute(p, 2000, 12, 5);
}
END_TEST

START_TEST(test_instances_may_differ_in_their_texture)
{
    struct object *child[50], *copy;

    for (int i = 0; i < 50; i++)
        child[i] = random_shape(1, 0.2);
    struct object *u = group(OBJECT_UNION, child, 50);
    for (int i = 0; i < 40; i++) {
        struct texture *t = arena_copy(&mem, &texture_default, sizeof *t);
        struct pigment *g = arena_copy(&mem, t->pigment, sizeof *g);
        g->colour.r = (float)i;
        t->pigment = g;
        copy = moved(u, turned(in_cube(180), in_cube(5)));
        copy->texture = t;
        scene_add(&scene, copy);
    }
    struct plan *p = plan();
    struct scratch *s = scratch_new(p, &mem);
    ck_assert_uint_eq(p->n_leaf, 50);
    for (int i = 0; i < 500; i++) {
        struct ray ray = random_ray(12, 5);
        struct meeting m;
        struct surface_point at;
        if (!geometry_nearest(p, s, ray, INFINITY, RAY_PRIMARY, &m))
            continue;
        geometry_point(p, &ray, &m, &at);
        ck_assert_int_eq((int)p->surface[at.surface].texture->pigment->colour.r, (int)m.instance);
    }
}
END_TEST

/* --- meshes ---------------------------------------------------------------- */

START_TEST(test_nothing_leaks_from_a_closed_mesh)
{
    struct mesh *ball = mesh_ball(24, 1);
    vec3 off = vec(1e5, -3e4, 7);

    scene_add(&scene, moved(mesh_object(ball), transform_translate(off)));
    struct plan *p = plan();
    struct scratch *s = scratch_new(p, &mem);
    for (int i = 0; i < 100000; i++) {
        const struct three *f = &ball->face[below((int)ball->n_face)];
        double mix = i % 2 ? 0 : uniform(0, 1);
        vec3 a = ball->vertex[f->of[0]], b = ball->vertex[f->of[1]];
        vec3 to = vec_add(off, vec_add(vec_scale(a, 1 - mix), vec_scale(b, mix)));
        vec3 from = vec_add(off, in_cube(0.5));
        struct meeting m;
        struct ray ray = { from, vec_sub(to, from) };
        ck_assert(geometry_nearest(p, s, ray, INFINITY, RAY_PRIMARY, &m));
    }
}
END_TEST

START_TEST(test_a_mesh_is_met_where_asking_every_face_meets_it)
{
    struct mesh *ball = mesh_ball(20, 1);

    scene_add(&scene, moved(mesh_object(ball), turned(in_cube(90), in_cube(1))));
    struct plan *p = plan();
    struct scratch *s = scratch_new(p, &mem);
    for (int i = 0; i < 2000; i++) {
        struct ray ray = random_ray(4, 2), r = leaf_ray(&p->leaf[0], ray);
        struct meeting m;
        double best = INFINITY;
        for (size_t k = 0; k < ball->n_face; k++) {
            struct object *t;
            vec3 c[3];
            for (int j = 0; j < 3; j++)
                c[j] = ball->vertex[ball->face[k].of[j]];
            t = SHAPE("triangle", c[0].x, c[0].y, c[0].z, c[1].x, c[1].y, c[1].z, c[2].x, c[2].y,
                      c[2].z);
            struct hit h;
            if (t->ops->nearest(t->shape, &r, 0, best, &h))
                best = h.t;
        }
        ck_assert_int_eq(geometry_nearest(p, s, ray, INFINITY, RAY_PRIMARY, &m), best < INFINITY);
        if (best < INFINITY)
            ck_assert(m.t == best);
    }
}
END_TEST

/* --- arrays of rays -------------------------------------------------------- */

static struct texture *glass(float transmit)
{
    struct texture *t = arena_copy(&mem, &texture_default, sizeof *t);
    struct pigment *g = arena_copy(&mem, t->pigment, sizeof *g);

    g->colour.t = transmit;
    t->pigment = g;
    return t;
}

static struct object *random_csg(int depth);

/* Some of it in the same place twice: then the first listed is met. */
static void add_mixture(int n, bool with_csg)
{
    struct object *o = NULL;

    for (int i = 0; i < n; i++) {
        struct mesh *four = mesh_ball(3, 0.7);
        vec3 c = in_cube(1), d = on_sphere();
        four->n_face = 4;
        switch (below(with_csg ? 8 : 7)) {
        case 0:  break;
        case 1:  o = triangle(2, 2); break;
        case 2:  o = moved(mesh_object(four), turned(in_cube(90), in_cube(2))); break;
        case 3:  o = SHAPE("disc", c.x, c.y, c.z, d.x, d.y, d.z, 1); break;
        case 4:
            d = below(2) ? d : below(2) ? vec(0, uniform(-2, 2), 0) : vec(uniform(-2, 2), 0, 0);
            o = SHAPE("plane", d.x, d.y, d.z, uniform(0, 3));
            break;
        case 5:  o = moved(random_shape(1, 1), turned(in_cube(90), in_cube(2))); break;
        case 6:  o = random_shape(2, 1); break;
        default: o = random_csg(2);
        }
        o = object_copy(&mem, o ? o : sphere(c, 1));
        o->texture = below(2) ? glass(0.5f) : &texture_default;
        o->flags = o->flags_given = below(5) ? 0 : below(2) ? OBJECT_NO_SHADOW : OBJECT_NO_IMAGE;
        scene_add(&scene, o);
    }
}

enum { SOME_RAYS = 300 };

struct some_rays { double at[6][SOME_RAYS], far[SOME_RAYS]; uint8_t mask[SOME_RAYS]; };

/* From one point mostly, as beams are. */
static struct rays make_rays(struct some_rays *r)
{
    vec3 from = vec_scale(on_sphere(), uniform(0, 8));

    for (int i = 0; i < SOME_RAYS; i++) {
        vec3 o = i % 50 ? from : in_cube(3), d = vec_sub(in_cube(2), o);
        for (int axis = 0; axis < 3; axis++) {
            r->at[axis][i] = vec_get(o, axis);
            r->at[3 + axis][i] = vec_get(d, axis);
        }
        r->far[i] = uniform(0, 2);
        r->mask[i] = below(2) ? RAY_PRIMARY : RAY_REFLECTED;
    }
    return (struct rays) { SOME_RAYS, r->at[0], r->at[1], r->at[2], r->at[3], r->at[4], r->at[5] };
}

struct list { int n; struct meeting m[100]; };

static bool add_to_list(void *arg, const struct meeting *m)
{
    struct list *l = arg;

    l->m[l->n++] = *m;
    return l->n < 100;
}

static void same_meeting(const struct meeting *a, const struct meeting *b)
{
    ck_assert(a->t == b->t && a->leaf == b->leaf && a->instance == b->instance
              && a->flipped == b->flipped && a->hit.t == b->hit.t && a->hit.u == b->hit.u
              && a->hit.v == b->hit.v && a->hit.slack == b->hit.slack && a->hit.part == b->hit.part);
}

static void same_crossings(const struct plan *p, struct scratch *s, struct ray ray, double far,
                           uint64_t barrier)
{
    struct list all = { 0 }, some = { 0 };

    if (barrier != 0)
        geometry_crossings(p, s, ray, far, 0, barrier, add_to_list, &some);
    geometry_crossings(p, s, ray, far, 0, BARRIER_CLEAR, add_to_list, &all);
    ck_assert_int_eq(some.n, all.n);
    for (int i = 0; i < all.n; i++)
        same_meeting(&some.m[i], &all.m[i]);
}

/* Where it is enough to count crossings, those of many rays at once are each one's. */
static void same_tallies(const struct plan *p, struct scratch *s, struct ray ray, double far,
                         uint64_t barrier)
{
    unsigned all[PLAN_TALLIES], some[PLAN_TALLIES] = { 0 };

    if (p->n_tally == 0)
        return;
    ck_assert(geometry_tally(p, s, ray, far, 0, BARRIER_CLEAR, all));
    if (barrier != 0)
        ck_assert(geometry_tally(p, s, ray, far, 0, barrier, some));
    for (int k = 0; k < p->n_tally; k++)
        ck_assert_uint_eq(some[k], all[k]);
}

static bool stands_between(const struct plan *p, struct scratch *s, struct ray ray, double far,
                           uint64_t barrier)
{
    struct list unused = { 0 };

    if (barrier == BARRIER_ANY)
        return !geometry_crossings(p, s, ray, far, 0, barrier, add_to_list, &unused);
    return barrier == BARRIER_OPAQUE;
}

static void arrays_meet_what_each_meets(const struct plan *p)
{
    static struct some_rays some;
    static struct meeting many[SOME_RAYS];
    uint64_t barrier[SOME_RAYS];
    struct scratch *s = scratch_new(p, &mem), *other = scratch_new(p, &mem);
    struct rays r = make_rays(&some);

    geometry_nearest_many(p, s, &r, some.mask, many);
    geometry_blocked_many(p, s, &r, some.far, 0, barrier);
    for (int i = 0; i < SOME_RAYS; i++) {
        struct meeting one;
        bool met = geometry_nearest(p, other, rays_at(&r, i), INFINITY, some.mask[i], &one);
        ck_assert_int_eq(many[i].leaf != NO_LEAF, met);
        if (met)
            same_meeting(&many[i], &one);
        bool blocked = geometry_blocked(p, other, rays_at(&r, i), some.far[i], 0);
        ck_assert_int_eq(stands_between(p, s, rays_at(&r, i), some.far[i], barrier[i]), blocked);
        if (blocked)
            continue;
        same_tallies(p, s, rays_at(&r, i), some.far[i], barrier[i]);
        same_crossings(p, s, rays_at(&r, i), some.far[i], barrier[i]);
    }
}

/* _i: in a small scene, in one with a tree, with CSG or without. */
START_TEST(test_arrays_of_rays_meet_what_each_ray_meets)
{
    for (int round = 0; round < 60; round++) {
        scene_init(&scene, &mem);
        add_mixture(_i & 2 ? 60 : 1 + below(FEW), _i & 1);
        arrays_meet_what_each_meets(plan());
        teardown();
        arena_init(&mem, NULL);
    }
}
END_TEST

/* Each face twice, the second time turned the other way; nothing in the upper
 * half, so that rays get in. */
static struct object *doubled_bowl(void)
{
    struct mesh *m = mesh_ball(2 + below(20), uniform(0.3, 1));
    size_t n = m->n_face / 2;
    struct three *face = arena_array(&mem, 2 * n, sizeof *face);

    for (size_t i = 0; i < n; i++) {
        face[i] = face[2 * n - 1 - i] = m->face[m->n_face - n + i];
        face[i].of[0] = m->face[m->n_face - n + i].of[1];
        face[i].of[1] = m->face[m->n_face - n + i].of[0];
    }
    m->face = face;
    m->n_face = 2 * n;
    return mesh_object(m);
}

START_TEST(test_arrays_of_rays_meet_meshes_as_each_ray_does)
{
    for (int round = 0; round < 60; round++) {
        scene_init(&scene, &mem);
        for (int i = round % 2 ? below(3) : 0; i >= 0; i--) {
            struct object *bowl = doubled_bowl();
            if (below(3))
                bowl = moved(bowl, turned(in_cube(90), in_cube(1)));
            bowl->texture = below(4) ? &texture_default : glass(0.5f);
            bowl->flags = bowl->flags_given = below(5) ? 0 : OBJECT_NO_IMAGE;
            scene_add(&scene, bowl);
            scene_add(&scene, below(2) ? object_copy(&mem, bowl) : random_shape(1, 0.5));
        }
        arrays_meet_what_each_meets(plan());
        teardown();
        arena_init(&mem, NULL);
    }
}
END_TEST

/* --- CSG ------------------------------------------------------------------- */

static struct object *random_csg(int depth)
{
    static const enum object_kind kinds[] = { OBJECT_MERGE, OBJECT_INTERSECTION,
                                              OBJECT_DIFFERENCE };
    struct object *child[3], *o;
    int n = 2 + below(2);

    if (depth == 0) {
        o = random_shape(0.7, 1.2);
    } else {
        for (int i = 0; i < n; i++)
            child[i] = random_csg(depth - 1);
        o = group(kinds[below(3)], child, (size_t)n);
    }
    if (below(6) == 0)
        o->flags ^= OBJECT_INVERSE;
    if (below(4) == 0)
        o = moved(o, turned(in_cube(180), in_cube(0.3)));
    return o;
}

/* How far a ray may be trusted to have been decided apart from rounding. */
static const double step = 1e-7;

START_TEST(test_csg_shows_exactly_where_its_inside_begins_and_ends)
{
    int met = 0;

    for (int round = 0; round < 300; round++) {
        struct object *o = random_csg(1 + below(3));
        scene_init(&scene, &mem);
        scene_add(&scene, o->kind == OBJECT_SHAPE ? GROUP(OBJECT_MERGE, o) : o);
        struct plan *p = plan();
        struct scratch *s = scratch_new(p, &mem);
        for (int i = 0; i < 60; i++) {
            struct ray ray = random_ray(4, 1);
            struct meeting m;
            double end = 2;
            bool first = object_inside(o, ray.origin, NULL);
            if (geometry_nearest(p, s, ray, 2, RAY_PRIMARY, &m)) {
                vec3 before = ray_at(ray, m.t - step), after = ray_at(ray, m.t + step);
                ck_assert_int_ne(object_inside(o, before, NULL), object_inside(o, after, NULL));
                end = m.t - step;
                met++;
            }
            for (int k = 0; k < 40; k++)
                ck_assert_int_eq(object_inside(o, ray_at(ray, uniform(0, end)), NULL), first);
        }
    }
    ck_assert_int_gt(met, 2000);
}
END_TEST

START_TEST(test_csg_normals_point_out_of_the_solid)
{
    for (int round = 0; round < 100; round++) {
        struct object *o = random_csg(2);
        scene_init(&scene, &mem);
        scene_add(&scene, o);
        struct plan *p = plan();
        struct scratch *s = scratch_new(p, &mem);
        for (int i = 0; i < 30; i++) {
            struct ray ray = random_ray(4, 1);
            struct meeting m;
            struct surface_point at;
            if (!geometry_nearest(p, s, ray, INFINITY, RAY_PRIMARY, &m))
                continue;
            geometry_point(p, &ray, &m, &at);
            bool enters = object_inside(o, ray_at(ray, m.t + step), NULL);
            ck_assert_int_eq(vec_dot(at.normal, ray.dir) < 0, enters);
        }
    }
}
END_TEST

/* ---- points in arrays ---- */

/* Shapes as they stand, turned ones, solids cut from others, and copies. */
static void add_all_sorts(void)
{
    struct object *child[12];

    for (int i = 0; i < 12; i++) {
        child[i] = random_shape(1, 0.4);
        scene_add(&scene, random_shape(3, 1));
        scene_add(&scene, moved(random_shape(1, 1), turned(in_cube(180), in_cube(3))));
    }
    struct object *u = group(OBJECT_UNION, child, 12);
    for (int i = 0; i < 40; i++)
        scene_add(&scene, moved(u, turned(in_cube(180), in_cube(3))));
    scene_add(&scene, random_csg(2));
    scene_add(&scene, moved(random_csg(1), turned(in_cube(180), in_cube(1))));
}

static void same_as_singly(const struct plan *p, const struct points *at, int i,
                           const struct ray *ray, const struct meeting *m)
{
    struct surface_point one;

    geometry_point(p, ray, m, &one);
    bool from_inside = vec_dot(one.normal, ray->dir) > 0;
    vec3 n = vec_unit(from_inside ? vec_neg(one.normal) : one.normal);
    ck_assert(at->x[i] == one.point.x && at->y[i] == one.point.y && at->z[i] == one.point.z);
    ck_assert(at->nx[i] == n.x && at->ny[i] == n.y && at->nz[i] == n.z);
    ck_assert(at->slack[i] == one.slack);
    ck_assert_int_eq(at->from_inside[i], from_inside);
    ck_assert_ptr_eq(at->surface[i], &p->surface[one.surface]);
}

START_TEST(test_points_in_arrays_are_what_each_is_alone)
{
    enum { RAYS = 3000 };
    static double column[6][RAYS];
    static struct meeting m[RAYS];
    static struct points at;
    const struct rays rays = { RAYS, column[0], column[1], column[2], column[3], column[4],
                               column[5] };

    add_all_sorts();
    struct plan *p = plan();
    struct scratch *s = scratch_new(p, &mem);
    for (int i = 0; i < RAYS; i++) {
        struct ray ray = random_ray(8, 3);
        ray.dir = vec_unit(ray.dir);
        const double part[] = { ray.origin.x, ray.origin.y, ray.origin.z,
                                ray.dir.x, ray.dir.y, ray.dir.z };
        for (int k = 0; k < 6; k++)
            column[k][i] = part[k];
        if (geometry_nearest(p, s, ray, INFINITY, RAY_PRIMARY, &m[i]))
            at.index[at.n++] = (uint32_t)i;
        if (at.n < 1 + below(BATCH) && i < RAYS - 1)
            continue;
        geometry_points(p, &rays, m, &at);
        for (int k = 0; k < at.n; k++) {
            uint32_t r = at.index[k];
            ray = (struct ray) { { column[0][r], column[1][r], column[2][r] },
                                 { column[3][r], column[4][r], column[5][r] } };
            same_as_singly(p, &at, k, &ray, &m[r]);
        }
        at.n = 0;
    }
}
END_TEST

/* Unions of all that there is, planes excepted, some not seen by all rays. */
static struct object *some_union(int n)
{
    struct object *child[50];

    for (int i = 0; i < n; i++) {
        child[i] = i % 4 == 3 ? mesh_object(mesh_ball(2 + below(12), 0.4))
                   : i % 4 == 2 ? random_csg(1) : random_shape(0.5, 0.3);
        child[i]->flags |= below(6) ? 0 : OBJECT_NO_IMAGE;
        child[i]->flags |= below(6) ? 0 : OBJECT_NO_SHADOW;
    }
    return group(OBJECT_UNION, child, (size_t)n);
}

START_TEST(test_rays_to_copies_go_together_and_meet_what_each_meets_alone)
{
    for (int round = 0; round < 6; round++) {
        teardown();
        setup();
        struct object *kind[6];
        scene_add_light(&scene, &(struct light) { .colour = { 1, 1, 1 } });
        int n_kind = round % 2 ? 6 : 2;
        double wide = round % 3 ? 8 : 3;
        for (int i = 0; i < n_kind; i++)
            kind[i] = some_union(i == 0 ? 50 : 3 + below(6));       /* one with a tree */
        for (int i = 0; i < 1200; i++)
            scene_add(&scene, moved(kind[i % n_kind], turned(in_cube(180), i % 10 ? in_cube(wide) : vec(0, 0, 0))));
        struct plan *p = plan();
        struct scratch *s = scratch_new(p, &mem);
        ck_assert_uint_eq(p->n_instance, 1200);
        for (int k = 0; k < 8; k++) {
            struct many m;
            for (int i = 0; i < MOST_RAYS; i++) {
                many_put(&m, i, i % 20 ? random_ray(uniform(0, 2), wide) : odd_ray(i + k));
                m.far[i] = i % 3 ? INFINITY : uniform(0, 2);
                m.mask[i] = i % 2 ? RAY_PRIMARY : RAY_REFLECTED;
            }
            many_as_one_by_one(p, s, &m, MOST_RAYS);
        }
    }
}
END_TEST

enum { COPIES = 4000 };

/* The same CSG at many places; or, so that nothing is shared, as many that are equal. */
static struct plan *csg_at_many_places(struct object *o, const struct transform at[], bool is_shared)
{
    scene_init(&scene, &mem);
    for (int i = 0; i < COPIES; i++) {
        struct object *copy = moved(o, at[i]);
        if (!is_shared)
            copy->child = arena_copy(&mem, copy->child, copy->n_child * sizeof *copy->child);
        scene_add(&scene, copy);
    }
    return plan();
}

START_TEST(test_csg_placed_often_is_stored_once_and_looks_alike)
{
    int n_shared = 0;

    for (int round = 0; round < 6; round++) {
        struct object *o = random_csg(1 + round % 2);
        struct transform at[COPIES];
        o->flags &= ~(unsigned)OBJECT_INVERSE;
        for (int i = 0; i < COPIES; i++)
            at[i] = turned(in_cube(180), in_cube(40));
        struct plan *once = csg_at_many_places(o, at, true), *each = csg_at_many_places(o, at, false);
        ck_assert_uint_eq(each->n_instance, 0);
        ck_assert(once->n_instance == COPIES || once->n_leaf == 0 || each->n_leaf / COPIES < 3);
        n_shared += once->n_instance == COPIES;
        struct scratch *a = scratch_new(once, &mem), *b = scratch_new(each, &mem);
        for (int i = 0; i < 1000; i++) {
            struct ray ray = random_ray(45, 30);
            struct meeting m, n;
            struct surface_point p, q;
            bool met = geometry_nearest(once, a, ray, INFINITY, RAY_PRIMARY, &m);
            ck_assert_int_eq(met, geometry_nearest(each, b, ray, INFINITY, RAY_PRIMARY, &n));
            if (!met)
                continue;
            ck_assert_double_eq_tol(m.t, n.t, 1e-9);
            geometry_point(once, &ray, &m, &p);
            geometry_point(each, &ray, &n, &q);
            ck_assert_double_le(vec_length(vec_sub(vec_unit(p.normal), vec_unit(q.normal))), 1e-6);
        }
    }
    ck_assert_int_gt(n_shared, 1);
}
END_TEST

/* Glass that is placed often: the camera may be in any of it. */
START_TEST(test_a_point_is_inside_of_the_copies_around_it)
{
    static const enum object_kind kinds[] = { OBJECT_UNION, OBJECT_INTERSECTION };
    static const struct interior glass = { .ior = 1.5 };

    for (int round = 0; round < 4; round++) {
        bool is_own = round >= 2;       /* of the copy, or of what is in it */
        struct object *child[3];
        for (int i = 0; i < 3; i++) {
            child[i] = sphere(vec(0.1 * i, 0, 0), 1);
            object_more(&mem, child[i])->interior = is_own || i > 0 ? NULL : &glass;
        }
        struct object *o = group(kinds[round % 2], child, 3);
        object_more(&mem, o)->interior = is_own ? &glass : NULL;
        scene_init(&scene, &mem);
        for (int i = 0; i < COPIES; i++)
            scene_add(&scene, moved(o, transform_translate(vec(4 * i, 0, 0))));
        struct plan *p = plan();
        struct scratch *s = scratch_new(p, &mem);
        uint32_t surface[8];
        ck_assert_uint_eq(p->n_instance, COPIES);
        ck_assert_uint_eq(geometry_inside(p, s, vec(40.1, 0, 0), surface, 8),
                          is_own && round % 2 == 0 ? 3 : 1);
        ck_assert_ptr_eq(p->surface[surface[0]].interior, &glass);
        ck_assert_uint_eq(geometry_inside(p, s, vec(42.5, 0, 0), surface, 8), 0);
    }
}
END_TEST

/* What blocked the last ray is asked first, where it stands. */
START_TEST(test_a_copy_that_blocks_is_remembered_where_it_stands)
{
    struct object *child[3] = { sphere(vec(0, 0, 0), 1), sphere(vec(0, 1, 0), 1), sphere(vec(0, 0, 1), 1) };
    struct object *three = group(OBJECT_UNION, child, 3);
    const struct ray at_it = { { 10, 0, -20 }, { 0, 0, 1 } }, beside = { { 20, 0, -20 }, { 0, 0, 1 } };

    scene_add_light(&scene, &(struct light) { .colour = { 1, 1, 1 } });
    scene_add(&scene, moved(three, transform_translate(vec(10, 0, 0))));
    for (int i = 0; i < 300; i++)
        scene_add(&scene, moved(three, transform_translate(vec(-10 - 4 * i, 0, 0))));
    struct plan *p = plan();
    struct scratch *s = scratch_new(p, &mem);
    ck_assert_uint_eq(p->n_instance, 301);
    for (int i = 0; i < 2; i++) {
        ck_assert(geometry_blocked(p, s, at_it, INFINITY, 0));
        ck_assert(!geometry_blocked(p, s, beside, INFINITY, 0));
    }
}
END_TEST

/* Corners on a coarse grid, so that many faces coincide. */
static double on_grid(void) { return 0.25 * (below(9) - 4); }

static struct object *gridded_shape(void)
{
    double x = on_grid(), y = on_grid(), z = on_grid(), h = 0.25 * (1 + below(4));

    switch (below(4)) {
    case 0:  return sphere(vec(x, y, z), 0.25 * (1 + below(4)));
    case 1:  return box(vec(x, y, z), vec(x + h, y + 0.5, z + 1));
    case 2:  return SHAPE("cylinder", x, y, z, x, y + h, z, 0.5);
    default: return SHAPE("plane", 0, 1, 0, y);
    }
}

/* Differences and intersections that touch where they can. */
static struct object *gridded_csg(void)
{
    static const enum object_kind kinds[] = { OBJECT_INTERSECTION, OBJECT_DIFFERENCE,
                                              OBJECT_DIFFERENCE };
    struct object *child[4];
    size_t n = 2 + (size_t)below(3);

    child[0] = box(vec(-1, -1, -1), vec(1, 1, 1));
    for (size_t i = 1; i < n; i++)
        child[i] = below(3) ? gridded_shape() : moved(gridded_shape(), turned(in_cube(180), in_cube(0.3)));
    return group(kinds[below(3)], child, n);
}

enum { COLUMN = 300 };

static void fill_columns(double column[6][COLUMN], int i, struct ray ray)
{
    for (int axis = 0; axis < 3; axis++) {
        column[axis][i] = vec_get(ray.origin, axis);
        column[3 + axis][i] = vec_get(ray.dir, axis);
    }
}

/* Rays that lie together, so that they make beams. */
static void many_are_as_each(const struct plan *p)
{
    struct scratch *s = scratch_new(p, &mem);
    vec3 from = vec_scale(on_sphere(), below(2) ? 1 : 12), to = in_cube(4);
    double column[6][COLUMN], far[COLUMN];
    struct meeting many[COLUMN], one;
    uint64_t barrier[COLUMN];
    uint8_t mask[COLUMN];

    for (int i = 0; i < COLUMN; i++) {
        vec3 at = vec_add(to, vec(0.02 * (i % 20), below(10) ? 0.02 * (i / 20) : 0.25, 0));
        fill_columns(column, i, (struct ray) { from, vec_unit(vec_sub(at, from)) });
        mask[i] = RAY_PRIMARY;
        far[i] = i % 3 ? 20 : uniform(0, 16);
    }
    const struct rays rays = { COLUMN, column[0], column[1], column[2], column[3], column[4],
                               column[5] };
    geometry_nearest_many(p, s, &rays, mask, many);
    geometry_blocked_many(p, s, &rays, far, 0, barrier);
    for (int i = 0; i < COLUMN; i++) {
        struct ray ray = rays_at(&rays, i);
        bool met = geometry_nearest(p, s, ray, INFINITY, RAY_PRIMARY, &one);
        ck_assert_int_eq(met, many[i].leaf != NO_LEAF);
        if (met)
            ck_assert(one.t == many[i].t && one.leaf == many[i].leaf
                      && one.hit.part == many[i].hit.part && one.hit.slack == many[i].hit.slack);
        ck_assert_int_eq(geometry_blocked(p, s, ray, far[i], 0), barrier[i] == BARRIER_OPAQUE);
    }
}

/* First in few, then in many, of which beams find some. */
START_TEST(test_rays_in_arrays_meet_csg_as_each_does)
{
    for (int round = 0; round < 400; round++) {
        int n = round % 2 ? 3 : 60;
        double apart = round % 2 ? 0.5 : 6;
        scene_init(&scene, &mem);
        for (int i = 0; i < n; i++) {
            struct object *o = below(5) ? gridded_csg() : random_csg(2);
            vec3 by = below(2) ? in_cube(apart) : vec(0.5 * below(6), 0, 0.5 * below(6));
            scene_add(&scene, moved(o, turned(below(2) ? vec(0, 0, 0) : in_cube(180), by)));
        }
        many_are_as_each(plan());
    }
}
END_TEST

/* A hole through o along x, y or z, whose cutter ends in o's own face. */
static void no_film(struct object *o, vec3 hole_from, vec3 hole_to, double radius)
{
    scene_init(&scene, &mem);
    scene_add(&scene, o);
    struct plan *p = plan();
    struct scratch *s = scratch_new(p, &mem);
    vec3 axis = vec_unit(vec_sub(hole_to, hole_from));
    for (int i = 0; i < 20000; i++) {
        vec3 across = vec_unit(vec_cross(axis, on_sphere()));
        vec3 through = vec_fma(hole_from, radius * uniform(0, 1), across);
        vec3 other = vec_fma(hole_to, radius * uniform(0, 1), across);
        struct ray ray = { through, vec_sub(other, through) };
        struct meeting m;
        ray.origin = vec_fma(through, -1.5, ray.dir);
        ck_assert_msg(!geometry_nearest(p, s, ray, INFINITY, RAY_PRIMARY, &m),
                      "ray %d stopped at %.17g", i, m.t);
    }
}

START_TEST(test_coincident_faces_leave_no_film)
{
    static const vec3 turns[] = { { 0, 0, 0 }, { 31, 47, 11 } };
    static const vec3 by[] = { { 0, 0, 0 }, { 1e4, -3e3, 7 } };

    for (int k = 0; k < 4; k++) {
        struct transform t = turned(turns[k & 1], by[k >> 1]);
        vec3 a = mat_point(&t.to, vec(0, 0, 0)), b = mat_point(&t.to, vec(0, 0, 1));
        struct object *block = box(vec(-1, -1, 0), vec(1, 1, 1));
        struct object *square = box(vec(-.5, -.5, 0), vec(.5, .5, 1));
        struct object *round = SHAPE("cylinder", 0, 0, 0, 0, 0, 1, .5);
        struct object *rod = SHAPE("cylinder", 0, 0, 0, 0, 0, 1, 1);
        no_film(moved(GROUP(OBJECT_DIFFERENCE, block, square), t), a, b, 0.49);
        no_film(moved(GROUP(OBJECT_DIFFERENCE, block, round), t), a, b, 0.49);
        no_film(moved(GROUP(OBJECT_DIFFERENCE, rod, round), t), a, b, 0.49);
    }
}
END_TEST

START_TEST(test_coincident_faces_of_differing_transforms_leave_no_film)
{
    static const vec3 by[] = { { 0, 0, 0 }, { 1e4, -3e3, 7 } };

    for (int k = 0; k < 2; k++) {
        struct transform t = turned(vec(31, 47, 11), by[k]);
        struct transform u = transform_rotate(vec(31, 0, 0)), v = transform_rotate(vec(0, 47, 0)),
                         w = turned(vec(0, 0, 11), by[k]);
        vec3 a = mat_point(&t.to, vec(0, 0, 0)), b = mat_point(&t.to, vec(0, 0, 1));
        struct object *block = moved(box(vec(-1, -1, 0), vec(1, 1, 1)), t);
        struct object *rod = moved(SHAPE("cylinder", 0, 0, 0, 0, 0, 1, 1), t);
        struct object *square = box(vec(-.5, -.5, 0), vec(.5, .5, 1));
        struct object *round = SHAPE("cylinder", 0, 0, 0, 0, 0, 1, .5);
        square = moved(moved(moved(square, u), v), w);
        round = moved(moved(moved(round, u), v), w);
        no_film(GROUP(OBJECT_DIFFERENCE, block, square), a, b, 0.49);
        no_film(GROUP(OBJECT_DIFFERENCE, block, round), a, b, 0.49);
        no_film(GROUP(OBJECT_DIFFERENCE, rod, round), a, b, 0.49);
    }
}
END_TEST

START_TEST(test_a_solid_less_itself_is_nothing_and_with_itself_is_itself)
{
    for (int round = 0; round < 200; round++) {
        struct object *o = random_shape(0.5, 1);
        scene_init(&scene, &mem);
        scene_add(&scene, GROUP(OBJECT_DIFFERENCE, o, o));
        struct plan *none = plan();
        scene_init(&scene, &mem);
        scene_add(&scene, o);
        struct plan *plain = plan();
        scene_init(&scene, &mem);
        scene_add(&scene, GROUP(round % 2 ? OBJECT_INTERSECTION : OBJECT_MERGE, o, o));
        struct plan *same = plan();
        struct scratch *a = scratch_new(none, &mem), *b = scratch_new(plain, &mem),
                       *c = scratch_new(same, &mem);
        for (int i = 0; i < 100; i++) {
            struct ray ray = random_ray(3, 1);
            struct meeting m, n;
            ck_assert(!geometry_nearest(none, a, ray, INFINITY, RAY_PRIMARY, &m));
            bool met = geometry_nearest(plain, b, ray, INFINITY, RAY_PRIMARY, &m);
            ck_assert_int_eq(geometry_nearest(same, c, ray, INFINITY, RAY_PRIMARY, &n), met);
            if (met) {
                ck_assert(m.t == n.t);
                ck_assert_uint_eq(n.leaf, 1);       /* the last listed */
            }
        }
    }
}
END_TEST

static int crossings_of(struct object *o, struct ray ray)
{
    int n = 0;
    struct meeting m;

    scene_init(&scene, &mem);
    scene_add(&scene, o);
    struct plan *p = plan();
    struct scratch *scratch = scratch_new(p, &mem);
    while (geometry_nearest(p, scratch, ray, INFINITY, RAY_PRIMARY, &m)) {
        struct surface_point at;
        geometry_point(p, &ray, &m, &at);
        double side = vec_dot(at.normal, ray.dir) > 0 ? 1 : -1;
        ray.origin = vec_fma(at.point, side * at.slack, vec_unit(at.normal));
        n++;
    }
    return n;
}

struct seen { int n; double last; };

static bool count_in_order(void *arg, const struct meeting *m)
{
    struct seen *s = arg;

    ck_assert(m->t >= s->last);
    s->last = m->t;
    s->n++;
    return true;
}

START_TEST(test_unions_show_inner_surfaces_and_merges_do_not)
{
    struct object *a = sphere(vec(-.5, 0, 0), 1), *b = sphere(vec(.5, 0, 0), 1);
    struct object *all = sphere(vec(0, 0, 0), 9);
    struct ray ray = { vec(-5, .1, .1), vec(1, 0, 0) };

    ck_assert_int_eq(crossings_of(GROUP(OBJECT_UNION, a, b), ray), 4);
    ck_assert_int_eq(crossings_of(GROUP(OBJECT_MERGE, a, b), ray), 2);
    ck_assert_int_eq(crossings_of(GROUP(OBJECT_INTERSECTION, GROUP(OBJECT_UNION, a, b), all), ray), 4);
    ck_assert_int_eq(crossings_of(GROUP(OBJECT_INTERSECTION, GROUP(OBJECT_MERGE, a, b), all), ray), 2);
}
END_TEST

START_TEST(test_merged_solids_that_touch_are_one)
{
    struct transform t = turned(vec(31, 47, 11), vec(3, 5, 7));
    struct object *a = moved(box(vec(-1, -1, -1), vec(1, 1, 0)), t);
    struct object *b = moved(box(vec(-1, -1, 0), vec(1, 1, 1)), t);
    struct object *both = GROUP(OBJECT_MERGE, a, b);

    for (int i = 0; i < 200; i++) {
        struct ray ray = random_ray(6, 0.5);
        ray.origin = mat_point(&t.to, ray.origin);
        ray.dir = mat_direction(&t.to, ray.dir);
        ck_assert_int_eq(crossings_of(both, ray), 2);
    }
}
END_TEST

static uint8_t mask_of_first(const struct plan *p) { return p->leaf[0].mask; }

START_TEST(test_members_of_a_union_may_hide_unless_it_is_whole)
{
    struct object *o = sphere(vec(0, 0, 0), 1), *u = GROUP(OBJECT_UNION, o);

    o->flags = o->flags_given = OBJECT_NO_SHADOW;
    scene_add(&scene, u);
    ck_assert_uint_eq(mask_of_first(plan()), RAY_PRIMARY | RAY_REFLECTED);
    u->keep_whole = true;
    ck_assert_uint_eq(mask_of_first(plan()), RAY_PRIMARY | RAY_REFLECTED | RAY_SHADOW);
    u->flags = u->flags_given = OBJECT_NO_IMAGE;
    ck_assert_uint_eq(mask_of_first(plan()), RAY_REFLECTED | RAY_SHADOW);
}
END_TEST

START_TEST(test_crossings_come_in_order_however_many)
{
    struct texture *t = glass(0.5f);

    for (int i = 0; i < 500; i++) {
        struct object *o = sphere(vec(0, 0, uniform(0, 10)), 0.3);
        o->texture = t;
        scene_add(&scene, o);
    }
    struct plan *p = plan();
    struct scratch *s = scratch_new(p, &mem);
    struct seen seen = { 0, 0 };
    geometry_crossings(p, s, (struct ray) { vec(0, .1, -5), vec(0, 0, 1) }, INFINITY, 0, BARRIER_ANY, count_in_order,
                       &seen);
    ck_assert_int_eq(seen.n, 1000);
    ck_assert(!geometry_blocked(p, s, (struct ray) { vec(0, .1, -5), vec(0, 0, 1) }, INFINITY, 0));
}
END_TEST

struct tallied { const struct plan *plan; unsigned count[PLAN_TALLIES]; };

static bool tally_one(void *arg, const struct meeting *m)
{
    struct tallied *t = arg;

    t->count[t->plan->surface[t->plan->leaf[m->leaf].surface].tally]++;
    return true;
}

/* They make no beams. */
static void rays_apart_are_tallied_as_each_is(const struct plan *p, struct scratch *s)
{
    static struct some_rays some;
    uint64_t barrier[SOME_RAYS];
    struct rays r = make_rays(&some);

    for (int i = 0; i < SOME_RAYS; i++)
        for (int axis = 0; axis < 3; axis++)
            some.at[axis][i] = uniform(-3, 3);
    r.n = 100;
    geometry_blocked_many(p, s, &r, some.far, 0, barrier);
    for (int i = 0; i < r.n; i++) {
        struct ray ray = rays_at(&r, i);
        bool is_blocked = geometry_blocked(p, s, ray, some.far[i], 0);
        ck_assert_int_eq(stands_between(p, s, ray, some.far[i], barrier[i]), is_blocked);
        if (!is_blocked)
            same_tallies(p, s, ray, some.far[i], barrier[i]);
    }
}

START_TEST(test_tallies_are_the_crossings_counted)
{
    struct texture *look[] = { glass(0.5f), glass(0.25f), glass(0) };
    int n_open = 0, n_crossed = 0;

    for (int i = 0; i < 120; i++) {
        struct object *o = below(4) ? random_shape(3, 1) : random_csg(1);
        o->texture = look[below(10) ? below(2) : 2];
        scene_add(&scene, o);
    }
    struct plan *p = plan();
    struct scratch *s = scratch_new(p, &mem);
    ck_assert_int_eq(p->n_tally, 2);
    for (int i = 0; i < 5000; i++) {
        struct ray ray = random_ray(4, 2);
        struct tallied t = { p, { 0 } };
        unsigned count[PLAN_TALLIES];
        double far = uniform(0, 2);
        bool is_open = geometry_crossings(p, s, ray, far, 0, BARRIER_ANY, tally_one, &t);
        ck_assert_int_eq(is_open, !geometry_blocked(p, s, ray, far, 0));
        ck_assert_int_eq(is_open, geometry_tally(p, s, ray, far, 0, BARRIER_ANY, count));
        n_open += is_open;
        if (!is_open)
            continue;
        ck_assert(count[0] == t.count[0] && count[1] == t.count[1]);
        n_crossed += count[0] > 0 && count[1] > 0;
    }
    ck_assert(n_open > 1000 && n_open < 4500 && n_crossed > 300);
    for (int i = 0; i < 40; i++)
        rays_apart_are_tallied_as_each_is(p, s);
}
END_TEST

START_TEST(test_a_ray_leaves_and_enters_glass_walls_of_any_thickness)
{
    for (int e = 0; e > -14; e--) {
        double h = pow(10, e);
        struct object *pane = box(vec(-9, -9, 0), vec(9, 9, h));
        ck_assert_int_eq(crossings_of(pane, (struct ray) { vec(.3, .2, -1), vec(.2, .1, 1) }), 2);
    }
}
END_TEST

START_TEST(test_clipping_leaves_a_shell_without_a_cap)
{
    struct object *o = sphere(vec(0, 0, 0), 1);
    const struct object *half = SHAPE("plane", 0, 1, 0, 0);

    struct object_more *more = object_more(&mem, o);
    more->clip = &half;
    more->n_clip = 1;
    ck_assert_int_eq(crossings_of(o, (struct ray) { vec(.1, 5, .1), vec(0, -1, 0) }), 1);
    ck_assert_int_eq(crossings_of(o, (struct ray) { vec(-5, -.5, .1), vec(1, 0, 0) }), 2);
    ck_assert_int_eq(crossings_of(o, (struct ray) { vec(-5, .5, .1), vec(1, 0, 0) }), 0);
}
END_TEST

START_TEST(test_patches_in_an_intersection_count_where_the_others_are)
{
    struct object *disc = SHAPE("disc", 0, 0, 0, 0, 1, 0, 3);
    struct object *ball = sphere(vec(0, 0, 0), 1);
    struct object *both = GROUP(OBJECT_INTERSECTION, ball, disc);
    struct ray down = { vec(.2, 5, .1), vec(0, -1, 0) };

    /* the disc's inside is all that is behind it */
    ck_assert_int_eq(crossings_of(both, down), 2);
    down.origin.x = 2;
    ck_assert_int_eq(crossings_of(both, down), 0);
}
END_TEST

START_TEST(test_a_difference_with_thousands_of_cutters_is_right)
{
    struct object *child[2001];

    child[0] = box(vec(-1, -1, -1), vec(1, 1, 1));
    for (int i = 1; i <= 2000; i++)
        child[i] = sphere(in_cube(1), 0.08);
    struct object *o = group(OBJECT_DIFFERENCE, child, 2001);
    scene_add(&scene, o);
    struct plan *p = plan();
    struct scratch *s = scratch_new(p, &mem);
    for (int i = 0; i < 1000; i++) {
        struct ray ray = random_ray(4, 1);
        struct meeting m;
        if (geometry_nearest(p, s, ray, INFINITY, RAY_PRIMARY, &m)) {
            ck_assert(!object_inside(o, ray_at(ray, m.t - step), NULL));
            ck_assert(object_inside(o, ray_at(ray, m.t + step), NULL));
        }
    }
}
END_TEST

START_TEST(test_a_mesh_with_an_inside_cuts_like_the_ball_it_is)
{
    struct object *ball = mesh_object(mesh_ball(24, 1));
    struct object *o = GROUP(OBJECT_DIFFERENCE, box(vec(-2, -2, -2), vec(2, 2, 0)), ball);
    struct ray ray = { vec(.1, .2, 5), vec(0, 0, -1) };
    struct meeting m;

    scene_add(&scene, o);
    struct plan *p = plan();
    struct scratch *s = scratch_new(p, &mem);
    ck_assert(geometry_nearest(p, s, ray, INFINITY, RAY_PRIMARY, &m));
    ck_assert(m.t > 5.9 && m.t < 6);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("geometry");
    TCase *tc = tcase_create("claims");

    tcase_add_checked_fixture(tc, setup, teardown);
    tcase_set_timeout(tc, 120);
    tcase_add_test(tc, test_the_tree_finds_what_asking_every_leaf_finds);
    tcase_add_test(tc, test_a_ray_of_any_length_and_origin_meets_the_same);
    tcase_add_test(tc, test_many_rays_meet_what_each_meets_alone);
    tcase_add_test(tc, test_scaling_by_two_to_the_k_changes_no_bit);
    tcase_add_test(tc, test_rays_at_edges_and_corners_of_stacked_boxes_never_slip_through);
    tcase_add_test(tc, test_small_spheres_are_met_at_their_very_edge);
    tcase_add_test(tc, test_slanted_things_are_met_at_their_very_edge);
    tcase_add_test(tc, test_any_number_of_threads_builds_the_same_tree);
    tcase_add_loop_test(tc, test_each_item_is_once_in_the_tree_within_its_box, 0, 5);
    tcase_add_test(tc, test_a_sphere_costs_at_most_80_bytes);
    tcase_add_test(tc, test_a_triangle_costs_at_most_64_bytes_beyond_its_corners);
    tcase_add_test(tc, test_equal_things_are_met_in_the_order_of_their_listing);
    tcase_add_test(tc, test_a_union_placed_often_is_stored_once);
    tcase_add_test(tc, test_instances_may_differ_in_their_texture);
    tcase_add_test(tc, test_csg_placed_often_is_stored_once_and_looks_alike);
    tcase_add_test(tc, test_a_point_is_inside_of_the_copies_around_it);
    tcase_add_test(tc, test_a_copy_that_blocks_is_remembered_where_it_stands);
    tcase_add_test(tc, test_rays_to_copies_go_together_and_meet_what_each_meets_alone);
    tcase_add_test(tc, test_nothing_leaks_from_a_closed_mesh);
    tcase_add_test(tc, test_a_mesh_is_met_where_asking_every_face_meets_it);
    tcase_add_loop_test(tc, test_arrays_of_rays_meet_what_each_ray_meets, 0, 4);
    tcase_add_test(tc, test_arrays_of_rays_meet_meshes_as_each_ray_does);
    tcase_add_test(tc, test_csg_shows_exactly_where_its_inside_begins_and_ends);
    tcase_add_test(tc, test_rays_in_arrays_meet_csg_as_each_does);
    tcase_add_test(tc, test_csg_normals_point_out_of_the_solid);
    tcase_add_test(tc, test_points_in_arrays_are_what_each_is_alone);
    tcase_add_test(tc, test_coincident_faces_leave_no_film);
    tcase_add_test(tc, test_coincident_faces_of_differing_transforms_leave_no_film);
    tcase_add_test(tc, test_a_solid_less_itself_is_nothing_and_with_itself_is_itself);
    tcase_add_test(tc, test_unions_show_inner_surfaces_and_merges_do_not);
    tcase_add_test(tc, test_merged_solids_that_touch_are_one);
    tcase_add_test(tc, test_members_of_a_union_may_hide_unless_it_is_whole);
    tcase_add_test(tc, test_crossings_come_in_order_however_many);
    tcase_add_test(tc, test_tallies_are_the_crossings_counted);
    tcase_add_test(tc, test_a_ray_leaves_and_enters_glass_walls_of_any_thickness);
    tcase_add_test(tc, test_clipping_leaves_a_shell_without_a_cap);
    tcase_add_test(tc, test_patches_in_an_intersection_count_where_the_others_are);
    tcase_add_test(tc, test_a_difference_with_thousands_of_cutters_is_right);
    tcase_add_test(tc, test_a_mesh_with_an_inside_cuts_like_the_ball_it_is);
    suite_add_tcase(suite, tc);

    SRunner *runner = srunner_create(suite);
    srunner_run_all(runner, CK_NORMAL);
    int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed ? EXIT_FAILURE : EXIT_SUCCESS;
}
