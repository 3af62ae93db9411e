/* build_scene.c: the blocks' table, the top level, #default, declared things. */
#include <string.h>

#include "lang/build.h"
#include "lang/colour.h"
#include "lang/frame.h"
#include "lang/guess.h"

/* --- what blocks there are -------------------------------------------------------------- */

static void use_object(struct lang *l, struct loc at, const struct value *made)
{
    (void)at;
    build_add(l, (struct object *)made->thing);
}

#define SOLID(word, help) { word, VALUE_OBJECT, make_object, use_object, help }

const struct block blocks[] = {
    SOLID("object", "a declared or other object"),
    { "light_source", VALUE_OBJECT, make_light, use_object, "a lamp" },
    SOLID("union", "objects together"),
    SOLID("composite", "old word for union"),
    SOLID("merge", "objects together without inner surfaces"),
    SOLID("intersection", "what objects have in common"),
    SOLID("difference", "the first object without the others"),
    SOLID("light_group", "objects with lights of their own"),
    SOLID("mesh", "triangles"),
    SOLID("mesh2", "triangles from lists"),
    SOLID("blob", "balls and beams that flow together"),
    SOLID("bicubic_patch", "a surface bent by 16 points"),
    SOLID("cubic", "a surface of order 3"),
    SOLID("quartic", "a surface of order 4"),
    SOLID("poly", "a surface of any order"),
    SOLID("polynomial", "a surface of any order, by its terms"),
    SOLID("height_field", "a landscape from a picture"),
    SOLID("isosurface", "where a function is 0"),
    SOLID("julia_fractal", "a fractal of four dimensions"),
    SOLID("lathe", "a curve turned about y"),
    SOLID("parametric", "a surface by three functions"),
    SOLID("polygon", "a flat shape with corners"),
    SOLID("prism", "a flat shape swept along y"),
    SOLID("sor", "a curve turned about y, by squares"),
    SOLID("sphere_sweep", "a ball moved along a curve"),
    SOLID("text", "letters of a font"),
    SOLID("box", "a box"),
    SOLID("sphere", "a ball"),
    SOLID("cylinder", "a cylinder"),
    SOLID("cone", "a cone, perhaps cut"),
    SOLID("torus", "a ring"),
    SOLID("plane", "a plane"),
    SOLID("disc", "a flat disc"),
    SOLID("triangle", "a triangle"),
    SOLID("smooth_triangle", "a triangle with normals"),
    SOLID("superellipsoid", "between a box and a ball"),
    SOLID("ovus", "an egg"),
    SOLID("quadric", "a surface of order 2"),
    { "texture", VALUE_TEXTURE, make_texture, NULL, "how a surface looks" },
    { "pigment", VALUE_PIGMENT, make_pigment, NULL, "colours over space" },
    { "normal", VALUE_NORMAL, make_normal, NULL, "bumps" },
    { "finish", VALUE_FINISH, make_finish, NULL, "how a surface answers light" },
    { "interior", VALUE_INTERIOR, make_interior, NULL, "what fills a solid" },
    { "material", VALUE_MATERIAL, make_material, NULL, "texture and interior" },
    { "media", VALUE_MEDIA, make_media, use_atmosphere, "smoke and glow" },
    { "density", VALUE_DENSITY, make_density, NULL, "how thick media is where" },
    { "color_map", VALUE_COLOUR_MAP, make_colour_map, NULL, "colours by a value" },
    { "colour_map", VALUE_COLOUR_MAP, make_colour_map, NULL, "colours by a value" },
    { "pigment_map", VALUE_PIGMENT_MAP, make_pigment_map, NULL, "pigments by a value" },
    { "normal_map", VALUE_NORMAL_MAP, make_normal_map, NULL, "normals by a value" },
    { "slope_map", VALUE_SLOPE_MAP, make_slope_map, NULL, "heights by a value" },
    { "texture_map", VALUE_TEXTURE_MAP, make_texture_map, NULL, "textures by a value" },
    { "density_map", VALUE_DENSITY_MAP, make_density_map, NULL, "densities by a value" },
    { "transform", VALUE_TRANSFORM, make_transform, NULL, "transforms together" },
    { "camera", VALUE_CAMERA, make_camera, use_camera, "from where the scene is seen" },
    { "fog", VALUE_FOG, make_fog, use_atmosphere, "fog" },
    { "rainbow", VALUE_RAINBOW, make_rainbow, use_atmosphere, "a rainbow" },
    { "sky_sphere", VALUE_SKY_SPHERE, make_sky_sphere, use_sky_sphere, "the sky behind everything" },
    { "background", VALUE_NONE, build_background, NULL, "the colour behind everything" },
    { "global_settings", VALUE_NONE, build_settings, NULL, "what holds for the whole scene" },
    { .word = NULL },
};

