/* build_pattern.c: the scheme that pigments, normals, densities and patterned
 * textures share: a pattern, then its modifiers in any order. */
#include <string.h>

#include "lang/build.h"
#include "lang/code.h"
#include "lang/colour.h"
#include "lang/function.h"

/* Words of the patterns that the renderer lacks: they are read in full.  A row
 * of patterns[] with the same name comes first. */
struct syntax {
    const char *name;
    const struct field *args, *words;
    int n_list;
};

/* Where their values go: read, then dropped with a warning that names the pattern. */
struct unkept { double number, more; vec3 vector; bool flag; };
#define NUMBER(word) { word, FIELD_NUM, offsetof(struct unkept, number), ANY, "" }
#define VECTOR(word) { word, FIELD_POINT, offsetof(struct unkept, vector), ANY, "" }
#define FLAG(word) { word, FIELD_FLAG, offsetof(struct unkept, flag), ANY, "" }
#define PAIR(word) { word, FIELD_CUSTOM, 0, ANY, "" }

static const struct field one_number[] = { NUMBER(""), FIELD_END };
static const struct field tiling_number[] = {
    { "", FIELD_NUM, offsetof(struct unkept, number), 1, 27, "" }, FIELD_END };
static const struct field one_vector[] = { VECTOR(""), FIELD_END };
static const struct field crackle_words[] = {
    VECTOR("form"), NUMBER("metric"), NUMBER("offset"), FLAG("solid"), FIELD_END };
static const struct field facets_words[] = {
    NUMBER("size"), NUMBER("coords"), NUMBER("metric"), FIELD_END };
static const struct field quilted_words[] = { NUMBER("control0"), NUMBER("control1"), FIELD_END };
static const struct field brick_words[] = { VECTOR("brick_size"), NUMBER("mortar"), FIELD_END };
static const struct field agate_words[] = { NUMBER("agate_turb"), FIELD_END };
static const struct field fractal_words[] = {
    PAIR("interior"), PAIR("exterior"), NUMBER("exponent"), FIELD_END };
static const struct field density_words[] = { NUMBER("interpolate"), FIELD_END };
static const struct field pavement_words[] = {
    NUMBER("number_of_sides"), NUMBER("number_of_tiles"), NUMBER("pattern"), NUMBER("interior"),
    NUMBER("exterior"), NUMBER("form"), FIELD_END };

static const struct syntax syntaxes[] = {
    { "agate", NULL, agate_words, 0 }, { "aoi", NULL, NULL, 0 }, { "bozo", NULL, NULL, 0 },
    { "boxed", NULL, NULL, 0 }, { "brick", NULL, brick_words, 2 }, { "bumps", NULL, NULL, 0 },
    { "cells", NULL, NULL, 0 }, { "checker", NULL, NULL, 2 }, { "crackle", NULL, crackle_words, 0 },
    { "cubic", NULL, NULL, 6 }, { "cylindrical", NULL, NULL, 0 }, { "dents", NULL, NULL, 0 },
    { "density_file", NULL, density_words, 0 }, { "facets", NULL, facets_words, 0 },
    { "function", NULL, NULL, 0 },
    { "gradient", one_vector, NULL, 0 }, { "granite", NULL, NULL, 0 }, { "hexagon", NULL, NULL, 3 },
    { "image_pattern", NULL, NULL, 0 }, { "julia", NULL, fractal_words, 0 },
    { "leopard", NULL, NULL, 0 }, { "magnet", NULL, fractal_words, 0 },
    { "mandel", one_number, fractal_words, 0 }, { "marble", NULL, NULL, 0 },
    { "object", NULL, NULL, 2 }, { "onion", NULL, NULL, 0 }, { "pavement", NULL, pavement_words, 0 },
    { "pigment_pattern", NULL, NULL, 0 }, { "planar", NULL, NULL, 0 },
    { "quilted", NULL, quilted_words, 0 }, { "radial", NULL, NULL, 0 }, { "ripples", NULL, NULL, 0 },
    { "slope", NULL, NULL, 0 }, { "spherical", NULL, NULL, 0 }, { "spiral1", one_number, NULL, 0 },
    { "spiral2", one_number, NULL, 0 }, { "spotted", NULL, NULL, 0 }, { "square", NULL, NULL, 4 },
    { "tiling", tiling_number, NULL, 0 }, { "triangular", NULL, NULL, 6 }, { "waves", NULL, NULL, 0 },
    { "wood", NULL, NULL, 0 }, { "wrinkles", NULL, NULL, 0 }, { "bump_map", NULL, NULL, 0 },
    { .name = NULL },
};

