/* build_object.c: object { }, the modifiers of all objects, and their end. */
#include <string.h>

#include "lang/build.h"
#include "lang/guess.h"
#include "lang/scope.h"
#include "lang/colour.h"
#include "lang/frame.h"

struct object *object_start(struct lang *l, enum object_kind kind, struct loc at)
{
    struct object *o = l->build->spare;

    if (o)
        object_renew(o, kind);
    else
        o = object_new(l->scene_mem, kind);
    l->build->spare = NULL;
    o->at = at;
    return o;
}

/* --- which items are objects ------------------------------------------------------- */

bool item_is_object(const struct item *i)
{
    if (i->kind == ITEM_VALUE)
        return i->value.type == VALUE_OBJECT;
    if (i->kind != ITEM_BLOCK)
        return false;
    return i->word->shape || i->word->special || item_is(i, "object") || item_is(i, "light_source");
}

struct object *build_object(struct lang *l, const struct item *i)
{
    struct value v = { .type = VALUE_NONE };

    if (!item_is_object(i))
        return NULL;
    if (i->kind == ITEM_VALUE) {
        struct object *copy = object_copy(l->scene_mem, i->value.thing);
        if (i->name)
            copy->name = i->name;
        return copy;
    }
    if (item_is(i, "light_source"))
        make_light(l, i, &v);
    else
        make_object(l, i, &v);
    return (struct object *)v.thing;
}

/* --- modifiers ----------------------------------------------------------------------- */

const struct field object_fields[] = {
    { "texture", FIELD_CUSTOM, 0, ANY, "a layer of its look" },
    { "pigment", FIELD_CUSTOM, 0, ANY, "its colours" },
    { "normal", FIELD_CUSTOM, 0, ANY, "its bumps" },
    { "finish", FIELD_CUSTOM, 0, ANY, "how it answers light" },
    { "interior_texture", FIELD_CUSTOM, 0, ANY, "how its inside looks" },
    { "interior", FIELD_CUSTOM, 0, ANY, "what fills it" },
    { "material", FIELD_CUSTOM, 0, ANY, "texture and interior together" },
    { "bounded_by", FIELD_CUSTOM, 0, ANY, "a simple object around it" },
    { "clipped_by", FIELD_CUSTOM, 0, ANY, "only what is inside remains" },
    { "inverse", FIELD_CUSTOM, OBJECT_INVERSE, ANY, "inside and outside change places" },
    { "no_shadow", FIELD_CUSTOM, OBJECT_NO_SHADOW, ANY, "casts no shadow" },
    { "no_image", FIELD_CUSTOM, OBJECT_NO_IMAGE, ANY, "not seen by the camera itself" },
    { "no_reflection", FIELD_CUSTOM, OBJECT_NO_REFLECTION, ANY, "not seen in mirrors" },
    { "no_radiosity", FIELD_CUSTOM, OBJECT_NO_RADIOSITY, ANY, "not seen by radiosity" },
    { "hollow", FIELD_CUSTOM, OBJECT_HOLLOW, ANY, "media and fog are inside too" },
    { "double_illuminate", FIELD_CUSTOM, OBJECT_DOUBLE_ILLUMINATE, ANY, "lit from both sides" },
    { "cutaway_textures", FIELD_CUSTOM, OBJECT_CUTAWAY_TEXTURES, ANY, "cuts look like what is cut" },
    { "uv_mapping", FIELD_CUSTOM, OBJECT_UV_MAPPING, ANY, "textures follow the surface" },
    { "sturm", FIELD_CUSTOM, 0, ANY, "not needed: roots are always found with care" },
    { "hierarchy", FIELD_CUSTOM, 0, ANY, "not needed" },
    { "split_union", FIELD_CUSTOM, 0, ANY, "whether a union's parts stand alone" },
    { "photons", FIELD_CUSTOM, 0, ANY, "how photons treat it" },
    { "radiosity", FIELD_CUSTOM, 0, ANY, "how radiosity treats it" },
    { "dtag", FIELD_CUSTOM, 0, ANY, "read, but not needed" },
    FIELD_END,
};

static bool is_among(const char *word, const char *const *list)
{
    for (; *list; list++)
        if (strcmp(word, *list) == 0)
            return true;
    return false;
}

