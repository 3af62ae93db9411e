/* build_image.c: image_map { } and the other blocks that begin with a picture. */
#include <string.h>

#include "lang/build.h"
#include "lang/code.h"
#include "lang/function.h"

const struct field image_types[] = {
    { "gif", FIELD_CUSTOM, 0, ANY, "a GIF file" }, { "tga", FIELD_CUSTOM, 0, ANY, "a Targa file" },
    { "png", FIELD_CUSTOM, 0, ANY, "a PNG file" }, { "jpeg", FIELD_CUSTOM, 0, ANY, "a JPEG file" },
    { "ppm", FIELD_CUSTOM, 0, ANY, "a PPM file" }, { "pgm", FIELD_CUSTOM, 0, ANY, "a PGM file" },
    { "pot", FIELD_CUSTOM, 0, ANY, "a Potfile" }, { "iff", FIELD_CUSTOM, 0, ANY, "an IFF file" },
    { "sys", FIELD_CUSTOM, 0, ANY, "the system's own kind of picture" },
    { "tiff", FIELD_CUSTOM, 0, ANY, "a TIFF file" }, { "bmp", FIELD_CUSTOM, 0, ANY, "a BMP file" },
    { "exr", FIELD_CUSTOM, 0, ANY, "an OpenEXR file" },
    { "hdr", FIELD_CUSTOM, 0, ANY, "a Radiance file" },
    FIELD_END,
};

#define MEMBER(m) offsetof(struct image_use, m)

const struct field image_fields[] = {
    { "map_type", FIELD_INT, MEMBER(map_type), ANY, "0 flat, 1 sphere, 2 cylinder, 5 torus" },
    { "interpolate", FIELD_INT, MEMBER(interpolate), ANY, "2 bilinear, 3 bicubic, 4 by distance" },
    { "once", FIELD_FLAG, MEMBER(once), ANY, "nothing outside of the picture" },
    { "repeat", FIELD_CUSTOM, 0, ANY, "how often in each direction" },
    { "offset", FIELD_CUSTOM, 0, ANY, "moves the picture" },
    { "use_color", FIELD_CUSTOM, 0, ANY, "colours, not palette numbers" },
    { "use_colour", FIELD_CUSTOM, 0, ANY, "colours, not palette numbers" },
    { "use_index", FIELD_CUSTOM, 0, ANY, "palette numbers" },
    { "use_alpha", FIELD_CUSTOM, 0, ANY, "transparency" },
    { "filter", FIELD_CUSTOM, 0, ANY, "all F, or palette number and F" },
    { "transmit", FIELD_CUSTOM, 0, ANY, "all F, or palette number and F" },
    { "all", FIELD_CUSTOM, 0, ANY, "every colour" },
    { "gamma", FIELD_CUSTOM, 0, ANY, "how the file is encoded" },
    { "premultiplied", FIELD_CUSTOM, 0, ANY, "colours hold their opacity already" },
    { "bump_size", FIELD_CUSTOM, 0, ANY, "how high bumps are" },
    FIELD_END,
};

struct source_file {
    struct loc at;
    const char *name, *type;
    double gamma;
    bool premultiplied;
    struct drawn drawn;
};

enum { MOST_PALETTE_WORDS = 1024 };

struct reading {
    struct source_file file;
    struct image_use *use;
    struct image_palette *palette;
    size_t n_palette, room_palette;
    const char *unsupported;
};

/* --- where the picture comes from ------------------------------------------------- */

enum { MOST_SIDE = 32768 };             /* pixels of a picture by a function */

static unsigned read_side(struct reader *r, bool comma)
{
    if (comma)
        reader_skip_comma(r);
    struct loc at = reader_at(r);
    double n = reader_number(r, false, "width and height of the function's picture");
    if (n >= 1 && n <= MOST_SIDE)
        return (unsigned)n;
    diag_error(r->lang->diag, at, "a picture by a function has 1 to %d pixels a side", MOST_SIDE);
    return 1;
}

/* The braces behind the size are a function's body. */
bool build_drawn(struct reader *r, struct drawn *d)
{
    struct ast body = { .kind = AST_FUNCTION };
    struct value v;

    if (!reader_takes_word(r, "function"))
        return false;
    d->width = read_side(r, false);
    d->height = read_side(r, true);
    struct item i = reader_next(r);
    if (i.kind != ITEM_BRACES) {
        diag_error(r->lang->diag, i.at, "expected { } with a function; found %s",
                   item_describe(r->lang, &i));
        return true;
    }
    body.at = i.at;
    body.body = (struct ast *)i.body;
    if (function_make(r->lang, &body, &v))
        d->function = v.thing;
    return true;
}

static float in_16_bits(double v)
{
    return (float)(floor(fmin(fmax(v, 0), 1) * 65535) / 65535);
}

static colour drawn_pixel(struct lang *l, const struct function *f, const double at[3])
{
    double v[MOST_COMPONENTS];

    function_run_counted(l, f->at, f, at, v);
    float g = in_16_bits(v[0]);
    if (function_components(f) == 1)
        return (colour) { g, g, g, 0, 0 };
    return (colour) { g, in_16_bits(v[1]), in_16_bits(v[2]), 0, 1 - in_16_bits(1 - v[4]) };
}

