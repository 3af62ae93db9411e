/* check_shape.c: what must hold of every primitive, and of some against an
 * oracle in 113 bits (tests/oracle).  The cases are those of the stability
 * suite (docs: facts numerics.md section 4). */
#include <check.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "oracle/oracle.h"
#include "shape/packet.h"
#include "shape/shapes.h"
#include "shape/triangle.h"
#include "shape/unit.h"

static struct arena mem;
static uint64_t state;

static void setup(void)
{
    arena_init(&mem, NULL);
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

static void *member(void *self, const struct field *f) { return (char *)self + f->offset; }

/* Random arguments by their rows, so that a new shape needs nothing here. */
static void fill(const struct shape_ops *ops, void *self)
{
    memcpy(self, ops->defaults, ops->size);
    for (const struct field *f = ops->args; f && f->name; f++) {
        if (f->type == FIELD_POINT)
            *(vec3 *)member(self, f) = in_cube(2);
        else if (f->type == FIELD_NUM)
            *(double *)member(self, f) = uniform(0.05, 2);
        else if (f->type == FIELD_POINT2)
            ((double *)member(self, f))[0] = uniform(0.1, 3),
            ((double *)member(self, f))[1] = uniform(0.1, 3);
    }
    for (const struct field *f = ops->words; f && f->name; f++)
        if (f->type == FIELD_FLAG)
            *(bool *)member(self, f) = uniform(0, 1) < 0.3;
}

static void scale(const struct shape_ops *ops, void *self, double by)
{
    for (const struct field *f = ops->args; f && f->name; f++) {
        if (f->type == FIELD_POINT)
            *(vec3 *)member(self, f) = vec_scale(*(vec3 *)member(self, f), by);
        else if (f->type == FIELD_NUM)
            *(double *)member(self, f) *= by;
    }
}

static void *some_shape(const struct shape_ops *ops, void *raw)
{
    for (int tries = 0; tries < 100; tries++) {
        void *self = arena_alloc(&mem, ops->size);
        fill(ops, self);
        if (raw)
            memcpy(raw, self, ops->size);
        if (!ops->prepare || !ops->prepare(self, &mem))
            return self;
    }
    ck_abort_msg("%s: no random arguments are right", ops->name);
}

static vec3 within(struct bounds b)
{
    double x = uniform(fmax(b.low.x, -4), fmin(b.high.x, 4));
    double y = uniform(fmax(b.low.y, -4), fmin(b.high.y, 4));
    double z = uniform(fmax(b.low.z, -4), fmin(b.high.z, 4));
    return vec(x, y, z);
}

/* A ray that has a chance, from as far away as asked. */
static struct ray some_ray(const struct shape_ops *ops, const void *self, double away)
{
    vec3 target = within(ops->bounds(self)), dir = on_sphere();

    if (uniform(0, 1) < 0.1)
        dir = vec(uniform(-1, 1) < 0 ? -1 : 1, 0, -0.0);
    if (uniform(0, 1) < 0.1)
        dir = vec(0, 0, uniform(-1, 1) < 0 ? -1 : 1);
    return (struct ray) { vec_fma(target, -away * uniform(0, 2), dir),
                          vec_scale(dir, uniform(0.1, 3)) };
}

#define EACH_SHAPE const struct shape_ops *ops = shapes[_i]; enum { ROUNDS = 80, RAYS = 40 }

START_TEST(test_a_row_is_complete)
{
    EACH_SHAPE;
    ck_assert(ops->name && ops->help && ops->size && ops->defaults && ops->hits && ops->bounds
              && ops->normal);
    ck_assert_int_ge(ops->most_hits, 1);
    ck_assert_int_le(ops->most_hits, SHAPE_MOST_HITS);
    ck_assert_ptr_eq(shape_find(ops->name), ops);
    if (_i > 0)
        ck_assert_int_lt(strcmp(shapes[_i - 1]->name, ops->name), 0);
    (void)ROUNDS, (void)RAYS;
}
END_TEST

static void span_is_of(const struct shape_ops *ops, const void *self, struct ray ray, double near,
                       double far)
{
    struct hit h[SHAPE_MOST_HITS];
    int n = ops->hits(self, ray, h);

    if (isnan(near))
        ck_assert(isnan(far));
    else if (n == 0)
        ck_assert(near > far);
    else if (n == 1)
        ck_assert((near == h[0].t && far > 0 && isinf(far))
                  || (far == h[0].t && near < 0 && isinf(near)));
    else
        ck_assert(n == 2 && near == h[0].t && far == h[1].t);
}

/* Few are left to hits(): else there would be nothing to compare. */
START_TEST(test_spans_are_what_hits_say)
{
    EACH_SHAPE;
    int left = 0, met = 0;
    for (int i = 0; ops->spans && i < ROUNDS; i++) {
        void *self = some_shape(ops, NULL);
        struct ray ray[RAYS];
        double of[6][RAYS], near[RAYS], far[RAYS];
        while (ops->is_leaky && ops->is_leaky(self))
            self = some_shape(ops, NULL);
        for (int j = 0; j < RAYS; j++) {
            ray[j] = some_ray(ops, self, 4);
            for (int axis = 0; axis < 3; axis++) {
                of[axis][j] = vec_get(ray[j].origin, axis);
                of[3 + axis][j] = vec_get(ray[j].dir, axis);
            }
        }
        ops->spans(self, &(struct rays) { RAYS, of[0], of[1], of[2], of[3], of[4], of[5] }, near, far);
        for (int j = 0; j < RAYS; j++) {
            span_is_of(ops, self, ray[j], near[j], far[j]);
            left += isnan(near[j]);
            met += near[j] <= far[j];
        }
    }
    ck_assert(!ops->spans || (met > ROUNDS * RAYS / 4 && left < ROUNDS * RAYS / 20));
}
END_TEST

START_TEST(test_hits_come_in_order_and_within_bounds)
{
    EACH_SHAPE;
    for (int i = 0; i < ROUNDS; i++) {
        void *self = some_shape(ops, NULL);
        struct bounds b = ops->bounds(self);
        for (int j = 0; j < RAYS; j++) {
            struct ray ray = some_ray(ops, self, 4);
            struct hit h[SHAPE_MOST_HITS];
            int n = ops->hits(self, ray, h);
            ck_assert_int_le(n, ops->most_hits);
            for (int k = 0; k < n; k++) {
                vec3 p = ray_at(ray, h[k].t);
                double s = h[k].slack;
                ck_assert(isfinite(h[k].t) && s > 0 && (ops->is_infinite || s < 1e-12));
                ck_assert(k == 0 || h[k - 1].t <= h[k].t);
                ck_assert(p.x >= b.low.x - s && p.x <= b.high.x + s && p.y >= b.low.y - s
                          && p.y <= b.high.y + s && p.z >= b.low.z - s && p.z <= b.high.z + s);
            }
        }
    }
}
END_TEST

/* By no more than the point may be off anyway; ahead stays ahead. */
static void is_a_little_before(const struct shape_ops *ops, const void *self, struct ray ray,
                               const struct hit *first, const struct hit *hit)
{
    vec3 n = vec_unit(ops->normal(self, ray_at(ray, hit->t), hit));

    ck_assert(first->t <= hit->t && (first->t > 0) == (hit->t > 0));
    ck_assert((hit->t - first->t) * fabs(vec_dot(n, ray.dir)) <= first->slack);
    ck_assert(hit->t <= 0 || first->t < hit->t);
}

START_TEST(test_nearest_is_the_first_hit_within_limits)
{
    EACH_SHAPE;
    for (int i = 0; ops->nearest && i < ROUNDS; i++) {
        void *self = some_shape(ops, NULL);
        for (int j = 0; j < RAYS; j++) {
            struct ray ray = some_ray(ops, self, 2);
            struct hit h[SHAPE_MOST_HITS], found;
            int n = ops->hits(self, ray, h), k = 0;
            bool is_at_hit = n > 0 && j % 4 == 0;       /* as rays from a surface, but for the slack */
            double near = is_at_hit ? h[j / 4 % n].t : uniform(-2, 2), far = near + uniform(0, 6);
            while (k < n && !(h[k].t > near))
                k++;
            bool is_there = k < n && h[k].t < far;
            ck_assert_int_eq(ops->nearest(self, &ray, near, far, &found), is_there);
            if (is_there && ops->lead)
                is_a_little_before(ops, self, ray, &found, &h[k]);
            else if (is_there)
                ck_assert(found.t == h[k].t && found.slack == h[k].slack
                          && found.part == h[k].part && found.u == h[k].u && found.v == h[k].v);
        }
    }
}
END_TEST

/* A packet of rays, some of them odd; the columns are filled up. */
static void fill_packet(const struct shape_ops *ops, const void *self, struct packet *p)
{
    static const double odd[] = { 0, -0.0, 1, -1, 1e-310, 1e-200, 1e200, 1e308, INFINITY, NAN };

    p->n = 1 + (int)uniform(0, PACKET);
    for (int i = 0; i < PACKET; i++) {
        struct ray r = some_ray(ops, self, pow(10, uniform(-1, 8)));
        double v[] = { r.origin.x, r.origin.y, r.origin.z, r.dir.x, r.dir.y, r.dir.z };
        if (uniform(0, 1) < 0.1)
            v[(int)uniform(0, 6)] = odd[(int)uniform(0, sizeof odd / sizeof *odd)];
        for (int axis = 0; axis < 3; axis++) {
            p->o[axis][i] = v[axis];
            p->d[axis][i] = v[3 + axis];
        }
    }
    p->has_inverse = false;
    packet_prepare(p);
}

/* What hits_many should say. */
static int expected_of(const struct shape_ops *ops, const void *self, struct ray ray, struct hit out[])
{
    if (ops->many_is_first)
        return ops->nearest(self, &ray, 0, INFINITY, out);
    return ops->hits(self, ray, out);
}

/* Lane i of what hits_many said, as hits() would. */
static int crossings_of(const struct crossings *c, int i, struct hit out[])
{
    int n = 0;

    for (int k = 0; (c->met[i / WIDE] >> i % WIDE & 1) && k < c->most; k++)
        if (!isnan(c->t[k][i]))
            out[n++] = (struct hit) { c->t[k][i], c->slack[k][i],
                                      c->has_weights ? (float)c->u[i] : 0,
                                      c->has_weights ? (float)c->v[i] : 0,
                                      (uint32_t)c->part[k][i] };
    return n;
}

/* An infinite direction's slack may be NaN. */
static bool same(double a, double b) { return a == b || (isnan(a) && isnan(b)); }

START_TEST(test_many_rays_hit_what_each_hits)
{
    EACH_SHAPE;
    static struct packet p;
    static struct crossings c;
    int n_sure = 0, n_met = 0;

    for (int i = 0; ops->hits_many && i < ROUNDS; i++) {
        void *self = some_shape(ops, NULL);
        uint8_t may[PACKET / 2];
        fill_packet(ops, self, &p);
        for (int k = 0; k < PACKET / 2; k++)
            may[k] = (uint8_t)uniform(0, 1 << WIDE);
        memset(&c, 0xff, sizeof c);
        ops->hits_many(self, &p, may, &c);
        for (int j = 0; j < p.n; j++) {
            struct hit one[SHAPE_MOST_HITS], many[2];
            bool asked = may[j / WIDE] >> j % WIDE & 1, sure = !(c.unsure[j / WIDE] >> j % WIDE & 1);
            int n = crossings_of(&c, j, many);
            ck_assert(n == 0 || (asked && sure));
            if (!asked || !sure)
                continue;
            ck_assert_int_eq(expected_of(ops, self, packet_ray(&p, j), one), n);
            for (int k = 0; k < n; k++)
                ck_assert(many[k].t == one[k].t && same(many[k].slack, one[k].slack)
                          && many[k].part == one[k].part && many[k].u == one[k].u
                          && many[k].v == one[k].v);
            n_met += n > 0;
            n_sure++;
        }
    }
    if (ops->hits_many) {
        ck_assert_int_gt(n_sure, ROUNDS * PACKET / 16);        /* half of the tori are spindles */
        ck_assert_int_gt(n_met, n_sure / 10);
    }
    (void)RAYS;
}
END_TEST

/* Steps across the surface by what the slack allows, so this also says that
 * the hit is that near to it. */
START_TEST(test_a_normal_points_outward_across_the_surface)
{
    EACH_SHAPE;
    for (int i = 0; ops->is_solid && i < ROUNDS; i++) {
        void *self = some_shape(ops, NULL);
        if (ops->is_leaky && ops->is_leaky(self))
            continue;
        for (int j = 0; j < RAYS; j++) {
            struct ray ray = some_ray(ops, self, 4);
            struct hit h[SHAPE_MOST_HITS];
            int n = ops->hits(self, ray, h);
            for (int k = 0; k < n; k++) {
                vec3 p = ray_at(ray, h[k].t), m = vec_unit(ops->normal(self, p, &h[k]));
                double by = 4 * h[k].slack;
                ck_assert_double_gt(vec_length(m), 0.5);
                if (k + 1 < n && (h[k + 1].t - h[k].t) < 1e-6)
                    break;              /* a corner */
                ck_assert(!ops->inside(self, vec_fma(p, by, m)));
                ck_assert(ops->inside(self, vec_fma(p, -by, m)));
            }
        }
    }
}
END_TEST

START_TEST(test_a_solids_hits_alternate)
{
    EACH_SHAPE;
    for (int i = 0; ops->is_solid && i < ROUNDS; i++) {
        void *self = some_shape(ops, NULL);
        if (ops->is_leaky && ops->is_leaky(self))
            continue;
        for (int j = 0; j < RAYS; j++) {
            struct ray ray = some_ray(ops, self, 4);
            struct hit h[SHAPE_MOST_HITS];
            int n = ops->hits(self, ray, h);
            bool in = ops->starts_inside && ops->starts_inside(self, ray.dir);
            if (!ops->is_infinite)
                ck_assert_int_eq(n % 2, 0);
            for (int k = 0; k < n; k++) {
                in = !in;
                double next = k + 1 < n ? h[k + 1].t : h[k].t + 1;
                if (next - h[k].t > 1e-6)
                    ck_assert_int_eq(ops->inside(self, ray_at(ray, (h[k].t + next) / 2)), in);
            }
        }
    }
}
END_TEST

START_TEST(test_a_solid_has_an_even_number_of_hits_from_anywhere)
{
    EACH_SHAPE;
    for (int i = 0; ops->is_solid && !ops->is_infinite && i < ROUNDS; i++) {
        void *self = some_shape(ops, NULL);
        if (ops->is_leaky && ops->is_leaky(self))
            continue;
        for (int j = 0; j < RAYS; j++) {
            struct ray ray = some_ray(ops, self, pow(10, uniform(0, 8)));
            struct hit h[SHAPE_MOST_HITS];
            ck_assert_int_eq(ops->hits(self, ray, h) % 2, 0);
        }
    }
}
END_TEST

/* Its arguments are lengths and directions, and not coefficients. */
static bool has_lengths(const struct shape_ops *ops)
{
    return strcmp(ops->name, "quadric") != 0 && strcmp(ops->name, "superellipsoid") != 0;
}

START_TEST(test_scaling_by_a_power_of_two_changes_no_bit)
{
    EACH_SHAPE;
    if (!has_lengths(ops))
        return;
    void *raw = arena_alloc(&mem, ops->size);
    for (int i = 0; i < ROUNDS; i++) {
        void *self = some_shape(ops, raw);
        double by = ldexp(1, (int)uniform(-100, 101)), dir_by = ldexp(1, (int)uniform(-100, 101));
        void *other = arena_copy(&mem, raw, ops->size);
        scale(ops, other, by);
        ck_assert_ptr_null(ops->prepare(other, &mem));
        for (int j = 0; j < RAYS; j++) {
            struct ray ray = some_ray(ops, self, 4);
            struct ray scaled = { vec_scale(ray.origin, by), vec_scale(ray.dir, dir_by) };
            struct hit h[SHAPE_MOST_HITS], g[SHAPE_MOST_HITS];
            int n = ops->hits(self, ray, h);
            ck_assert_int_eq(ops->hits(other, scaled, g), n);
            for (int k = 0; k < n; k++) {
                ck_assert(g[k].t == h[k].t * by / dir_by);
                ck_assert(g[k].slack == h[k].slack * by);
                ck_assert(g[k].part == h[k].part && g[k].u == h[k].u && g[k].v == h[k].v);
            }
        }
    }
}
END_TEST

START_TEST(test_odd_rays_do_no_harm)
{
    EACH_SHAPE;
    static const double odd[] = { 0, -0.0, 1, -1, 1e-310, 1e-200, 1e200, 1e308, INFINITY, NAN };
    enum { N = sizeof odd / sizeof *odd };
    void *self = some_shape(ops, NULL);
    struct hit h[SHAPE_MOST_HITS];

    for (int i = 0; i < 100000; i++) {
        double v[6];
        for (int j = 0; j < 6; j++)
            v[j] = odd[(int)uniform(0, N)];
        struct ray ray = { vec(v[0], v[1], v[2]), vec(v[3], v[4], v[5]) };
        int n = ops->hits(self, ray, h);
        ck_assert_int_le(n, ops->most_hits);
        for (int k = 0; k < n; k++)
            ck_assert(!isnan(h[k].t));
    }
    (void)ROUNDS, (void)RAYS;
}
END_TEST

/* Against the oracle. */

static const vec3 no_where = { 0, 0, 0 };

/* A shape by name from its numbers in order. */
static void *shape_of(const char *name, const double v[], const struct shape_ops **ops)
{
    *ops = shape_find(name);
    char *self = arena_copy(&mem, (*ops)->defaults, (*ops)->size);
    for (const struct field *f = (*ops)->args; f->name; f++) {
        if (f->type == FIELD_POINT) {
            *(vec3 *)member(self, f) = vec(v[0], v[1], v[2]);
            v += 3;
        } else {
            *(double *)member(self, f) = *v++;
        }
    }
    ck_assert_ptr_null((*ops)->prepare(self, &mem));
    return self;
}

static double distance_of(const char *name, const double v[], bool is_open, vec3 p)
{
    vec3 a = vec(v[0], v[1], v[2]);

    switch (name[1] == 'y' || name[1] == 'r' ? name[1] : name[0]) {
    case 's': return oracle_sphere_distance(a, v[3], p);
    case 'p': return oracle_plane_distance(a, v[3], p);
    case 'b': return oracle_box_distance(vec(fmin(v[0], v[3]), fmin(v[1], v[4]), fmin(v[2], v[5])),
                                         vec(fmax(v[0], v[3]), fmax(v[1], v[4]), fmax(v[2], v[5])), p);
    case 'y': return oracle_cone_distance(a, v[6], vec(v[3], v[4], v[5]), v[6], is_open, p);
    case 'c': return oracle_cone_distance(a, v[3], vec(v[4], v[5], v[6]), v[7], is_open, p);
    case 'd': return oracle_disc_distance(a, vec(v[3], v[4], v[5]), v[6], v[7], p);
    case 't': return oracle_torus_distance(v[0], v[1], p);
    case 'r': return oracle_triangle_distance(a, vec(v[3], v[4], v[5]), vec(v[6], v[7], v[8]), p);
    default: return NAN;
    }
}

/* How far hits are from the surface, from all distances, as a multiple of
 * what is allowed: 4 units of rounding (of 2^-53) of distance and size. */
START_TEST(test_hits_lie_on_the_surface)
{
    static const struct { const char *name; double v[9]; } some[] = {
        { "sphere", { 0, 0, 0, 1 } }, { "sphere", { 3, -2, 1, 0.3 } },
        { "plane", { 0, 1, 0, 0.5 } }, { "plane", { 1, 2, 3, -0.5 } },
        { "box", { -1, -1, -1, 1, 1, 1 } }, { "box", { 0.1, 0.3, -1, 2, 0.300001, 1 } },
        { "cylinder", { 0, 0, 0, 0, 1, 0, 1 } }, { "cylinder", { 1, 2, 3, -1, 0, 0.5, 0.2 } },
        { "cylinder", { 0, 0, 0, 0, 1e-3, 0, 1 } }, { "cylinder", { 0, 0, 0, 1, 1, 1, 1e-3 } },
        { "cone", { 0, 0, 0, 1, 0, 1, 0, 0 } }, { "cone", { 0, 0, 0, 1, 0, 2, 0, 0.5 } },
        { "cone", { 1, 0, 2, 0.2, -1, 1, 0, 0.7 } }, { "cone", { 0, 0, 0, 1e-3, 0, 1, 0, 0 } },
        { "cone", { 0, 0, 0, 1, 0, 1e-3, 0, 0.5 } }, { "cone", { 0, 0, 0, 1, 0, 1, 0, 1 + 1e-10 } },
        { "disc", { 0, 0, 0, 0, 1, 0, 1, 0 } }, { "disc", { 1, 2, 3, 1, -1, 2, 1, 0.5 } },
        { "torus", { 1, 0.43 } }, { "torus", { 1, 1e-3 } }, { "torus", { 1, 1e-6 } },
        { "torus", { 1, 1 } }, { "torus", { 1, 1.5 } }, { "torus", { 0.1, 1 } },
        { "triangle", { 0, 0, 0, 1, 0, 0, 0, 1, 0.5 } },
        { "triangle", { 0, 0, 0, 1500, 0, 0, 750, 1, 0 } },
    };
    const double *v = some[_i].v;
    const struct shape_ops *ops;
    void *self = shape_of(some[_i].name, v, &ops);
    struct bounds b = ops->bounds(self);
    double size = ops->is_infinite ? 1 : fmax(vec_largest(b.low), vec_largest(b.high));

    for (double away = 1; away <= 1e10; away *= 10) {
        double worst = 0, most = 0;
        for (int i = 0; i < 1000; i++) {
            struct ray ray = some_ray(ops, self, away * size);
            struct hit h[SHAPE_MOST_HITS];
            int n = ops->hits(self, ray, h);
            for (int k = 0; k < n; k++) {
                vec3 p = ray_at(ray, h[k].t);
                double off = distance_of(some[_i].name, v, false, p);
                double reach = vec_length(ray.origin) + fabs(h[k].t) * vec_length(ray.dir) + size;
                worst = fmax(worst, off / (ROUNDING * reach));
                most = fmax(most, off / h[k].slack);
            }
        }
        if (getenv("SHOW"))
            printf("%-9s %2d %6.0e  off %.2f, of slack %.2f\n", some[_i].name, _i, away, worst, most);
        ck_assert_msg(worst <= 4 && most <= 0.7, "%s %d from %g: off %g, of slack %g",
                      some[_i].name, _i, away, worst, most);
    }
}
END_TEST
enum { N_ON_SURFACE = 26 };

START_TEST(test_a_sphere_is_hit_or_missed_rightly)
{
    const double v[] = { 0.7, -0.3, 0.2, 1 };
    const struct shape_ops *ops;
    void *self = shape_of("sphere", v, &ops);
    vec3 centre = vec(v[0], v[1], v[2]);

    for (int i = 0; i < 100000; i++) {
        double away = pow(10, uniform(0, _i ? 2 : 8));
        vec3 d = on_sphere(), side = vec_unit(vec_cross(d, on_sphere()));
        double off = _i ? 1 + copysign(pow(10, -uniform(0, 17)), uniform(-1, 1)) : uniform(0, 2);
        struct ray ray = { vec_fma(vec_fma(centre, off, side), -away, d), d };
        struct hit h[2];
        quad t[2];
        int n = ops->hits(self, ray, h);
        ck_assert_int_eq(n, oracle_sphere(centre, v[3], ray, t));
    }
}
END_TEST

/* As the library tells exponents. */
static double unit_by_library(double size)
{
    int e = ilogb(size);

    return ldexp(1, e < -1000 ? 1000 : e > 1000 ? -1000 : -e);
}

START_TEST(test_a_unit_from_the_bits_of_a_size_is_the_same)
{
    for (int e = -1074; e < 1024; e++)
        for (double x = 1; x < 2; x += 0.37)
            ck_assert(unit_for(ldexp(x, e)) == unit_by_library(ldexp(x, e)));
}
END_TEST

START_TEST(test_a_sphere_of_any_size_is_the_same)
{
    for (int e = -300; e <= 300; e += 50) {
        double r = pow(10, e), v[] = { 0, 0, 0, r };
        const struct shape_ops *ops;
        void *self = shape_of("sphere", v, &ops);
        struct ray ray = { vec(0.1 * r, 0.2 * r, -3 * r), vec(0, 0, 1) };
        struct hit h[2];
        ck_assert_int_eq(ops->hits(self, ray, h), 2);
        ck_assert_double_eq_tol(h[0].t / r, 3 - sqrt(0.95), 1e-14);
    }
}
END_TEST

START_TEST(test_a_cone_is_hit_or_missed_rightly)
{
    static const double radius[][3] = { { 1, 1, 1 }, { 1, 0, 1 }, { 0.5, 2, 3 }, { 1, 1 + 1e-9, 2 },
                                        { 0, 1, 1 }, { 1e-3, 1, 1e-2 } };
    const double *r = radius[_i], v[] = { 0, 0, 0, r[0], 0, r[2], 0, r[1] };
    const struct shape_ops *ops;
    void *self = shape_of("cone", v, &ops);
    int wrong = 0;

    for (int i = 0; i < 50000; i++) {
        vec3 d = on_sphere();
        double away = pow(10, uniform(0, 6)), slope = (r[1] - r[0]) / r[2];
        if (i % 10 == 0)
            d = vec(0, 1, 0);
        if (i % 10 == 1)                /* along the slope */
            d = vec_unit(vec(0.6 * slope, 1, 0.8 * slope));
        vec3 target = vec(uniform(-2, 2), uniform(-1, r[2] + 1), uniform(-2, 2));
        if (i % 3 == 0 && i % 10 != 1) {        /* at a rim */
            double angle = uniform(0, 7);
            bool cap = i % 2;
            target = vec(r[cap] * cos(angle), cap ? r[2] : 0, r[cap] * sin(angle));
        }
        struct ray ray = { vec_fma(target, -away, d), d };
        struct hit h[2];
        quad t[2];
        int n = ops->hits(self, ray, h), m = oracle_cone(r[0], r[1], r[2], ray, t);
        ck_assert_int_eq(n % 2, 0);
        if (n == m)
            continue;
        /* Apart by rounding only where hardly anything is cut off. */
        double length = n ? h[1].t - h[0].t : (double)(t[1] - t[0]);
        double depth = i % 10 == 1 ? 1e-3 : 1e-6;
        wrong += !(length < depth * sqrt(away));
    }
    ck_assert_int_eq(wrong, 0);
}
END_TEST

START_TEST(test_an_open_cone_has_its_wall_alone)
{
    const double v[] = { 0, 0, 0, 1, 0, 1, 0, 0.5 };
    const struct shape_ops *ops;
    struct ray up = { vec(0.2, -3, 0.1), vec(0, 1, 0) }, across = { vec(-3, 0.5, 0), vec(1, 0, 0) };
    struct hit h[2];
    void *closed = shape_of("cone", v, &ops), *open = arena_copy(&mem, closed, ops->size);

    *(bool *)member(open, ops->words) = true;
    ck_assert_ptr_null(ops->prepare(open, &mem));
    ck_assert_int_eq(ops->hits(closed, up, h), 2);
    ck_assert_int_eq(ops->hits(open, up, h), 0);
    ck_assert_int_eq(ops->hits(open, across, h), 2);
    ck_assert(ops->is_leaky(open) && !ops->is_leaky(closed));
}
END_TEST

START_TEST(test_planes_across_an_axis_are_thin)
{
    for (int i = 0; i < 300; i++) {
        const struct shape_ops *ops;
        double v[4] = { 0, 0, 0, uniform(-3, 3) };
        v[i % 3] = uniform(-2, 2);
        void *self = shape_of("plane", v, &ops);
        struct bounds b = ops->crust(self);
        ck_assert(vec_get(b.low, i % 3) == vec_get(b.high, i % 3));
        for (int j = 0; j < 20; j++) {
            struct ray ray = some_ray(ops, self, 4);
            struct hit h[SHAPE_MOST_HITS];
            int n = ops->hits(self, ray, h);
            vec3 p = ray_at(ray, n ? h[0].t : 0);
            for (int axis = 0; axis < 3 && n; axis++)
                ck_assert(vec_get(p, axis) >= vec_get(b.low, axis) - h[0].slack
                          && vec_get(p, axis) <= vec_get(b.high, axis) + h[0].slack);
        }
    }
}
END_TEST

START_TEST(test_a_disc_ends_at_its_rim)
{
    const double v[] = { 0, 0, 0, 0, 1, 0, 1, 0.5 };
    const struct shape_ops *ops;
    void *self = shape_of("disc", v, &ops);
    struct hit h;

    for (int i = 0; i < 10000; i++) {
        double r[] = { 1 - 1e-15, 1 + 1e-15, 0.5 + 1e-15, 0.5 - 1e-15 };
        struct ray ray = { vec(i % 2 ? r[i % 4] : 0, uniform(1, 1000), i % 2 ? 0 : r[i % 4]),
                           vec(0, -1, 0) };
        ck_assert_int_eq(ops->hits(self, ray, &h), i % 2 == 0);
    }
    struct ray rim = { vec(1, 2, 0), vec(0, -1, 0) }, hole = { vec(0.5, 2, 0), vec(0, -1, 0) };
    ck_assert_int_eq(ops->hits(self, rim, &h) + ops->hits(self, hole, &h), 2);
}
END_TEST

START_TEST(test_a_box_is_hit_on_its_edges_and_in_its_faces)
{
    const double v[] = { -1, -2, -3, 1, 2, 3 };
    const struct shape_ops *ops;
    void *self = shape_of("box", v, &ops);
    struct hit h[2];

    for (int i = 0; i < 100000; i++) {
        int axis = (int)uniform(0, 3);
        double p[3];
        for (int k = 0; k < 3; k++)
            p[k] = v[k + 3] * (uniform(-1, 1) < 0 ? -1 : 1);
        p[axis] = uniform(v[axis], v[axis + 3]);
        vec3 edge = vec(p[0], p[1], p[2]), d = on_sphere();
        if (i % 2)                      /* in a face */
            d = vec(axis == 0 ? d.x : 0, axis == 1 ? d.y : -0.0, axis == 2 ? d.z : d.x);
        /* Dyadic, so that the ray meets the edge exactly. */
        d = vec(rint(d.x * 1024), rint(d.y * 1024), rint(d.z * 1024));
        if (vec_largest(d) == 0)
            continue;
        p[axis] = rint(p[axis] * 1024) / 1024;
        edge = vec(p[0], p[1], p[2]);
        struct ray ray = { vec_fma(edge, -rint(uniform(1, 100)), d), d };
        int n = ops->hits(self, ray, h);
        ck_assert_int_eq(n, 2);
        ck_assert(isfinite(h[0].t) && isfinite(h[1].t));
    }
}
END_TEST

/* A closed convex mesh: an icosphere-like grid of latitude and longitude,
 * perhaps stretched to needles and moved away. */
enum { ACROSS = 24, DOWN = 12, N_VERTEX = ACROSS * (DOWN - 1) + 2 };

static int mesh_of(vec3 vertex[], int face[][3], vec3 stretch, vec3 at)
{
    int n = 0;

    for (int i = 1; i < DOWN; i++)
        for (int j = 0; j < ACROSS; j++) {
            double a = M_PI * i / DOWN, b = 2 * M_PI * j / ACROSS;
            vertex[2 + (i - 1) * ACROSS + j] = vec(sin(a) * cos(b), cos(a), sin(a) * sin(b));
        }
    vertex[0] = vec(0, 1, 0);
    vertex[1] = vec(0, -1, 0);
    for (int i = 0; i < N_VERTEX; i++)
        vertex[i] = vec_add(vec_mul(vertex[i], stretch), at);
    for (int i = 0; i < DOWN; i++)
        for (int j = 0; j < ACROSS; j++) {
            int k = (j + 1) % ACROSS, up = 2 + (i - 1) * ACROSS, down = up + ACROSS;
            if (i < DOWN - 1)
                memcpy(face[n++], (int[]) { i ? up + j : 0, down + j, down + k }, 3 * sizeof(int));
            if (i > 0)
                memcpy(face[n++], (int[]) { up + j, i < DOWN - 1 ? down + k : 1, up + k },
                       3 * sizeof(int));
        }
    return n;
}

START_TEST(test_a_closed_mesh_has_no_gaps_and_no_doubles)
{
    static const struct { vec3 stretch, at; } kinds[] = {
        { { 1, 1, 1 }, { 0, 0, 0 } }, { { 1500, 1, 1 }, { 0, 0, 0 } },
        { { 1, 1, 1 }, { 1e8, -1e8, 1e8 } }, { { 1, 1500, 1 }, { 1e8, 0, 3e7 } } };
    vec3 vertex[N_VERTEX];
    int face[2 * ACROSS * DOWN][3];
    int n = mesh_of(vertex, face, kinds[_i].stretch, kinds[_i].at);

    for (int i = 0; i < 4000; i++) {
        const int *f = face[(int)uniform(0, n)];
        double s = i % 3 == 0 ? 0 : i % 3 == 1 ? 0.5 : uniform(0, 1);
        vec3 target = vec_fma(vertex[f[0]], s, vec_sub(vertex[f[1]], vertex[f[0]]));
        vec3 o = vec_add(kinds[_i].at, vec_mul(kinds[_i].stretch, in_cube(0.3)));
        struct ray ray = { o, vec_sub(target, o) };
        if (i % 5 == 0)
            ray.origin = vec_fma(o, -1, ray.dir);       /* from outside */
        struct triangle_ray r = triangle_ray(ray);
        int forth = 0, all = 0;
        for (int j = 0; j < n; j++) {
            struct triangle_hit h;
            if (!triangle_cross(&r, vertex[face[j][0]], vertex[face[j][1]], vertex[face[j][2]], &h))
                continue;
            ck_assert(h.u >= 0 && h.v >= 0 && h.u + h.v <= 1 + 1e-15);
            all++;
            forth += h.t > 0;
        }
        ck_assert_int_eq(all % 2, 0);
        if (i % 5)
            ck_assert_int_eq(forth, 1);
    }
}
END_TEST

START_TEST(test_a_degenerate_triangle_is_never_hit)
{
    for (int i = 0; i < 100000; i++) {
        vec3 a = in_cube(1), b = in_cube(1), c = i % 2 ? a : vec_fma(a, 0.5, vec_sub(b, a));
        struct ray ray = { in_cube(3), vec_sub(i % 3 ? a : c, in_cube(3)) };
        struct triangle_ray r = triangle_ray(ray);
        struct triangle_hit h;
        if (triangle_cross(&r, a, b, c, &h))
            ck_assert(i % 2 == 0 && isfinite(h.t));
    }
    const double flat[] = { 0, 0, 0, 1, 1, 1, 2, 2, 2 };
    const struct shape_ops *ops = shape_find("triangle");
    char *self = arena_copy(&mem, ops->defaults, ops->size);
    memcpy(self + ops->args[0].offset, flat, sizeof flat);
    ck_assert_ptr_nonnull(ops->prepare(self, &mem));
}
END_TEST

static const struct { double r; double away; bool tangent; } tori[] = {
    { 0.43, 10, 0 }, { 0.43, 1e3, 0 }, { 0.43, 1e6, 0 }, { 1e-3, 10, 0 }, { 1e-5, 10, 0 },
    { 1e-6, 1e6, 0 }, { 1, 10, 0 }, { 1.7, 10, 0 }, { 0.43, 10, 1 }, { 1e-3, 10, 1 },
    { 1e-5, 1, 1 }, { 1.4, 10, 1 },
};
enum { N_TORI = sizeof tori / sizeof *tori };

START_TEST(test_a_torus_is_hit_as_often_as_it_should)
{
    const double v[] = { 1, tori[_i].r };
    const struct shape_ops *ops;
    void *self = shape_of("torus", v, &ops);
    int wrong = 0, rays = 1000;

    for (int i = 0; i < rays; i++) {
        double a = uniform(0, 7), b = uniform(0, 7), r = v[1] * uniform(0, 1.5);
        vec3 d = on_sphere();
        if (tori[_i].tangent)
            r = v[1] * (1 + copysign(pow(10, -uniform(1, 14)), uniform(-1, 1)));
        vec3 n = vec(cos(a) * cos(b), sin(b), sin(a) * cos(b));
        vec3 p = vec_fma(vec(cos(a), 0, sin(a)), r, n);
        if (tori[_i].tangent)
            d = vec_unit(vec_cross(n, d));
        struct ray ray = { vec_fma(p, -tori[_i].away * uniform(0.5, 1), d), d };
        struct hit h[4];
        quad t[4];
        int count = ops->hits(self, ray, h), truth = oracle_torus(v[0], v[1], ray, t);
        wrong += count != truth;
    }
    if (getenv("SHOW"))
        printf("torus r %g from %g%s: %d of %d wrong\n", v[1], tori[_i].away,
               tori[_i].tangent ? ", tangent" : "", wrong, rays);
    ck_assert_int_eq(wrong, 0);
}
END_TEST

/* A ray that starts slack outside of the surface and goes away does not
 * meet it again; one that starts inside and goes in leaves the solid. */
START_TEST(test_slack_is_enough_to_leave_a_surface)
{
    static const char *const convex[] = { "sphere", "box", "cylinder", "cone", "plane" };
    const struct shape_ops *ops = shape_find(convex[_i]);
    void *raw = arena_alloc(&mem, ops->size);

    for (int i = 0; i < 300; i++) {
        double by = pow(10, uniform(-6, 6));
        vec3 move = vec_scale(in_cube(1), pow(10, uniform(-6, 6)));
        some_shape(ops, raw);
        scale(ops, raw, by);
        for (const struct field *f = ops->args; f->name && !ops->is_infinite; f++)
            if (f->type == FIELD_POINT)
                *(vec3 *)member(raw, f) = vec_add(*(vec3 *)member(raw, f), move);
        for (const struct field *f = ops->words; f && f->name; f++)
            *(bool *)member(raw, f) = false;
        void *self = arena_copy(&mem, raw, ops->size);
        if (ops->prepare(self, &mem))
            continue;
        struct bounds b = ops->bounds(self);
        vec3 middle = ops->is_infinite ? no_where : vec_scale(vec_add(b.low, b.high), 0.5);
        double size = ops->is_infinite ? by : vec_largest(vec_sub(b.high, b.low));
        for (int j = 0; j < 100; j++) {
            vec3 d = on_sphere(), out = on_sphere();
            struct ray ray = { vec_fma(vec_fma(middle, 0.3 * size, on_sphere()), -10 * size, d), d };
            struct hit h[SHAPE_MOST_HITS], g;
            if (!ops->hits(self, ray, h) || h[0].slack > 1e-3 * size)
                continue;
            vec3 p = ray_at(ray, h[0].t), n = vec_unit(ops->normal(self, p, &h[0]));
            if (vec_dot(out, n) < 0)
                out = vec_neg(out);
            struct ray away = { vec_fma(p, h[0].slack, n), out };
            ck_assert(!ops->nearest(self, &away, 0, INFINITY, &g));
            if (ops->is_infinite)
                continue;
            struct ray into = { vec_fma(p, -h[0].slack, n), vec_neg(out) };
            ck_assert(ops->nearest(self, &into, 0, INFINITY, &g)
                      || !ops->inside(self, into.origin));     /* out again: an edge is near */
        }
    }
}
END_TEST

START_TEST(test_uv_of_known_points)
{
    const double one[] = { 0, 0, 0, 1 }, ring[] = { 2, 0.5 };
    const struct shape_ops *sphere, *torus;
    void *s = shape_of("sphere", one, &sphere), *t = shape_of("torus", ring, &torus);

    vec2 uv = sphere->uv(s, vec(0, 0, 1), NULL);
    ck_assert_double_eq_tol(uv.u, 0.25, 1e-15);
    ck_assert_double_eq_tol(uv.v, 0.5, 1e-15);
    uv = sphere->uv(s, vec(0, 1, 0), NULL);
    ck_assert_double_eq_tol(uv.u, 0, 1e-15);
    ck_assert_double_eq_tol(uv.v, 1, 1e-15);
    uv = torus->uv(t, vec(2, 0.5, 0), NULL);
    ck_assert_double_eq_tol(uv.u, 0.5, 1e-15);
    ck_assert_double_eq_tol(uv.v, 0.75, 1e-15);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("shape");
    TCase *rows = tcase_create("rows"), *exact = tcase_create("oracle");
    int n = 0;

    while (shapes[n])
        n++;
    tcase_add_checked_fixture(rows, setup, teardown);
    tcase_add_checked_fixture(exact, setup, teardown);
    tcase_set_timeout(rows, 60);
    tcase_set_timeout(exact, 60);
    tcase_add_loop_test(rows, test_a_row_is_complete, 0, n);
    tcase_add_loop_test(rows, test_spans_are_what_hits_say, 0, n);
    tcase_add_loop_test(rows, test_hits_come_in_order_and_within_bounds, 0, n);
    tcase_add_loop_test(rows, test_nearest_is_the_first_hit_within_limits, 0, n);
    tcase_add_loop_test(rows, test_many_rays_hit_what_each_hits, 0, n);
    tcase_add_loop_test(rows, test_a_normal_points_outward_across_the_surface, 0, n);
    tcase_add_loop_test(rows, test_a_solids_hits_alternate, 0, n);
    tcase_add_loop_test(rows, test_a_solid_has_an_even_number_of_hits_from_anywhere, 0, n);
    tcase_add_loop_test(rows, test_scaling_by_a_power_of_two_changes_no_bit, 0, n);
    tcase_add_loop_test(rows, test_odd_rays_do_no_harm, 0, n);
    tcase_add_loop_test(exact, test_hits_lie_on_the_surface, 0, N_ON_SURFACE);
    tcase_add_loop_test(exact, test_a_sphere_is_hit_or_missed_rightly, 0, 2);
    tcase_add_test(exact, test_a_unit_from_the_bits_of_a_size_is_the_same);
    tcase_add_test(exact, test_a_sphere_of_any_size_is_the_same);
    tcase_add_loop_test(exact, test_a_cone_is_hit_or_missed_rightly, 0, 6);
    tcase_add_test(exact, test_an_open_cone_has_its_wall_alone);
    tcase_add_test(exact, test_planes_across_an_axis_are_thin);
    tcase_add_test(exact, test_a_disc_ends_at_its_rim);
    tcase_add_test(exact, test_a_box_is_hit_on_its_edges_and_in_its_faces);
    tcase_add_loop_test(exact, test_a_closed_mesh_has_no_gaps_and_no_doubles, 0, 4);
    tcase_add_test(exact, test_a_degenerate_triangle_is_never_hit);
    tcase_add_loop_test(exact, test_a_torus_is_hit_as_often_as_it_should, 0, N_TORI);
    tcase_add_loop_test(exact, test_slack_is_enough_to_leave_a_surface, 0, 5);
    tcase_add_test(exact, test_uv_of_known_points);
    suite_add_tcase(suite, rows);
    suite_add_tcase(suite, exact);

    SRunner *runner = srunner_create(suite);
    srunner_run_all(runner, CK_ENV);
    int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed != 0;
}