static const char *shape_word(const struct object *o, const struct item *block)
{
    if (o->more->unsupported)
        return o->more->unsupported;
    return o->kind == OBJECT_SHAPE ? o->ops->name : o->kind == OBJECT_MESH ? "mesh" : block->text;
}

/* What only some kinds of objects take: facts sdl.md 6.2. */
static bool is_for(const struct object *o, const struct item *block, const char *word)
{
    static const char *const sturm[] = { "blob", "cubic", "quartic", "poly", "polynomial", "lathe",
                                         "ovus", "prism", "sor", "torus", NULL };
    static const char *const hierarchy[] = { "blob", "height_field", "mesh", "mesh2", NULL };
    bool is_csg = o->kind == OBJECT_INTERSECTION || o->kind == OBJECT_DIFFERENCE;

    if (strcmp(word, "sturm") == 0)
        return is_among(shape_word(o, block), sturm);
    if (strcmp(word, "hierarchy") == 0)
        return is_among(shape_word(o, block), hierarchy);
    if (strcmp(word, "split_union") == 0)
        return o->kind == OBJECT_UNION && !o->more->unsupported;
    if (strcmp(word, "cutaway_textures") == 0)
        return is_csg;
    return true;
}

static void set_flag(struct object *o, unsigned flag, bool on)
{
    o->flags_given |= (uint16_t)flag;
    o->flags = (uint16_t)(on ? o->flags | flag : o->flags & ~flag);
}

static void invert(struct reader *r, struct object *o, struct loc at)
{
    bool patch = o->kind == OBJECT_SHAPE && !o->ops->inside;

    if (patch)
        diag_warning(r->lang->diag, at, "%s has no inside: inverse changes nothing", o->ops->name);
    else
        o->flags ^= OBJECT_INVERSE;
}

static void read_flag(struct reader *r, struct object *o, const struct item *i, unsigned flag)
{
    switch (flag) {
    case OBJECT_INVERSE:
        invert(r, o, i->at);
        return;
    case OBJECT_NO_SHADOW: case OBJECT_CUTAWAY_TEXTURES:
        set_flag(o, flag, true);
        return;
    case OBJECT_UV_MAPPING:
        if (o->texture)
            diag_error(r->lang->diag, i->at, "uv_mapping must stand before texture, pigment, normal and finish");
        set_flag(o, flag, true);
        return;
    default:
        set_flag(o, flag, build_flag(r));
    }
}

/* bounded_by { objects transforms }, and the links between the two. */
static const struct object **read_list(struct lang *l, const struct item *block, size_t *n)
{
    const struct object **list = NULL;
    size_t room = 0;
    struct transform t;
    struct reader r;

    *n = 0;
    reader_open(&r, l, block->body);
    for (struct item i = reader_next(&r); i.kind != ITEM_END; i = reader_next(&r)) {
        struct object *o = build_object(l, &i);
        if (o) {
            list = arena_grow(l->scene_mem, list, *n, &room, sizeof *list);
            list[(*n)++] = o;
        } else if (build_transform(&r, &i, &t)) {
            for (size_t k = 0; k < *n; k++)
                object_move(l->scene_mem, (struct object *)list[k], &t);
        } else
            build_unknown(l, &i, block->text, NULL);
    }
    reader_close(&r);
    if (*n == 0)
        build_wrong(l, block, "%s needs an object", block->text);
    return list;
}

static bool links_to(struct lang *l, const struct item *block, const char *word)
{
    struct reader r;

    reader_open(&r, l, block->body);
    bool links = reader_peek(&r)->kind == ITEM_WORD && item_is(reader_peek(&r), word);
    if (links) {
        reader_next(&r);
        if (reader_peek(&r)->kind != ITEM_END)
            build_unknown(l, reader_peek(&r), block->text, NULL);
    }
    reader_close(&r);
    return links;
}

/* Several lists cut together: each adds its objects. */
static void append(struct lang *l, const struct object ***list, size_t *n,
                   const struct object **more, size_t n_more)
{
    const struct object **all = arena_array(l->scene_mem, *n + n_more, sizeof *all);

    if (*n > 0)
        memcpy(all, *list, *n * sizeof *all);
    if (n_more > 0)
        memcpy(all + *n, more, n_more * sizeof *all);
    *list = all;
    *n += n_more;
}