#undef SOLID

const struct field *const block_fields[] = {
    finish_fields, reflection_fields, finish_parts, interior_fields, camera_fields, camera_kinds,
    light_fields, settings_fields, settings_more_fields, radiosity_fields, photons_fields,
    subsurface_fields, pattern_fields, image_fields, image_types, warp_fields, object_fields,
    csg_fields, material_fields, mesh_fields, shape_more_fields, transform_fields, media_fields,
    scattering_fields, fog_fields, rainbow_fields, sky_sphere_fields, pattern_more_fields, NULL,
};

/* Looks that many objects share come again soon; a colour for each of a million
 * objects should not cost a place in a table. */
enum { MOST_LOOKS = 4096 };

struct build *build_of(struct lang *l)
{
    if (!l->build) {
        l->build = arena_alloc(l->mem, sizeof *l->build);
        l->build->texture = &texture_default;
        l->build->camera = camera_default;
        l->build->plain.most = l->build->look.most = MOST_LOOKS;
    }
    return l->build;
}

/* --- values ------------------------------------------------------------------------------- */

/* A top-level statement that makes nothing cannot be declared. */
bool build_value(struct lang *l, const struct word *word, const struct item *block,
                 struct value *out)
{
    const struct block *b = word->block;

    build_of(l);
    if (b && b->makes != VALUE_NONE)
        return b->make(l, block, out);
    if (word->shape)
        return make_object(l, block, out);
    return false;
}

bool build_word_value(struct lang *l, struct reader *r, const struct item *word,
                      struct value *out)
{
    struct transform t;

    if (!item_is(word, "transform") || !build_transform(r, word, &t))
        return false;
    *out = value_thing(VALUE_TRANSFORM, arena_copy(l->scene_mem, &t, sizeof t));
    return true;
}

/* --- what the picture cannot show yet ---------------------------------------------------------- */

static void report_pigment(struct lang *l, struct loc at, const struct pigment *p);
static void report_finish(struct lang *l, struct loc at, const struct finish *f);

static void report_texture(struct lang *l, struct loc at, const struct texture *t)
{
    for (; t; t = t->above) {
        if (t->unsupported)
            diag_unsupported(l->diag, at, t->unsupported);
        if (t->kind == TEXTURE_PLAIN && t->pigment)
            report_pigment(l, at, t->pigment);
        if (t->kind == TEXTURE_PLAIN && t->finish)
            report_finish(l, at, t->finish);
        if (t->normal)
            diag_unsupported(l->diag, at, arena_format(l->mem, "normal (%s)", t->normal->word
                                                       ? t->normal->word : "plain"));
        for (size_t i = 0; t->kind != TEXTURE_PLAIN && i < t->n_entry; i++)
            report_texture(l, at, t->entry[i].texture);
    }
}

static void report_pigment(struct lang *l, struct loc at, const struct pigment *p)
{
    if (p->unsupported)
        diag_unsupported(l->diag, at, p->unsupported);
    if (p->kind == PIGMENT_COLOUR || p->kind == PIGMENT_IMAGE)
        return;
    for (size_t i = 0; i < p->n_entry; i++)
        if (p->entry[i].pigment)
            report_pigment(l, at, p->entry[i].pigment);
}