/* Words that stand in no other table. */
const struct field pattern_more_fields[] = {
    { "average", FIELD_CUSTOM, 0, ANY, "the mean of a map's entries" },
    { "image_map", FIELD_CUSTOM, 0, ANY, "colours from a picture" },
    { "form", FIELD_CUSTOM, 0, ANY, "of crackle, pavement" },
    { "metric", FIELD_CUSTOM, 0, ANY, "of crackle, facets" },
    { "solid", FIELD_CUSTOM, 0, ANY, "crackle: one colour for each cell" },
    { "size", FIELD_CUSTOM, 0, ANY, "of facets" },
    { "coords", FIELD_CUSTOM, 0, ANY, "of facets" },
    { "control0", FIELD_CUSTOM, 0, ANY, "of quilted" },
    { "control1", FIELD_CUSTOM, 0, ANY, "of quilted" },
    { "brick_size", FIELD_CUSTOM, 0, ANY, "of brick" },
    { "mortar", FIELD_CUSTOM, 0, ANY, "of brick" },
    { "agate_turb", FIELD_CUSTOM, 0, ANY, "of agate" },
    { "exterior", FIELD_CUSTOM, 0, ANY, "of fractals: colours outside" },
    { "exponent", FIELD_CUSTOM, 0, ANY, "of fractals" },
    { "number_of_sides", FIELD_CUSTOM, 0, ANY, "of pavement" },
    { "number_of_tiles", FIELD_CUSTOM, 0, ANY, "of pavement" },
    { "pattern", FIELD_CUSTOM, 0, ANY, "of pavement" },
    { "df3", FIELD_CUSTOM, 0, ANY, "a density file" },
    { "altitude", FIELD_CUSTOM, 0, ANY, "of slope" },
    { "tiles", FIELD_CUSTOM, 0, ANY, "two textures as a checker" },
    { "tile2", FIELD_CUSTOM, 0, ANY, "the second texture of tiles" },
    { "material_map", FIELD_CUSTOM, 0, ANY, "textures by a picture" },
#define PATTERN(word) { word, FIELD_CUSTOM, 0, ANY, "a pattern" }
    PATTERN("agate"), PATTERN("aoi"), PATTERN("bozo"), PATTERN("boxed"), PATTERN("brick"),
    PATTERN("bumps"), PATTERN("cells"), PATTERN("checker"), PATTERN("crackle"),
    PATTERN("cylindrical"), PATTERN("dents"), PATTERN("density_file"), PATTERN("facets"),
    PATTERN("gradient"), PATTERN("granite"), PATTERN("hexagon"), PATTERN("image_pattern"),
    PATTERN("julia"), PATTERN("leopard"), PATTERN("magnet"), PATTERN("mandel"), PATTERN("marble"),
    PATTERN("onion"), PATTERN("pavement"), PATTERN("pigment_pattern"), PATTERN("planar"),
    PATTERN("quilted"), PATTERN("radial"), PATTERN("ripples"), PATTERN("slope"),
    PATTERN("spherical"), PATTERN("spiral1"), PATTERN("spiral2"), PATTERN("spotted"),
    PATTERN("square"), PATTERN("tiling"), PATTERN("triangular"), PATTERN("waves"),
    PATTERN("wood"), PATTERN("wrinkles"), PATTERN("bump_map"),
    FIELD_END,
};

static const struct syntax *find_syntax(const char *word)
{
    for (const struct syntax *s = syntaxes; s->name; s++)
        if (strcmp(s->name, word) == 0)
            return s;
    return NULL;
}

/* --- default colours: facts patterns.md 4.5 ----------------------------------- */

#define C(v, r, g, b) { .value = v, .colour = { r, g, b, 0, 0 } }

static const struct map_entry plain_map[] = { C(0, 0, 0, 0), C(1, 1, 1, 1) };
static const struct map_entry two[] = { C(0, 0, 0, 1), C(1, 0, 1, 0) };
static const struct map_entry brick[] = { C(0, .5f, .5f, .5f), C(1, .6f, .15f, .15f) };
static const struct map_entry hexagon[] = { C(0, 0, 0, 1), C(1, 0, 1, 0), C(2, 1, 0, 0) };
static const struct map_entry six[] = { C(0, 1, 0, 0), C(1, 0, 1, 0), C(2, 0, 0, 1), C(3, 1, 1, 0),
                                        C(4, 0, 1, 1), C(5, 1, 0, 1) };
static const struct map_entry bozo[] = { C(.4, 1, 1, 1), C(.4, 0, 1, 0), C(.6, 0, 1, 0),
                                         C(.6, 0, 0, 1), C(.8, 0, 0, 1), C(.8, 1, 0, 0) };
static const struct map_entry wood[] = { C(.6, .666f, .312f, .2f), C(.6, .4f, .1333f, .066f) };
static const struct map_entry mandel[] = { C(.001, 0, 0, 0), C(.001, 0, 1, 1), C(.012, 1, 1, 0),
                                           C(.015, 1, 0, 1), C(.1, 0, 1, 1) };
static const struct map_entry agate[] = { C(0, 1, 1, 1), C(.5, .95f, .75f, .5f),
                                          C(.5, .9f, .7f, .5f), C(.6, .9f, .7f, .4f),
                                          C(.6, 1, .7f, .4f), C(1, .6f, .3f, 0) };
