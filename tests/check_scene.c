/* check_scene.c: what must hold of cameras, placed objects, lights and tables. */
#include <check.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "scene/atmosphere.h"
#include "scene/scene.h"

static struct arena mem;

static void setup(void) { arena_init(&mem, NULL); }
static void teardown(void) { arena_free(&mem); }

static double random_in(double low, double high)
{
    return low + (high - low) * ((double)rand() / RAND_MAX);
}

static vec3 random_vector(double size)
{
    return vec(random_in(-size, size), random_in(-size, size), random_in(-size, size));
}

static struct transform random_place(void)
{
    struct transform s = transform_scale(vec(random_in(0.2, 3), random_in(0.2, 3), random_in(0.2, 3)));
    struct transform r = transform_rotate(random_vector(180)), t = transform_translate(random_vector(5));

    r = transform_compose(&r, &s);
    return transform_compose(&t, &r);
}

#define NEAR(a, b) ck_assert_double_eq_tol(a, b, 1e-9)
#define NEAR_VEC(a, b) do { vec3 p_ = a, q_ = b; \
    NEAR(p_.x, q_.x); NEAR(p_.y, q_.y); NEAR(p_.z, q_.z); } while (0)

/* --- a shape of our own: the unit ball, so that only the scene is tested -------------- */

struct ball { double radius; };

static struct bounds ball_bounds(const void *self)
{
    double r = ((const struct ball *)self)->radius;

    return (struct bounds) { { -r, -r, -r }, { r, r, r } };
}

static int ball_hits(const void *self, struct ray ray, struct hit out[])
{
    double r = ((const struct ball *)self)->radius, a = vec_dot(ray.dir, ray.dir);
    double b = vec_dot(ray.origin, ray.dir), c = vec_dot(ray.origin, ray.origin) - r * r;
    double disc = b * b - a * c;

    if (disc <= 0)
        return 0;
    out[0] = (struct hit) { .t = (-b - sqrt(disc)) / a };
    out[1] = (struct hit) { .t = (-b + sqrt(disc)) / a };
    return 2;
}

static bool ball_inside(const void *self, vec3 p)
{
    return vec_length(p) < ((const struct ball *)self)->radius;
}

static vec3 ball_normal(const void *self, vec3 p, const struct hit *h)
{
    (void)self;
    (void)h;
    return p;
}

static const struct field no_args[] = { FIELD_END };
static const struct ball unit_ball = { 1 };
static const struct shape_ops ball_ops = {
    .name = "ball", .size = sizeof(struct ball), .defaults = &unit_ball, .args = no_args,
    .is_solid = true, .most_hits = 2, .bounds = ball_bounds, .hits = ball_hits,
    .inside = ball_inside, .normal = ball_normal,
};

static struct object *ball_at(vec3 centre)
{
    struct object *o = object_new(&mem, OBJECT_SHAPE);
    const struct transform place = transform_translate(centre);

    o->ops = &ball_ops;
    o->shape = &unit_ball;
    o->place = arena_copy(&mem, &place, sizeof place);
    return o;
}

static struct object *combined(enum object_kind kind, struct object *a, struct object *b)
{
    struct object *o = object_new(&mem, kind);
    const struct object **child = arena_array(&mem, 2, sizeof *child);

    child[0] = a;
    child[1] = b;
    o->child = child;
    o->n_child = 2;
    return o;
}

/* --- camera ---------------------------------------------------------------------------- */

START_TEST(test_without_words_the_camera_is_the_default)
{
    struct camera c;

    ck_assert_ptr_null(camera_solve(&camera_default, &c));
    NEAR_VEC(c.right, vec(1.33, 0, 0));
    NEAR_VEC(c.direction, vec(0, 0, 1));
}
END_TEST

