/* check_image.c: picture files in and out. */
#include <check.h>
#include <fcntl.h>
#include <math.h>
#include <png.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "image/image.h"
#include "image/tone.h"

static struct arena mem;
static char folder[] = "/tmp/check_image.XXXXXX";

static void setup(void)
{
    strcpy(folder + strlen(folder) - 6, "XXXXXX");
    ck_assert_ptr_nonnull(mkdtemp(folder));
    arena_init(&mem, NULL);
}

static void teardown(void)
{
    char command[64];

    arena_free(&mem);
    snprintf(command, sizeof command, "rm -rf %s", folder);
    ck_assert_int_eq(system(command), 0);
}

static const char *path(const char *name)
{
    return arena_format(&mem, "%s/%s", folder, name);
}

static void put(const char *file, const void *bytes, size_t n)
{
    FILE *f = fopen(file, "wb");

    ck_assert_ptr_nonnull(f);
    ck_assert_uint_eq(fwrite(bytes, 1, n, f), n);
    fclose(f);
}

static uint8_t *get(const char *file, size_t *n)
{
    FILE *f = fopen(file, "rb");
    uint8_t *bytes = arena_alloc(&mem, 1 << 20);

    ck_assert_ptr_nonnull(f);
    *n = fread(bytes, 1, 1 << 20, f);
    fclose(f);
    return bytes;
}

/* A file as another program would write it: any type, depth and interlace. */
struct form { int type, depth, interlace, channels; };
static const struct form forms[] = {
    { PNG_COLOR_TYPE_GRAY, 1, 0, 1 },       { PNG_COLOR_TYPE_GRAY, 2, 1, 1 },
    { PNG_COLOR_TYPE_GRAY, 4, 0, 1 },       { PNG_COLOR_TYPE_GRAY, 8, 1, 1 },
    { PNG_COLOR_TYPE_GRAY, 16, 0, 1 },      { PNG_COLOR_TYPE_GRAY_ALPHA, 8, 0, 2 },
    { PNG_COLOR_TYPE_GRAY_ALPHA, 16, 1, 2 }, { PNG_COLOR_TYPE_RGB, 8, 0, 3 },
    { PNG_COLOR_TYPE_RGB, 16, 1, 3 },       { PNG_COLOR_TYPE_RGB_ALPHA, 8, 1, 4 },
    { PNG_COLOR_TYPE_RGB_ALPHA, 16, 0, 4 }, { PNG_COLOR_TYPE_PALETTE, 1, 0, 1 },
    { PNG_COLOR_TYPE_PALETTE, 2, 1, 1 },    { PNG_COLOR_TYPE_PALETTE, 4, 0, 1 },
    { PNG_COLOR_TYPE_PALETTE, 8, 1, 1 },
};
enum { N_FORMS = sizeof forms / sizeof *forms, WIDE = 13, HIGH = 7 };

/* Sample k of pixel (x, y), within the depth. */
static unsigned sample_of(const struct form *f, unsigned x, unsigned y, unsigned k)
{
    return (x * 7 + y * 31 + k * 101 + x * y * 1009) & ((1u << f->depth) - 1);
}

static void put_sample(uint8_t *row, const struct form *f, unsigned i, unsigned value)
{
    unsigned bit = i * (unsigned)f->depth;

    if (f->depth == 16) {
        row[2 * i] = (uint8_t)(value >> 8);
        row[2 * i + 1] = (uint8_t)value;
    } else
        row[bit / 8] |= (uint8_t)(value << (8 - f->depth - (int)(bit % 8)));
}

