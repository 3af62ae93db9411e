/* check_math.c: vectors, transforms, polynomials, noise, random streams. */
#include <check.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "math/dd.h"
#include "math/mat.h"
#include "math/noise.h"
#include "math/poly.h"
#include "math/random.h"

static uint32_t state = 1;

static double uniform(double low, double high)
{
    return low + (high - low) * random_next(&state);
}

START_TEST(test_noise_is_that_of_its_tables)
{
    ck_assert_int_eq(noise_hash(vec(0, 0, 0)), 3687);
    ck_assert_int_eq(noise_hash(vec(1, 2, 3)), 560);
    ck_assert_int_eq(noise_hash(vec(-1, -1, -1)), 3535);
    ck_assert_double_eq_tol(noise_random(0), 0.814723692, 1e-9);
    ck_assert_double_eq_tol(noise_random(4095), 0.938243111, 1e-9);
}
END_TEST

/* One line of what POV-Ray printed: quantity, parameters, x, y, z, value. */
static double sample(const char *what, const char *with, vec3 p)
{
    int generator = 2, octaves = 6;
    double lambda = 2, omega = 0.5;
    char axis = 'x';

    sscanf(with, "generator=%d octaves=%d lambda=%lf omega=%lf", &generator, &octaves, &lambda,
           &omega);
    sscanf(with, "component=%c octaves=%d lambda=%lf omega=%lf", &axis, &octaves, &lambda, &omega);
    lambda = (double)(float)lambda;     /* as POV-Ray keeps them */
    omega = (double)(float)omega;
    if (strcmp(what, "noise") == 0)
        return noise_at(generator, p);
    if (strcmp(what, "turbulence") == 0)
        return noise_turbulence(generator, p, octaves, omega, lambda);
    if (strcmp(what, "dnoise") == 0)
        return vec_get(noise_vector(p), axis - 'x');
    if (strcmp(what, "dturbulence") == 0)
        return vec_get(noise_vector_turbulence(p, octaves, omega, lambda), axis - 'x');

    double seed = 0, value = 0;
    int draws = 0;
    ck_assert_int_eq(sscanf(with, "seed=%lf draw=%d", &seed, &draws), 2);
    uint32_t stream = random_seed(seed);
    for (int i = 0; i < draws; i++)
        value = random_next(&stream);
    return value;
}

START_TEST(test_noise_is_that_of_POV_Ray)
{
    const char *folder = getenv("srcdir");
    char path[4096], line[512], what[32], with[128];
    int n = 0;

    snprintf(path, sizeof path, "%s/tests/vectors/noise-samples.tsv", folder ? folder : ".");
    FILE *f = fopen(path, "r");
    ck_assert_msg(f != NULL, "%s", path);
    while (fgets(line, sizeof line, f)) {
        vec3 p = { 0, 0, 0 };
        char number[4][64];
        if (line[0] == '#')
            continue;
        ck_assert_int_eq(sscanf(line, "%31[^\t]\t%127[^\t]\t%63[^\t]\t%63[^\t]\t%63[^\t]\t%63[^\n]",
                                what, with, number[0], number[1], number[2], number[3]), 6);
        p = vec(atof(number[0]), atof(number[1]), atof(number[2]));
        double truth = atof(number[3]), got = sample(what, with, p);
        ck_assert_msg(fabs(got - truth) < 1e-10, "%s got %.13g", line, got);
        n++;
    }
    fclose(f);
    ck_assert_int_gt(n, 300);
}
END_TEST

START_TEST(test_noise_far_away_and_of_nonsense_is_still_a_number)
{
    const double odd[] = { 1e9, -1e9, 1e17, -1e17, 1e300, INFINITY, -INFINITY, NAN };

    for (int i = 0; i < 8; i++)
        for (int g = 1; g <= 3; g++) {
            double v = noise_at(g, vec(odd[i], 0.5, -0.5));
            ck_assert(isnan(v) || (v >= 0 && v <= 1));
        }
}
END_TEST

START_TEST(test_seeds_wrap_around_and_lose_their_fraction)
{
    uint32_t a = random_seed(-1), b = random_seed(42.9), c = random_seed(42);

    ck_assert_double_eq_tol(random_next(&a), 0.5780128735532, 1e-13);
    ck_assert_uint_eq(b, c);
}
END_TEST