static const struct map_entry radial[] = { C(0, 0, 1, 1), C(.333, 1, 1, 0), C(.666, 1, 0, 1),
                                           C(1, 0, 1, 1) };
static const struct map_entry marble[] = { C(0, .9f, .8f, .8f), C(.9, .9f, .08f, .08f),
                                           C(.9, 0, 0, 0) };

#define ROW(name, map) { name, map, sizeof map / sizeof *map }

static const struct { const char *name; const struct map_entry *entry; size_t n; } default_maps[] = {
    ROW("checker", two), ROW("object", two), ROW("brick", brick), ROW("hexagon", hexagon),
    ROW("square", six), ROW("triangular", six), ROW("cubic", six), ROW("bozo", bozo),
    ROW("wood", wood), ROW("mandel", mandel), ROW("agate", agate), ROW("radial", radial),
    ROW("marble", marble),
};

static struct map default_map(const char *word)
{
    for (size_t i = 0; i < sizeof default_maps / sizeof *default_maps; i++)
        if (strcmp(default_maps[i].name, word) == 0)
            return (struct map) { VALUE_COLOUR_MAP, default_maps[i].entry, default_maps[i].n };
    return (struct map) { VALUE_COLOUR_MAP, plain_map, 2 };
}

/* --- words -------------------------------------------------------------------- */

const struct field pattern_fields[] = {
    { "frequency", FIELD_NUM, offsetof(struct patterned, use.frequency), ANY, "how often the map repeats" },
    { "phase", FIELD_NUM, offsetof(struct patterned, use.phase), ANY, "where the map begins" },
    { "octaves", FIELD_INT, offsetof(struct patterned, use.turbulence.octaves), ANY, "of the turbulence" },
    { "omega", FIELD_NUM, offsetof(struct patterned, use.turbulence.omega), ANY, "of the turbulence" },
    { "lambda", FIELD_NUM, offsetof(struct patterned, use.turbulence.lambda), ANY, "of the turbulence" },
    { "turbulence", FIELD_POINT, offsetof(struct patterned, use.turbulence.amount), ANY, "how far points are stirred" },
    { "ramp_wave", FIELD_CUSTOM, 0, ANY, "the map from 0 to 1, again and again" },
    { "triangle_wave", FIELD_CUSTOM, 0, ANY, "the map up and down" },
    { "sine_wave", FIELD_CUSTOM, 0, ANY, "the map up and down, smoothly" },
    { "scallop_wave", FIELD_CUSTOM, 0, ANY, "the map in arches" },
    { "cubic_wave", FIELD_CUSTOM, 0, ANY, "the map up and down, by a cubic" },
    { "poly_wave", FIELD_CUSTOM, 0, ANY, "the map to a power" },
    { "quick_color", FIELD_CUSTOM, 0, ANY, "the colour of quick pictures" },
    { "quick_colour", FIELD_CUSTOM, 0, ANY, "the colour of quick pictures" },
    { "warp", FIELD_CUSTOM, 0, ANY, "bends the pattern" },
    { "noise_generator", FIELD_CUSTOM, 0, ANY, "which noise this pattern uses" },
    { "color_map", FIELD_CUSTOM, 0, ANY, "colours by the pattern's value" },
    { "colour_map", FIELD_CUSTOM, 0, ANY, "colours by the pattern's value" },
    { "pigment_map", FIELD_CUSTOM, 0, ANY, "pigments by the pattern's value" },
    { "normal_map", FIELD_CUSTOM, 0, ANY, "normals by the pattern's value" },
    { "slope_map", FIELD_CUSTOM, 0, ANY, "heights by the pattern's value" },
    { "texture_map", FIELD_CUSTOM, 0, ANY, "textures by the pattern's value" },
    { "density_map", FIELD_CUSTOM, 0, ANY, "densities by the pattern's value" },
    { "bump_size", FIELD_NUM, offsetof(struct patterned, amount), ANY, "how high bumps are" },
    { "accuracy", FIELD_NUM, offsetof(struct patterned, accuracy), ANY, "how far apart slopes are measured" },
    { "no_bump_scale", FIELD_FLAG, offsetof(struct patterned, no_bump_scale), ANY, "scaling leaves bumps as high" },
    FIELD_END,
};

struct patterned patterned_new(enum value_type of)
{
    struct patterned p;

    memset(&p, 0, sizeof p);            /* equal ones are found by their bytes */
    p.of = of;
    p.use = *pigment_default.pattern;
    p.place = transform_identity;
    p.amount = 0.5;
    p.accuracy = 0.02;
    return p;
}

bool patterned_starts(const struct item *i)
{
    if (i->kind == ITEM_VALUE)
        return i->value.type == VALUE_FUNCTION && !i->name;
    return (i->kind == ITEM_WORD || i->kind == ITEM_BLOCK) && i->word->begins_pattern;
}