static void write_form(const char *file, const struct form *f)
{
    FILE *out = fopen(file, "wb");
    png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, NULL, NULL, NULL);
    png_infop info = png_create_info_struct(png);
    png_color palette[256];
    uint8_t rows[HIGH][WIDE * 8] = { { 0 } }, *row[HIGH];

    png_init_io(png, out);
    png_set_IHDR(png, info, WIDE, HIGH, f->depth, f->type,
                 f->interlace ? PNG_INTERLACE_ADAM7 : PNG_INTERLACE_NONE, 0, 0);
    for (int i = 0; i < 256; i++)
        palette[i] = (png_color) { (uint8_t)(i * 3), (uint8_t)(255 - i), (uint8_t)(i * 5) };
    if (f->type == PNG_COLOR_TYPE_PALETTE)
        png_set_PLTE(png, info, palette, 1 << f->depth);
    png_set_gAMA(png, info, 0.5);
    for (unsigned y = 0; y < HIGH; y++) {
        row[y] = rows[y];
        for (unsigned x = 0; x < WIDE; x++)
            for (unsigned k = 0; k < (unsigned)f->channels; k++)
                put_sample(rows[y], f, x * (unsigned)f->channels + k, sample_of(f, x, y, k));
    }
    png_set_rows(png, info, row);
    png_write_png(png, info, PNG_TRANSFORM_IDENTITY, NULL);
    png_destroy_write_struct(&png, &info);
    fclose(out);
}

START_TEST(test_every_colour_type_and_depth_is_read)
{
    const struct form *f = &forms[_i];
    const char *file = path("form.png"), *error;
    struct bitmap b;

    write_form(file, f);
    ck_assert_msg(image_read_png(&mem, file, 0, &b, &error), "%s", error);
    ck_assert(b.width == WIDE && b.height == HIGH && b.has_gamma && !b.has_srgb);
    ck_assert_double_eq_tol(b.gamma, 0.5, 1e-5);
    for (unsigned y = 0; y < HIGH; y++)
        for (unsigned x = 0; x < WIDE; x++)
            for (unsigned k = 0; k < (unsigned)f->channels; k++) {
                unsigned s = sample_of(f, x, y, k);
                if (f->type == PNG_COLOR_TYPE_PALETTE) {
                    ck_assert_uint_eq(b.index[y * WIDE + x], s);
                    ck_assert_float_eq(bitmap_sample(&b, x, y, 1), (255 - (float)s) / 255);
                } else
                    ck_assert_float_eq_tol(bitmap_sample(&b, x, y, k),
                                           (float)s / (float)((1 << f->depth) - 1), 1e-6f);
            }
}
END_TEST

/* Every shorter file is an error with words, never a crash. */
START_TEST(test_a_truncated_file_is_an_error)
{
    const char *file = path("form.png"), *cut = path("cut.png"), *error;
    struct bitmap b;
    size_t n;

    write_form(file, &forms[_i]);
    uint8_t *bytes = get(file, &n);
    for (size_t k = 0; k < n; k++) {
        put(cut, bytes, k);
        ck_assert_msg(!image_read_png(&mem, cut, 0, &b, &error), "%zu of %zu bytes", k, n);
        ck_assert_ptr_nonnull(error);
    }
}
END_TEST

START_TEST(test_a_corrupt_file_never_crashes)
{
    const char *file = path("form.png"), *bad = path("bad.png"), *error;
    struct bitmap b;
    size_t n;

    srand(7);
    write_form(file, &forms[_i]);
    uint8_t *bytes = get(file, &n);
    for (int k = 0; k < 300; k++) {
        uint8_t *copy = arena_copy(&mem, bytes, n);
        for (int j = 0; j < 3; j++)
            copy[(size_t)rand() % n] = (uint8_t)rand();
        put(bad, copy, n);
        if (!image_read_png(&mem, bad, 0, &b, &error))
            ck_assert_ptr_nonnull(error);
    }
}
END_TEST

