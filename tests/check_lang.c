/* check_lang.c: the language through its header: what a text says. */
#include <check.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "lang/lang.h"

/* One run of a text: what it said, and how often it was wrong. */
struct outcome {
    char *said, *messages;
    unsigned errors, warnings;
    bool limit_reached;
};

static struct outcome run_file(const char *path)
{
    struct arena mem, scene_mem, text;
    struct sources sources;
    struct diag diag;
    struct limits limits = LIMITS_DEFAULT;
    struct outcome o = { 0 };
    size_t n, m;
    FILE *debug = open_memstream(&o.said, &n), *messages = open_memstream(&o.messages, &m);

    arena_init(&mem, NULL);
    arena_init(&scene_mem, NULL);
    arena_init(&text, NULL);
    sources_init(&sources, &text);
    diag_init(&diag, &sources, messages);
    limits.iterations = 1e5;
    struct lang_setup setup = { .mem = &mem, .scene_mem = &scene_mem, .sources = &sources,
                                .diag = &diag, .limits = &limits, .width = 4, .height = 4,
                                .debug = debug };
    struct lang *l = lang_new(&setup);
    const struct ast *tree = lang_parse(l, path);
    if (tree)
        lang_build(l, tree);
    o.limit_reached = lang_limit_reached(l);
    lang_free(l);
    diag_end(&diag);
    fclose(debug);
    fclose(messages);
    o.errors = diag.errors;
    o.warnings = diag.warnings;
    arena_free(&mem);
    arena_free(&scene_mem);
    arena_free(&text);
    return o;
}

static struct outcome run(const char *text)
{
    char path[] = "/tmp/check_lang_XXXXXX";
    FILE *f = fdopen(mkstemp(path), "w");

    fputs(text, f);
    fclose(f);
    struct outcome o = run_file(path);
    unlink(path);
    return o;
}

static void outcome_free(struct outcome *o)
{
    free(o->said);
    free(o->messages);
}

/* What an expression's text is; the texts come with str or vstr. */
static void says(const char *text, const char *wanted)
{
    struct outcome o = run(text);

    ck_assert_msg(o.errors == 0, "%s\n%s", text, o.messages);
    ck_assert_str_eq(o.said, wanted);
    outcome_free(&o);
}

static void fails_with(const char *text, const char *part)
{
    struct outcome o = run(text);

    ck_assert_msg(o.errors == 1, "%u errors in %s:\n%s", o.errors, text, o.messages);
    ck_assert_msg(strstr(o.messages, part), "%s\n%s", text, o.messages);
    outcome_free(&o);
}

#define SAY(expression) "#debug concat(" expression ", \"\\n\")\n"

START_TEST(test_signs_bind_tighter_than_products)
{
    says(SAY("str(-2*-3+1,0,0)"), "7\n");
    says(SAY("str((1 | 0 & 0),0,0)"), "0\n");
}
END_TEST

START_TEST(test_a_sign_behind_an_operand_is_an_operator)
{
    says(SAY("vstr(2,<1 -2 3>,\",\",0,0)"), "-1,3\n");
}
END_TEST

START_TEST(test_a_macro_brings_no_parentheses)
{
    says("#macro Sum(A,B) A + B #end\n" SAY("str(Sum(2,3)*10,0,0)"), "32\n");
    says("#macro Sum(A,B) A + B #end\n" SAY("str((Sum(2,3))*10,0,0)"), "50\n");
}
END_TEST

START_TEST(test_a_directive_can_go_on_an_expression)
{
    says(SAY("str((1 #if (1) + 1 #end * 3),0,0)"), "4\n");
}
END_TEST

START_TEST(test_a_name_is_passed_by_reference)
{
    says("#declare A = 1; #macro M(P) #declare P = P + 1; #end M(A) M(A)\n" SAY("str(A,0,0)"),
         "3\n");
    says("#declare A = 1; #macro M(P) #declare P = P + 1; #end M(A+0)\n" SAY("str(A,0,0)"), "1\n");
}
END_TEST

START_TEST(test_a_local_ends_with_its_macro)
{
    says("#macro M() #local L = 1; #end M()\n" SAY("str(defined(L),0,0)"), "0\n");
}
END_TEST

START_TEST(test_an_array_that_is_assigned_is_a_copy)
{
    says("#declare A = array[2] {1,2} #declare B = A; #declare A[0] = 5;\n"
         SAY("str(A[0],0,0), str(B[0],0,0)"), "51\n");
}
END_TEST