const char *patterned_word(size_t i)
{
    static const char *const more[] = { "average", "image_map", "uv_mapping", NULL };
    const size_t n = sizeof syntaxes / sizeof *syntaxes - 1;

    return i < n ? syntaxes[i].name : more[i - n];
}

/* --- the pattern --------------------------------------------------------------- */

static struct map default_map_of(const struct patterned *p)
{
    return p->of == VALUE_PIGMENT || p->of == VALUE_DENSITY ? default_map(p->word)
                                                           : (struct map) { .type = VALUE_NONE };
}

static const char *thing_word(enum value_type of)
{
    return of == VALUE_PIGMENT ? "pigment" : of == VALUE_NORMAL ? "normal"
           : of == VALUE_TEXTURE ? "texture" : of == VALUE_FUNCTION ? "pattern" : "density";
}

static bool list_item(struct reader *r, struct patterned *p, struct map_entry *e, bool colours)
{
    const struct item *i = reader_peek(r);

    if (item_is_block(i, thing_word(p->of))) {
        struct item block = reader_next(r);
        if (p->of == VALUE_PIGMENT)
            e->pigment = build_pigment(r->lang, &block, r->lang->build->texture->pigment);
        else if (p->of == VALUE_NORMAL)
            e->normal = build_normal(r->lang, &block, NULL);
        else if (p->of == VALUE_TEXTURE)
            e->texture = build_texture(r->lang, &block);
        else {
            struct value v;
            make_density(r->lang, &block, &v);
            e->pigment = v.thing;
        }
        return true;
    }
    if (!colours || !item_is_colour(i))
        return false;
    e->colour = colour_take(r, false, p->word);
    return true;
}

static enum value_type map_type(enum value_type of)
{
    return of == VALUE_PIGMENT ? VALUE_PIGMENT_MAP : of == VALUE_NORMAL ? VALUE_NORMAL_MAP
           : of == VALUE_TEXTURE ? VALUE_TEXTURE_MAP : VALUE_DENSITY_MAP;
}

/* Missing items: the default's. */
static void fill_list(struct reader *r, struct patterned *p, struct map_entry *e, int from, int n)
{
    struct build *b = r->lang->build;

    for (int i = from; i < n; i++) {
        if (p->map.type == VALUE_COLOUR_MAP)
            e[i].colour = default_map(p->word).entry[i].colour;
        else if (p->of == VALUE_PIGMENT || p->of == VALUE_DENSITY)
            e[i].pigment = b->texture->pigment;
        else if (p->of == VALUE_TEXTURE)
            e[i].texture = b->texture;
        else
            e[i].normal = build_normal_body(r, NULL, NULL);
    }
}

/* checker and its like: colours or blocks, the first item decides. */
static void read_list(struct reader *r, struct patterned *p, int n)
{
    struct map_entry *e = arena_array(r->lang->scene_mem, (size_t)n, sizeof *e);
    bool colours = p->of == VALUE_PIGMENT || p->of == VALUE_DENSITY;
    int got = 0;

    p->kind = PATTERNED_LIST;
    if (p->of == VALUE_FUNCTION)        /* the number itself is wanted */
        return;
    p->map.type = colours && !item_is_block(reader_peek(r), thing_word(p->of)) ? VALUE_COLOUR_MAP
                                                                              : map_type(p->of);
    while (got < n && list_item(r, p, &e[got], p->map.type == VALUE_COLOUR_MAP)) {
        got++;
        reader_skip_comma(r);
    }
    if (p->of == VALUE_NORMAL && got == 0)
        p->map.type = VALUE_NONE;
    else
        fill_list(r, p, e, got, n);
    for (int i = 0; i < n; i++)
        e[i].value = i;
    p->map.entry = e;
    p->map.n = p->map.type == VALUE_NONE ? 0 : (size_t)n;
}

static void read_args(struct reader *r, const struct field *args, void *self)
{
    for (const struct field *f = args; f && f->name; f++) {
        if (f != args)
            reader_skip_comma(r);
        build_field(r, f, f->help && *f->help ? f->help : "the pattern's number", reader_at(r), self);
    }
}

/* slope { ... }, density_file df3 "..", julia V, n, magnet n mandel n ... */
static void skip_slope(struct reader *r, const struct item *i)
{
    struct reader in;

    if (i->kind == ITEM_WORD) {
        build_vector(r, false, "slope");
        return;
    }
    reader_open(&in, r->lang, i->body);
    for (int part = 0; part < 2; part++) {
        reader_takes_word(&in, part == 0 ? "point_at" : "altitude");
        build_vector(&in, false, "slope");
        for (int k = 0; k < 2 && (reader_skip_comma(&in), reader_is_number(&in)); k++)
            reader_number(&in, false, "slope");
        if (part == 0 && !item_is(reader_peek(&in), "altitude"))
            break;
    }
    if (reader_peek(&in)->kind != ITEM_END)
        build_unknown(r->lang, reader_peek(&in), "slope", NULL);
    reader_close(&in);
}