/* A header that claims 10^9 pixels a side costs no memory. */
START_TEST(test_a_small_file_cannot_claim_a_huge_picture)
{
    uint8_t bytes[] = "\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\0\x40\0\0\0\x3f\xff\x08\x02\0\0\0";
    const char *file = path("huge.png"), *error;
    uint8_t chunk[33 + 12];
    struct bitmap b;

    memcpy(chunk, bytes, 29);
    uint32_t crc = (uint32_t)0xffffffff;
    for (int i = 12; i < 29; i++) {
        crc ^= chunk[i];
        for (int k = 0; k < 8; k++)
            crc = crc >> 1 ^ (crc & 1 ? 0xedb88320u : 0);
    }
    crc = ~crc;
    for (int i = 0; i < 4; i++)
        chunk[29 + i] = (uint8_t)(crc >> (24 - 8 * i));
    memcpy(chunk + 33, "\0\0\0\0IDAT\x35\xaf\x06\x1e", 12);
    put(file, chunk, sizeof chunk);
    ck_assert(!image_read_png(&mem, file, 0, &b, &error));
    ck_assert_uint_lt(arena_size(&mem), 8 << 20);
    ck_assert_str_eq(error, "truncated");
}
END_TEST

START_TEST(test_what_is_no_picture_is_an_error)
{
    const char *error;
    struct bitmap b;

    put(path("text.png"), "not a picture at all", 20);
    ck_assert(!image_read_png(&mem, path("text.png"), 0, &b, &error));
    ck_assert_str_eq(error, "not a PNG file");
    ck_assert(!image_read_png(&mem, folder, 0, &b, &error));
    ck_assert_str_eq(error, "is a folder");
    ck_assert(!image_read_png(&mem, path("nothing.png"), 0, &b, &error));
    write_form(path("form.png"), &forms[0]);
    ck_assert(!image_read_png(&mem, path("form.png"), WIDE * HIGH - 1, &b, &error));
    ck_assert_str_eq(error, "the picture has too many pixels");
}
END_TEST

/* Rows of 4 floats that cover 0..1 and beyond. */
static float *some_pixels(unsigned n)
{
    float *p = arena_array(&mem, n, 4 * sizeof *p);

    srand(3);
    for (unsigned i = 0; i < 4 * n; i++)
        p[i] = (float)rand() / (float)RAND_MAX * 1.2f - 0.1f;
    return p;
}

static void write_picture(const char *file, unsigned bits, bool alpha, struct tone tone,
                          const float *pixels)
{
    const char *error;
    struct png_writer *w = png_open(file, WIDE, HIGH, bits, alpha, tone, &error);

    ck_assert_msg(w != NULL, "%s", error);
    ck_assert(png_rows(w, 3, pixels, &error));
    ck_assert(png_rows(w, HIGH - 3, pixels + 3 * WIDE * 4, &error));
    ck_assert(png_close(w, true, &error));
}

static const struct tone tones[] = {
    { .working = TONE_RAW }, { .working = TONE_LINEAR }, { .working = TONE_POWER, .gamma = 2.2 },
    { .working = TONE_POWER, .gamma = 0.5 }, { .working = TONE_SRGB },
};
enum { N_TONES = sizeof tones / sizeof *tones };

START_TEST(test_what_is_written_is_read_back)
{
    const float *p = some_pixels(WIDE * HIGH);
    const char *error, *file = path("out.png");
    struct bitmap b;

    for (unsigned bits = 8; bits <= 16; bits += 8) {
        unsigned top = (1u << bits) - 1;
        write_picture(file, bits, false, tones[_i], p);
        ck_assert(image_read_png(&mem, file, 0, &b, &error));
        ck_assert(b.has_srgb && b.has_gamma && b.bits == bits && b.channels == 3);
        ck_assert_double_eq_tol(b.gamma, 0.45455, 1e-9);
        for (unsigned i = 0; i < WIDE * HIGH * 3; i++) {
            unsigned want = tone_level(tone_encode(&tones[_i], p[i / 3 * 4 + i % 3]), top);
            ck_assert_uint_eq(bits == 8 ? b.pixel8[i] : b.pixel16[i], want);
        }
    }
}
END_TEST