/* The default's ambient is too little to see anything by. */
static bool glows(const struct finish *f)
{
    return f->emission.r + f->emission.g + f->emission.b > 0
        || f->ambient.r + f->ambient.g + f->ambient.b > 0.31f;
}

static void report_finish(struct lang *l, struct loc at, const struct finish *f)
{
    l->build->glows |= glows(f);
    if (f->irid != 0 && f->irid_turbulence != 0)
        diag_unsupported(l->diag, at, "turbulence of irid");
    if (f->caustics > 0)
        diag_unsupported(l->diag, at, "caustics");
}

static void report_interior(struct lang *l, struct loc at, const struct interior *i)
{
    if (i->media)
        diag_unsupported(l->diag, at, "media");
    if (i->dispersion != 1)
        diag_unsupported(l->diag, at, "dispersion");
}

/* The same texture over and over is looked at once. */
static void report_object(struct lang *l, const struct object *o)
{
    struct build *b = l->build;

    b->has_light |= o->kind == OBJECT_LIGHT;
    if (o->more->unsupported)
        diag_unsupported(l->diag, o->at, o->more->unsupported);
    if (o->texture && o->texture != b->reported)
        report_texture(l, o->at, o->texture);
    if (o->texture)
        b->reported = o->texture;
    if (o->more->interior_texture)
        report_texture(l, o->at, o->more->interior_texture);
    if (o->more->interior)
        report_interior(l, o->at, o->more->interior);
    if (o->kind == OBJECT_LIGHT && o->light->projected_through)
        diag_unsupported(l->diag, o->at, "projected_through");
    if (o->kind == OBJECT_LIGHT && o->light->looks_like)
        report_object(l, o->light->looks_like);
    if (o->flags & OBJECT_CUTAWAY_TEXTURES)
        diag_unsupported(l->diag, o->at, "cutaway_textures");
    for (size_t i = 0; i < o->n_child; i++)
        report_object(l, o->child[i]);
}

/* The default texture of this moment is the look of what has none. */
void build_add(struct lang *l, struct object *o)
{
    report_object(l, o);
    if (o->kind != OBJECT_LIGHT && !l->build->first.source)
        l->build->first = o->at;
    if (!o->texture && o->kind == OBJECT_SHAPE && l->diag->lint)
        diag_warning(l->diag, o->at, "no texture: the default's is taken");
    if (!o->texture && o->kind != OBJECT_LIGHT) {
        o->texture = build_of(l)->texture;
        l->build->glows |= o->texture->finish && glows(o->texture->finish);
    }
    if (scene_add(l->scene, o))
        l->build->spare = o;
}

/* --- the top level ------------------------------------------------------------------------------ */

static void unknown_statement(struct lang *l, struct reader *r, const struct item *i)
{
    if ((r->failed || l->skipping) && (i->kind == ITEM_VALUE || i->kind == ITEM_COMMA
                                       || (i->kind == ITEM_WORD && !i->word->block)))
        return;                 /* it is part of what was said to be wrong */
    if (i->kind == ITEM_NAME) {
        struct guess g = guess_start(i->text);
        for (const struct block *b = blocks; b->word; b++)
            guess_try(&g, b->word);
        guess_names(&g, l);
        diag_error(l->diag, i->at, i->body ? "unknown statement '%s'%s"
                                           : "'%s' is not declared, and no statement%s",
                   i->text, guess_text(&g, l));
        guess_note(&g, l);
    } else if (i->kind == ITEM_WORD && i->word->block) {
        diag_error(l->diag, i->at, "'%s' needs braces: %s { }", i->text, i->text);
        if (i->word->block->use || i->word->block->makes == VALUE_NONE)
            error_is_late(l);
    } else
        diag_error(l->diag, i->at, "%s cannot stand outside of all blocks", item_describe(l, i));
}