START_TEST(test_a_run_of_constants_is_a_list_of_numbers)
{
    says("#declare A = array[20] {0,1,2,3,4,5,6,7,8,9,10,-11,1e1,.5,14,15,16,17,18,19}\n"
         SAY("str(A[11],0,0), str(A[13],0,1), str(A[19],0,0)"), "-110.519\n");
}
END_TEST

START_TEST(test_what_is_skipped_may_be_anything)
{
    says("#if (0) } ) foo ' < = #end\n" SAY("\"a\""), "a\n");
}
END_TEST

START_TEST(test_functions_freeze_numbers)
{
    says("#declare N = 2; #declare F = function(x) { x*N + select(x, 1, 2) }\n#declare N = 9;\n"
         SAY("str(F(3),0,0)"), "8\n");
    says("#declare F = function(x) { sum(i, 1, x, i*i) }\n" SAY("str(F(4),0,0)"), "30\n");
}
END_TEST

START_TEST(test_random_streams_are_those_of_povray)
{
    says("#declare S = seed(0);\n" SAY("str(rand(S),0,10)"), "0.0000028743\n");
}
END_TEST

START_TEST(test_one_mistake_is_one_message)
{
    fails_with("#declare Radius = 1;\nsphere { 0, Raduis }\n", "did you mean 'Radius'?");
    fails_with("#macro M(A) A #end\nsphere { 0, M(1, 2) }\n", "takes 1 argument");
    fails_with("sphere { 0, 1 };\n", "';' cannot stand here");
    fails_with("#declare A = 1 < 2;\n", "parentheses");
    fails_with("sphere { <0, 0, 0, 1 }\n", "missing '>'");
    fails_with("#declare S = \"abc;\n", "closing quote");
    fails_with("#if (1)\n", "this has no '#end'");
    fails_with("#inculde \"x\"\n", "did you mean 'include'?");
}
END_TEST

START_TEST(test_nothing_is_said_after_a_mistake)
{
    struct outcome o = run("#debug \"before\\n\"\nsphere { 0, Nothing }\n#debug \"after\\n\"\n");

    ck_assert_str_eq(o.said, "before\n");
    outcome_free(&o);
}
END_TEST

/* Of text, with a mistake and then directives, and of what POV-Ray writes. */
static void writes(const char *text, const char *said)
{
    struct outcome o = run(text);

    ck_assert_msg(o.errors > 0, "%s", text);
    ck_assert_msg(strcmp(o.said, said) == 0, "%s: %s%s", text, o.said, o.messages);
    outcome_free(&o);
}

#define AFTER "\n#debug \"a\\n\"\n#debug \"b\\n\"\n"

START_TEST(test_directives_in_the_place_of_something_else_are_carried_out)
{
    static const char *const carried_out[] = {
        "#debug", "#include", "#declare A =", "#declare A = 1 +", "#declare A = sphere", "sphere",
        "sphere { 0, 1 pigment", "max_trace_level", "#macro M(X) #end M", "#macro M(X) #end M(",
        "#macro M(X) #end #declare A = M", "#declare A = sin(", "#declare A = <1,", "#switch (1)",
        "#for (I, 1, 2)", "#while (1)", "#fopen F", "#default",
        "#declare F = function { x } #declare G = F",
    }, *const left[] = {
        "#declare", "#declare A", "#undef", "#macro", "#version", "#declare A = array", "(", "foo",
        "#declare A = 1", "sphere { 0, 1 } }", "sphere foo", "#macro M(X) #end M(1", "color_map",
    };
    char text[200];

    for (size_t i = 0; i < sizeof carried_out / sizeof *carried_out; i++) {
        snprintf(text, sizeof text, "%s" AFTER, carried_out[i]);
        writes(text, "a\nb\n");
    }
    for (size_t i = 0; i < sizeof left / sizeof *left; i++) {
        snprintf(text, sizeof text, "%s" AFTER, left[i]);
        writes(text, "");
    }
}
END_TEST

START_TEST(test_a_label_that_belongs_to_nothing_ends_a_macro)
{
    fails_with("#macro M() #else #end\n", "this closes nothing");
    fails_with("#macro M() #case (1) #end\n", "this closes nothing");
    fails_with("#macro M)( #end\n", "#macro takes a name");
    fails_with("sphere { 0, # 1 }\n", "unknown directive");
}
END_TEST

static void reaches_limit(const char *text, const char *part)
{
    struct outcome o = run(text);

    ck_assert(o.limit_reached);
    ck_assert_msg(strstr(o.messages, part), "%s", o.messages);
    outcome_free(&o);
}