static void skip_object(struct reader *r, struct patterned *p, const struct item *i)
{
    struct reader in;
    struct transform t;

    if (i->kind != ITEM_BLOCK) {
        diag_error(r->lang->diag, i->at, "the object pattern needs braces: object { Thing, ... }");
        return;
    }
    reader_open(&in, r->lang, i->body);
    struct item o = reader_next(&in);
    if (!build_object(r->lang, &o))
        diag_error(r->lang->diag, o.at, "expected an object in the object pattern; found %s",
                   item_describe(r->lang, &o));
    while ((reader_peek(&in)->kind == ITEM_WORD || reader_peek(&in)->kind == ITEM_BLOCK)
           && field_find(transform_fields, reader_peek(&in)->word->text)) {
        struct item word = reader_next(&in);
        build_transform(&in, &word, &t);
    }
    reader_skip_comma(&in);
    read_list(&in, p, 2);
    if (reader_peek(&in)->kind != ITEM_END)
        build_unknown(r->lang, reader_peek(&in), "object", NULL);
    reader_close(&in);
}

static void skip_block(struct reader *r, const struct item *i)
{
    struct image_use image = { 0 };
    bool unsupported = false;

    build_image(r->lang, i, &image, &unsupported);
}

static void skip_special(struct reader *r, struct patterned *p, const struct item *i)
{
    const char *w = p->word;

    if (strcmp(w, "facets") == 0 && p->of != VALUE_NORMAL)
        diag_error(r->lang->diag, i->at, "facets can only stand in normal");
    if (strcmp(w, "slope") == 0)
        skip_slope(r, i);
    else if (strcmp(w, "object") == 0)
        skip_object(r, p, i);
    else if (strcmp(w, "image_pattern") == 0 || strcmp(w, "bump_map") == 0)
        skip_block(r, i);
    else if (strcmp(w, "density_file") == 0) {
        if (!reader_takes_word(r, "df3"))
            diag_error(r->lang->diag, reader_at(r), "density_file needs df3 and a file name");
        reader_text(r, false, "density_file");
    } else if (strcmp(w, "magnet") == 0) {
        int type = reader_whole(r, false, "magnet");
        if (type != 1 && type != 2)
            diag_error(r->lang->diag, i->at, "magnet has the types 1 and 2");
        if (reader_takes_word(r, "mandel"))
            reader_number(r, false, "mandel");
        else if (reader_takes_word(r, "julia")) {
            double v[2];
            reader_vector(r, false, 2, v, "julia");
            reader_number(r, true, "julia");
        } else
            diag_error(r->lang->diag, reader_at(r), "magnet needs mandel or julia");
    } else if (strcmp(w, "julia") == 0) {
        double v[2];
        reader_vector(r, false, 2, v, "julia");
        reader_number(r, true, "julia");
    }
}

/* A wave's or a pattern's own beginning (facts sdl.md 6.10). */
static void start_values(struct patterned *p, const char *word)
{
    static const char *const triangles[] = { "marble", "wood", "spiral1", "spiral2" };
    bool still = strcmp(word, "quilted") == 0 || strcmp(word, "image_pattern") == 0;

    p->use.frequency = p->kind == PATTERNED_LIST || still ? 0 : 1;
    for (size_t i = 0; i < sizeof triangles / sizeof *triangles; i++)
        if (strcmp(triangles[i], word) == 0)
            p->use.wave = WAVE_TRIANGLE;
}

static void read_row(struct reader *r, struct patterned *p, const struct pattern_ops *ops)
{
    void *self = ops->size > 0 ? arena_copy(r->lang->scene_mem, ops->defaults, ops->size) : NULL;

    p->use.ops = ops;
    p->use.self = self;
    read_args(r, ops->args, self);
    if (ops->n_list > 0)
        read_list(r, p, ops->n_list);
}

static void read_unsupported(struct reader *r, struct patterned *p, const struct item *i,
                             const struct syntax *s)
{
    struct unkept unkept;

    p->unsupported = arena_format(r->lang->scene_mem, "the %s pattern", s->name);
    p->use.ops = NULL;
    p->use.self = NULL;
    read_args(r, s->args, &unkept);
    skip_special(r, p, i);
    if (s->n_list > 0 && strcmp(s->name, "object") != 0)
        read_list(r, p, s->n_list);
}

static void take_function(struct lang *l, const struct item *i, struct patterned *p,
                          const struct function *f)
{
    p->nest = (struct nest) { 0 };
    nest_add(&p->nest, f->nest);
    function_as_pattern(l, i->at, f, (void *)p->use.self, &p->unsupported);
}

/* The brightness of a pigment is a function like others. */
static void read_pigment_pattern(struct reader *r, struct patterned *p, const struct item *i)
{
    struct lang *l = r->lang;
    const struct pigment *pigment;

    if (i->kind != ITEM_BLOCK) {
        diag_error(l->diag, i->at, "%s needs braces", i->text);
        return;
    }
    pigment = build_pigment(l, i, l->build->texture->pigment);
    read_row(r, p, pattern_find("function"));
    take_function(l, i, p, function_of_grey(l, pigment, i->at));
}