START_TEST(test_look_at_keeps_lengths_and_makes_right_angles)
{
    for (int i = 0; i < 200; i++) {
        struct camera_words w = camera_default;
        struct camera c;
        w.location = random_vector(10);
        w.look_at = random_vector(10);
        w.has_look_at = true;
        ck_assert_ptr_null(camera_solve(&w, &c));
        NEAR(vec_length(c.right), 1.33);
        NEAR(vec_length(c.direction), 1);
        NEAR(vec_dot(c.right, c.direction), 0);
        NEAR(vec_dot(c.up, c.direction), 0);
        vec3 view = vec_unit(vec_sub(w.look_at, w.location));
        NEAR_VEC(vec_unit(c.direction), view);
    }
}
END_TEST

START_TEST(test_a_negative_right_mirrors)
{
    struct camera_words w = camera_default;
    struct camera c;

    w.right = vec(-1.33, 0, 0);
    w.look_at = vec(0, 0, 5);
    w.has_look_at = true;
    ck_assert_ptr_null(camera_solve(&w, &c));
    NEAR_VEC(c.right, vec(-1.33, 0, 0));
}
END_TEST

START_TEST(test_angle_sets_the_length_of_direction)
{
    struct camera_words w = camera_default;
    struct camera c;

    w.angle = 90;
    w.has_angle = true;
    ck_assert_ptr_null(camera_solve(&w, &c));
    NEAR(vec_length(c.direction), 1.33 / 2);
    w.angle = 180;
    ck_assert_ptr_nonnull(camera_solve(&w, &c));
}
END_TEST

START_TEST(test_orthographic_is_as_wide_as_the_view_at_look_at)
{
    struct camera_words w = camera_default;
    struct camera c;

    w.kind = CAMERA_ORTHOGRAPHIC;
    w.location = vec(1, 1, -3);         /* facts shading.md 1.3, step 4 */
    ck_assert_ptr_null(camera_solve(&w, &c));
    NEAR(vec_length(c.right), 1.33 * sqrt(18));
}
END_TEST

START_TEST(test_a_camera_at_its_look_at_is_refused)
{
    struct camera_words w = camera_default;
    struct camera c;

    w.look_at = w.location;
    w.has_look_at = true;
    ck_assert_ptr_nonnull(camera_solve(&w, &c));
}
END_TEST

/* --- objects ----------------------------------------------------------------------------- */

START_TEST(test_bounds_hold_the_moved_ball)
{
    for (int i = 0; i < 200; i++) {
        struct object *o = ball_at(random_vector(3));
        struct transform t = random_place();
        object_move(&mem, o, &t);
        struct bounds b = object_bounds(o);
        for (int k = 0; k < 50; k++) {
            vec3 p = mat_point(&o->place->to, vec_unit(random_vector(1)));
            ck_assert(p.x >= b.low.x - 1e-9 && p.x <= b.high.x + 1e-9);
            ck_assert(p.y >= b.low.y - 1e-9 && p.y <= b.high.y + 1e-9);
            ck_assert(p.z >= b.low.z - 1e-9 && p.z <= b.high.z + 1e-9);
        }
    }
}
END_TEST

START_TEST(test_infinite_bounds_stay_without_nan_when_moved)
{
    struct bounds b = { { -INFINITY, 0, -INFINITY }, { INFINITY, 0, INFINITY } };
    struct transform t = transform_rotate(vec(0, 30, 0));
    struct bounds moved = bounds_move(&b, &t);

    ck_assert_double_eq(moved.low.y, 0);
    ck_assert_double_eq(moved.high.y, 0);
    ck_assert(isinf(moved.low.x) && isinf(moved.high.z));
}
END_TEST

START_TEST(test_insides_follow_set_algebra)
{
    for (int i = 0; i < 2000; i++) {
        struct object *a = ball_at(vec(0, 0, 0)), *b = ball_at(vec(0.8, 0, 0));
        vec3 p = random_vector(2);
        bool in_a = object_inside(a, p, NULL), in_b = object_inside(b, p, NULL);
        ck_assert(object_inside(combined(OBJECT_UNION, a, b), p, NULL) == (in_a || in_b));
        ck_assert(object_inside(combined(OBJECT_MERGE, a, b), p, NULL) == (in_a || in_b));
        ck_assert(object_inside(combined(OBJECT_INTERSECTION, a, b), p, NULL) == (in_a && in_b));
        struct object *d = combined(OBJECT_DIFFERENCE, a, b);
        ck_assert(object_inside(d, p, NULL) == (in_a && !in_b));
        d->flags |= OBJECT_INVERSE;
        ck_assert(object_inside(d, p, NULL) != (in_a && !in_b));
    }
}
END_TEST

