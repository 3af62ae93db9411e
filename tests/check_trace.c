/* check_trace.c: shading, piece by piece. */
#include <check.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "math/vmath.h"
#include "trace/camera_rays.h"
#include "trace/film.h"
#include "trace/insides.h"
#include "trace/light.h"
#include "trace/parked.h"
#include "scene/picture.h"
#include "trace/program.h"
#include "trace/render.h"
#include "trace/wave.h"

static struct arena mem;

static void setup(void) { arena_init(&mem, NULL); }
static void teardown(void) { arena_free(&mem); }

static double random_in(unsigned *seed, double low, double high)
{
    return low + (high - low) * (rand_r(seed) / (double)RAND_MAX);
}

/* ---- powers ---- */

static double ulps_off(float got, double want)
{
    float near = (float)want, next = nextafterf(near, INFINITY);

    return fabs((double)got - want) / ((double)next - (double)near);
}

START_TEST(test_powers_are_right_to_two_ulps)
{
    enum { N = 1000 };
    unsigned seed = 1;
    float x[N], out[N];

    for (int round = 0; round < 200; round++) {
        float y = (float)exp(random_in(&seed, log(0.01), log(10000)));
        for (int i = 0; i < N; i++)
            x[i] = (float)(1 - pow(random_in(&seed, 0, 1), 6));
        vmath_pow(N, x, y, out);
        for (int i = 0; i < N; i++) {
            double want = pow((double)x[i], (double)y);
            if (want > 1e-37)
                ck_assert_double_le(ulps_off(out[i], want), 2);
        }
    }
}
END_TEST

START_TEST(test_powers_of_nothing_are_nothing)
{
    const float x[] = { 0, -1, -0.f, 1, 2, 1e-40f };
    float out[6];

    vmath_pow(6, x, 40, out);
    ck_assert(out[0] == 0 && out[1] == 0 && out[2] == 0 && out[3] == 1 && out[5] == 0);
    ck_assert(out[4] == 1099511627776.f);
}
END_TEST

/* ---- cameras ---- */

static struct camera plain_camera(enum camera_kind kind)
{
    return (struct camera) { .kind = kind, .direction = { 0, 0, 1 }, .right = { 1.5, 0, 0 },
                             .up = { 0, 1, 0 }, .angle = M_PI / 2, .h_angle = 2 * M_PI,
                             .v_angle = M_PI };
}

START_TEST(test_perspective_looks_through_the_picture_plane)
{
    struct camera c = plain_camera(CAMERA_PERSPECTIVE);
    struct lens l = lens_of(&c);
    struct ray r;

    ck_assert(lens_ray(&l, 1, 0, &r));
    vec3 want = vec_unit(vec(0.75, 0.5, 1));
    ck_assert_double_lt(vec_length(vec_sub(r.dir, want)), 1e-15);
    ck_assert(l.fixed_origin);
}
END_TEST

START_TEST(test_rays_of_every_camera_have_unit_length)
{
    unsigned seed = 2;

    for (int kind = CAMERA_PERSPECTIVE; kind <= CAMERA_SPHERICAL; kind++) {
        struct camera c = plain_camera((enum camera_kind)kind);
        struct lens l = lens_of(&c);
        for (int i = 0; i < 1000; i++) {
            struct ray r;
            if (lens_ray(&l, random_in(&seed, 0, 1), random_in(&seed, 0, 1), &r))
                ck_assert_double_lt(fabs(vec_length(r.dir) - 1), 1e-14);
        }
    }
}
END_TEST

START_TEST(test_a_fisheye_sees_nothing_outside_its_circle)
{
    struct camera c = plain_camera(CAMERA_FISHEYE);
    c.right = vec(1, 0, 0);
    struct lens l = lens_of(&c);
    struct ray r;

    ck_assert(!lens_ray(&l, 0.01, 0.01, &r));
    ck_assert(lens_ray(&l, 0.5, 0.5, &r));
    ck_assert_double_lt(vec_length(vec_sub(r.dir, vec(0, 0, 1))), 1e-15);
}
END_TEST