START_TEST(test_equal_pictures_are_equal_files)
{
    const float *p = some_pixels(WIDE * HIGH);
    size_t n, m;

    write_picture(path("a.png"), 8, true, tones[1], p);
    write_picture(path("b.png"), 8, true, tones[1], p);
    uint8_t *a = get(path("a.png"), &n), *b = get(path("b.png"), &m);
    ck_assert_uint_eq(n, m);
    ck_assert_int_eq(memcmp(a, b, n), 0);
}
END_TEST

/* Facts shading.md 5.3: colour is divided by alpha; brightness makes opaque. */
START_TEST(test_alpha_is_not_multiplied_in)
{
    float p[WIDE * HIGH * 4] = { 0.1f, 0.2f, 0.05f, 0.5f,   0, 0, 0, 1,   0.9f, 0.9f, 0.9f, 0.75f };
    const uint8_t want[] = { 51, 102, 26, 128,   0, 0, 0, 0,   255, 255, 255, 230 };
    const char *error;
    struct bitmap b;

    write_picture(path("a.png"), 8, true, tones[0], p);
    ck_assert(image_read_png(&mem, path("a.png"), 0, &b, &error));
    for (unsigned i = 0; i < sizeof want; i++)
        ck_assert_uint_eq(b.pixel8[i], want[i]);
}
END_TEST

/* The table against the function: random floats, and all near each step. */
START_TEST(test_the_table_of_levels_is_exact)
{
    struct tone_table table;

    tone_table_init(&table, &tones[_i]);
    srand(11);
    for (int i = 0; i < 300000; i++) {
        float x = ldexpf((float)rand() / (float)RAND_MAX, rand() % 30 - 25);
        ck_assert_uint_eq(tone_table_level(&table, x), tone_level(tone_encode(&tones[_i], x), 255));
    }
    for (unsigned level = 1; level < 256; level++) {
        float x = table.least[level];
        for (int i = 0; i < 40; i++)
            x = nextafterf(x, 0);
        for (int i = 0; i < 80; i++, x = nextafterf(x, 2))
            ck_assert_uint_eq(tone_table_level(&table, x),
                              tone_level(tone_encode(&tones[_i], x), 255));
    }
    const float odd[] = { NAN, -1, -0.0f, 0, 1e-40f, 0.99999994f, 1, 1e30f, INFINITY, -INFINITY };
    for (unsigned i = 0; i < sizeof odd / sizeof *odd; i++)
        ck_assert_uint_eq(tone_table_level(&table, odd[i]),
                          tone_level(tone_encode(&tones[_i], odd[i]), 255));
}
END_TEST

START_TEST(test_srgb_has_the_known_levels)
{
    ck_assert_uint_eq(tone_level(tone_encode(&tones[1], 0.5f), 255), 188);
    ck_assert_uint_eq(tone_level(tone_encode(&tones[1], 0.002f), 255), 7);
    ck_assert_uint_eq(tone_level(tone_encode(&tones[0], 0.5f), 255), 128);
    ck_assert_uint_eq(tone_level(tone_encode(&tones[2], 0.5f), 255), 128);
}
END_TEST

START_TEST(test_an_older_picture_stays_until_the_new_one_is_whole)
{
    const float *p = some_pixels(WIDE * HIGH);
    const char *file = path("old.png"), *error;
    size_t n;

    put(file, "older", 5);
    struct png_writer *w = png_open(file, WIDE, HIGH, 8, false, tones[1], &error);
    ck_assert(png_rows(w, 2, p, &error));
    ck_assert_str_eq((char *)get(file, &n), "older");
    char *temporary = arena_format(&mem, "%s", png_temporary(w));
    ck_assert_int_eq(access(temporary, F_OK), 0);
    ck_assert(png_close(w, false, &error));
    ck_assert_str_eq((char *)get(file, &n), "older");
    ck_assert_int_ne(access(temporary, F_OK), 0);
}
END_TEST