START_TEST(test_a_clip_takes_its_outside_away)
{
    struct object *o = ball_at(vec(0, 0, 0));
    const struct object *clip[] = { ball_at(vec(0.8, 0, 0)) };

    struct object_more *more = object_more(&mem, o);
    more->clip = clip;
    more->n_clip = 1;
    ck_assert(!object_inside(o, vec(-0.5, 0, 0), NULL));
    ck_assert(object_inside(o, vec(0.5, 0, 0), NULL));
}
END_TEST

START_TEST(test_inside_moves_with_the_object)
{
    for (int i = 0; i < 500; i++) {
        struct object *o = combined(OBJECT_DIFFERENCE, ball_at(vec(0, 0, 0)), ball_at(vec(1, 0, 0)));
        struct transform t = random_place();
        vec3 p = random_vector(1.5);
        bool before = object_inside(o, p, NULL);
        object_move(&mem, o, &t);
        ck_assert(object_inside(o, mat_point(&t.to, p), NULL) == before);
    }
}
END_TEST

START_TEST(test_trace_meets_the_surface_of_what_remains)
{
    for (int i = 0; i < 2000; i++) {
        struct object *o = combined(OBJECT_DIFFERENCE, ball_at(vec(0, 0, 0)), ball_at(vec(0.9, 0, 0)));
        struct transform t = random_place();
        object_move(&mem, o, &t);
        vec3 from = random_vector(10), dir = vec_unit(random_vector(1)), p, n;
        if (!object_trace(o, from, dir, NULL, &p, &n))
            continue;
        NEAR(vec_length(n), 1);
        ck_assert(object_inside(o, vec_fma(p, -1e-4, n), NULL));
        ck_assert(!object_inside(o, vec_fma(p, 1e-4, n), NULL));
    }
}
END_TEST

START_TEST(test_trace_tells_a_miss)
{
    vec3 p, n;

    ck_assert(!object_trace(ball_at(vec(0, 0, 0)), vec(0, 5, -5), vec(0, 0, 1), NULL, &p, &n));
    ck_assert(!object_trace(ball_at(vec(0, 0, 0)), vec(0, 0, -5), vec(0, 0, -1), NULL, &p, &n));
    ck_assert(object_trace(ball_at(vec(0, 0, 0)), vec(0, 0, -5), vec(0, 0, 7), NULL, &p, &n));
    NEAR_VEC(p, vec(0, 0, -1));
    NEAR_VEC(n, vec(0, 0, -1));
}
END_TEST

START_TEST(test_trace_of_an_intersection_needs_all)
{
    struct object *o = combined(OBJECT_INTERSECTION, ball_at(vec(-0.5, 0, 0)), ball_at(vec(0.5, 0, 0)));
    vec3 p, n;

    ck_assert(object_trace(o, vec(-5, 0, 0), vec(1, 0, 0), NULL, &p, &n));
    NEAR_VEC(p, vec(-0.5, 0, 0));       /* the left side of the right ball */
}
END_TEST

/* --- trees over parts ------------------------------------------------------------------------ */

/* Balls of which some stand in others' place, some are inverse, one is of
 * another crowd. */
static struct object *crowd(enum object_kind kind, size_t n, const struct object *inner)
{
    struct object *o = object_new(&mem, kind);
    const struct object **child = arena_array(&mem, n, sizeof *child);