START_TEST(test_a_spherical_camera_looks_up_at_the_top_and_back_at_the_side)
{
    struct camera c = plain_camera(CAMERA_SPHERICAL);
    c.right = vec(1, 0, 0);
    struct lens l = lens_of(&c);
    struct ray r;

    lens_ray(&l, 0.5, 0, &r);
    ck_assert_double_lt(vec_length(vec_sub(r.dir, vec(0, 1, 0))), 1e-14);
    lens_ray(&l, 0.75, 0.5, &r);
    ck_assert_double_lt(vec_length(vec_sub(r.dir, vec(1, 0, 0))), 1e-14);
}
END_TEST

/* ---- maps ---- */

static void value_is_x(const void *self, int n, const double *x, const double *y, const double *z,
                       double *value)
{
    (void)self, (void)y, (void)z;
    memcpy(value, x, (size_t)n * sizeof *value);
}

static const struct pattern_ops along_x = { .name = "x", .values = value_is_x };

static colour colour_by_map(const struct map_entry *entry, size_t n, double value)
{
    struct pigment p = pigment_default;
    double zero = 0;
    struct colours c;

    p.kind = PIGMENT_COLOUR_MAP;
    struct pattern_use use = *p.pattern;
    use.ops = &along_x;
    p.pattern = &use;
    p.entry = (struct map_entry *)entry;
    p.n_entry = n;
    const struct paint *paint = paint_new(&mem, &p, &transform_identity);
    paint_colours(paint, &(struct spots) { 1, &value, &zero, &zero, &zero, &zero }, &c);
    return (colour) { c.r[0], c.g[0], c.b[0], c.f[0], c.t[0] };
}

START_TEST(test_equal_keys_are_a_jump_and_the_first_holds_at_the_key)
{
    const struct map_entry e[] = { { .value = 0, .colour = { .r = 0 } },
                                   { .value = 0.5, .colour = { .r = 1 } },
                                   { .value = 0.5, .colour = { .r = 5 } },
                                   { .value = 1, .colour = { .r = 6 } } };

    ck_assert(colour_by_map(e, 4, 0.25).r == 0.5f);
    ck_assert(colour_by_map(e, 4, 0.5).r == 1);
    ck_assert_float_ge(colour_by_map(e, 4, 0.5000001).r, 5);
    ck_assert(colour_by_map(e, 4, 1).r == 6);
}
END_TEST

START_TEST(test_keys_are_single_precision)
{
    const struct map_entry e[] = { { .value = 0.4, .colour = { .r = 1 } },
                                   { .value = 0.4, .colour = { .r = 2 } } };

    ck_assert(colour_by_map(e, 2, 0.4).r == 1);         /* below the float next to 0.4 */
    ck_assert(colour_by_map(e, 2, (double)0.4f).r == 2);
}
END_TEST

/* ---- pictures ---- */

static struct image *two_by_two(void)
{
    struct image *m = arena_alloc(&mem, sizeof *m);

    *m = (struct image) { 2, 2, arena_array(&mem, 4, sizeof(colour)), false };
    for (int i = 0; i < 4; i++)
        m->pixel[i].r = (float)(i + 1);                 /* 1 2 above 3 4 */
    return m;
}

START_TEST(test_a_picture_has_its_first_row_on_top_and_repeats)
{
    struct image_use use = { .image = two_by_two() };

    ck_assert(picture_colour(&use, vec(0.1, 0.9, 7)).r == 1);
    ck_assert(picture_colour(&use, vec(0.9, 0.1, 0)).r == 4);
    ck_assert(picture_colour(&use, vec(-0.1, 0.1, 0)).r == 4);
    ck_assert(picture_colour(&use, vec(3.1, -0.9, 0)).r == 3);
}
END_TEST

START_TEST(test_once_is_clear_outside)
{
    struct image_use use = { .image = two_by_two(), .once = true };

    ck_assert(picture_colour(&use, vec(1.1, 0.5, 0)).t == 1);
    ck_assert(picture_colour(&use, vec(0.6, 0.6, 0)).r == 2);
}
END_TEST

