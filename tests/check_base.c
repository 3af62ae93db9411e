/* check_base.c: arenas, names, sources, messages. */
#include <check.h>
#include <stdlib.h>
#include <string.h>

#include "base/diag.h"
#include "base/intern.h"
#include "base/name.h"

static struct arena mem;

static void setup(void) { arena_init(&mem, NULL); }
static void teardown(void) { arena_free(&mem); }

START_TEST(test_an_arena_goes_back_to_a_mark_and_gives_zeros)
{
    struct arena a;
    char *again;

    arena_init(&a, NULL);
    arena_alloc(&a, 100);
    struct arena_mark mark = arena_mark(&a);
    memset(arena_alloc(&a, 1000), 7, 1000);
    memset(arena_alloc(&a, 1 << 20), 7, 1 << 20);
    arena_recycle(&a, mark);
    memset(arena_alloc(&a, 3000), 7, 3000);
    arena_recycle(&a, arena_mark(&a));
    again = arena_alloc(&a, 1 << 19);
    for (int i = 0; i < 1 << 19; i++)
        ck_assert_int_eq(again[i], 0);
    arena_free(&a);
}
END_TEST

/* From small to more than a megabyte, and given back by a mark. */
START_TEST(test_an_array_grows_and_keeps_what_it_holds)
{
    struct budget budget = { .limit = 0 };
    struct arena a;
    size_t room[2] = { 0, 0 };
    uint32_t *item[2] = { NULL, NULL }, wrong = 0;

    arena_init(&a, &budget);
    struct arena_mark mark = arena_mark(&a);
    for (uint32_t i = 0; i < 1 << 20; i++)
        for (int k = 0; k < 2; k++) {
            item[k] = arena_grow(&a, item[k], i, &room[k], sizeof *item[k]);
            wrong |= item[k][i];
            item[k][i] = i * 2 + (uint32_t)k;
        }
    for (uint32_t i = 0; i < 1 << 20; i++)
        for (uint32_t k = 0; k < 2; k++)
            wrong |= item[k][i] ^ (i * 2 + k);
    ck_assert_uint_eq(wrong, 0);
    ck_assert_uint_eq(budget.used, arena_size(&a));
    ck_assert_uint_ge(arena_size(&a), 8 << 20);
    arena_recycle(&a, mark);
    ck_assert_uint_eq(budget.used, arena_size(&a));
    ck_assert_uint_lt(arena_size(&a), 8 << 20);
    arena_free(&a);
    ck_assert_uint_eq(budget.used, 0);
}
END_TEST

/* A small array is copied, a large one moves as it is. */
START_TEST(test_an_array_that_grew_is_taken_without_what_it_does_not_use)
{
    struct budget budget = { .limit = 0 };

    for (uint32_t n = 100; n <= 1000 * 1000; n *= 10000) {
        struct arena from, to;
        size_t room = 0;
        uint32_t *item = NULL, wrong = 0;
        arena_init(&from, &budget);
        arena_init(&to, &budget);
        for (uint32_t i = 0; i < n; i++) {
            item = arena_grow(&from, item, i, &room, sizeof *item);
            item[i] = i + 7;
        }
        item = arena_take(&to, &from, item, n, sizeof *item);
        ck_assert_uint_eq(budget.used, arena_size(&from) + arena_size(&to));
        arena_free(&from);
        for (uint32_t i = 0; i < n; i++)
            wrong |= item[i] ^ (i + 7);
        ck_assert_uint_eq(wrong, 0);
        ck_assert_uint_le(arena_size(&to), n * sizeof *item + (1 << 15));
        arena_free(&to);
        ck_assert_uint_eq(budget.used, 0);
    }
}
END_TEST

START_TEST(test_memory_is_zeroed_and_aligned)
{
    for (size_t size = 1; size < 100000; size = size * 3 + 1) {
        char *p = arena_alloc(&mem, size);
        ck_assert_uint_eq((uintptr_t)p % 16, 0);
        for (size_t i = 0; i < size; i++)
            ck_assert_int_eq(p[i], 0);
        memset(p, 0xff, size);
    }
    ck_assert_uint_eq((uintptr_t)arena_alloc_aligned(&mem, 10, 64) % 64, 0);
}
END_TEST

START_TEST(test_a_budget_counts_what_arenas_hold_and_lets_go)
{
    struct budget budget = { .limit = 0 };
    struct arena a;

    arena_init(&a, &budget);
    arena_alloc(&a, 1000000);
    ck_assert_uint_ge(budget.used, 1000000);
    ck_assert_uint_eq(budget.used, arena_size(&a));
    arena_free(&a);
    ck_assert_uint_eq(budget.used, 0);
}
END_TEST