    for (size_t i = 0; i < n; i++) {
        vec3 at = random_vector(6);
        struct object *ball = ball_at(vec(floor(at.x), floor(at.y), floor(at.z)));
        if (kind == OBJECT_UNION && i % 7 == 3)
            ball->flags |= OBJECT_INVERSE;
        child[i] = inner && i == n / 2 ? inner : ball;
    }
    o->child = child;
    o->n_child = (uint32_t)n;
    return o;
}

/* Faces through a few corners again and again: rays that meet edges, too. */
static struct object *random_mesh(size_t n)
{
    struct mesh *m = arena_alloc(&mem, sizeof *m);
    struct object *o = object_new(&mem, OBJECT_MESH);
    vec3 *vertex = arena_array(&mem, 12, sizeof *vertex);

    m->box = BOUNDS_EMPTY;
    for (size_t i = 0; i < 12; i++) {
        vec3 at = random_vector(3);
        vertex[i] = vec(floor(at.x), floor(at.y), floor(at.z));
        m->box = bounds_join(m->box, (struct bounds) { vertex[i], vertex[i] });
    }
    *m = (struct mesh) { .vertex = vertex, .n_vertex = 12, .n_face = n, .box = m->box,
                         .face = arena_array(&mem, n, sizeof *m->face), .inside_vector = vec(0.1, 1, 0.2) };
    for (size_t i = 0; i < n; i++)
        for (int k = 0; k < 3; k++)
            m->face[i].of[k] = (uint32_t)(fabs(random_vector(12).x));
    o->mesh = m;
    return o;
}

static void answers_are_equal(const struct object *o)
{
    struct object_trees trees = { .mem = &mem };

    for (int i = 0; i < 1500; i++) {
        vec3 p = random_vector(8), dir = random_vector(1), at[2], n[2];
        if (i % 3 == 0)                 /* from grid to grid: touching, edges, ties */
            p = vec(floor(p.x), floor(p.y), -9), dir = vec(0, 0, 1);
        ck_assert(object_inside(o, p, &trees) == object_inside(o, p, NULL));
        bool met = object_trace(o, p, dir, NULL, &at[0], &n[0]);
        ck_assert(object_trace(o, p, dir, &trees, &at[1], &n[1]) == met);
        ck_assert_mem_eq(&at[0], &at[1], sizeof at[0]);
        ck_assert_mem_eq(&n[0], &n[1], sizeof n[0]);
    }
    ck_assert(trees.known.n > 0);
}

START_TEST(test_trees_change_no_answer)
{
    const enum object_kind kind[] = { OBJECT_UNION, OBJECT_MERGE, OBJECT_DIFFERENCE };

    for (int i = 0; i < 3; i++) {
        answers_are_equal(crowd(kind[i], 60, NULL));
        answers_are_equal(crowd(kind[i], 60, crowd(OBJECT_UNION, 40, NULL)));
        answers_are_equal(crowd(kind[i], 40, random_mesh(50)));
    }
    answers_are_equal(random_mesh(300));
}
END_TEST

/* --- textures and lights -------------------------------------------------------------------- */

START_TEST(test_all_layers_of_a_texture_move)
{
    struct texture top = texture_default, bottom = texture_default;
    struct transform t = transform_translate(vec(1, 2, 3));

    bottom.above = &top;
    const struct texture *moved = texture_move(&mem, &bottom, &t);
    NEAR_VEC(mat_point(&moved->place->to, vec(0, 0, 0)), vec(1, 2, 3));
    NEAR_VEC(mat_point(&moved->above->place->to, vec(0, 0, 0)), vec(1, 2, 3));
    ck_assert_ptr_null(moved->above->above);
    ck_assert(bottom.place->is_identity && top.place->is_identity);
}
END_TEST

static vec3 middle_of(const struct transform *t) { return mat_point(&t->to, vec(0, 0, 0)); }

/* A texture may share its object's place, but a copy of the object is moved
 * alone, and so is a layer that came later than the first move. */