START_TEST(test_interpolation_in_the_middle_is_the_mean)
{
    struct image_use use = { .image = two_by_two(), .interpolate = INTERPOLATE_BILINEAR };

    ck_assert_float_eq_tol(picture_colour(&use, vec(0.5, 0.5, 0)).r, 2.5f, 1e-6f);
    use.interpolate = INTERPOLATE_BICUBIC;
    ck_assert_float_eq_tol(picture_colour(&use, vec(0.5, 0.5, 0)).r, 2.5f, 1e-6f);
    use.interpolate = INTERPOLATE_DISTANCE;
    ck_assert_float_eq_tol(picture_colour(&use, vec(0.5, 0.5, 0)).r, 2.5f, 1e-6f);
}
END_TEST

/* ---- lamps ---- */

static float share_at(const struct light *l, vec3 p, struct beams *b)
{
    const double x[BATCH] = { p.x }, y[BATCH] = { p.y }, z[BATCH] = { p.z };
    struct lamp lamp = lamp_of(l);

    lamp_beams(&lamp, 1, x, y, z, b);
    return b->share[0];
}

START_TEST(test_a_fading_light_has_its_strength_at_its_distance)
{
    struct light l = light_default;
    struct beams b;

    l.fade_distance = 3;
    l.fade_power = 2;
    ck_assert_float_eq_tol(share_at(&l, vec(0, 3, 0), &b), 1, 1e-6f);
    ck_assert_float_eq_tol(share_at(&l, vec(0, 6, 0), &b), 0.4f, 1e-6f);
    ck_assert_double_eq(b.far[0], 6);
    ck_assert_double_eq(b.dy[0], -1);
}
END_TEST

START_TEST(test_a_spotlight_is_dark_outside_its_cone)
{
    struct light l = light_default;
    struct beams b;

    l.kind = LIGHT_SPOT;
    l.radius = 30;
    l.falloff = 45;
    ck_assert(share_at(&l, vec(0, 0, 5), &b) == 1);
    ck_assert(share_at(&l, vec(6, 0, 5), &b) == 0);
    ck_assert(share_at(&l, vec(0, 0, -5), &b) == 0);
    float edge = share_at(&l, vec(5 * tan(37 * M_PI / 180), 0, 5), &b);
    ck_assert(edge > 0.2f && edge < 0.8f);
}
END_TEST

START_TEST(test_parallel_light_comes_from_one_side)
{
    struct light l = light_default;
    struct beams b;

    l.parallel = true;
    l.centre = vec(0, 10, 0);
    l.point_at = vec(0, 0, 0);
    ck_assert(share_at(&l, vec(500, 4, -3), &b) == 1);
    ck_assert_double_eq(b.dy[0], 1);
    ck_assert_double_eq(b.far[0], 6);
}
END_TEST

/* ---- film, interiors, waves ---- */

START_TEST(test_a_power_is_taken_of_the_whole_sum)
{
    struct film f = { 0 };

    film_start(&f, 2);
    uint32_t outer = film_branch(&f, 1, rgb_of(0.5f, 1, 1), 0.5f);
    uint32_t inner = film_branch(&f, outer, rgb_of(1, 1, 1), 2);
    film_add(&f, inner, rgb_of(1, 0, 0));
    film_add(&f, inner, rgb_of(2, 0, 0));
    film_add(&f, outer, rgb_of(7, 0, 0));
    film_settle(&f, f.n_pixel);
    ck_assert_double_eq_tol(f.sum[1][0], 0.5 * sqrt(7 + 9), 1e-12);
    ck_assert_double_eq(f.sum[0][0], 0);
    film_release(&f);
}
END_TEST

START_TEST(test_leaving_from_the_middle_keeps_the_others)
{
    struct surface a = { .solid = "a" }, b = { .solid = "b" }, c = { .solid = "c" };
    struct insides in;

    insides_init(&in);
    uint32_t list = insides_enter(&in, 0, &a, 1);
    list = insides_enter(&in, list, &b, 2);
    list = insides_enter(&in, list, &c, 3);
    uint32_t less = insides_leave(&in, list, &b, 2);
    ck_assert(insides_holds(&in, list, &b, 2) && !insides_holds(&in, less, &b, 2));
    ck_assert(insides_holds(&in, less, &a, 1) && !insides_holds(&in, less, &a, 2));
    ck_assert(in.item[less].surface == &c);
    ck_assert(in.item[in.item[less].before].surface == &a);
    insides_release(&in);
}
END_TEST