static void build_block(struct lang *l, const struct item *i, const struct block *b)
{
    struct value v = { .type = VALUE_NONE };

    if (b->makes != VALUE_NONE && !b->use && !l->skipping)
        diag_error(l->diag, i->at, "%s can only stand in an object or be declared", i->text);
    if (b->make(l, i, &v) && b->use)
        b->use(l, i->at, &v);
}

/* max_trace_level and max_intersections outside of global_settings. */
static bool old_setting(struct lang *l, struct reader *r, const struct item *i)
{
    if (i->kind != ITEM_WORD || !(item_is(i, "max_trace_level") || item_is(i, "max_intersections")))
        return false;
    diag_warning(l->diag, i->at, "%s belongs in global_settings { }", i->text);
    unsigned errors = l->diag->errors;
    double n = reader_number(r, false, i->text);
    if (errors != l->diag->errors && reader_peek(r)->kind == ITEM_END)
        error_is_late(l);
    if (item_is(i, "max_trace_level"))
        l->scene->settings.max_trace_level = (int)fmin(fmax(n, 1), 256);
    return true;
}

void build_statement(struct lang *l, struct reader *r, struct item item)
{
    const struct block *b = item.kind == ITEM_BLOCK ? item.word->block : NULL;
    struct object *o;

    build_of(l);
    if (b)
        build_block(l, &item, b);
    else if ((o = build_object(l, &item)))
        build_add(l, o);
    else if (!old_setting(l, r, &item))
        unknown_statement(l, r, &item);
}

/* --- #default --------------------------------------------------------------------------------- */

static void default_texture(struct lang *l, const struct item *i)
{
    const struct texture *t = build_texture(l, i);

    if (t->above || t->kind != TEXTURE_PLAIN)
        diag_error(l->diag, i->at, "the default texture must be plain: no layers, no patterns of textures");
    else
        l->build->texture = t;
}

static bool default_item(struct lang *l, const struct item *i)
{
    struct build *b = l->build;

    if (item_is_block(i, "texture"))
        default_texture(l, i);
    else if (item_is_block(i, "camera"))
        build_default_camera(l, i);
    else if (item_is_block(i, "radiosity"))
        build_importance(l, i);
    else
        return build_look(l, i, &b->texture);
    return true;
}

void build_default(struct lang *l, struct reader *r)
{
    build_of(l);
    for (struct item i = reader_next(r); i.kind != ITEM_END; i = reader_next(r))
        if (!default_item(l, &i))
            build_unknown(l, &i, "#default", NULL);
}

/* --- the end ------------------------------------------------------------------------------------ */

/* Told at the first solid, which shows nothing without them. */
static void say_what_lacks(struct lang *l)
{
    const struct build *b = l->build;
    bool dark = !b->has_light && !b->glows;

    if (l->scene->n_object == 0)
        diag_warning(l->diag, (struct loc) { 0 }, "the scene has no objects");
    else if (dark && !b->has_camera)
        diag_warning(l->diag, b->first, "the scene has no camera, and no light_source: it will be dark");
    else if (dark)
        diag_warning(l->diag, b->first, "the scene has no light_source: it will be dark");
    else if (!b->has_camera)
        diag_warning(l->diag, b->first, "the scene has no camera: it is seen from 0 towards z");
}

/* What should stand at the top of the scene is told there. */
static void say_what_is_assumed(struct lang *l)
{
    const struct settings *s = &l->scene->settings;
    struct loc top = { l->main_source, 0, 0 };

    if (!l->version_given)
        diag_warning(l->diag, top, "no #version: colours and gamma are treated as POV-Ray 3.6 did; "
                     "new scenes begin with #version 3.7;");
    else if (s->version >= 370 && !s->has_assumed_gamma)
        diag_warning(l->diag, l->version_at.source ? l->version_at : top,
                     "no global_settings { assumed_gamma }: taken as 1.0");
}

void build_end(struct lang *l)
{
    build_of(l);
    build_version(l);
    if (l->diag->errors)
        return;
    say_what_lacks(l);
    say_what_is_assumed(l);
}