START_TEST(test_textures_move_with_their_own_object)
{
    const struct transform x = transform_translate(vec(1, 0, 0)), y = transform_translate(vec(0, 1, 0));
    struct texture late = texture_default, first = texture_default;
    struct object *o = ball_at(vec(0, 0, 0));

    o->place = &transform_identity;
    first.above = &late;
    o->texture = &texture_default;
    object_move(&mem, o, &x);
    object_move(&mem, o, &x);
    struct object *copy = object_copy(&mem, o);
    object_move(&mem, copy, &y);
    object_move(&mem, copy, &y);
    NEAR_VEC(middle_of(copy->texture->place), vec(2, 2, 0));
    NEAR_VEC(middle_of(o->texture->place), vec(2, 0, 0));
    first.place = o->texture->place;
    o->texture = &first;
    object_move(&mem, o, &y);
    NEAR_VEC(middle_of(o->texture->place), vec(2, 1, 0));
    NEAR_VEC(middle_of(o->texture->above->place), vec(0, 1, 0));
    object_move(&mem, o, &y);
    NEAR_VEC(middle_of(o->texture->place), vec(2, 2, 0));
    NEAR_VEC(middle_of(o->texture->above->place), vec(0, 2, 0));
    NEAR_VEC(middle_of(copy->texture->place), vec(2, 2, 0));
    ck_assert(texture_default.place->is_identity && late.place->is_identity);
}
END_TEST

/* One that differs in anything else is not like the others. */
START_TEST(test_shapes_that_differ_in_nothing_else_share_one_object)
{
    const struct ball size[] = { { 1 }, { 2 }, { 3 } };
    struct object *o[4], room;
    struct scene s;

    scene_init(&s, &mem);
    for (int i = 0; i < 4; i++) {
        o[i] = ball_at(vec(0, 0, 0));
        o[i]->place = &transform_identity;
        o[i]->texture = &texture_default;
        o[i]->shape = &size[i % 3];
        o[i]->flags = i == 2 ? OBJECT_NO_SHADOW : 0;
        ck_assert(scene_add(&s, o[i]) == (i == 1));
    }
    ck_assert(scene_object(&s, 0, &room) == o[0] && scene_object(&s, 2, &room) == o[2]);
    const struct object *second = scene_object(&s, 1, &room);
    ck_assert(second->shape == &size[1] && second->ops == &ball_ops && second->flags == 0);
    ck_assert(scene_object(&s, 3, &room)->flags == 0);
}
END_TEST

START_TEST(test_lights_in_unions_come_into_the_world_where_they_stand)
{
    struct light lamp = light_default;
    const struct transform aside = transform_translate(vec(1, 0, 0));
    struct object light = { .kind = OBJECT_LIGHT, .light = &lamp, .place = &aside,
                            .more = &object_no_more };
    struct object *o = combined(OBJECT_UNION, ball_at(vec(0, 0, 0)), &light);
    struct transform t = transform_translate(vec(0, 5, 0));
    struct scene s;

    scene_init(&s, &mem);
    object_move(&mem, o, &t);
    scene_add(&s, o);
    ck_assert_uint_eq(s.n_light, 1);
    ck_assert_uint_eq(s.n_object, 1);
    NEAR_VEC(s.light[0].centre, vec(1, 5, 0));
}
END_TEST

START_TEST(test_what_a_light_looks_like_moves_with_it)
{
    struct light lamp = light_default;
    lamp.looks_like = ball_at(vec(0, 0, 0));
    const struct transform away = transform_translate(vec(0, 0, 9));
    struct object light = { .kind = OBJECT_LIGHT, .light = &lamp, .place = &away,
                            .more = &object_no_more };
    struct scene s;

    scene_init(&s, &mem);
    scene_add(&s, &light);
    NEAR_VEC(mat_point(&s.light[0].looks_like->place->to, vec(0, 0, 0)), vec(0, 0, 9));
}
END_TEST

/* --- tables ------------------------------------------------------------------------------------ */

static const struct field *const tables[] = {
    finish_fields, reflection_fields, interior_fields, camera_fields, light_fields,
    settings_fields, media_fields, scattering_fields, fog_fields, rainbow_fields,
    sky_sphere_fields,
};