START_TEST(test_a_wave_keeps_its_rays_as_it_grows)
{
    struct wave w = { 0 };

    for (int i = 0; i < 1000; i++) {
        wave_reserve(&w, i + 1);
        w.x[i] = i;
        w.pixel[i] = (uint32_t)i;
        w.depth[i] = (uint16_t)(i % 7);
        w.n++;
    }
    ck_assert(w.room >= 1000);
    ck_assert(w.x[999] == 999 && w.pixel[500] == 500 && w.depth[13] == 6);
    wave_release(&w);
}
END_TEST

static void push_pixel(struct wave *w, uint32_t pixel, double x)
{
    wave_reserve(w, w->n + 1);
    w->x[w->n] = x;
    w->pixel[w->n++] = pixel;
}

/* A wave, what waits, and what they refer to. */
struct traffic {
    struct wave wave;
    struct parked parked;
    struct insides insides;
    struct film film;
};

static void traffic_init(struct traffic *t)
{
    *t = (struct traffic) { 0 };
    insides_init(&t->insides);
    film_start(&t->film, 4);
}

static void traffic_release(struct traffic *t)
{
    wave_release(&t->wave);
    parked_release(&t->parked);
    insides_release(&t->insides);
    film_release(&t->film);
}

static void park(struct traffic *t, int most)
{
    parked_push(&t->parked, &t->wave, most, &t->insides, &t->film);
}

static bool pop(struct traffic *t)
{
    return parked_pop(&t->parked, &t->wave, &t->insides, &t->film);
}

START_TEST(test_rays_of_some_pixels_wait_and_come_back)
{
    struct traffic t;

    traffic_init(&t);
    uint32_t hidden = film_branch(&t.film, 3, rgb_of(1, 1, 1), 2);
    const uint32_t pixel[] = { 3, 0, hidden, 0, 3 };
    for (int i = 0; i < 5; i++)
        push_pixel(&t.wave, pixel[i], i);
    park(&t, 2);
    ck_assert_int_eq(t.wave.n, 2);
    ck_assert_double_eq(t.wave.x[0], 1);
    ck_assert_double_eq(t.wave.x[1], 3);
    t.wave.n = 0;
    ck_assert(pop(&t));
    ck_assert_int_eq(t.wave.n, 3);
    for (int i = 0; i < 3; i++)
        ck_assert_double_eq(t.wave.x[i], 2 * i);
    ck_assert_uint_eq(t.wave.pixel[1], hidden);
    ck_assert(!pop(&t));
    traffic_release(&t);
}
END_TEST

START_TEST(test_rays_of_one_pixel_wait_by_their_order)
{
    struct traffic t;

    traffic_init(&t);
    for (int i = 0; i < 7; i++)
        push_pixel(&t.wave, 2, i);
    park(&t, 4);
    ck_assert_int_eq(t.wave.n, 4);
    t.wave.n = 0;
    ck_assert(pop(&t));
    ck_assert_int_eq(t.wave.n, 3);
    ck_assert_double_eq(t.wave.x[0], 4);
    traffic_release(&t);
}
END_TEST

START_TEST(test_what_came_after_parked_rays_is_over_when_they_come_back)
{
    struct surface glass = { 0 };
    struct traffic t;

    traffic_init(&t);
    push_pixel(&t.wave, 0, 0);
    push_pixel(&t.wave, 1, 0);
    uint32_t n = t.insides.n;
    park(&t, 1);
    insides_enter(&t.insides, 0, &glass, 0);
    film_add(&t.film, film_branch(&t.film, 0, rgb_of(1, 1, 1), 2), rgb_of(3, 0, 0));
    t.wave.n = 0;
    ck_assert(pop(&t));
    ck_assert_uint_eq(t.insides.n, n);
    ck_assert_uint_eq(t.film.n, t.film.n_pixel);
    ck_assert_double_eq(t.film.sum[0][0], 9);
    traffic_release(&t);
}
END_TEST

/* ---- whole pictures ---- */

static const struct texture *texture_with(colour c, struct finish finish)
{
    struct pigment *p = arena_copy(&mem, &pigment_default, sizeof *p);
    struct texture *t = arena_copy(&mem, &texture_default, sizeof *t);

    p->colour = c;
    t->pigment = p;
    t->finish = arena_copy(&mem, &finish, sizeof finish);
    return t;
}