static void read_cut(struct lang *l, struct object *o, const struct item *i)
{
    bool clips = item_is(i, "clipped_by");
    const char *other = clips ? "bounded_by" : "clipped_by";
    struct object_more *more = object_more(l->scene_mem, o);
    size_t n;

    if (links_to(l, i, other)) {
        if (clips)
            append(l, &more->clip, &more->n_clip, more->bound, more->n_bound);
        else
            append(l, &more->bound, &more->n_bound, more->clip, more->n_clip);
        return;
    }
    const struct object **list = read_list(l, i, &n);
    if (clips)
        append(l, &more->clip, &more->n_clip, list, n);
    else
        append(l, &more->bound, &more->n_bound, list, n);
}

static void add_interior_texture(struct lang *l, struct object *o, const struct item *i,
                                 const struct texture *t)
{
    struct object_more *more = object_more(l->scene_mem, o);

    more->interior_texture = texture_over(l, i->at, more->interior_texture, t);
}

static void take_material(struct reader *r, struct object *o, const struct item *i)
{
    struct lang *l = r->lang;
    struct value v;

    make_material(l, i, &v);
    const struct material *m = v.thing;
    if (m->texture)
        o->texture = texture_over(l, i->at, o->texture, m->texture);
    if (m->interior_texture)
        add_interior_texture(l, o, i, m->interior_texture);
    if (m->interior)
        object_more(l->scene_mem, o)->interior = m->interior;
}

/* Read in full; it only matters when photons or radiosity are there. */
static void skip_photons(struct reader *outer, const struct item *block)
{
    static const char *const words[] = { "target", "reflection", "refraction", "collect",
                                         "pass_through", NULL };
    struct reader r;

    reader_open(&r, outer->lang, block->body);
    for (struct item i = reader_next(&r); i.kind != ITEM_END; i = reader_next(&r)) {
        if (i.kind == ITEM_WORD && is_among(i.word->text, words))
            build_flag(&r);
        else
            build_unknown(outer->lang, &i, "photons", NULL);
    }
    reader_close(&r);
}

void build_importance(struct lang *l, const struct item *block)
{
    struct reader r;

    reader_open(&r, l, block->body);
    if (!reader_takes_word(&r, "importance"))
        diag_error(l->diag, reader_at(&r), "radiosity of an object needs importance");
    struct loc at = reader_at(&r);
    double x = reader_number(&r, false, "importance");
    if (!(x > 0 && x <= 1))
        diag_error(l->diag, at, "importance must be above 0 and at most 1");
    if (reader_peek(&r)->kind != ITEM_END)
        build_unknown(l, reader_peek(&r), "radiosity", NULL);
    reader_close(&r);
}

static bool read_block(struct reader *r, struct object *o, const struct item *i)
{
    struct lang *l = r->lang;

    if (item_is(i, "texture"))
        o->texture = texture_over(l, i->at, o->texture, build_texture(l, i));
    else if (item_is(i, "interior_texture"))
        add_interior_texture(l, o, i, build_texture(l, i));
    else if (item_is(i, "interior"))
        object_more(l->scene_mem, o)->interior = build_interior(l, i, o->more->interior);
    else if (item_is(i, "material"))
        take_material(r, o, i);
    else if (item_is(i, "bounded_by") || item_is(i, "clipped_by"))
        read_cut(l, o, i);
    else if (item_is(i, "photons"))
        skip_photons(r, i);
    else if (item_is(i, "radiosity"))
        build_importance(l, i);
    else
        return build_look(l, i, &o->texture);
    return true;
}

static bool read_word(struct reader *r, struct object *o, const struct item *i,
                      const struct item *block)
{
    const struct field *f = field_find(object_fields, i->word->text);

    if (!f)
        return false;
    if (!is_for(o, block, f->name))
        diag_error(r->lang->diag, i->at, "%s has no meaning for %s", f->name,
                   shape_word(o, block));
    if (f->offset != 0)
        read_flag(r, o, i, (unsigned)f->offset);
    else if (item_is(i, "split_union"))
        o->keep_whole = !build_flag(r);
    else if (item_is(i, "sturm") || item_is(i, "hierarchy"))
        build_flag(r);
    else if (item_is(i, "dtag"))
        reader_text(r, false, "dtag");
    else
        return false;
    return true;
}

/* A colour alone is ignored with a warning, as POV-Ray does. */
static bool skip_colour(struct reader *r, const struct item *i)
{
    struct value v;

    diag_warning(r->lang->diag, i->at, "a colour here has no effect: it belongs in pigment { }");
    if (i->kind == ITEM_VALUE)
        return true;
    if (reader_is_number(r))
        reader_next(r);                 /* of rgb, red ... */
    else
        colour_read(r, &v);             /* behind color */
    return true;
}

