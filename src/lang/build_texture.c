/* build_texture.c: texture { }, its layers, and looks given to objects. */
#include <string.h>

#include "lang/build.h"

/* --- layers ---------------------------------------------------------------------- */

static struct texture *copy(struct lang *l, const struct texture *t)
{
    return arena_copy(l->scene_mem, t, sizeof *t);
}

static const struct texture *top_of(const struct texture *t)
{
    while (t->above)
        t = t->above;
    return t;
}

/* All layers again, the highest one given back to be changed. */
static const struct texture *copy_layers(struct lang *l, const struct texture *from,
                                         struct texture **top)
{
    const struct texture *bottom = *top = copy(l, from);

    while ((from = from->above)) {
        struct texture *next = copy(l, from);
        (*top)->above = next;
        *top = next;
    }
    return bottom;
}

/* Layers to be changed.  Thousands of objects may say the same of their one layer:
 * it is made in single, on the caller's stack, and kept once; then NULL. */
static const struct texture *begin_layers(struct lang *l, const struct texture *from,
                                          struct texture *single, struct texture **top)
{
    if (from->above)
        return copy_layers(l, from, top);
    *single = *from;
    *top = single;
    return NULL;
}

/* All that tells one plain layer that was not moved from another. */
static const struct texture *keep_once(struct lang *l, const struct texture *t)
{
    const void *const key[] = { t->pigment, t->normal, t->finish, t->unsupported };
    const void **one = intern_at(&build_of(l)->look, l->scene_mem, key, sizeof key);

    if (!*one)
        *one = copy(l, t);
    return *one;
}

static const struct texture *end_layers(struct lang *l, const struct texture *bottom,
                                        const struct texture *single)
{
    if (bottom)
        return bottom;
    bool is_more = single->kind != TEXTURE_PLAIN || single->uv_mapping
                   || !single->place->is_identity;
    return is_more ? copy(l, single) : keep_once(l, single);
}

const struct texture *texture_over(struct lang *l, struct loc at, const struct texture *below,
                                   const struct texture *above)
{
    struct texture *top;

    if (!below)
        return above;
    if (below->kind != TEXTURE_PLAIN || above->kind != TEXTURE_PLAIN) {
        diag_error(l->diag, at, "textures made by a pattern cannot be layered");
        return above;
    }
    const struct texture *bottom = copy_layers(l, below, &top);
    top->above = above;
    return bottom;
}

/* --- pigment, normal, finish in a texture ------------------------------------------ */

static bool change(struct lang *l, const struct item *i, struct texture *t)
{
    if (item_is_block(i, "pigment"))
        t->pigment = build_pigment(l, i, t->pigment);
    else if (item_is_block(i, "normal"))
        t->normal = build_normal(l, i, t->normal);
    else if (item_is_block(i, "finish"))
        t->finish = build_finish(l, i, t->finish);
    else
        return false;
    return true;
}

static bool is_look(const struct item *i)
{
    return item_is_block(i, "pigment") || item_is_block(i, "normal") || item_is_block(i, "finish");
}

/* The block's struct is worked out in the pattern's own place: a texture that
 * was moved gets a pigment that was not, so the place goes into a new layer
 * only when it moved; what is inside keeps its own. */
static const struct pigment *placed_pigment(struct lang *l, const struct pigment *p,
                                            const struct transform *place)
{
    if (place->is_identity || p->uv_mapping)
        return p;
    struct pigment *moved = arena_copy(l->scene_mem, p, sizeof *p);
    moved->place = transform_moved(l->scene_mem, place, p->place);
    if (p->said) {
        struct patterned *said = arena_copy(l->scene_mem, p->said, sizeof *said);
        said->place = *moved->place;
        moved->said = said;
    }
    return moved;
}

static const struct normal *placed_normal(struct lang *l, const struct normal *n,
                                          const struct transform *place)
{
    if (!n || place->is_identity)
        return n;
    struct normal *moved = arena_copy(l->scene_mem, n, sizeof *n);
    moved->place = transform_compose(place, &n->place);
    return moved;
}

/* Puts a layer's place into its parts, so that a part can be exchanged for one
 * that has not been moved. */
static void settle(struct lang *l, struct texture *t)
{
    if (t->kind != TEXTURE_PLAIN || t->place->is_identity)
        return;
    t->pigment = placed_pigment(l, t->pigment, t->place);
    t->normal = placed_normal(l, t->normal, t->place);
    t->place = &transform_identity;
}