static struct object *shape_object(const char *name, struct transform place,
                                   const struct texture *texture)
{
    const struct shape_ops *ops = shape_find(name);
    void *shape = arena_copy(&mem, ops->defaults, ops->size);
    struct object *o = object_new(&mem, OBJECT_SHAPE);

    ck_assert_ptr_null(ops->prepare(shape, &mem));
    o->ops = ops;
    o->shape = shape;
    o->place = arena_copy(&mem, &place, sizeof place);
    o->texture = texture;
    return o;
}

/* Mirrors and glass over a plane, so that waves are deep and mixed. */
static void build_scene(struct scene *s)
{
    unsigned seed = 3;
    struct finish shiny = finish_default;
    struct interior glass = interior_default;

    scene_init(s, &mem);
    s->settings = settings_default;
    s->camera = plain_camera(CAMERA_PERSPECTIVE);
    s->camera.location = vec(0, 1, -5);
    s->has_background = true;
    s->background = (colour) { 0.2f, 0.4f, 0.6f, 0, 0 };
    struct light l = light_default;
    l.centre = vec(4, 8, -6);
    l.colour = rgb_of(1, 1, 1);
    scene_add_light(s, &l);
    shiny.reflection.low = shiny.reflection.high = rgb_of(0.5f, 0.5f, 0.5f);
    shiny.specular = 0.5;
    glass.ior = 1.5;
    scene_add(s, shape_object("plane", transform_identity,
                              texture_with((colour) { .8f, .7f, .6f, 0, 0 }, finish_default)));
    for (int i = 0; i < 40; i++) {
        struct transform move = transform_translate(vec(random_in(&seed, -3, 3),
                                                        random_in(&seed, 0, 3),
                                                        random_in(&seed, 0, 4)));
        struct transform size = transform_scale(vec(.4, .4, .4));
        colour c = { (float)random_in(&seed, 0, 1), .5f, .8f, i % 3 ? 0 : .8f, 0 };
        struct object *o = shape_object("sphere", transform_compose(&move, &size),
                                        texture_with(c, i % 2 ? shiny : finish_default));
        if (i % 3 == 0)
            object_more(&mem, o)->interior = arena_copy(&mem, &glass, sizeof glass);
        scene_add(s, o);
    }
}

struct sheet { float *pixels; unsigned width, rows, stop_at; };

static bool keep_rows(void *arg, unsigned first, unsigned count, const float *pixels)
{
    struct sheet *s = arg;

    ck_assert_uint_eq(first, s->rows);
    memcpy(s->pixels + (size_t)first * s->width * 4, pixels, (size_t)count * s->width * 4 * 4);
    s->rows += count;
    return s->stop_at == 0 || s->rows < s->stop_at;
}

static struct sheet render_part(const struct plan *p, unsigned x, unsigned y, unsigned width,
                                unsigned height, unsigned threads, unsigned stop_at)
{
    struct sheet s = { arena_array(&mem, (size_t)width * height * 4, sizeof(float)), width, 0,
                       stop_at };
    struct render_options o = { .width = 150, .height = 101, .crop_x = x, .crop_y = y,
                                .crop_width = width, .crop_height = height, .samples_side = 2,
                                .threads = threads, .rows = keep_rows, .arg = &s };
    struct render_stats stats;

    ck_assert(render(p, &o, &stats) == (stop_at == 0));
    ck_assert_uint_ge(s.rows, stats.rows_done);
    return s;
}

START_TEST(test_threads_do_not_change_a_bit)
{
    struct scene scene;

    build_scene(&scene);
    struct plan *p = plan_new(&scene, &mem, 1);
    struct sheet one = render_part(p, 0, 0, 150, 101, 1, 0);
    for (unsigned threads = 2; threads < 6; threads++) {
        struct sheet many = render_part(p, 0, 0, 150, 101, threads, 0);
        ck_assert_int_eq(memcmp(one.pixels, many.pixels, 150 * 101 * 4 * sizeof(float)), 0);
    }
}
END_TEST