static char *repeated(const char *begin, const char *part, int n)
{
    char *text = calloc(strlen(begin) + strlen(part) * (size_t)n + 1, 1), *p = text;

    p = stpcpy(p, begin);
    for (int i = 0; i < n; i++)
        p = stpcpy(p, part);
    return text;
}

START_TEST(test_deep_nesting_is_refused)
{
    static const char *const cases[][2] = {
        { "#declare A = ", "(" }, { "", "union {" }, { "#declare A = ", "-" },
        { "#declare A = 1", "+1" }, { "", "#if (1) " }, { "sphere { ", "<" },
    };

    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char *text = repeated(cases[i][0], cases[i][1], 50000);
        reaches_limit(text, "nested too deeply");
        free(text);
    }
}
END_TEST

START_TEST(test_endless_work_is_refused)
{
    reaches_limit("#while (1) #declare A = 1; #end\n", "loops");
    fails_with("#macro Again(N) Again(N+1) #end Again(1)\n", "macro 'Again'");
    reaches_limit("#declare A = array[1e9];\n", "array");
}
END_TEST

START_TEST(test_files_outside_are_refused)
{
    fails_with("#include \"/etc/passwd\"\n", "--allow-read");
    fails_with("#include \"../etc/passwd\"\n", "--allow-read");
    fails_with("#fopen F \"check_lang_out\" write\n", "--allow-write");
}
END_TEST

/* A text as the language sees it. */
struct reading {
    struct arena mem;
    struct sources sources;
    struct diag diag;
    struct limits limits;
    struct lang *lang;
    char path[32];
};

static void reading_start(struct reading *r, const char *text)
{
    strcpy(r->path, "/tmp/check_lang_XXXXXX");
    FILE *f = fdopen(mkstemp(r->path), "w");

    fputs(text, f);
    fclose(f);
    r->limits = (struct limits) LIMITS_DEFAULT;
    arena_init(&r->mem, NULL);
    sources_init(&r->sources, &r->mem);
    diag_init(&r->diag, &r->sources, stderr);
    struct lang_setup setup = { .mem = &r->mem, .scene_mem = &r->mem, .sources = &r->sources,
                                .diag = &r->diag, .limits = &r->limits };
    r->lang = lang_new(&setup);
}

static void reading_end(struct reading *r)
{
    unlink(r->path);
    lang_free(r->lang);
    arena_free(&r->mem);
}

/* The tree as --dump=ast prints it. */
static char *tree_of(const char *text)
{
    struct reading r;
    char *dump;
    size_t n;
    FILE *f = open_memstream(&dump, &n);

    reading_start(&r, text);
    lang_dump_ast(r.lang, lang_parse(r.lang, r.path), f);
    fclose(f);
    reading_end(&r);
    return dump;
}

/* A form feed behind a brace is white space to the scanner, but more than plain
 * blocks may hold: the same text by way of the grammar. */
static void reads_alike(const char *text)
{
    char *plain = tree_of(text), *copy = strdup(text);

    for (char *c = copy; (c = strstr(c, "{ ")); c += 2)
        c[1] = '\f';
    char *by_grammar = tree_of(copy);
    ck_assert_str_eq(plain, by_grammar);
    free(plain);
    free(copy);
    free(by_grammar);
}

START_TEST(test_a_plain_block_is_what_the_grammar_makes_of_it)
{
    reads_alike("sphere { <1, -2,3>, 0.5 texture { Ball } no_shadow }");
    reads_alike("box { A, B pigment { rgb <1,2,3> filter 0.5 } scale -2 rotate x translate <1,2> }");
    reads_alike("union { sphere { 0 1 } sphere { 0, 1 -1 } object { A scale 2 -3 } }");
    reads_alike("union { sphere { A -1 } sphere { x*2, y } sphere { <1,2,3>*2, 1 } box { A.x B[0] } }");
    reads_alike("spline { 1, 2, 3, 4, 5, 6, 7, 8, 9 } mesh2 { vertex_vectors { 2, <1,2,3>, <1,2,3> } }");
    reads_alike("prism { 9, <1,2>, <1,2>, <1,2>, <1,2>, <1,2>, <1,2>, <1,2>, <1,2>, <1,2> }");
    reads_alike("torus { 1, M(2) } torus { 1, .5 } torus { 1 .5.5 } lathe { 3 <1> <1,2,3,4,5,6> }");
    reads_alike("#declare A = sphere { 0, 1 } sphere { 0, 1 } #declare T = texture { A } texture { B }");
    reads_alike("#if (1) sphere { 0, 1 } #else box { 0, 1 } #end function { sphere { 0 1 } }");
    reads_alike("#macro M(A) sphere { A, 1 } #end light_source { x rgb 1 spotlight on } a { 1 }");
    reads_alike("sphere { 0, 1 sphere { 0, 1 ] } box { 0, 1; } cone { 0 1 } } fog { \"a\" } sky { [0 x] }");
    reads_alike("a { b { c { d { e { f { g { h { i { j { k { 1 } } } } } } } } } } }");
}
END_TEST