bool build_look(struct lang *l, const struct item *i, const struct texture **layers)
{
    struct texture single, *top;

    if (!is_look(i))
        return false;
    if (!*layers)
        *layers = build_of(l)->texture;
    if (top_of(*layers)->kind != TEXTURE_PLAIN) {
        diag_error(l->diag, i->at, "%s cannot change a texture made by a pattern", i->text);
        struct texture spare = texture_default;
        change(l, i, &spare);
        return true;
    }
    const struct texture *bottom = begin_layers(l, *layers, &single, &top);
    settle(l, top);
    change(l, i, top);
    *layers = end_layers(l, bottom, &single);
    return true;
}

/* --- the forms of texture { } -------------------------------------------------------- */

static bool take_identifiers(struct reader *r, struct texture *t)
{
    const void *thing;

    if ((thing = build_start(r, VALUE_PIGMENT)))
        t->pigment = thing;
    else if ((thing = build_start(r, VALUE_NORMAL)))
        t->normal = thing;
    else if ((thing = build_start(r, VALUE_FINISH)))
        t->finish = thing;
    else
        return false;
    return true;
}

static const struct field texture_words[] = {
    { "pigment", FIELD_CUSTOM, 0, ANY, "its colours" },
    { "normal", FIELD_CUSTOM, 0, ANY, "its bumps" },
    { "finish", FIELD_CUSTOM, 0, ANY, "how it answers light" },
    { "no_bump_scale", FIELD_CUSTOM, 0, ANY, "scaling leaves bumps as high" },
    { "texture_map", FIELD_CUSTOM, 0, ANY, "textures by a pattern" },
    FIELD_END,
};

static void move_layers(struct lang *l, const struct texture **layers, const struct transform *t)
{
    *layers = texture_move(l->scene_mem, *layers, t);
}

/* Only transforms may follow (forms 2, 4 and 5). */
static const struct texture *only_moved(struct reader *r, const struct texture *t)
{
    const struct field *const tables[] = { transform_fields, NULL };
    struct transform move;

    for (struct item i = reader_next(r); i.kind != ITEM_END; i = reader_next(r)) {
        if (build_transform(r, &i, &move))
            move_layers(r->lang, &t, &move);
        else if (is_look(&i)) {
            struct texture spare = texture_default;
            diag_error(r->lang->diag, i.at, "only transforms can follow a texture made by a pattern");
            change(r->lang, &i, &spare);
        } else
            build_unknown(r->lang, &i, "a texture made by a pattern", tables);
    }
    return t;
}

/* Of layers, pigment, normal and finish change the highest; transforms move
 * them all. */
static const struct texture *plain(struct reader *r, const struct texture *from)
{
    const struct field *const tables[] = { texture_words, transform_fields, NULL };
    struct texture single, *top;
    struct transform move;

    if (reader_peek(r)->kind == ITEM_END)
        return from;                    /* thousands of objects may share it */
    const struct texture *bottom = begin_layers(r->lang, from, &single, &top);
    while (take_identifiers(r, top))
        continue;
    for (struct item i = reader_next(r); i.kind != ITEM_END; i = reader_next(r)) {
        if (is_look(&i)) {
            settle(r->lang, top);
            change(r->lang, &i, top);
        } else if (build_transform(r, &i, &move)) {
            for (struct texture *t = bottom ? (struct texture *)bottom : top; t;
                 t = (struct texture *)t->above)
                if (!t->uv_mapping)
                    t->place = transform_moved(r->lang->scene_mem, &move, t->place);
        } else if (i.kind != ITEM_WORD || !item_is(&i, "no_bump_scale"))
            build_unknown(r->lang, &i, "texture", tables);
    }
    return end_layers(r->lang, bottom, &single);
}

/* With all layers of each entry. */
static struct nest nest_of(struct nest nest, const struct map_entry *entry, size_t n)
{
    for (size_t i = 0; i < n; i++)
        for (const struct texture *t = entry[i].texture; t; t = t->above) {
            nest_add(&nest, t->nest);
            if (t->pigment)
                nest_add(&nest, t->pigment->nest);
        }
    return nest;
}