START_TEST(test_a_cropped_picture_is_a_part_of_the_whole_to_the_bit)
{
    struct scene scene;

    build_scene(&scene);
    struct plan *p = plan_new(&scene, &mem, 1);
    struct sheet whole = render_part(p, 0, 0, 150, 101, 1, 0);
    struct sheet part = render_part(p, 37, 23, 51, 44, 2, 0);
    for (unsigned y = 0; y < 44; y++)
        ck_assert_int_eq(memcmp(part.pixels + (size_t)y * 51 * 4,
                                whole.pixels + ((size_t)(y + 23) * 150 + 37) * 4,
                                51 * 4 * sizeof(float)), 0);
}
END_TEST

START_TEST(test_a_receiver_that_refuses_rows_ends_the_render)
{
    struct scene scene;

    build_scene(&scene);
    struct plan *p = plan_new(&scene, &mem, 1);
    struct sheet part = render_part(p, 0, 0, 150, 101, 3, 30);
    ck_assert_uint_eq(part.rows, 32);
}
END_TEST

START_TEST(test_a_stopped_render_has_whole_rows_only)
{
    struct scene scene;
    const volatile sig_atomic_t stop = 1;
    struct sheet s = { arena_array(&mem, 64 * 64 * 4, sizeof(float)), 64, 0, 0 };
    struct render_options o = { .width = 64, .height = 64, .crop_width = 64, .crop_height = 64,
                                .samples_side = 1, .threads = 2, .stop = &stop, .rows = keep_rows,
                                .arg = &s };
    struct render_stats stats;

    build_scene(&scene);
    ck_assert(!render(plan_new(&scene, &mem, 1), &o, &stats));
    ck_assert_uint_eq(stats.rows_done, s.rows);
}
END_TEST

static void add_tests(TCase *c)
{
    tcase_add_test(c, test_threads_do_not_change_a_bit);
    tcase_add_test(c, test_a_cropped_picture_is_a_part_of_the_whole_to_the_bit);
    tcase_add_test(c, test_a_receiver_that_refuses_rows_ends_the_render);
    tcase_add_test(c, test_a_stopped_render_has_whole_rows_only);
    tcase_add_test(c, test_powers_are_right_to_two_ulps);
    tcase_add_test(c, test_powers_of_nothing_are_nothing);
    tcase_add_test(c, test_perspective_looks_through_the_picture_plane);
    tcase_add_test(c, test_rays_of_every_camera_have_unit_length);
    tcase_add_test(c, test_a_fisheye_sees_nothing_outside_its_circle);
    tcase_add_test(c, test_a_spherical_camera_looks_up_at_the_top_and_back_at_the_side);
    tcase_add_test(c, test_equal_keys_are_a_jump_and_the_first_holds_at_the_key);
    tcase_add_test(c, test_keys_are_single_precision);
    tcase_add_test(c, test_a_picture_has_its_first_row_on_top_and_repeats);
    tcase_add_test(c, test_once_is_clear_outside);
    tcase_add_test(c, test_interpolation_in_the_middle_is_the_mean);
    tcase_add_test(c, test_a_fading_light_has_its_strength_at_its_distance);
    tcase_add_test(c, test_a_spotlight_is_dark_outside_its_cone);
    tcase_add_test(c, test_parallel_light_comes_from_one_side);
    tcase_add_test(c, test_a_power_is_taken_of_the_whole_sum);
    tcase_add_test(c, test_leaving_from_the_middle_keeps_the_others);
    tcase_add_test(c, test_a_wave_keeps_its_rays_as_it_grows);
    tcase_add_test(c, test_rays_of_some_pixels_wait_and_come_back);
    tcase_add_test(c, test_rays_of_one_pixel_wait_by_their_order);
    tcase_add_test(c, test_what_came_after_parked_rays_is_over_when_they_come_back);
}

int main(void)
{
    Suite *s = suite_create("trace");
    TCase *c = tcase_create("shading");
    SRunner *r = srunner_create(s);

    tcase_add_checked_fixture(c, setup, teardown);
    add_tests(c);
    suite_add_tcase(s, c);
    srunner_run_all(r, CK_NORMAL);
    int failed = srunner_ntests_failed(r);
    srunner_free(r);
    return failed ? EXIT_FAILURE : EXIT_SUCCESS;
}