START_TEST(test_every_row_has_help_and_stands_once)
{
    const struct field *table = tables[_i];

    for (const struct field *f = table; f->name; f++) {
        ck_assert(f->help && *f->help);
        for (const struct field *g = f + 1; g->name; g++)
            ck_assert_str_ne(f->name, g->name);
    }
}
END_TEST

static int times(const char *text, const char *word)
{
    int n = 0;

    for (const char *at = strstr(text, word); at; at = strstr(at + 1, word))
        n++;
    return n;
}

START_TEST(test_the_dump_names_what_is_there)
{
    char *text = NULL;
    size_t size = 0;
    FILE *out = open_memstream(&text, &size);
    struct scene s;
    struct finish bright = finish_default;
    struct texture texture = texture_default;

    scene_init(&s, &mem);
    struct object *o = ball_at(vec(0, 2, 0));
    o->name = "Moon";
    bright.emission = bright.ambient = rgb_of(0.5f, 0.25f, 0);
    texture.finish = &bright;
    o->texture = &texture;
    scene_add(&s, o);
    scene_dump(&s, out);
    fclose(out);
    ck_assert_ptr_nonnull(strstr(text, "ball {  // Moon"));
    ck_assert_ptr_nonnull(strstr(text, "translate <0, 2, 0>"));
    ck_assert_ptr_nonnull(strstr(text, "camera {"));
    ck_assert_ptr_null(strstr(text, "-0"));
    ck_assert_int_eq(times(text, "ambient rgb <0.5, 0.25, 0>"), 1);
    ck_assert_int_eq(times(text, "emission rgb <0.5, 0.25, 0>"), 1);
    free(text);
}
END_TEST

int main(void)
{
    Suite *s = suite_create("scene");
    TCase *t = tcase_create("scene");

    srand(1);
    tcase_add_checked_fixture(t, setup, teardown);
    tcase_add_test(t, test_without_words_the_camera_is_the_default);
    tcase_add_test(t, test_look_at_keeps_lengths_and_makes_right_angles);
    tcase_add_test(t, test_a_negative_right_mirrors);
    tcase_add_test(t, test_angle_sets_the_length_of_direction);
    tcase_add_test(t, test_orthographic_is_as_wide_as_the_view_at_look_at);
    tcase_add_test(t, test_a_camera_at_its_look_at_is_refused);
    tcase_add_test(t, test_bounds_hold_the_moved_ball);
    tcase_add_test(t, test_infinite_bounds_stay_without_nan_when_moved);
    tcase_add_test(t, test_insides_follow_set_algebra);
    tcase_add_test(t, test_a_clip_takes_its_outside_away);
    tcase_add_test(t, test_inside_moves_with_the_object);
    tcase_add_test(t, test_trace_meets_the_surface_of_what_remains);
    tcase_add_test(t, test_trace_tells_a_miss);
    tcase_add_test(t, test_trace_of_an_intersection_needs_all);
    tcase_add_test(t, test_all_layers_of_a_texture_move);
    tcase_add_test(t, test_trees_change_no_answer);
    tcase_add_test(t, test_textures_move_with_their_own_object);
    tcase_add_test(t, test_shapes_that_differ_in_nothing_else_share_one_object);
    tcase_add_test(t, test_lights_in_unions_come_into_the_world_where_they_stand);
    tcase_add_test(t, test_what_a_light_looks_like_moves_with_it);
    tcase_add_test(t, test_the_dump_names_what_is_there);
    tcase_add_loop_test(t, test_every_row_has_help_and_stands_once, 0,
                        sizeof tables / sizeof *tables);
    suite_add_tcase(s, t);
    SRunner *r = srunner_create(s);
    srunner_run_all(r, CK_ENV);
    int failed = srunner_ntests_failed(r);
    srunner_free(r);
    return failed ? EXIT_FAILURE : EXIT_SUCCESS;
}
