/* png_read.c: PNG pictures in, of every colour type, depth and interlace. */
#include <errno.h>
#include <png.h>
#include <setjmp.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

#include "image/image.h"

enum { SIGNATURE = 8, LARGEST_CHUNK = 8 << 20 };
static const size_t default_pixels = (size_t)1 << 28;
static const double densest = 1032;     /* deflate never does better */

/* All that a read touches, outside the frame that longjmp returns to. */
struct reading {
    struct arena *mem;
    FILE *file;
    png_structp png;
    png_infop info;
    size_t limit;
    struct bitmap *out;
    uint8_t *bytes;                     /* the rows as libpng gives them */
    size_t row_size;
    const char *error;
};

static void on_error(png_structp png, png_const_charp message)
{
    struct reading *r = png_get_error_ptr(png);

    r->error = arena_text(r->mem, message, strlen(message));
    longjmp(png_jmpbuf(png), 1);
}

static void on_warning(png_structp png, png_const_charp message)
{
    (void)png, (void)message;
}

static void on_read(png_structp png, png_bytep to, size_t n)
{
    struct reading *r = png_get_io_ptr(png);

    if (fread(to, 1, n, r->file) != n)
        png_error(png, ferror(r->file) ? strerror(errno) : "truncated");
}

/* A few bytes that claim a huge picture are refused before memory is taken. */
static void check_size(struct reading *r)
{
    double pixels = (double)r->out->width * r->out->height;
    double bytes = (double)png_get_rowbytes(r->png, r->info) * r->out->height;
    struct stat st;

    if (pixels > (double)r->limit)
        png_error(r->png, "the picture has too many pixels");
    if (fstat(fileno(r->file), &st) == 0 && S_ISREG(st.st_mode) &&
        (double)st.st_size * densest < bytes)
        png_error(r->png, "truncated");
}

static void read_facts(struct reading *r)
{
    struct bitmap *b = r->out;

    b->format = BITMAP_PNG;
    b->width = png_get_image_width(r->png, r->info);
    b->height = png_get_image_height(r->png, r->info);
    b->bits = png_get_bit_depth(r->png, r->info) == 16 ? 16 : 8;
    b->has_srgb = png_get_valid(r->png, r->info, PNG_INFO_sRGB) != 0;
    b->has_gamma = png_get_valid(r->png, r->info, PNG_INFO_gAMA) != 0 &&
                   png_get_gAMA(r->png, r->info, &b->gamma) != 0;
    b->is_indexed = png_get_color_type(r->png, r->info) == PNG_COLOR_TYPE_PALETTE;
}

/* Palette numbers stay as they are; the rest becomes 8 or 16 bits a channel,
 * a transparent colour an alpha channel. */
static void choose_transforms(struct reading *r)
{
    bool has_key = png_get_valid(r->png, r->info, PNG_INFO_tRNS) != 0;

    if (r->out->is_indexed)
        png_set_packing(r->png);
    else {
        png_set_expand_gray_1_2_4_to_8(r->png);
        if (has_key)
            png_set_tRNS_to_alpha(r->png);
    }
#if __BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__
    if (r->out->bits == 16)
        png_set_swap(r->png);
#endif
    png_set_interlace_handling(r->png);
    png_read_update_info(r->png, r->info);
}

static void read_rows(struct reading *r)
{
    r->row_size = png_get_rowbytes(r->png, r->info);
    r->bytes = arena_array(r->mem, r->out->height, r->row_size);
    png_bytep *row = arena_array(r->mem, r->out->height, sizeof *row);
    for (unsigned y = 0; y < r->out->height; y++)
        row[y] = r->bytes + y * r->row_size;
    png_read_image(r->png, row);
    png_read_end(r->png, NULL);
}

static void read_palette(struct reading *r)
{
    struct bitmap *b = r->out;
    png_colorp rgb = NULL;
    png_bytep alpha = NULL;
    int n = 0, n_alpha = 0;

    png_get_PLTE(r->png, r->info, &rgb, &n);
    png_get_tRNS(r->png, r->info, &alpha, &n_alpha, NULL);
    b->n_palette = (unsigned)n;
    b->palette = arena_array(r->mem, 256, sizeof *b->palette);  /* numbers beyond it are black */
    for (int i = 0; i < 256; i++)
        b->palette[i][3] = 255;
    for (int i = 0; i < n; i++) {
        b->palette[i][0] = rgb[i].red;
        b->palette[i][1] = rgb[i].green;
        b->palette[i][2] = rgb[i].blue;
        if (i < n_alpha)
            b->palette[i][3] = alpha[i];
    }
    b->channels = n_alpha > 0 ? 4 : 3;
}

static void expand_palette(struct reading *r)
{
    struct bitmap *b = r->out;
    size_t n = (size_t)b->width * b->height;

    b->index = r->bytes;
    b->pixel8 = arena_array(r->mem, n, b->channels);
    for (size_t i = 0; i < n; i++)
        memcpy(b->pixel8 + i * b->channels, b->palette[b->index[i]], b->channels);
}

static void read_picture(struct reading *r)
{
    struct bitmap *b = r->out;

    png_read_info(r->png, r->info);
    read_facts(r);
    check_size(r);
    choose_transforms(r);
    b->channels = png_get_channels(r->png, r->info);
    read_rows(r);
    if (b->is_indexed) {
        read_palette(r);
        expand_palette(r);
    } else if (b->bits == 16)
        b->pixel16 = (uint16_t *)r->bytes;
    else
        b->pixel8 = r->bytes;
}

/* The frame of setjmp: it has no locals, so none can be lost. */
static bool guarded_read(struct reading *r)
{
    if (setjmp(png_jmpbuf(r->png)))
        return false;
    read_picture(r);
    return true;
}

static bool read_with_libpng(struct reading *r)
{
    bool done = false;

    r->png = png_create_read_struct(PNG_LIBPNG_VER_STRING, r, on_error, on_warning);
    if (r->png)
        r->info = png_create_info_struct(r->png);
    if (r->info) {
        png_set_read_fn(r->png, r, on_read);
        png_set_user_limits(r->png, PNG_UINT_31_MAX, PNG_UINT_31_MAX);
        png_set_chunk_malloc_max(r->png, LARGEST_CHUNK);
        done = guarded_read(r);
    } else
        r->error = "out of memory";
    png_destroy_read_struct(&r->png, &r->info, NULL);
    return done;
}

static bool open_picture(struct reading *r, const char *path)
{
    uint8_t start[SIGNATURE];
    struct stat st;

    r->file = fopen(path, "rb");
    if (!r->file)
        r->error = strerror(errno);
    else if (fstat(fileno(r->file), &st) == 0 && S_ISDIR(st.st_mode))
        r->error = "is a folder";
    else if (fread(start, 1, sizeof start, r->file) != sizeof start ||
             png_sig_cmp(start, 0, sizeof start) != 0)
        r->error = "not a PNG file";
    else
        rewind(r->file);
    return !r->error;
}

bool image_read_png(struct arena *mem, const char *path, size_t limit_pixels, struct bitmap *out,
                    const char **error)
{
    struct reading r = { .mem = mem, .out = out,
                         .limit = limit_pixels ? limit_pixels : default_pixels };

    *out = (struct bitmap) { 0 };
    bool done = open_picture(&r, path) && read_with_libpng(&r);
    if (r.file)
        fclose(r.file);
    *error = done ? NULL : r.error;
    return done;
}
