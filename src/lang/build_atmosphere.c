/* build_atmosphere.c: fog { }, rainbow { }, sky_sphere { }, background { }. */
#include <string.h>

#include "lang/build.h"
#include "lang/colour.h"

/* --- fog ----------------------------------------------------------------------------- */

static bool read_fog_item(struct reader *r, const struct item *i, struct fog *f)
{
    struct transform t;

    if (build_transform(r, i, &t))
        f->up = vec_unit(mat_direction(&t.to, f->up));
    else
        return build_from_table(r, fog_fields, i, f);
    return true;
}

bool make_fog(struct lang *l, const struct item *block, struct value *out)
{
    const struct field *const tables[] = { fog_fields, transform_fields, NULL };
    struct reader r;

    reader_open(&r, l, block->body);
    const struct fog *declared = build_start(&r, VALUE_FOG);
    struct fog *f = arena_copy(l->scene_mem, declared ? declared : &fog_default, sizeof *f);
    while (reader_peek(&r)->kind != ITEM_END) {
        if (colour_is_next(&r)) {
            f->colour = colour_take(&r, false, "fog");
            continue;
        }
        struct item i = reader_next(&r);
        if (!read_fog_item(&r, &i, f))
            build_unknown(l, &i, "fog", tables);
    }
    reader_close(&r);
    *out = value_thing(VALUE_FOG, f);
    return true;
}

/* --- rainbow --------------------------------------------------------------------------- */

static bool read_rainbow_item(struct reader *r, const struct item *i, struct rainbow *b)
{
    struct value v;

    if (!item_is_block(i, "color_map") && !item_is_block(i, "colour_map"))
        return build_from_table(r, rainbow_fields, i, b);
    make_colour_map(r->lang, i, &v);
    const struct map *m = v.thing;
    b->entry = m->entry;
    b->n_entry = m->n;
    return true;
}

static void check_rainbow(struct lang *l, const struct item *block, const struct rainbow *b)
{
    if (!(vec_largest(b->direction) > 0))
        build_wrong(l, block, "a rainbow needs a direction that is not 0");
    else if (!(vec_largest(vec_cross(b->direction, b->up)) > 1e-10))
        build_wrong(l, block, "a rainbow's direction and up point the same way");
}

bool make_rainbow(struct lang *l, const struct item *block, struct value *out)
{
    const struct field *const tables[] = { rainbow_fields, NULL };
    struct reader r;

    reader_open(&r, l, block->body);
    const struct rainbow *declared = build_start(&r, VALUE_RAINBOW);
    struct rainbow *b = arena_copy(l->scene_mem, declared ? declared : &rainbow_default, sizeof *b);
    for (struct item i = reader_next(&r); i.kind != ITEM_END; i = reader_next(&r))
        if (!read_rainbow_item(&r, &i, b))
            build_unknown(l, &i, "rainbow", tables);
    reader_close(&r);
    check_rainbow(l, block, b);
    *out = value_thing(VALUE_RAINBOW, b);
    return true;
}

/* --- sky_sphere -------------------------------------------------------------------------- */

static void add_pigment(struct lang *l, const struct item *block, struct sky_sphere *s)
{
    const struct pigment **more = arena_array(l->scene_mem, s->n_pigment + 1, sizeof *more);

    if (s->n_pigment > 0)
        memcpy(more, s->pigment, s->n_pigment * sizeof *more);
    more[s->n_pigment++] = build_pigment(l, block, build_of(l)->texture->pigment);
    s->pigment = more;
}

bool make_sky_sphere(struct lang *l, const struct item *block, struct value *out)
{
    const struct field *const tables[] = { sky_sphere_fields, transform_fields, NULL };
    unsigned errors = l->diag->errors;
    struct transform t;
    struct reader r;

    reader_open(&r, l, block->body);
    const struct sky_sphere *declared = build_start(&r, VALUE_SKY_SPHERE);
    struct sky_sphere *s = arena_copy(l->scene_mem, declared ? declared : &sky_sphere_default,
                                      sizeof *s);
    for (struct item i = reader_next(&r); i.kind != ITEM_END; i = reader_next(&r)) {
        if (item_is_block(&i, "pigment"))
            add_pigment(l, &i, s);
        else if (build_transform(&r, &i, &t))
            s->place = transform_compose(&t, &s->place);
        else if (!build_from_table(&r, sky_sphere_fields, &i, s) && errors == l->diag->errors)
            build_unknown(l, &i, "sky_sphere", tables);
    }
    reader_close(&r);
    if (s->n_pigment == 0 && errors == l->diag->errors)
        build_wrong(l, block, "a sky_sphere needs a pigment");
    *out = value_thing(VALUE_SKY_SPHERE, s);
    return true;
}

void use_sky_sphere(struct lang *l, struct loc at, const struct value *made)
{
    if (build_of(l)->has_sky)
        diag_warning(l->diag, at, "a second sky_sphere: only the last one counts");
    l->build->has_sky = true;
    l->scene->sky_sphere = made->thing;
}

static void use_fog(struct lang *l, const struct fog *f)
{
    struct scene *s = l->scene;

    s->fog = arena_grow(s->mem, s->fog, s->n_fog, &s->room_fog, sizeof *s->fog);
    s->fog[s->n_fog++] = f;
}

void use_atmosphere(struct lang *l, struct loc at, const struct value *made)
{
    if (made->type == VALUE_FOG)
        use_fog(l, made->thing);
    else
        diag_unsupported(l->diag, at, value_type_name(made->type));
}

/* --- background ---------------------------------------------------------------------------- */

bool build_background(struct lang *l, const struct item *block, struct value *out)
{
    struct reader r;

    *out = (struct value) { .type = VALUE_NONE };
    reader_open(&r, l, block->body);
    l->scene->background = (colour) { 0 };
    if (reader_peek(&r)->kind != ITEM_END)
        l->scene->background = colour_take(&r, false, "background");
    l->scene->has_background = true;
    struct item rest = reader_next(&r);
    if (rest.kind != ITEM_END)
        build_unknown(l, &rest, "background", NULL);
    reader_close(&r);
    return true;
}