static const struct texture *patterned(struct reader *r, const struct item *block)
{
    struct patterned p = patterned_new(VALUE_TEXTURE);

    build_patterned(r, &p, block);
    struct texture *t = copy(r->lang, &texture_default);
    t->kind = p.kind == PATTERNED_AVERAGE ? TEXTURE_AVERAGE : TEXTURE_MAP;
    t->pattern = arena_copy(r->lang->scene_mem, &p.use, sizeof p.use);
    t->entry = (struct map_entry *)p.map.entry;
    t->n_entry = p.map.n;
    t->nest = nest_of(p.nest, p.map.entry, p.map.n);
    t->place = arena_copy(r->lang->scene_mem, &p.place, sizeof p.place);
    t->uv_mapping = p.uv_mapping;
    lang_may_nest(r->lang, block ? block->at : r->brace, &t->nest);
    if (p.unsupported || p.map.n == 0) {    /* the first entry stands for all */
        *t = p.map.n > 0 ? *p.map.entry[0].texture : *r->lang->build->texture;
        t->unsupported = p.unsupported;
    }
    return t;
}

/* texture { uv_mapping texture { } }-like bodies: the rest is in (u, v). */
static const struct texture *uv_mapped(struct reader *r, const struct item *block)
{
    struct texture *top;
    const struct texture *t = copy_layers(r->lang, build_texture_body(r, block), &top);

    for (struct texture *layer = (struct texture *)t; layer; layer = (struct texture *)layer->above)
        layer->uv_mapping = true;
    return t;
}

/* tiles { texture { } tile2 texture { } }: a checker whose entries are the
 * other way round. */
static const struct texture *read_tile(struct reader *r)
{
    const struct texture *layers = NULL;

    while (item_is_block(reader_peek(r), "texture")) {
        struct item i = reader_next(r);
        layers = texture_over(r->lang, i.at, layers, build_texture(r->lang, &i));
    }
    return layers ? layers : r->lang->build->texture;
}

static const struct texture *tiles(struct reader *outer, const struct item *block)
{
    struct lang *l = outer->lang;
    struct map_entry *e = arena_array(l->scene_mem, 2, sizeof *e);
    struct texture *t = copy(l, &texture_default);
    struct reader r;

    reader_open(&r, l, block->body);
    e[1].texture = read_tile(&r);
    if (!reader_takes_word(&r, "tile2"))
        diag_error(l->diag, reader_at(&r), "tiles needs tile2 and a second texture");
    e[0].texture = read_tile(&r);
    if (reader_peek(&r)->kind != ITEM_END)
        build_unknown(l, reader_peek(&r), "tiles", NULL);
    reader_close(&r);
    e[1].value = 1;
    t->kind = TEXTURE_MAP;
    struct pattern_use checker = *texture_default.pattern;
    checker.ops = pattern_find("checker");
    checker.frequency = 0;
    t->pattern = arena_copy(l->scene_mem, &checker, sizeof checker);
    t->entry = e;
    t->n_entry = 2;
    t->nest = nest_of(t->nest, e, 2);
    lang_may_nest(l, block->at, &t->nest);
    return checker.ops ? t : e[1].texture;
}

static const struct texture *material_map(struct reader *outer, const struct item *block)
{
    struct image_use use = { 0 };
    bool unsupported = false;

    build_image(outer->lang, block, &use, &unsupported);
    struct texture *t = copy(outer->lang, build_of(outer->lang)->texture);
    t->unsupported = "material_map";
    return t;
}

const struct texture *build_texture_body(struct reader *r, const struct item *block)
{
    const struct texture *declared = build_start(r, VALUE_TEXTURE);
    struct build *b = build_of(r->lang);
    const struct item *i = reader_peek(r);

    if (declared && declared->kind != TEXTURE_PLAIN)
        return only_moved(r, declared);
    if (declared)
        return plain(r, declared);
    if (item_is_block(i, "tiles") || item_is_block(i, "material_map")) {
        struct item first = reader_next(r);
        return only_moved(r, item_is(&first, "tiles") ? tiles(r, &first)
                                                      : material_map(r, &first));
    }
    if (i->kind == ITEM_WORD && item_is(i, "uv_mapping")) {
        reader_next(r);
        return uv_mapped(r, block);
    }
    return patterned_starts(i) ? patterned(r, block) : plain(r, b->texture);
}

const struct texture *build_texture(struct lang *l, const struct item *block)
{
    const struct texture *named = build_named(block, VALUE_TEXTURE);
    struct reader r;

    if (named)
        return named;
    reader_open(&r, l, block->body);
    const struct texture *t = build_texture_body(&r, block);
    reader_close(&r);
    return t;
}

/* Further blocks of one declaration lie over those before. */
bool make_texture(struct lang *l, const struct item *block, struct value *out)
{
    const struct texture *below = out->type == VALUE_TEXTURE ? out->thing : NULL;

    build_of(l);
    *out = value_thing(VALUE_TEXTURE, texture_over(l, block->at, below, build_texture(l, block)));
    return true;
}