/* Facts patterns.md 6.6: y grows downwards, and 16 bits are kept. */
static const struct image *draw(struct lang *l, const struct drawn *d)
{
    struct image *to = arena_alloc(l->scene_mem, sizeof *to);
    double step_x = d->width > 1 ? 1.0 / (d->width - 1) : 0;
    double step_y = d->height > 1 ? 1.0 / (d->height - 1) : 0;

    to->width = d->width;
    to->height = d->height;
    to->pixel = arena_array(l->scene_mem, (size_t)d->width * d->height, sizeof *to->pixel);
    for (unsigned y = 0; y < d->height && !l->stopped; y++)
        for (unsigned x = 0; x < d->width && !l->stopped; x++) {
            double at[3] = { x * step_x, y * step_y, 0 };
            colour c = drawn_pixel(l, d->function, at);
            to->pixel[(size_t)y * d->width + x] = c;
            to->has_transparency |= c.t > 0;
        }
    return to;
}

static void read_source(struct reader *r, struct source_file *f)
{
    if (build_drawn(r, &f->drawn))
        return;
    const struct item *i = reader_peek(r);
    if (i->kind == ITEM_WORD && field_find(image_types, i->word->text))
        f->type = reader_next(r).word->text;
    f->at = reader_at(r);
    f->name = reader_text(r, false, "picture file");
    if (!*f->name && !r->failed)
        diag_error(r->lang->diag, f->at, "a picture's name cannot be empty");
    if (reader_takes_word(r, "gamma"))
        f->gamma = reader_takes_word(r, "srgb") ? -1 : reader_number(r, false, "gamma");
    if (reader_takes_word(r, "premultiplied"))
        f->premultiplied = build_flag(r);
}

/* --- items -------------------------------------------------------------------------- */

static struct image_palette *add_palette(struct lang *l, struct reading *w)
{
    w->palette = arena_grow(l->mem, w->palette, w->n_palette, &w->room_palette, sizeof *w->palette);
    w->palette[w->n_palette] = (struct image_palette) { -1, -1, -1 };
    return &w->palette[w->n_palette++];
}

static void read_transparency(struct reader *r, struct reading *w, const char *word)
{
    struct image_palette *p = add_palette(r->lang, w);

    if (!reader_takes_word(r, "all"))
        p->entry = reader_whole(r, false, word);
    float x = (float)reader_number(r, true, word);
    if (strcmp(word, "filter") == 0)
        p->filter = x;
    else
        p->transmit = x;
}

static void read_shift(struct reader *r, struct reading *w, const char *word)
{
    double v[2] = { 0, 0 }, neutral = strcmp(word, "repeat") == 0 ? 1 : 0;

    reader_vector(r, false, 2, v, word);
    if (v[0] != neutral || v[1] != neutral)
        w->unsupported = arena_format(r->lang->mem, "%s in image_map", word);
}

static bool read_item(struct reader *r, struct reading *w, const struct item *i, const char *block)
{
    bool map = strcmp(block, "image_map") == 0;

    if (item_is_block(i, "texture") && strcmp(block, "material_map") == 0) {
        build_texture(r->lang, i);
        return true;
    }
    if (i->kind != ITEM_WORD)
        return false;
    const char *word = i->word->text;
    if (map && (strcmp(word, "filter") == 0 || strcmp(word, "transmit") == 0))
        read_transparency(r, w, word);
    else if (strcmp(word, "repeat") == 0 || strcmp(word, "offset") == 0)
        read_shift(r, w, word);
    else if (strcmp(word, "bump_size") == 0 && strcmp(block, "bump_map") == 0)
        reader_number(r, false, word);
    else if (strcmp(word, "use_alpha") == 0)
        return strcmp(block, "image_pattern") == 0;
    else if (strncmp(word, "use_", 4) != 0)
        return build_from_table(r, image_fields, i, w->use);
    return true;
}

static void check_use(struct lang *l, const struct item *block, struct image_use *u)
{
    bool known = u->map_type == MAP_PLANAR || u->map_type == MAP_SPHERICAL
                 || u->map_type == MAP_CYLINDRICAL || u->map_type == MAP_TOROIDAL;

    if (!known) {
        build_wrong(l, block, "map_type is 0, 1, 2 or 5, not %d", u->map_type);
        u->map_type = MAP_PLANAR;
    }
    if (u->interpolate != 0 && (u->interpolate < 2 || u->interpolate > 4)) {
        build_wrong(l, block, "interpolate is 2, 3 or 4, not %d", u->interpolate);
        u->interpolate = INTERPOLATE_NONE;
    }
}

void build_image(struct lang *l, const struct item *block, struct image_use *use,
                 bool *unsupported)
{
    const struct field *const tables[] = { image_fields, image_types, NULL };
    struct reading w = { .use = use };
    struct reader r;

    *use = (struct image_use) { 0 };
    if (block->kind != ITEM_BLOCK) {
        diag_error(l->diag, block->at, "%s needs braces", block->text);
        return;
    }
    reader_open(&r, l, block->body);
    read_source(&r, &w.file);
    for (struct item i = reader_next(&r); i.kind != ITEM_END; i = reader_next(&r)) {
        reader_skip_comma(&r);
        if (!read_item(&r, &w, &i, block->text))
            build_unknown(l, &i, block->text, tables);
    }
    reader_close(&r);
    check_use(l, block, use);
    const struct function *f = w.file.drawn.function;
    bool fits = f && function_components(f) != 3 && function_parameters(f) == 3;
    *unsupported = w.file.drawn.width > 0 && !fits;
    if (fits && strcmp(block->text, "image_map") == 0)
        use->image = draw(l, &w.file.drawn);
    if (w.unsupported)
        diag_unsupported(l->diag, block->at, w.unsupported);
    if (w.file.name && *w.file.name)
        use->image = load_image(l, w.file.at, w.file.name, w.file.type, w.file.gamma,
                                w.file.premultiplied, w.palette, w.n_palette);
}