START_TEST(test_the_dumped_tree_has_numbers_as_they_were_written)
{
    char *tree = tree_of("#declare A = 3.7 + 0.1 + 1e-300 + 123456789; #declare V = <0.2, 1/3, 7>;");

    ck_assert_ptr_nonnull(strstr(tree, "number 3.7\n"));
    ck_assert_ptr_nonnull(strstr(tree, "number 0.1\n"));
    ck_assert_ptr_nonnull(strstr(tree, "number 1e-300\n"));
    ck_assert_ptr_nonnull(strstr(tree, "number 123456789\n"));
    free(tree);
}
END_TEST

START_TEST(test_equal_looks_are_kept_once)
{
    struct reading r;

    reading_start(&r, "#version 3.7; global_settings { assumed_gamma 1 }"
                  "#macro Ball(I, C) sphere { I*x, 1 pigment { rgb C } finish { ambient 1 } } #end "
                  "Ball(0, 1) Ball(1, 1) Ball(2, 0.5) "
                  "sphere { 0, 1 texture { pigment { rgb 1 } finish { ambient 1 } } } "
                  "object { Ball(3, 1) scale 2 } object { Ball(3, 1) scale 3 } "
                  "#declare P = pigment { rgb <0,1,0> } "
                  "sphere { 0, 1 pigment { rgb <0,0,1> } } sphere { 0, 1 pigment { P scale 2 } }");
    const struct scene *s = lang_read(r.lang, r.path);
    ck_assert_uint_eq(s->n_object, 8);
    ck_assert_ptr_eq(s->listed[0].like->texture, s->listed[1].like->texture);
    ck_assert_ptr_eq(s->listed[0].like->texture, s->listed[3].like->texture);
    ck_assert_ptr_ne(s->listed[0].like->texture, s->listed[2].like->texture);
    ck_assert_ptr_ne(s->listed[4].like->texture, s->listed[5].like->texture);
    ck_assert_float_eq(s->listed[2].like->texture->pigment->colour.r, 0.5f);
    ck_assert_float_eq(s->listed[7].like->texture->pigment->colour.g, 1);
    ck_assert_float_eq(s->listed[7].like->texture->pigment->colour.b, 0);
    reading_end(&r);
}
END_TEST

static Suite *lang_suite(void)
{
    Suite *s = suite_create("lang");
    TCase *t = tcase_create("lang");

    tcase_add_test(t, test_signs_bind_tighter_than_products);
    tcase_add_test(t, test_a_sign_behind_an_operand_is_an_operator);
    tcase_add_test(t, test_a_macro_brings_no_parentheses);
    tcase_add_test(t, test_a_directive_can_go_on_an_expression);
    tcase_add_test(t, test_a_name_is_passed_by_reference);
    tcase_add_test(t, test_a_local_ends_with_its_macro);
    tcase_add_test(t, test_an_array_that_is_assigned_is_a_copy);
    tcase_add_test(t, test_a_run_of_constants_is_a_list_of_numbers);
    tcase_add_test(t, test_what_is_skipped_may_be_anything);
    tcase_add_test(t, test_a_plain_block_is_what_the_grammar_makes_of_it);
    tcase_add_test(t, test_the_dumped_tree_has_numbers_as_they_were_written);
    tcase_add_test(t, test_equal_looks_are_kept_once);
    tcase_add_test(t, test_functions_freeze_numbers);
    tcase_add_test(t, test_random_streams_are_those_of_povray);
    tcase_add_test(t, test_one_mistake_is_one_message);
    tcase_add_test(t, test_nothing_is_said_after_a_mistake);
    tcase_add_test(t, test_directives_in_the_place_of_something_else_are_carried_out);
    tcase_add_test(t, test_a_label_that_belongs_to_nothing_ends_a_macro);
    tcase_add_test(t, test_deep_nesting_is_refused);
    tcase_add_test(t, test_endless_work_is_refused);
    tcase_add_test(t, test_files_outside_are_refused);
    suite_add_tcase(s, t);
    return s;
}

int main(void)
{
    SRunner *r = srunner_create(lang_suite());

    srunner_run_all(r, CK_NORMAL);
    int failed = srunner_ntests_failed(r);
    srunner_free(r);
    return failed ? EXIT_FAILURE : EXIT_SUCCESS;
}