/* The same pattern may have had a map from an identifier: it stays. */
static void read_pattern(struct reader *r, struct patterned *p, const struct item *i)
{
    const char *word = i->kind == ITEM_VALUE ? "function" : i->word->text;
    const struct pattern_ops *ops = i->kind == ITEM_VALUE ? pattern_find(word) : i->word->pattern;
    bool had_map = p->kind == PATTERNED_MAP && p->map.n > 0;

    p->word = word;
    p->kind = PATTERNED_MAP;
    p->unsupported = NULL;
    if (ops)
        read_row(r, p, ops);
    if (i->kind == ITEM_VALUE)
        take_function(r->lang, i, p, i->value.thing);
    else if (item_is(i, "pigment_pattern"))
        read_pigment_pattern(r, p, i);
    else if (!ops)
        read_unsupported(r, p, i, find_syntax(word));
    if (p->kind == PATTERNED_MAP && !had_map)
        p->map = default_map_of(p);
    start_values(p, word);
}

static void read_start(struct reader *r, struct patterned *p, const struct item *block)
{
    const struct item *i = reader_peek(r);

    if (item_is_colour(i) && (p->of == VALUE_PIGMENT || p->of == VALUE_DENSITY)) {
        p->kind = PATTERNED_COLOUR;
        p->colour = colour_take(r, false, thing_word(p->of));
        return;
    }
    if (!patterned_starts(i))
        return;
    struct item word = reader_next(r);
    if (item_is(&word, "uv_mapping")) {
        p->uv_mapping = true;
        read_start(r, p, block);
    } else if (item_is(&word, "average")) {
        p->kind = PATTERNED_AVERAGE;
        p->word = "average";
        p->map = (struct map) { .type = VALUE_NONE };
    } else if (item_is(&word, "image_map")) {
        bool unsupported = false;
        if (p->of != VALUE_PIGMENT)
            diag_error(r->lang->diag, word.at, "image_map can only stand in pigment");
        p->kind = PATTERNED_IMAGE;
        p->word = "image_map";
        build_image(r->lang, &word, &p->image, &unsupported);
        if (unsupported)
            p->unsupported = "image_map by a function";
    } else
        read_pattern(r, p, &word);
}

/* --- modifiers ------------------------------------------------------------------ */

static bool read_wave(struct reader *r, struct patterned *p, const struct item *i)
{
    static const char *const words[] = { "ramp_wave", "triangle_wave", "sine_wave",
                                         "scallop_wave", "cubic_wave", "poly_wave" };

    for (unsigned w = 0; w < sizeof words / sizeof *words; w++)
        if (item_is(i, words[w])) {
            p->use.wave = (enum wave_type)w;
            if (w == WAVE_POLY && reader_is_number(r))
                p->use.exponent = reader_number(r, false, "poly_wave");
            return true;
        }
    return false;
}

static bool allowed(const struct patterned *p, enum value_type map)
{
    bool average = p->kind == PATTERNED_AVERAGE;

    if (p->kind == PATTERNED_LIST || p->kind == PATTERNED_COLOUR || p->kind == PATTERNED_IMAGE
        || p->kind == PATTERNED_NONE || p->of == VALUE_FUNCTION)
        return false;
    if (map == VALUE_COLOUR_MAP)
        return (p->of == VALUE_PIGMENT || p->of == VALUE_DENSITY) && !average;
    if (map == VALUE_SLOPE_MAP)
        return p->of == VALUE_NORMAL && !average;
    return map == map_type(p->of);
}

static const struct {
    const char *word;
    enum value_type type;
    bool (*make)(struct lang *l, const struct item *block, struct value *out);
} map_makers[] = {
    { "color_map", VALUE_COLOUR_MAP, make_colour_map },
    { "colour_map", VALUE_COLOUR_MAP, make_colour_map },
    { "pigment_map", VALUE_PIGMENT_MAP, make_pigment_map },
    { "normal_map", VALUE_NORMAL_MAP, make_normal_map },
    { "slope_map", VALUE_SLOPE_MAP, make_slope_map },
    { "texture_map", VALUE_TEXTURE_MAP, make_texture_map },
    { "density_map", VALUE_DENSITY_MAP, make_density_map },
};

static bool read_map(struct reader *r, struct patterned *p, const struct item *i)
{
    struct value v;

    for (size_t m = 0; m < sizeof map_makers / sizeof *map_makers; m++) {
        if (!item_is_block(i, map_makers[m].word))
            continue;
        if (p->kind == PATTERNED_NONE)
            diag_error(r->lang->diag, i->at, "%s needs a pattern before it", i->text);
        else if (!allowed(p, map_makers[m].type))
            diag_error(r->lang->diag, i->at, "%s cannot be used with %s in %s", i->text,
                       p->kind == PATTERNED_COLOUR ? "a plain colour" : p->word,
                       thing_word(p->of));
        map_makers[m].make(r->lang, i, &v);
        const struct map *map = v.thing;        /* an empty one was complained of: nothing can be looked up in it */
        if (allowed(p, map_makers[m].type) && map->n > 0)
            p->map = *map;
        return true;
    }
    return false;
}

