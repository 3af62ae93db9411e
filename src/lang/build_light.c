/* build_light.c: light_source { }, light_group { }. */
#include <string.h>

#include "lang/build.h"
#include "lang/colour.h"

/* --- kinds ---------------------------------------------------------------------- */

static void make_spot(struct light *l)
{
    l->kind = LIGHT_SPOT;
    l->radius = 30;
    l->falloff = 45;
    l->tightness = 0;
}

static void make_beam(struct light *l)
{
    l->kind = LIGHT_CYLINDER;
    l->parallel = true;
    l->radius = 0.75;
    l->falloff = 1;
    l->tightness = 0;
}

/* Words that only make sense after the light's kind: facts sdl.md 6.8. */
static void check_order(struct lang *l, const struct item *i, const struct light *light)
{
    bool sized = item_is(i, "radius") || item_is(i, "falloff") || item_is(i, "tightness");

    if (l->reader->failed)              /* an unknown word may have been the one that lacks */
        return;
    if (sized && light->kind == LIGHT_POINT)
        diag_error(l->diag, i->at, "%s needs spotlight or cylinder before it", i->text);
    if (item_is(i, "point_at") && light->kind == LIGHT_POINT && !light->parallel)
        diag_error(l->diag, i->at, "point_at needs spotlight, cylinder or parallel before it");
}

static int count(struct reader *r, const char *what)
{
    struct loc at;

    reader_skip_comma(r);
    at = reader_at(r);
    int n = reader_whole(r, false, what);
    if (n >= 1)
        return n;
    diag_error(r->lang->diag, at, "an area light needs at least 1 light each way, not %d", n);
    return 1;
}

/* Each point remembers what it saw of every light. */
static void keep_few(struct reader *r, struct light *l, struct loc at)
{
    enum { MOST = 1 << 20 };

    if ((double)l->samples1 * l->samples2 <= MOST)
        return;
    diag_error(r->lang->diag, at, "an area light of %d by %d lights: at most %d are possible",
               l->samples1, l->samples2, (int)MOST);
    l->samples1 = l->samples2 = 1;
}

static void read_area(struct reader *r, struct light *l)
{
    l->is_area = true;
    l->axis1 = build_vector(r, false, "axis of area_light");
    l->axis2 = build_vector(r, true, "second axis of area_light");
    reader_skip_comma(r);
    struct loc at = reader_at(r);
    l->samples1 = count(r, "area_light");
    l->samples2 = count(r, "area_light");
    keep_few(r, l, at);
}

/* Its colours, weighted, are added to the light's. */
static void add_spectrum(struct lang *l, const struct item *block, struct light *light)
{
    struct value v;

    make_colour_map(l, block, &v);
    const struct map *m = v.thing;
    for (size_t i = 0; i < m->n; i++)
        light->colour = rgb_add(light->colour, rgb_scale(colour_rgb(m->entry[i].colour),
                                                         (float)m->entry[i].value));
}

/* An object and its modifiers in braces. */
static struct object *read_inner(struct lang *l, const struct item *block)
{
    struct reader r;

    reader_open(&r, l, block->body);
    struct item first = reader_next(&r);
    struct object *o = build_object(l, &first);
    if (!o) {
        diag_error(l->diag, first.at, "expected an object in %s; found %s", block->text,
                   item_describe(l, &first));
        o = object_start(l, OBJECT_UNION, block->at);
    }
    build_modifiers(&r, o, block, NULL, NULL, NULL);
    reader_close(&r);
    return o;
}

static bool read_photons(struct reader *outer, const struct item *block)
{
    struct reader r;

    reader_open(&r, outer->lang, block->body);
    for (struct item i = reader_next(&r); i.kind != ITEM_END; i = reader_next(&r)) {
        if (i.kind != ITEM_WORD || !(item_is(&i, "refraction") || item_is(&i, "reflection")
                                     || item_is(&i, "area_light")))
            build_unknown(outer->lang, &i, "photons", NULL);
        else
            build_flag(&r);
    }
    reader_close(&r);
    return true;
}

/* --- the block ----------------------------------------------------------------- */

struct reading {
    struct light light;
    struct transform place;
    struct object *seen;                /* looks_like, in the light's place */
};