static void leave(size_t limit) { exit(limit == 100000 ? 4 : 5); }

START_TEST(test_beyond_the_budget_the_handler_is_called)
{
    struct budget budget = { .limit = 100000, .exceeded = leave };
    struct arena a;

    arena_init(&a, &budget);
    for (;;)
        arena_alloc(&a, 1000);
}
END_TEST

START_TEST(test_an_overflowing_array_is_a_limit_and_not_a_small_block)
{
    struct budget budget = { .limit = 100000, .exceeded = leave };
    struct arena a;

    arena_init(&a, &budget);
    arena_array(&a, SIZE_MAX / 4, 8);
}
END_TEST

START_TEST(test_equal_text_is_an_equal_pointer)
{
    struct names t;
    char text[16];

    names_init(&t, &mem);
    struct name *first = name_intern(&t, "sphere", 6);
    for (int i = 0; i < 5000; i++) {
        int n = snprintf(text, sizeof text, "n%d", i);
        ck_assert_ptr_eq(name_intern(&t, text, n), name_intern(&t, text, n));
    }
    ck_assert_ptr_eq(name_intern(&t, "sphere", 6), first);
    ck_assert_ptr_null(name_find(&t, "spher", 5));
    ck_assert_uint_eq(t.n, 5001);
}
END_TEST

START_TEST(test_a_table_with_a_limit_forgets_and_stays_small)
{
    struct intern t = { .most = 100 };

    for (uint64_t i = 0; i < 5000; i++) {
        uint64_t key = i / 2;           /* each comes twice, one after the other */
        const void **value = intern_at(&t, &mem, &key, sizeof key);
        ck_assert_ptr_eq(*value, i % 2 ? (const void *)&t : NULL);
        *value = &t;
    }
    ck_assert_uint_le(t.n, 100);
    ck_assert_uint_le(t.room, 256);
}
END_TEST

static const void *nth(size_t i) { return (const char *)0x7f0000001000 + i * 432; }

/* Keys are mostly pointers, whose lower bits say little. */
START_TEST(test_equal_bytes_have_one_value_and_slots_of_their_own)
{
    struct intern t = { 0 };
    size_t at_home = 0;

    for (size_t i = 0; i < 5000; i++) {
        const void *key[] = { &t, nth(i), NULL };
        const void **value = intern_at(&t, &mem, key, sizeof key);
        ck_assert_ptr_null(*value);
        *value = nth(i);
    }
    for (size_t i = 0; i < 5000; i++) {
        const void *key[] = { &t, nth(i), NULL };
        ck_assert_ptr_eq(*intern_at(&t, &mem, key, sizeof key), nth(i));
    }
    ck_assert_uint_eq(t.n, 5000);
    for (size_t i = 0; i < t.room; i++)
        at_home += t.slot[i].key && (t.slot[i].hash & (t.room - 1)) == i;
    ck_assert_uint_gt(at_home, 3500);
}
END_TEST

START_TEST(test_distance_counts_edits_and_swaps)
{
    ck_assert_uint_eq(name_distance("phong", "phong", 3), 0);
    ck_assert_uint_eq(name_distance("phnog", "phong", 3), 1);
    ck_assert_uint_eq(name_distance("pigmnet", "pigment", 3), 1);
    ck_assert_uint_eq(name_distance("Sphere", "sphere", 3), 1);
    ck_assert_uint_eq(name_distance("box", "sphere", 9), 6);
    ck_assert_uint_eq(name_distance("", "abc", 9), 3);
}
END_TEST

START_TEST(test_every_kind_of_line_end_counts_once)
{
    static const char text[] = "a\nb\r\nc\rd\n\re";
    struct sources s;
    size_t length;

    sources_init(&s, &mem);
    uint32_t n = source_add(&s, "x", text, sizeof text - 1, (struct loc) { 0, 0, 0 });
    for (uint32_t i = 0, line = 1; text[i]; i++)
        if (strchr("abcde", text[i])) {
            struct position p = source_position(&s, n, i);
            ck_assert_uint_eq(p.line, line);
            ck_assert_uint_eq(p.column, 1);
            ck_assert(*source_line(&s, n, line, &length) == text[i] && length == 1);
            line++;
        }
}
END_TEST

START_TEST(test_a_folder_is_no_source)
{
    struct sources s;
    uint32_t n;

    sources_init(&s, &mem);
    ck_assert(!source_read(&s, "/", (struct loc) { 0, 0, 0 }, 0, &n));
    ck_assert(!source_read(&s, "/nonexistent", (struct loc) { 0, 0, 0 }, 0, &n));
}
END_TEST

