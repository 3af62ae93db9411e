/* build_csg.c: union, merge, intersection, difference, light_group. */
#include <string.h>

#include "lang/build.h"

struct children {
    struct lang *lang;
    struct object *of;
    const struct object **child;
    size_t n, room;
    unsigned depth;                     /* of what they are in */
    double parts;
    bool ended;                         /* a modifier came: no more objects */
    bool is_group;
};

static void warn_patch(struct lang *l, const struct object *of, const struct object *child)
{
    bool cuts = of->kind == OBJECT_INTERSECTION || of->kind == OBJECT_DIFFERENCE;
    bool patch = (child->kind == OBJECT_SHAPE || child->kind == OBJECT_MESH)
                 && !object_has_inside(child);

    if (cuts && patch)
        diag_warning(l->diag, child->at, "this has no inside: in an intersection or difference it cuts nothing");
}

/* The tracer walks objects by recursion; what is declared step by step
 * escapes the limit on blocks in blocks. */
static void count_depth(struct children *c, const struct object *child, struct loc at)
{
    struct lang *l = c->lang;

    if (child->more->depth >= c->depth)
        c->depth = child->more->depth + 1;
    if (c->depth > l->limits->csg_depth)
        lang_limit(l, at, "objects are nested more than %u deep (--max-csg-depth=N would let them)",
                   l->limits->csg_depth);
}

/* Objects in objects double with each step, and each of their parts takes memory in the
 * end: what cannot be held is not begun. */
static void count_parts(struct children *c, const struct object *child, struct loc at)
{
    enum { LEAST_BYTES = 256 };         /* that a part takes */
    struct lang *l = c->lang;

    c->parts += child->more->parts > 0 ? child->more->parts : 1;
    if (c->parts > (double)l->limits->memory / LEAST_BYTES)
        lang_limit(l, at, "an object of %.3g parts needs more than the %zu MiB of memory that "
                   "--max-memory allows", c->parts, l->limits->memory >> 20);
}

/* Once; and what was not understood may have been an object. */
static void say_late(struct reader *r, const struct item *i)
{
    if (!r->failed)
        diag_error(r->lang->diag, i->at, "objects must stand before the modifiers");
    r->failed = true;
}

static bool take_child(struct reader *r, const struct item *i, void *arg)
{
    struct children *c = arg;

    if (!item_is_object(i)) {
        c->ended = true;
        return false;
    }
    if (c->ended)
        say_late(r, i);
    struct object *o = build_object(r->lang, i);
    warn_patch(r->lang, c->of, o);
    count_depth(c, o, i->at);
    count_parts(c, o, i->at);
    c->child = arena_grow(r->lang->mem, c->child, c->n, &c->room, sizeof *c->child);
    c->child[c->n++] = o;
    return true;
}

static void take_all(struct reader *r, struct children *c)
{
    while (item_is_object(reader_peek(r))) {
        struct item i = reader_next(r);
        take_child(r, &i, c);
    }
    c->of->child = arena_copy(r->lang->scene_mem, c->child, c->n * sizeof *c->child);
    c->of->n_child = (uint32_t)c->n;
    struct object_more *more = object_more(r->lang->scene_mem, c->of);
    more->depth = c->depth;
    more->parts = c->parts;
}

static bool is_misplaced(struct reader *r, const struct item *i, void *arg)
{
    (void)arg;
    if (!item_is_object(i))
        return false;
    say_late(r, i);
    build_object(r->lang, i);
    return true;
}

static struct object *combine(struct lang *l, struct reader *r, const struct item *block,
                              enum object_kind kind)
{
    struct object *o = object_start(l, kind, block->at);
    struct children c = { .lang = l, .of = o };

    take_all(r, &c);
    if (c.n < 2 && !l->stopped)
        diag_warning(l->diag, block->at, "%s has %s", block->text,
                     c.n == 0 ? "no objects" : "only one object");
    build_modifiers(r, o, block, is_misplaced, NULL, NULL);
    return o;
}

static struct object *make_union(struct lang *l, struct reader *r, const struct item *block)
{
    if (strcmp(block->text, "composite") == 0)
        diag_warning(l->diag, block->at, "composite is old: it is a union");
    return combine(l, r, block, OBJECT_UNION);
}

static struct object *make_merge(struct lang *l, struct reader *r, const struct item *block)
{
    return combine(l, r, block, OBJECT_MERGE);
}

static struct object *make_intersection(struct lang *l, struct reader *r, const struct item *block)
{
    return combine(l, r, block, OBJECT_INTERSECTION);
}

static struct object *make_difference(struct lang *l, struct reader *r, const struct item *block)
{
    return combine(l, r, block, OBJECT_DIFFERENCE);
}

/* --- light_group --------------------------------------------------------------------- */

const struct field csg_fields[] = {
    { "global_lights", FIELD_CUSTOM, 0, ANY, "whether other lights reach a light_group" },
    FIELD_END,
};

static bool take_group_word(struct reader *r, const struct item *i, void *arg)
{
    if (i->kind == ITEM_WORD && item_is(i, "global_lights")) {
        build_flag(r);
        return true;
    }
    return is_misplaced(r, i, arg);
}

static struct object *make_group(struct lang *l, struct reader *r, const struct item *block)
{
    struct object *o = object_start(l, OBJECT_UNION, block->at);
    struct children c = { .lang = l, .of = o };

    take_all(r, &c);
    build_modifiers(r, o, block, take_group_word, NULL, NULL);
    diag_unsupported(l->diag, block->at, "light_group (its lights reach everything)");
    return o;
}

const struct special_shape csg_shapes[] = {
    { "union", make_union, false },
    { "composite", make_union, false },
    { "merge", make_merge, false },
    { "intersection", make_intersection, false },
    { "difference", make_difference, false },
    { "light_group", make_group, false },
    { .word = NULL },
};