bool build_modifier(struct reader *r, struct object *o, const struct item *i,
                    const struct item *block)
{
    struct transform t;

    if (build_transform(r, i, &t)) {
        object_move(r->lang->scene_mem, o, &t);
        return true;
    }
    if (i->kind == ITEM_BLOCK)
        return read_block(r, o, i);
    if (item_is_colour(i))
        return skip_colour(r, i);
    return i->kind == ITEM_WORD && read_word(r, o, i, block);
}

static void no_such(struct reader *r, const struct item *i, const struct item *block,
                    const struct field *const *more)
{
    const struct field *const tables[] = { object_fields, transform_fields,
                                           more && more[0] ? more[0] : object_fields, NULL };

    if (item_is_thing(i, VALUE_TEXTURE) && i->name) {
        diag_error(r->lang->diag, i->at, "the texture '%s' must stand in texture { %s }", i->name,
                   i->name);
        return;
    }
    build_unknown(r->lang, i, block->text, tables);
}

void build_modifiers(struct reader *r, struct object *o, const struct item *block,
                     bool (*extra)(struct reader *r, const struct item *i, void *arg), void *arg,
                     const struct field *const *tables)
{
    build_of(r->lang);
    for (struct item i = reader_next(r); i.kind != ITEM_END; i = reader_next(r))
        if (!(extra && extra(r, &i, arg)) && !build_modifier(r, o, &i, block))
            no_such(r, &i, block, tables);
    object_close(r->lang, o, block);
}

void object_close(struct lang *l, struct object *o, const struct item *block)
{
    if (o->more->interior_texture && !o->texture)
        build_wrong(l, block, "interior_texture needs a texture too");
    if (o->n_child && !o->more->has_box) {
        struct object_more *more = object_more(l->scene_mem, o);
        more->box = object_inner_bounds(o);
        more->has_box = true;
    }
}

/* --- object { X } and the dispatch ------------------------------------------------------ */

static void no_object(struct lang *l, const struct item *name)
{
    struct guess g = guess_start(name->text);

    guess_names(&g, l);
    diag_error(l->diag, name->at, "no object '%s' is declared%s", name->text, guess_text(&g, l));
    guess_note(&g, l);
    scope_declare_broken(l, name_intern(&l->names, name->text, strlen(name->text)), name->at);
}

static struct object *wrapped(struct lang *l, struct reader *r, const struct item *block)
{
    unsigned errors = l->diag->errors;
    struct item first = reader_next(r);
    struct object *o = build_object(l, &first);

    if (!o) {
        if (first.kind == ITEM_NAME)
            no_object(l, &first);
        else if (first.kind == ITEM_END && errors == l->diag->errors)
            build_wrong(l, block, "this object is empty");
        else if (errors == l->diag->errors && !r->failed)
            diag_error(l->diag, first.at, "expected an object; found %s", item_describe(l, &first));
        o = object_start(l, OBJECT_UNION, block->at);
    }
    build_modifiers(r, o, block, NULL, NULL, NULL);
    return o;
}

/* cubic, quartic: < > with more numbers than a vector has must not be evaluated
 * as one, so the node is asked before the item. */
static bool starts_with_object(struct reader *r)
{
    const struct ast *a = r->has_item ? NULL : reader_look(r);

    return !(a && (a->kind == AST_VECTOR || a->kind == AST_LITERAL)) && item_is_thing(reader_peek(r), VALUE_OBJECT);
}

static struct object *any(struct lang *l, struct reader *r, const struct item *block,
                          unsigned errors)
{
    const struct special_shape *special = block->word->special;

    if (item_is(block, "object") || starts_with_object(r))
        return wrapped(l, r, block);
    if (special && !(special->until_row && block->word->shape))
        return special->make(l, r, block);
    return build_plain_shape(l, r, block, block->word->shape, errors);
}

bool make_object(struct lang *l, const struct item *block, struct value *out)
{
    unsigned errors = l->diag->errors;
    struct reader r;

    build_of(l);
    reader_open(&r, l, block->body);
    struct object *o = any(l, &r, block, errors);
    reader_close(&r);
    *out = value_thing(VALUE_OBJECT, o);
    return true;
}