static char *said(enum diag_style style, void (*speak)(struct diag *, struct loc))
{
    static char text[4096];
    struct sources s;
    struct diag d;
    FILE *f = fmemopen(text, sizeof text, "w");

    sources_init(&s, &mem);
    uint32_t n = source_add(&s, "table.pov", "\n  finish { phnog 0.9 }\n", 23,
                            (struct loc) { 0, 0, 0 });
    diag_init(&d, &s, f);
    d.style = style;
    speak(&d, (struct loc) { n, 12, 17 });
    diag_end(&d);
    fclose(f);
    return text;
}

static void one_error(struct diag *d, struct loc at)
{
    diag_error(d, at, "unknown word '%s'", "phnog");
    diag_note(d, at, "here");
}

START_TEST(test_a_message_has_place_line_and_caret)
{
    ck_assert_str_eq(said(DIAG_FULL, one_error),
                     "table.pov:2:12: error: unknown word 'phnog'\n"
                     "    finish { phnog 0.9 }\n"
                     "             ^~~~~\n"
                     "table.pov:2:12: note: here\n"
                     "    finish { phnog 0.9 }\n"
                     "             ^~~~~\n");
    ck_assert_str_eq(said(DIAG_SHORT, one_error),
                     "table.pov:2:12: error: unknown word 'phnog'\ntable.pov:2:12: note: here\n");
}
END_TEST

START_TEST(test_json_is_one_object_a_message_with_its_notes)
{
    ck_assert_str_eq(said(DIAG_JSON, one_error),
                     "{\"severity\":\"error\",\"file\":\"table.pov\",\"line\":2,\"column\":12,"
                     "\"endLine\":2,\"endColumn\":17,\"message\":\"unknown word 'phnog'\","
                     "\"notes\":[{\"severity\":\"note\",\"file\":\"table.pov\",\"line\":2,"
                     "\"column\":12,\"endLine\":2,\"endColumn\":17,\"message\":\"here\"}]}\n");
}
END_TEST

static void many(struct diag *d, struct loc at)
{
    for (int i = 0; i < 100; i++)
        diag_error(d, (struct loc) { at.source, at.begin, at.end + (uint32_t)i }, "no");
    diag_warning(d, at, "neither");
    ck_assert_uint_eq(d->errors, 100);
    ck_assert(d->full);
}

START_TEST(test_no_more_than_twenty_errors_are_shown)
{
    int lines = 0;

    for (const char *c = said(DIAG_SHORT, many); *c; c++)
        lines += *c == '\n';
    ck_assert_int_eq(lines, 20 + 1);    /* and that there are more */
}
END_TEST

static void warned(struct diag *d, struct loc at)
{
    for (int i = 0; i < 1000; i++)
        diag_warning(d, at, "no %d", i);
}

START_TEST(test_no_more_than_a_hundred_warnings_are_shown)
{
    int lines = 0;

    for (const char *c = said(DIAG_SHORT, warned); *c; c++)
        lines += *c == '\n';
    ck_assert_int_eq(lines, 100 + 1);
}
END_TEST

static void again(struct diag *d, struct loc at)
{
    for (int i = 0; i < 30; i++) {
        diag_error(d, at, "no");
        diag_note(d, at, "here");
        diag_warning(d, at, "careful");
    }
    ck_assert(!d->full);
    diag_error(d, at, "and because of that no");
    diag_error(d, (struct loc) { at.source, at.begin + 1, at.end }, "no");
    diag_error(d, (struct loc) { at.source, at.end, at.end }, "missing }");
    diag_error(d, (struct loc) { at.source, at.end, at.end }, "missing )");
    diag_remark(d, at, "hi");
    diag_remark(d, at, "hi");
    for (int i = 0; i < 900; i++)
        diag_repeat(d);
    ck_assert(!d->full);
    for (int i = 0; i < 200; i++)
        diag_error(d, at, "no");
    ck_assert(d->full);                 /* nobody waits for a loop to make no more of them */
}

START_TEST(test_the_same_at_the_same_place_is_said_once_but_for_remarks)
{
    ck_assert_str_eq(said(DIAG_SHORT, again),
                     "table.pov:2:12: error: no\ntable.pov:2:12: note: here\n"
                     "table.pov:2:12: warning: careful\ntable.pov:2:13: error: no\n"
                     "table.pov:2:17: error: missing }\ntable.pov:2:17: error: missing )\n"
                     "table.pov:2:12: warning: hi\ntable.pov:2:12: warning: hi\n");
}
END_TEST