START_TEST(test_missing_rows_are_black)
{
    const float *p = some_pixels(WIDE * HIGH);
    const char *file = path("part.png"), *error;
    struct bitmap b;

    struct png_writer *w = png_open(file, WIDE, HIGH, 8, false, tones[0], &error);
    ck_assert(png_rows(w, 2, p, &error));
    ck_assert(png_close(w, true, &error));
    ck_assert(image_read_png(&mem, file, 0, &b, &error));
    ck_assert_uint_eq(b.height, HIGH);
    for (unsigned i = WIDE * 2 * 3; i < WIDE * HIGH * 3; i++)
        ck_assert_uint_eq(b.pixel8[i], 0);
}
END_TEST

START_TEST(test_a_full_disk_is_an_error)
{
    const float *p = some_pixels(WIDE * HIGH);
    const char *error;

    if (access("/dev/full", W_OK) != 0)
        return;
    struct png_writer *w = png_open("/dev/full", WIDE, HIGH, 8, false, tones[0], &error);
    if (w) {
        png_rows(w, HIGH, p, &error);
        ck_assert(!png_close(w, true, &error));
    }
    ck_assert_str_eq(error, "No space left on device");
    ck_assert_int_eq(access("/dev/full", W_OK), 0);
}
END_TEST

START_TEST(test_a_folder_is_no_target)
{
    const char *error;

    ck_assert_ptr_null(png_open(folder, WIDE, HIGH, 8, false, tones[0], &error));
    ck_assert_str_eq(error, "Is a directory");
    ck_assert_ptr_null(png_open(path("none/x.png"), WIDE, HIGH, 8, false, tones[0], &error));
    ck_assert_str_eq(error, "No such file or directory");
}
END_TEST

/* The mode is what open() gives, or the older picture's. */
START_TEST(test_the_mode_of_the_file_is_usual)
{
    const float *p = some_pixels(WIDE * HIGH);
    struct stat st;

    umask(022);
    write_picture(path("new.png"), 8, false, tones[0], p);
    ck_assert_int_eq(stat(path("new.png"), &st), 0);
    ck_assert_uint_eq(st.st_mode & 0777, 0644);
    chmod(path("new.png"), 0600);
    write_picture(path("new.png"), 8, false, tones[0], p);
    ck_assert_int_eq(stat(path("new.png"), &st), 0);
    ck_assert_uint_eq(st.st_mode & 0777, 0600);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("image");
    TCase *c = tcase_create("png");

    tcase_add_checked_fixture(c, setup, teardown);
    tcase_add_loop_test(c, test_every_colour_type_and_depth_is_read, 0, N_FORMS);
    tcase_add_loop_test(c, test_a_truncated_file_is_an_error, 0, N_FORMS);
    tcase_add_loop_test(c, test_a_corrupt_file_never_crashes, 0, N_FORMS);
    tcase_add_test(c, test_a_small_file_cannot_claim_a_huge_picture);
    tcase_add_test(c, test_what_is_no_picture_is_an_error);
    tcase_add_loop_test(c, test_what_is_written_is_read_back, 0, N_TONES);
    tcase_add_test(c, test_equal_pictures_are_equal_files);
    tcase_add_test(c, test_alpha_is_not_multiplied_in);
    tcase_add_loop_test(c, test_the_table_of_levels_is_exact, 0, N_TONES);
    tcase_add_test(c, test_srgb_has_the_known_levels);
    tcase_add_test(c, test_an_older_picture_stays_until_the_new_one_is_whole);
    tcase_add_test(c, test_missing_rows_are_black);
    tcase_add_test(c, test_a_full_disk_is_an_error);
    tcase_add_test(c, test_a_folder_is_no_target);
    tcase_add_test(c, test_the_mode_of_the_file_is_usual);
    tcase_set_timeout(c, 60);
    suite_add_tcase(suite, c);
    SRunner *runner = srunner_create(suite);
    srunner_run_all(runner, CK_ENV);
    int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed != 0;
}