const struct field warp_fields[] = {
    { "repeat", FIELD_CUSTOM, 0, ANY, "the same again" },
    { "offset", FIELD_CUSTOM, 0, ANY, "moves each copy" },
    { "flip", FIELD_CUSTOM, 0, ANY, "mirrors every other copy" },
    { "black_hole", FIELD_CUSTOM, 0, ANY, "pulls points to a centre" },
    { "strength", FIELD_CUSTOM, 0, ANY, "of a black hole" },
    { "falloff", FIELD_CUSTOM, 0, ANY, "of a black hole" },
    { "type", FIELD_CUSTOM, 0, ANY, "of a black hole" },
    { "inverse", FIELD_CUSTOM, 0, ANY, "pushes instead" },
    { "toroidal", FIELD_CUSTOM, 0, ANY, "wraps around a torus" },
    { "orientation", FIELD_CUSTOM, 0, ANY, "of a wrapping" },
    { "dist_exp", FIELD_CUSTOM, 0, ANY, "of a wrapping" },
    { "major_radius", FIELD_CUSTOM, 0, ANY, "of a torus" },
    FIELD_END,
};

/* Word and how many vectors (v) and numbers (n) follow; capitals: if there. */
static const struct { const char *word, *values; } warp_words[] = {
    { "turbulence", "v" }, { "octaves", "n" }, { "omega", "n" }, { "lambda", "n" },
    { "repeat", "v" }, { "offset", "v" }, { "flip", "v" }, { "black_hole", "vn" },
    { "strength", "n" }, { "falloff", "n" }, { "inverse", "" }, { "type", "n" },
    { "spherical", "" }, { "cylindrical", "" }, { "toroidal", "" }, { "cubic", "" },
    { "planar", "VN" }, { "orientation", "v" }, { "dist_exp", "n" }, { "major_radius", "n" },
};

/* A warp that begins with repeat; a black hole's is free. */
static void check_repeat(struct reader *r, const struct item *i, vec3 v)
{
    if ((v.x != 0) + (v.y != 0) + (v.z != 0) != 1)
        diag_error(r->lang->diag, i->at, "repeat goes along one axis, as in repeat 2*x");
}

static bool read_warp_word(struct reader *r, const struct item *i, bool is_first)
{
    for (size_t w = 0; w < sizeof warp_words / sizeof *warp_words; w++) {
        if (i->kind != ITEM_WORD || !item_is(i, warp_words[w].word))
            continue;
        for (const char *v = warp_words[w].values; *v; v++) {
            if (*v < 'a' && !(reader_skip_comma(r), reader_is_number(r)))
                break;
            if (*v == 'n' || *v == 'N') {
                reader_number(r, true, warp_words[w].word);
                continue;
            }
            vec3 vector = build_vector(r, true, warp_words[w].word);
            if (is_first && item_is(i, "repeat"))
                check_repeat(r, i, vector);
        }
        return true;
    }
    return false;
}

static void read_warp(struct reader *r, struct patterned *p, const struct item *i)
{
    const struct field *const tables[] = { warp_fields, NULL };
    struct reader in;
    bool is_empty = true;

    reader_open(&in, r->lang, i->body);
    for (struct item word = reader_next(&in); word.kind != ITEM_END; word = reader_next(&in)) {
        if (!read_warp_word(&in, &word, is_empty))
            build_unknown(r->lang, &word, "warp", tables);
        is_empty = false;
    }
    reader_close(&in);
    if (is_empty)
        diag_error(r->lang->diag, i->at, "warp { } is empty: it needs a kind, as in warp { repeat x }");
    p->unsupported = "warp";
}

/* interior 1, 2: two numbers; the rest as the table says. */
static bool read_pattern_word(struct reader *r, struct patterned *p, const struct item *i)
{
    const struct syntax *s = p->word ? find_syntax(p->word) : NULL;
    struct unkept unkept;

    if (i->kind != ITEM_WORD)
        return false;
    if (p->use.ops)
        return build_from_table(r, p->use.ops->words, i, (void *)p->use.self);
    const struct field *f = s ? field_find(s->words, i->word->text) : NULL;
    if (!f)
        return false;
    if (f->type != FIELD_CUSTOM)
        return build_field(r, f, f->name, i->at, &unkept);
    reader_number(r, false, f->name);
    reader_number(r, true, f->name);
    return true;
}

static bool is_for(const struct patterned *p, const char *word)
{
    static const char *const of_normals[] = { "bump_size", "accuracy", "no_bump_scale", "slope_map" };

    for (size_t i = 0; i < sizeof of_normals / sizeof *of_normals; i++)
        if (strcmp(word, of_normals[i]) == 0)
            return p->of == VALUE_NORMAL;
    return true;
}