/* UTF-8, Latin-1, a tab, a NUL, and control characters of both kinds. */
static char *told_of(enum diag_style style, const char *line, size_t size, uint32_t begin)
{
    static char text[4096];
    struct sources s;
    struct diag d;
    FILE *f = fmemopen(text, sizeof text, "w");

    sources_init(&s, &mem);
    uint32_t n = source_add(&s, "a.rt", line, size, (struct loc) { 0, 0, 0 });
    diag_init(&d, &s, f);
    d.style = style;
    diag_error(&d, (struct loc) { n, begin, begin + 3 }, "no '%.3s'", line + begin);
    diag_end(&d);
    fclose(f);
    return text;
}

START_TEST(test_carets_count_characters_and_lines_are_utf8)
{
    static const char line[] = "\t\xc3\xa4\xe4\0\x1b\x9b\xc2\x9b*Q\xc3\xa4*\0";

    ck_assert_str_eq(told_of(DIAG_FULL, line, sizeof line - 2, 10),
                     "a.rt:1:9: error: no 'Q\xc3\xa4'\n"
                     "   \xc3\xa4\xc3\xa4????*Q\xc3\xa4*\n"
                     "          ^~\n");
    ck_assert_str_eq(told_of(DIAG_JSON, line, sizeof line - 2, 10),
                     "{\"severity\":\"error\",\"file\":\"a.rt\",\"line\":1,\"column\":9,"
                     "\"endLine\":1,\"endColumn\":11,\"message\":\"no 'Q\xc3\xa4'\"}\n");
}
END_TEST

START_TEST(test_of_a_long_line_whole_characters_are_shown)
{
    char line[1002];

    for (int i = 0; i < 1000; i += 2)
        memcpy(line + i, "\xc3\xa4", 2);
    line[1000] = line[1001] = '\0';
    const char *shown = strchr(told_of(DIAG_FULL, line, 1000, 501 - 1), '\n') + 3;
    const char *end = strchr(shown, '\n');
    ck_assert(end - shown >= 198 && end - shown <= 202 && (end - shown) % 2 == 0);
    for (; shown < end; shown += 2)
        ck_assert(memcmp(shown, "\xc3\xa4", 2) == 0);
}
END_TEST

static void unsupported(struct diag *d, struct loc at)
{
    diag_unsupported(d, at, "media");
    diag_unsupported(d, at, "media");
    diag_unsupported(d, at, "fog");
}

START_TEST(test_a_missing_feature_is_named_once)
{
    ck_assert_str_eq(said(DIAG_SHORT, unsupported),
                     "table.pov:2:12: warning: media is not supported yet; ignored\n"
                     "table.pov:2:12: warning: fog is not supported yet; ignored\n");
}
END_TEST

int main(void)
{
    Suite *s = suite_create("base");
    TCase *t = tcase_create("base");

    tcase_add_checked_fixture(t, setup, teardown);
    tcase_add_test(t, test_an_arena_goes_back_to_a_mark_and_gives_zeros);
    tcase_add_test(t, test_an_array_grows_and_keeps_what_it_holds);
    tcase_add_test(t, test_an_array_that_grew_is_taken_without_what_it_does_not_use);
    tcase_add_test(t, test_memory_is_zeroed_and_aligned);
    tcase_add_test(t, test_a_budget_counts_what_arenas_hold_and_lets_go);
    tcase_add_exit_test(t, test_beyond_the_budget_the_handler_is_called, 4);
    tcase_add_exit_test(t, test_an_overflowing_array_is_a_limit_and_not_a_small_block, 4);
    tcase_add_test(t, test_equal_text_is_an_equal_pointer);
    tcase_add_test(t, test_a_table_with_a_limit_forgets_and_stays_small);
    tcase_add_test(t, test_equal_bytes_have_one_value_and_slots_of_their_own);
    tcase_add_test(t, test_distance_counts_edits_and_swaps);
    tcase_add_test(t, test_every_kind_of_line_end_counts_once);
    tcase_add_test(t, test_a_folder_is_no_source);
    tcase_add_test(t, test_a_message_has_place_line_and_caret);
    tcase_add_test(t, test_json_is_one_object_a_message_with_its_notes);
    tcase_add_test(t, test_no_more_than_twenty_errors_are_shown);
    tcase_add_test(t, test_no_more_than_a_hundred_warnings_are_shown);
    tcase_add_test(t, test_the_same_at_the_same_place_is_said_once_but_for_remarks);
    tcase_add_test(t, test_carets_count_characters_and_lines_are_utf8);
    tcase_add_test(t, test_of_a_long_line_whole_characters_are_shown);
    tcase_add_test(t, test_a_missing_feature_is_named_once);
    suite_add_tcase(s, t);
    SRunner *r = srunner_create(s);
    srunner_run_all(r, CK_NORMAL);
    int failed = srunner_ntests_failed(r);
    srunner_free(r);
    return failed ? 1 : 0;
}
