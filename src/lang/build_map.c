/* build_map.c: color_map, pigment_map, texture_map ...: entries [value thing]. */
#include <string.h>

#include "lang/build.h"
#include "lang/colour.h"

enum { MOST_ENTRIES = 256 };            /* POV-Ray's limit */

struct entries {
    struct map_entry *entry;
    size_t n, room;
    bool falls;                         /* which was said */
};

static struct map_entry *add(struct lang *l, struct entries *e)
{
    e->entry = arena_grow(l->scene_mem, e->entry, e->n, &e->room, sizeof *e->entry);
    memset(&e->entry[e->n], 0, sizeof *e->entry);
    return &e->entry[e->n++];
}

/* [ value colour ], or the old [ low high colour colour ]. */
static void read_colours(struct lang *l, struct reader *r, struct entries *e)
{
    double low = reader_number(r, false, "a map's value");
    bool old = (reader_skip_comma(r), reader_is_number(r)) && !colour_is_next(r);

    if (!old) {
        struct map_entry *one = add(l, e);
        one->value = (double)(float)low;
        if (!colour_is_next(r)) {
            if (!reader_explains(r))
                diag_error(l->diag, reader_at(r),
                           "expected a colour in the map: rgb ..., or a declared colour; found %s",
                           item_describe(l, reader_peek(r)));
        } else
            one->colour = colour_take(r, false, "a map");
        return;
    }
    struct item looked = *reader_peek(r);
    if (looked.value.n > 1) {
        diag_error(l->diag, looked.at, "a vector is no colour here: write rgb before it");
        reader_next(r);
        return;
    }
    double high = reader_number(r, false, "a map's value");
    for (int i = 0; i < 2; i++) {
        const struct item *next = reader_peek(r);
        if (!item_is(next, "color") && !item_is(next, "colour")) {
            diag_error(l->diag, reader_at(r), "expected 'color' before each of the two colours");
            r->failed = true;
            return;
        }
        struct map_entry *one = add(l, e);
        one->value = (double)(float)(i == 0 ? low : high);
        one->colour = colour_take(r, false, "a map");
    }
}

static void read_slope(struct lang *l, struct reader *r, struct entries *e)
{
    double v[2] = { 0, 0 };

    add(l, e)->value = (double)(float)reader_number(r, false, "a map's value");
    reader_vector(r, true, 2, v, "height and slope");
}

/* A value may be left out in `average`: such a map is read the same way. */
static void read_thing(struct lang *l, struct reader *r, struct entries *e, enum value_type type,
                       const struct item *entry)
{
    double value = 1;

    if (reader_is_number(r)) {
        value = reader_number(r, false, "a map's value");
        reader_skip_comma(r);
    }
    struct map_entry *one = add(l, e);
    one->value = (double)(float)value;
    if (type == VALUE_PIGMENT_MAP)
        one->pigment = build_pigment_body(r, entry, l->build->texture->pigment);
    else if (type == VALUE_NORMAL_MAP)
        one->normal = build_normal_body(r, entry, NULL);
    else if (type == VALUE_DENSITY_MAP)
        one->pigment = build_density_body(r, entry, NULL);
    else
        one->texture = build_texture_body(r, entry);
}

/* Entries that fall are never seen, or cut the one before short: said once a
 * map, at the first.  n: how many there were before this one. */
static void check_order(struct lang *l, struct entries *e, size_t n, struct loc at,
                        const char *map)
{
    for (size_t i = n > 0 ? n : 1; i < e->n && !e->falls; i++) {
        e->falls = e->entry[i].value < e->entry[i - 1].value;
        if (e->falls)
            diag_warning(l->diag, at, "the entries of this %s do not rise: %g after %g", map,
                         e->entry[i].value, e->entry[i - 1].value);
    }
}

static void read_entry(struct lang *l, const struct item *i, enum value_type type,
                       struct entries *e, const char *map)
{
    struct reader r;
    size_t before = e->n;

    reader_open(&r, l, i->body);
    struct loc at = reader_at(&r);
    if (type == VALUE_COLOUR_MAP)
        read_colours(l, &r, e);
    else if (type == VALUE_SLOPE_MAP)
        read_slope(l, &r, e);
    else
        read_thing(l, &r, e, type, i);
    if (!r.failed && reader_peek(&r)->kind != ITEM_END)
        build_unknown(l, reader_peek(&r), "a map's entry", NULL);
    reader_close(&r);
    check_order(l, e, before, at, map);
}

static bool finish_map(struct lang *l, const struct item *block, enum value_type type,
                       const struct entries *e, bool is_wrong, struct value *out)
{
    struct map map = { type, e->entry, e->n };

    if (e->n == 0 && !is_wrong)
        build_wrong(l, block, "%s needs at least one entry in [ ]", block->text);
    if (e->n > MOST_ENTRIES)
        build_wrong(l, block, "%s has %zu entries; at most %d are allowed", block->text, e->n,
                    MOST_ENTRIES);
    *out = value_thing(type, arena_copy(l->scene_mem, &map, sizeof map));
    return true;
}

static bool make_map(struct lang *l, const struct item *block, enum value_type type,
                     struct value *out)
{
    unsigned errors = l->diag->errors;
    struct entries e = { 0 };
    struct reader r;

    build_of(l);
    reader_open(&r, l, block->body);
    const struct map *whole = type == VALUE_DENSITY_MAP ? NULL : build_start(&r, type);
    for (struct item i = reader_next(&r); i.kind != ITEM_END; i = reader_next(&r)) {
        if (i.kind == ITEM_ENTRY && !whole)
            read_entry(l, &i, type, &e, block->text);
        else if (errors == l->diag->errors && i.kind == ITEM_VALUE && value_is_number(&i.value))    /* said once */
            diag_error(l->diag, i.at, "an entry of %s stands in brackets: [ ]", block->text);
        else if (errors == l->diag->errors)
            build_unknown(l, &i, block->text, NULL);
    }
    reader_close(&r);
    if (!whole)
        return finish_map(l, block, type, &e, errors < l->diag->errors, out);
    *out = value_thing(type, whole);
    return true;
}

bool make_colour_map(struct lang *l, const struct item *block, struct value *out)
{
    return make_map(l, block, VALUE_COLOUR_MAP, out);
}

bool make_pigment_map(struct lang *l, const struct item *block, struct value *out)
{
    return make_map(l, block, VALUE_PIGMENT_MAP, out);
}

bool make_normal_map(struct lang *l, const struct item *block, struct value *out)
{
    return make_map(l, block, VALUE_NORMAL_MAP, out);
}

bool make_slope_map(struct lang *l, const struct item *block, struct value *out)
{
    return make_map(l, block, VALUE_SLOPE_MAP, out);
}

bool make_texture_map(struct lang *l, const struct item *block, struct value *out)
{
    return make_map(l, block, VALUE_TEXTURE_MAP, out);
}

/* A declared density_map cannot be used again (facts sdl.md 5.2). */
bool make_density_map(struct lang *l, const struct item *block, struct value *out)
{
    return make_map(l, block, VALUE_DENSITY_MAP, out);
}
