/* build_interior.c: interior { }, material { }, media { }. */
#include <string.h>

#include "lang/build.h"
#include "lang/colour.h"

/* --- media ------------------------------------------------------------------------ */

static void read_scattering(struct reader *outer, const struct item *block, struct media *m)
{
    const struct field *const tables[] = { scattering_fields, NULL };
    struct reader r;

    reader_open(&r, outer->lang, block->body);
    struct loc at = reader_at(&r);
    m->scattering_type = reader_whole(&r, false, "type of scattering");
    if (m->scattering_type < 1 || m->scattering_type > 5)
        diag_error(outer->lang->diag, at, "scattering has the types 1 to 5");
    m->scattering = colour_take_rgb(&r, true, "scattering");
    for (struct item i = reader_next(&r); i.kind != ITEM_END; i = reader_next(&r))
        if (!build_from_table(&r, scattering_fields, &i, m))
            build_unknown(outer->lang, &i, "scattering", tables);
    reader_close(&r);
}

static void add_density(struct lang *l, const struct item *block, struct media *m)
{
    struct value v;

    make_density(l, block, &v);
    const struct pigment **more = arena_array(l->scene_mem, m->n_density + 1, sizeof *more);
    if (m->n_density > 0)
        memcpy(more, m->density, m->n_density * sizeof *more);
    more[m->n_density++] = v.thing;
    m->density = more;
}

/* samples LEAST [, MOST] */
static void read_samples(struct reader *r, const struct item *i, struct media *m)
{
    m->samples_min = m->samples_max = reader_whole(r, false, "samples");
    reader_skip_comma(r);
    if (reader_is_number(r))
        m->samples_max = reader_whole(r, false, "samples");
    if (m->samples_min < 1)
        diag_error(r->lang->diag, i->at, "samples: there must be one at least");
    else if (m->samples_max < m->samples_min)
        diag_error(r->lang->diag, i->at, "samples: the most is smaller than the least");
}

static bool read_media_item(struct reader *r, const struct item *i, struct media *m)
{
    struct transform t;

    if (build_transform(r, i, &t))
        m->place = transform_compose(&t, &m->place);
    else if (item_is_block(i, "scattering"))
        read_scattering(r, i, m);
    else if (item_is_block(i, "density"))
        add_density(r->lang, i, m);
    else if (i->kind == ITEM_WORD && item_is(i, "samples"))
        read_samples(r, i, m);
    else
        return build_from_table(r, media_fields, i, m);
    return true;
}

bool make_media(struct lang *l, const struct item *block, struct value *out)
{
    const struct field *const tables[] = { media_fields, transform_fields, NULL };
    struct reader r;

    reader_open(&r, l, block->body);
    const struct media *declared = build_start(&r, VALUE_MEDIA);
    struct media *m = arena_copy(l->scene_mem, declared ? declared : &media_default, sizeof *m);
    m->more = NULL;
    for (struct item i = reader_next(&r); i.kind != ITEM_END; i = reader_next(&r))
        if (!read_media_item(&r, &i, m))
            build_unknown(l, &i, "media", tables);
    reader_close(&r);
    *out = value_thing(VALUE_MEDIA, m);
    return true;
}

/* --- interior ----------------------------------------------------------------------- */

static void add_media(struct lang *l, const struct item *block, struct interior *to)
{
    struct value v;

    make_media(l, block, &v);
    ((struct media *)v.thing)->more = to->media;
    to->media = v.thing;
}

const struct interior *build_interior(struct lang *l, const struct item *block,
                                      const struct interior *from)
{
    const struct field *const tables[] = { interior_fields, NULL };
    struct reader r;

    reader_open(&r, l, block->body);
    const struct interior *declared = build_start(&r, VALUE_INTERIOR);
    if (!from)
        from = &interior_default;
    struct interior *to = arena_copy(l->scene_mem, declared ? declared : from, sizeof *to);
    for (struct item i = reader_next(&r); i.kind != ITEM_END; i = reader_next(&r)) {
        if (item_is_block(&i, "media"))
            add_media(l, &i, to);
        else if (!build_from_table(&r, interior_fields, &i, to))
            build_unknown(l, &i, "interior", tables);
    }
    reader_close(&r);
    return to;
}

bool make_interior(struct lang *l, const struct item *block, struct value *out)
{
    *out = value_thing(VALUE_INTERIOR, build_interior(l, block, NULL));
    return true;
}

/* --- material ------------------------------------------------------------------------ */

const struct field material_fields[] = {
    { "texture", FIELD_CUSTOM, 0, ANY, "how the outside looks" },
    { "interior_texture", FIELD_CUSTOM, 0, ANY, "how the inside looks" },
    { "interior", FIELD_CUSTOM, 0, ANY, "what fills it" },
    FIELD_END,
};

static bool read_material_item(struct reader *r, const struct item *i, struct material *m)
{
    struct lang *l = r->lang;
    struct transform t;

    if (item_is_block(i, "texture"))
        m->texture = texture_over(l, i->at, m->texture, build_texture(l, i));
    else if (item_is_block(i, "interior_texture"))
        m->interior_texture = texture_over(l, i->at, m->interior_texture, build_texture(l, i));
    else if (item_is_block(i, "interior"))
        m->interior = build_interior(l, i, m->interior);
    else if (build_transform(r, i, &t)) {
        m->texture = texture_move(l->scene_mem, m->texture, &t);
        m->interior_texture = texture_move(l->scene_mem, m->interior_texture, &t);
    } else
        return false;
    return true;
}

bool make_material(struct lang *l, const struct item *block, struct value *out)
{
    const struct field *const tables[] = { material_fields, transform_fields, NULL };
    struct reader r;

    build_of(l);
    reader_open(&r, l, block->body);
    const struct material *declared = build_start(&r, VALUE_MATERIAL);
    struct material *m = arena_alloc(l->scene_mem, sizeof *m);
    if (declared)
        *m = *declared;
    for (struct item i = reader_next(&r); i.kind != ITEM_END; i = reader_next(&r))
        if (!read_material_item(&r, &i, m))
            build_unknown(l, &i, "material", tables);
    reader_close(&r);
    *out = value_thing(VALUE_MATERIAL, m);
    return true;
}
