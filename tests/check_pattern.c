/* check_pattern.c: what must hold of every pattern, and their values against
 * numbers that POV-Ray printed (tests/vectors/pattern-samples.tsv). */
#include <check.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "pattern/patterns.h"

static struct arena mem;

static void setup(void) { arena_init(&mem, NULL); }
static void teardown(void) { arena_free(&mem); }

static void *member(void *self, const struct field *f) { return (char *)self + f->offset; }

static void *some_pattern(const struct pattern_ops *ops)
{
    void *self = ops->size ? arena_copy(&mem, ops->defaults, ops->size) : NULL;

    if (ops->prepare)
        ck_assert_ptr_null(ops->prepare(self, &mem));
    return self;
}

START_TEST(test_a_row_is_complete)
{
    const struct pattern_ops *ops = patterns[_i];
    ck_assert(ops->name && ops->help && ops->values);
    ck_assert((ops->size > 0) == (ops->defaults != NULL));
    ck_assert(!ops->takes_block || ops->size >= sizeof(struct pattern_block));
    ck_assert(!ops->keeps_point || ops->takes_block);
    ck_assert_ptr_eq(pattern_find(ops->name), ops);
    if (_i > 0)
        ck_assert_int_lt(strcmp(patterns[_i - 1]->name, ops->name), 0);
}
END_TEST

START_TEST(test_a_list_chooses_one_of_its_entries)
{
    const struct pattern_ops *ops = patterns[_i];
    const void *self = some_pattern(ops);
    unsigned seen = 0;

    for (int i = 0; ops->n_list > 0 && i < 20000; i++) {
        double x = (i % 97) / 7.0 - 6, y = (i % 89) / 6.0 - 7, z = (i % 83) / 5.0 - 8, v;
        if (i % 3 == 0)
            x = rint(x), y = rint(y), z = rint(z);
        ops->values(self, 1, &x, &y, &z, &v);
        ck_assert(v == rint(v) && v >= 0 && v < ops->n_list);
        seen |= 1u << (int)v;
    }
    ck_assert_uint_eq(seen, (1u << ops->n_list) - 1);
}
END_TEST

START_TEST(test_odd_points_do_no_harm)
{
    const struct pattern_ops *ops = patterns[_i];
    const void *self = some_pattern(ops);
    static const double odd[] = { 0, -0.0, 1e-300, 1e17, -1e17, 1e308, INFINITY, -INFINITY, NAN };

    for (int i = 0; i < 9 * 9 * 9; i++) {
        double x = odd[i % 9], y = odd[i / 9 % 9], z = odd[i / 81], v;
        ops->values(self, 1, &x, &y, &z, &v);
    }
}
END_TEST

START_TEST(test_an_array_gives_what_its_points_give)
{
    const struct pattern_ops *ops = patterns[_i];
    const void *self = some_pattern(ops);
    enum { N = 133 };
    double x[N], y[N], z[N], all[N], one;

    for (int i = 0; i < N; i++)
        x[i] = sin(i) * 5, y[i] = cos(3 * i) * 5, z[i] = sin(i * i) * 5;
    ops->values(self, N, x, y, z, all);
    for (int i = 0; i < N; i++) {
        ops->values(self, 1, x + i, y + i, z + i, &one);
        ck_assert(one == all[i]);
    }
}
END_TEST

/* ---- against POV-Ray ---- */

enum wave { RAMP, TRIANGLE, SINE, SCALLOP, CUBIC, POLY };

struct setting {
    const struct pattern_ops *ops;
    void *self;
    struct pattern_block block;
    enum wave wave;
    double exponent;
    vec3 scale;
};

static double number(char **text) { return (double)(float)strtod(*text, text); }

static vec3 vector(char **text)
{
    double v[3];

    *text += strspn(*text, " ");
    if (**text == 'x' || **text == 'y' || **text == 'z') {
        char axis = *(*text)++;
        return vec(axis == 'x', axis == 'y', axis == 'z');
    }
    if (**text != '<') {
        v[0] = strtod(*text, text);
        return vec(v[0], v[0], v[0]);
    }
    for (int i = 0; i < 3; i++)
        v[i] = strtod(*text + 1, text);
    (*text)++;
    return vec(v[0], v[1], v[2]);
}

static void read_field(struct setting *s, const struct field *f, char **text)
{
    void *to = member(s->self, f);

    switch (f->type) {
    case FIELD_POINT: *(vec3 *)to = vector(text); break;
    case FIELD_NUM:   *(double *)to = strtod(*text, text); break;
    case FIELD_INT:   *(int *)to = (int)strtod(*text, text); break;
    case FIELD_FLAG:  *(bool *)to = true; break;
    default: ck_abort_msg("a row of a type that this test does not read");
    }
}

static bool read_word(struct setting *s, const char *w, char **text)
{
    static const char *const waves[] = { "ramp_wave", "triangle_wave", "sine_wave",
                                         "scallop_wave", "cubic_wave", "poly_wave" };
    for (int i = 0; i < 6; i++)
        if (strcmp(w, waves[i]) == 0) {
            s->wave = i;
            if (i == POLY)
                s->exponent = number(text);
            return true;
        }
    for (const struct field *f = s->ops->words; f && f->name; f++)
        if (strcmp(w, f->name) == 0) {
            read_field(s, f, text);
            return true;
        }
    if (strcmp(w, "frequency") == 0)
        s->block.frequency = number(text);
    else if (strcmp(w, "phase") == 0)
        s->block.phase = number(text);
    else if (strcmp(w, "octaves") == 0)
        s->block.octaves = (int)number(text);
    else if (strcmp(w, "omega") == 0)
        s->block.omega = number(text);
    else if (strcmp(w, "lambda") == 0)
        s->block.lambda = number(text);
    else if (strcmp(w, "turbulence") == 0)
        s->block.turbulence = vector(text);
    else if (strcmp(w, "scale") == 0 && !strchr(*text, '<'))
        s->scale = vector(text);
    else
        return false;
    return true;
}