static bool read_block(struct reader *r, const struct item *i, struct reading *w)
{
    if (item_is_block(i, "looks_like")) {
        if (w->seen)
            diag_error(r->lang->diag, i->at, "a light has one looks_like");
        w->seen = read_inner(r->lang, i);
    } else if (item_is_block(i, "projected_through")) {
        w->light.projected_through = read_inner(r->lang, i);
    } else if (item_is_block(i, "color_map") || item_is_block(i, "colour_map"))
        add_spectrum(r->lang, i, &w->light);
    else if (item_is_block(i, "photons"))
        read_photons(r, i);
    else
        return false;
    return true;
}

static bool read_item(struct reader *r, const struct item *i, struct reading *w)
{
    struct transform t;

    if (build_transform(r, i, &t)) {
        w->place = transform_compose(&t, &w->place);
        return true;
    }
    if (read_block(r, i, w))
        return true;
    if (i->kind != ITEM_WORD)
        return false;
    check_order(r->lang, i, &w->light);
    if (item_is(i, "spotlight"))
        make_spot(&w->light);
    else if (item_is(i, "cylinder"))
        make_beam(&w->light);
    else if (item_is(i, "area_light"))
        read_area(r, &w->light);
    else
        return build_from_table(r, light_fields, i, &w->light);
    return true;
}

static void check_area(struct lang *l, const struct item *block, struct light *light)
{
    if (light->orient && !light->circular) {
        diag_warning(l->diag, block->at, "orient makes an area light circular");
        light->circular = true;
    }
    if (light->circular && light->is_area && (light->samples1 < 2 || light->samples2 < 2))
        build_wrong(l, block, "a circular area light needs more than 1 light each way");
}

static const struct field *const light_tables[] = { light_fields, transform_fields, NULL };

static void read_rest(struct reader *r, struct reading *w)
{
    for (struct item i = reader_next(r); i.kind != ITEM_END; i = reader_next(r))
        if (!read_item(r, &i, w))
            build_unknown(r->lang, &i, "light_source", light_tables);
}

static struct object *light_object(struct lang *l, const struct light *light, struct loc at)
{
    struct object *o = object_start(l, OBJECT_LIGHT, at);

    o->light = arena_copy(l->scene_mem, light, sizeof *light);
    return o;
}

/* What the light looks like stands at its centre, casts no shadow, and moves
 * with it (scene_add). */
static void place_looks(struct lang *l, struct reading *w)
{
    struct transform to_light = transform_translate(w->light.centre);

    if (!w->seen)
        return;
    object_move(l->scene_mem, w->seen, &to_light);
    if (!w->seen->texture)
        w->seen->texture = build_of(l)->texture;
    w->seen->flags |= OBJECT_NO_SHADOW;
    w->seen->flags_given |= OBJECT_NO_SHADOW;
    w->light.looks_like = w->seen;
}

static struct object *copied(struct reader *r, const struct object *from, const struct item *block)
{
    struct object *o = object_copy(r->lang->scene_mem, from);
    struct reading w = { .light = *from->light, .place = transform_identity };

    read_rest(r, &w);
    check_area(r->lang, block, &w.light);
    place_looks(r->lang, &w);
    o->light = arena_copy(r->lang->scene_mem, &w.light, sizeof w.light);
    object_move(r->lang->scene_mem, o, &w.place);
    return o;
}

static struct object *fresh(struct reader *r, const struct item *block)
{
    struct reading w = { .light = light_default, .place = transform_identity };

    w.light.centre = build_vector(r, false, "place of light_source");
    reader_skip_comma(r);
    if (colour_is_next(r) || reader_is_number(r))
        w.light.colour = colour_take_rgb(r, false, "light_source");
    read_rest(r, &w);
    check_area(r->lang, block, &w.light);
    place_looks(r->lang, &w);
    struct object *o = light_object(r->lang, &w.light, block->at);
    object_move(r->lang->scene_mem, o, &w.place);
    return o;
}

static bool is_light(const struct object *o) { return o->kind == OBJECT_LIGHT; }

bool make_light(struct lang *l, const struct item *block, struct value *out)
{
    struct reader r;

    reader_open(&r, l, block->body);
    bool declared = item_is_thing(reader_peek(&r), VALUE_OBJECT)
                    && is_light(reader_peek(&r)->value.thing);
    struct object *o = declared ? copied(&r, reader_next(&r).value.thing, block)
                                : fresh(&r, block);
    reader_close(&r);
    *out = value_thing(VALUE_OBJECT, o);
    return true;
}