START_TEST(test_polynomials_have_the_roots_they_were_made_of)
{
    for (int i = 0; i < 20000; i++) {
        int n = 1 + (int)uniform(0, 5);
        double truth[6], root[POLY_MOST], c[7] = { 1 };
        truth[0] = uniform(-1, 1);
        for (int k = 1; k < n; k++)
            truth[k] = truth[k - 1] + uniform(0.05, 1);
        for (int k = 0; k < n; k++)
            for (int j = k + 1; j >= 0; j--)
                c[j] = (j > 0 ? c[j - 1] : 0) - (j <= k ? truth[k] * c[j] : 0);
        ck_assert_int_eq(poly_roots(n, c, -100, 100, root), n);
        for (int k = 0; k < n; k++)
            ck_assert_double_eq_tol(root[k], truth[k], 1e-9);
    }
}
END_TEST

START_TEST(test_roots_that_are_only_touched_do_not_count)
{
    const double twice[] = { 1, -2, 1 }, thrice[] = { -1, 3, -3, 1 }, none[] = { 1, 0, 1 };
    double root[POLY_MOST];

    ck_assert_int_eq(poly_roots(2, twice, -9, 9, root), 0);
    ck_assert_int_eq(poly_roots(2, none, -9, 9, root), 0);
    ck_assert_int_eq(poly_roots(3, thrice, -9, 9, root), 1);
    ck_assert_double_eq_tol(root[0], 1, 1e-5);
}
END_TEST

START_TEST(test_a_difference_of_products_has_the_right_sign)
{
    for (int i = 0; i < 100000; i++) {
        double a = uniform(1, 2), b = uniform(1, 2), c = a * (1 + 0x1p-52), d = a * b / c;
        __float128 truth = (__float128)a * b - (__float128)c * d;
        double got = difference_of_products(a, b, c, d);
        ck_assert_int_eq((got > 0) - (got < 0), (truth > 0) - (truth < 0));
        ck_assert(fabs(got - (double)truth) <= 2 * 0x1p-53 * fabs((double)truth));
    }
}
END_TEST

START_TEST(test_a_transform_and_its_inverse_cancel)
{
    for (int i = 0; i < 1000; i++) {
        struct transform t = transform_rotate(vec(uniform(-400, 400), uniform(-9, 9), 30));
        struct transform s = transform_scale(vec(uniform(0.1, 9), 2, -1));
        struct transform m = transform_translate(vec(1, uniform(-9, 9), 3));
        t = transform_compose(&s, &t);
        t = transform_compose(&m, &t);
        vec3 p = vec(uniform(-5, 5), uniform(-5, 5), uniform(-5, 5));
        vec3 q = mat_point(&t.from, mat_point(&t.to, p));
        ck_assert_double_lt(vec_largest(vec_sub(p, q)), 1e-12);
    }
}
END_TEST

START_TEST(test_quarter_turns_are_exact)
{
    struct transform t = transform_rotate(vec(90, 0, 0));
    vec3 p = mat_point(&t.to, vec(0, 1, 0));

    ck_assert(p.x == 0 && p.y == 0 && p.z == 1);
}
END_TEST

START_TEST(test_unit_vectors_at_any_scale)
{
    for (int e = -300; e <= 300; e += 10) {
        double s = pow(10, e);
        ck_assert_double_eq_tol(vec_length(vec_unit(vec(s, -2 * s, 3 * s))), 1, 1e-15);
    }
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("math");
    TCase *all = tcase_create("all");

    tcase_add_test(all, test_noise_is_that_of_its_tables);
    tcase_add_test(all, test_noise_is_that_of_POV_Ray);
    tcase_add_test(all, test_noise_far_away_and_of_nonsense_is_still_a_number);
    tcase_add_test(all, test_seeds_wrap_around_and_lose_their_fraction);
    tcase_add_test(all, test_polynomials_have_the_roots_they_were_made_of);
    tcase_add_test(all, test_roots_that_are_only_touched_do_not_count);
    tcase_add_test(all, test_a_difference_of_products_has_the_right_sign);
    tcase_add_test(all, test_a_transform_and_its_inverse_cancel);
    tcase_add_test(all, test_quarter_turns_are_exact);
    tcase_add_test(all, test_unit_vectors_at_any_scale);
    suite_add_tcase(suite, all);

    SRunner *runner = srunner_create(suite);
    srunner_run_all(runner, CK_ENV);
    int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed != 0;
}