static bool read_custom(struct reader *r, struct patterned *p, const struct item *i)
{
    if (read_wave(r, p, i) || read_map(r, p, i))
        return true;
    if (item_is_block(i, "warp")) {
        read_warp(r, p, i);
        return true;
    }
    if (item_is(i, "noise_generator")) {
        reader_number(r, false, "noise_generator");     /* of a pattern without noise */
        return true;
    }
    if (p->of == VALUE_PIGMENT && (item_is(i, "quick_color") || item_is(i, "quick_colour"))) {
        p->quick_colour = colour_take(r, false, "quick_color");
        p->has_quick_colour = true;
        return true;
    }
    return false;
}

static bool read_modifier(struct reader *r, struct patterned *p, const struct item *i)
{
    struct transform t;

    if (build_transform(r, i, &t)) {
        p->place = transform_compose(&t, &p->place);
        return true;
    }
    if (read_pattern_word(r, p, i) || read_custom(r, p, i))
        return true;
    return i->kind == ITEM_WORD && is_for(p, i->word->text)
           && build_from_table(r, pattern_fields, i, p);
}

/* One message: its numbers are skipped. */
static void say_late(struct reader *r, struct patterned *p, const struct item *i)
{
    diag_error(r->lang->diag, i->at, "a pattern must come first in %s", thing_word(p->of));
    while (reader_is_number(r) || reader_peek(r)->kind == ITEM_COMMA)
        reader_next(r);
}

static void wrong_item(struct reader *r, struct patterned *p, const struct item *i)
{
    const struct syntax *s = p->word ? find_syntax(p->word) : NULL;
    const struct field *const tables[] = {
        pattern_fields, transform_fields,
        p->use.ops && p->use.ops->words ? p->use.ops->words : transform_fields,
        s && s->words ? s->words : transform_fields, NULL };

    if (i->kind == ITEM_VALUE && p->kind == PATTERNED_NONE
        && (i->value.type == VALUE_NUMBER))
        diag_error(r->lang->diag, i->at, "%s is no colour here: write rgb before it",
                   item_describe(r->lang, i));
    else if (patterned_starts(i))
        say_late(r, p, i);
    else
        build_unknown(r->lang, i, thing_word(p->of), tables);
}

/* What the whole block says that the pattern's own formula uses. */
static void fill_block(struct lang *l, struct patterned *p)
{
    if (!p->use.ops || !p->use.ops->takes_block)
        return;
    struct pattern_block *b = (struct pattern_block *)p->use.self;
    const struct settings *s = &l->scene->settings;
    b->turbulence = p->use.turbulence.amount;
    b->octaves = p->use.turbulence.octaves;
    b->omega = p->use.turbulence.omega;
    b->lambda = p->use.turbulence.lambda;
    b->frequency = p->use.frequency;
    b->phase = p->use.phase;
    b->number_of_waves = s->number_of_waves;
    if (b->noise_generator == 0)
        b->noise_generator = s->noise_generator;
}

static void check_end(struct reader *r, struct patterned *p, const struct item *block)
{
    struct lang *l = r->lang;
    struct loc at = block ? block->at : reader_at(r);

    if (p->use.turbulence.octaves < 1)
        p->use.turbulence.octaves = 1;
    if (p->use.turbulence.octaves > 10)
        p->use.turbulence.octaves = 10;
    if (p->kind == PATTERNED_AVERAGE && p->map.n == 0)
        diag_error(l->diag, at, "average needs a %s_map", thing_word(p->of));
    if (p->of == VALUE_TEXTURE && p->kind == PATTERNED_MAP && p->map.n == 0)
        diag_error(l->diag, at, "a texture with a pattern needs a texture_map");
    fill_block(l, p);
    if (p->use.ops && p->use.ops->prepare) {
        const char *wrong = p->use.ops->prepare((void *)p->use.self, l->scene_mem);
        if (wrong)
            diag_error(l->diag, at, "%s in %s", wrong, p->use.ops->name);
    }
}

/* A use of a declared pattern shares its struct until words change it. */
static void own_self(struct reader *r, struct patterned *p)
{
    if (p->use.ops && p->use.self)
        p->use.self = arena_copy(r->lang->scene_mem, p->use.self, p->use.ops->size);
}

void build_patterned(struct reader *r, struct patterned *p, const struct item *block)
{
    build_of(r->lang);
    own_self(r, p);
    read_start(r, p, block);
    if (p->of == VALUE_NORMAL && p->kind != PATTERNED_NONE
        && (reader_skip_comma(r), reader_is_number(r)))
        p->amount = reader_number(r, false, "how high the bumps are");
    while (reader_peek(r)->kind != ITEM_END) {
        struct item i = reader_next(r);
        if (!read_modifier(r, p, &i))
            wrong_item(r, p, &i);
    }
    check_end(r, p, block);
}
