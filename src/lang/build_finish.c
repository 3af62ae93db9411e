/* build_finish.c: finish { }. */
#include <string.h>

#include "lang/build.h"
#include "lang/colour.h"

static const struct field irid_table[] = {
    { "thickness", FIELD_NUM, offsetof(struct finish, irid_thickness), ANY, "of the film" },
    { "turbulence", FIELD_NUM, offsetof(struct finish, irid_turbulence), ANY, "of the film" },
    FIELD_END,
};

const struct field finish_parts[] = {
    { "albedo", FIELD_CUSTOM, 0, ANY, "the number that follows is the share of all light" },
    { "translucency", FIELD_CUSTOM, 0, ANY, "how far light goes below the surface" },
    { "anisotropy", FIELD_CUSTOM, 0, ANY, "how light is scattered below the surface" },
    { "thickness", FIELD_CUSTOM, 0, ANY, "of an iridescent film" },
    FIELD_END,
};

/* The switches that only count until the block ends. */
struct albedo { bool diffuse, phong, specular; };

static double albedo_number(struct reader *r, const char *word, bool *albedo)
{
    if (reader_takes_word(r, "albedo"))
        *albedo = true;
    return reader_number(r, false, word);
}

static void read_diffuse(struct reader *r, struct finish *f, struct albedo *a)
{
    f->diffuse = albedo_number(r, "diffuse", &a->diffuse);
    f->diffuse_back = 0;
    reader_skip_comma(r);
    if (reader_is_number(r))
        f->diffuse_back = reader_number(r, false, "diffuse of the back");
}

static void read_reflection_block(struct reader *outer, const struct item *block,
                                  struct reflection *to)
{
    const struct field *const tables[] = { reflection_fields, NULL };
    struct reader r;

    reader_open(&r, outer->lang, block->body);
    *to = (struct reflection) { .falloff = 1, .exponent = 1 };
    to->low = to->high = colour_take_rgb(&r, false, "reflection");
    reader_skip_comma(&r);
    bool two = colour_is_next(&r) || reader_is_number(&r);
    if (two)
        to->high = colour_take_rgb(&r, false, "reflection");
    for (struct item i = reader_next(&r); i.kind != ITEM_END; i = reader_next(&r))
        if (!build_from_table(&r, reflection_fields, &i, to))
            build_unknown(outer->lang, &i, "reflection", tables);
    if (to->fresnel && !two)
        to->low = rgb_of(0, 0, 0);
    reader_close(&r);
}

static void read_reflection(struct reader *r, const struct item *i, struct reflection *to)
{
    if (i->kind == ITEM_BLOCK) {
        read_reflection_block(r, i, to);
        return;
    }
    to->low = to->high = colour_take_rgb(r, false, "reflection");
    to->falloff = 1;
    to->fresnel = false;
}

static void read_irid(struct reader *outer, const struct item *block, struct finish *f)
{
    const struct field *const tables[] = { irid_table, NULL };
    struct reader r;

    reader_open(&r, outer->lang, block->body);
    f->irid = reader_number(&r, false, "irid");
    for (struct item i = reader_next(&r); i.kind != ITEM_END; i = reader_next(&r))
        if (!build_from_table(&r, irid_table, &i, f))
            build_unknown(outer->lang, &i, "irid", tables);
    reader_close(&r);
}

static void skip_subsurface(struct reader *outer, const struct item *block)
{
    struct reader r;

    reader_open(&r, outer->lang, block->body);
    for (struct item i = reader_next(&r); i.kind != ITEM_END; i = reader_next(&r)) {
        if (item_is(&i, "translucency") || item_is(&i, "anisotropy"))
            colour_take(&r, false, i.text);
        else
            build_unknown(outer->lang, &i, "subsurface", NULL);
    }
    reader_close(&r);
    diag_unsupported(outer->lang->diag, block->at, "subsurface");
}

static bool read_special(struct reader *r, const struct item *i, struct finish *f,
                         struct albedo *a)
{
    if (item_is(i, "reflection"))
        read_reflection(r, i, &f->reflection);
    else if (item_is_block(i, "irid"))
        read_irid(r, i, f);
    else if (item_is_block(i, "subsurface"))
        skip_subsurface(r, i);
    else if (i->kind != ITEM_WORD)
        return false;
    else if (item_is(i, "diffuse"))
        read_diffuse(r, f, a);
    else if (item_is(i, "phong"))
        f->phong = albedo_number(r, "phong", &a->phong);
    else if (item_is(i, "specular"))
        f->specular = albedo_number(r, "specular", &a->specular);
    else
        return false;
    return true;
}

static void warn_old(struct lang *l, const struct item *i)
{
    if (item_is(i, "ior") || item_is(i, "caustics") || item_is(i, "refraction"))
        diag_warning(l->diag, i->at, "%s in finish is old: it belongs in interior", i->text);
}

/* Facts shading.md 2.1: worked out with the final sizes. */
static void apply_albedo(struct finish *f, const struct albedo *a)
{
    double m = 1 / f->roughness;

    if (a->diffuse) {
        f->diffuse *= (f->brilliance + 1) / 2;
        f->diffuse_back *= (f->brilliance + 1) / 2;
    }
    if (a->phong)
        f->phong *= (f->phong_size + 1) / 2;
    if (a->specular)
        f->specular *= (m + 2) / (4 * (2 - pow(2, -m / 2)));
}

static void check_roughness(struct lang *l, const struct item *block, struct finish *f)
{
    if (f->roughness != 0)
        return;
    diag_warning(l->diag, block->at, "roughness 0 makes a highlight without size");
    f->roughness = 1e-6;
}

const struct finish *build_finish(struct lang *l, const struct item *block,
                                  const struct finish *from)
{
    const struct field *const tables[] = { finish_fields, NULL };
    struct albedo albedo = { 0 };
    struct reader r;

    reader_open(&r, l, block->body);
    const struct finish *declared = build_start(&r, VALUE_FINISH);
    struct finish made, *f = memcpy(&made, declared ? declared : from, sizeof made);
    for (struct item i = reader_next(&r); i.kind != ITEM_END; i = reader_next(&r)) {
        warn_old(l, &i);
        if (!read_special(&r, &i, f, &albedo) && !build_from_table(&r, finish_fields, &i, f))
            build_unknown(l, &i, "finish", tables);
    }
    reader_close(&r);
    check_roughness(l, block, f);
    apply_albedo(f, &albedo);
    return intern_copy(&build_of(l)->finish, l->scene_mem, f, sizeof *f);
}

bool make_finish(struct lang *l, const struct item *block, struct value *out)
{
    *out = value_thing(VALUE_FINISH, build_finish(l, block, build_of(l)->texture->finish));
    return true;
}