/* False: something that is not the pattern's own business. */
static bool read_setting(struct setting *s, const char *pattern, char *text)
{
    static const char *const triangles[] = { "marble", "wood", "spiral1", "spiral2" };
    char w[32];
    int length;

    *s = (struct setting) { .ops = pattern_find(pattern), .block = PATTERN_BLOCK,
                            .scale = { 1, 1, 1 } };
    if (!s->ops)
        return false;
    for (int i = 0; i < 4; i++)
        if (strcmp(pattern, triangles[i]) == 0)
            s->wave = TRIANGLE;
    s->block.frequency = s->ops->n_list > 0 || strcmp(pattern, "quilted") == 0 ? 0 : 1;
    s->self = s->ops->size ? arena_copy(&mem, s->ops->defaults, s->ops->size) : NULL;
    if (strcmp(text, "-") == 0)
        text++;
    for (const struct field *f = s->ops->args; f && f->name; f++)
        read_field(s, f, &text);
    while (sscanf(text, " %31[a-z_0-9]%n", w, &length) == 1) {
        text += length;
        if (!read_word(s, w, &text))
            return false;
    }
    text += strspn(text, " ");
    if (*text)
        return false;
    if (s->ops->takes_block) {
        int generator = ((struct pattern_block *)s->self)->noise_generator;
        s->block.noise_generator = generator;
        memcpy(s->self, &s->block, sizeof s->block);
    }
    return !s->ops->prepare || !s->ops->prepare(s->self, &mem);
}

static double wave_of(const struct setting *s, double v)
{
    switch (s->wave) {
    case RAMP:     return v;
    case TRIANGLE: return triangle(v);
    case SINE:     return (1 + cycle(v)) / 2;
    case SCALLOP:  return fabs(cycle(v / 2));
    case CUBIC:    return v * v * (3 - 2 * v);
    case POLY:     return pow(v, s->exponent);
    }
    return v;
}

static double value_of(const struct setting *s, vec3 p)
{
    const struct pattern_block *b = &s->block;
    double v;

    p = vec(p.x / s->scale.x, p.y / s->scale.y, p.z / s->scale.z);
    if (vec_largest(b->turbulence) > 0 && !s->ops->keeps_point)
        p = vec_add(p, vec_mul(b->turbulence,
                               noise_vector_turbulence(p, b->octaves, b->omega, b->lambda)));
    s->ops->values(s->self, 1, &p.x, &p.y, &p.z, &v);
    if (b->frequency != 0)
        v = fmod(v * b->frequency + b->phase, 1.00001);
    if (v < 0)
        v -= floor(v);
    return wave_of(s, v);
}

START_TEST(test_patterns_are_those_of_POV_Ray)
{
    const char *folder = getenv("srcdir");
    char path[4096], line[1024], pattern[64], options[256], kind[16], n[4][64];
    char last[400] = "";
    struct setting s;
    int checked = 0, settings = 0;
    bool is_ours = false;

    snprintf(path, sizeof path, "%s/tests/vectors/pattern-samples.tsv", folder ? folder : ".");
    FILE *f = fopen(path, "r");
    ck_assert_msg(f != NULL, "%s", path);
    while (fgets(line, sizeof line, f)) {
        if (line[0] == '#')
            continue;
        ck_assert_int_eq(sscanf(line, "%63[^\t]\t%255[^\t]\t%15[^\t]\t%63[^\t]\t%63[^\t]\t%63[^\t]\t%63[^\n]",
                                pattern, options, kind, n[0], n[1], n[2], n[3]), 7);
        char key[400];
        snprintf(key, sizeof key, "%s %s", pattern, options);
        if (strcmp(key, last) != 0) {
            strcpy(last, key);
            is_ours = read_setting(&s, pattern, options);
            settings += is_ours;
            if (!is_ours && getenv("SHOW"))
                printf("not checked: %s\n", key);
        }
        if (!is_ours)
            continue;
        double truth = atof(n[3]), got = value_of(&s, vec(atof(n[0]), atof(n[1]), atof(n[2])));
        ck_assert_msg(fabs(got - truth) < 1e-10, "%s got %.13g", line, got);
        checked++;
    }
    fclose(f);
    if (getenv("SHOW"))
        printf("%d values of %d settings\n", checked, settings);
    ck_assert_int_gt(checked, 1500);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("pattern");
    TCase *all = tcase_create("all");
    int n = 0;

    while (patterns[n])
        n++;
    tcase_add_checked_fixture(all, setup, teardown);
    tcase_add_loop_test(all, test_a_row_is_complete, 0, n);
    tcase_add_loop_test(all, test_a_list_chooses_one_of_its_entries, 0, n);
    tcase_add_loop_test(all, test_odd_points_do_no_harm, 0, n);
    tcase_add_loop_test(all, test_an_array_gives_what_its_points_give, 0, n);
    tcase_add_test(all, test_patterns_are_those_of_POV_Ray);
    suite_add_tcase(suite, all);

    SRunner *runner = srunner_create(suite);
    srunner_run_all(runner, CK_ENV);
    int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed != 0;
}
