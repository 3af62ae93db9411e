/* object.c: moving objects, how far they reach, and what is inside them. */
#include "scene/object.h"

#include "scene/light.h"

const struct object_more object_no_more = { .box = BOUNDS_ALL, .reach = BOUNDS_EMPTY };

static struct object *room_for_one(struct arena *mem)
{
    return arena_alloc_aligned(mem, sizeof(struct object), _Alignof(struct object));
}

void object_renew(struct object *o, enum object_kind kind)
{
    *o = (struct object) { .kind = (uint8_t)kind, .place = &transform_identity,
                           .more = &object_no_more };
}

struct object *object_new(struct arena *mem, enum object_kind kind)
{
    struct object *o = room_for_one(mem);

    object_renew(o, kind);
    return o;
}

/* What has an interior is a solid of its own, and what has clips is no shape
 * alone: such things are in more. */
bool object_is_like(const struct object *a, const struct object *b)
{
    return a->kind == OBJECT_SHAPE && b->kind == OBJECT_SHAPE && a->ops == b->ops
           && a->texture == b->texture && a->place == b->place && a->more == &object_no_more
           && b->more == &object_no_more && a->flags == b->flags
           && a->flags_given == b->flags_given && a->keep_whole == b->keep_whole
           && a->name == b->name;
}

struct object *object_copy(struct arena *mem, const struct object *o)
{
    struct object *copy = room_for_one(mem);

    *copy = *o;
    copy->own_place = copy->own_more = false;
    return copy;
}

struct object_more *object_more(struct arena *mem, struct object *o)
{
    if (!o->own_more)
        o->more = arena_copy(mem, o->more, sizeof *o->more);
    o->own_more = true;
    return (struct object_more *)o->more;
}

/* --- moving ---------------------------------------------------------------- */

static const struct object **moved_list(struct arena *mem, const struct object *const *list,
                                        size_t n, const struct transform *t)
{
    const struct object **moved = arena_array(mem, n, sizeof *moved);

    for (size_t i = 0; i < n; i++) {
        struct object *o = object_copy(mem, list[i]);
        object_move(mem, o, t);
        moved[i] = o;
    }
    return moved;
}

/* Most objects are where they were made and share one place; the first move
 * gives a node its own. */
static void move_place(struct arena *mem, struct object *o, const struct transform *t)
{
    struct transform moved = transform_compose(t, o->place);

    if (o->own_place)
        *(struct transform *)o->place = moved;
    else
        o->place = arena_copy(mem, &moved, sizeof moved);
    o->own_place = true;
}

/* Do all layers stand as the object does, so that its move has moved them? */
static bool moves_along(const struct object *o, const struct transform *before)
{
    const struct texture *t = o->texture;

    while (t && t->place == before && o->place == before)
        t = t->above;
    return !t;
}

/* Where a layer stood as the object did, it goes on sharing its place: most
 * textures are given to an object that is moved afterwards. */
static const struct transform *moved_layer(struct arena *mem, const struct object *o,
                                           const struct transform *before,
                                           const struct texture *layer, const struct transform *t)
{
    if (layer->uv_mapping)
        return layer->place;
    if (layer->place == before || (layer->place->is_identity && before->is_identity))
        return o->place;
    return transform_moved(mem, t, layer->place);
}

static void move_layers(struct arena *mem, struct object *o, const struct transform *before,
                        const struct transform *t)
{
    const struct texture **link = &o->texture;

    if (moves_along(o, before))
        return;
    for (const struct texture *from = o->texture; from; from = from->above) {
        struct texture *copy = arena_copy(mem, from, sizeof *from);
        copy->place = moved_layer(mem, o, before, from, t);
        *link = copy;
        link = &copy->above;
    }
}

static void move_more(struct arena *mem, struct object *o, const struct transform *t)
{
    struct object_more *m = object_more(mem, o);
    bool linked = m->clip == m->bound;

    if (!(o->flags & OBJECT_UV_MAPPING))
        m->interior_texture = texture_move(mem, m->interior_texture, t);
    if (m->n_clip > 0)
        m->clip = moved_list(mem, m->clip, m->n_clip, t);
    if (m->n_bound > 0)
        m->bound = linked ? m->clip : moved_list(mem, m->bound, m->n_bound, t);
}

void object_move(struct arena *mem, struct object *o, const struct transform *t)
{
    if (t->is_identity)
        return;
    const struct transform *before = o->place;
    move_place(mem, o, t);
    if (!(o->flags & OBJECT_UV_MAPPING))        /* such textures live in (u, v) */
        move_layers(mem, o, before, t);
    if (o->more->interior_texture || o->more->n_clip || o->more->n_bound)
        move_more(mem, o, t);
}

/* --- bounds ---------------------------------------------------------------- */

static bool is_empty(const struct bounds *b)
{
    return b->low.x > b->high.x || b->low.y > b->high.y || b->low.z > b->high.z;
}

static bool is_finite(const struct bounds *b)
{
    return vec_is_finite(b->low) && vec_is_finite(b->high);
}

/* Zero times infinity is no number; an axis that the transform does not
 * look at adds nothing. */
static void stretch(double m, double low, double high, double *to_low, double *to_high)
{
    if (m == 0)
        return;
    *to_low += m > 0 ? m * low : m * high;
    *to_high += m > 0 ? m * high : m * low;
}

static void move_row(const double m[4], const struct bounds *b, double *low, double *high)
{
    *low = *high = m[3];
    stretch(m[0], b->low.x, b->high.x, low, high);
    stretch(m[1], b->low.y, b->high.y, low, high);
    stretch(m[2], b->low.z, b->high.z, low, high);
}

struct bounds bounds_move(const struct bounds *b, const struct transform *t)
{
    struct bounds moved;

    if (t->is_identity || is_empty(b))
        return *b;
    move_row(t->to.m[0], b, &moved.low.x, &moved.high.x);
    move_row(t->to.m[1], b, &moved.low.y, &moved.high.y);
    move_row(t->to.m[2], b, &moved.low.z, &moved.high.z);
    return moved;
}

static double volume(const struct bounds *b)
{
    return (b->high.x - b->low.x) * (b->high.y - b->low.y) * (b->high.z - b->low.z);
}

static struct bounds bounds_under(const struct object *o, const struct transform *outer);

/* Of the children that do not stand for the rest of space. */
static struct bounds children_bounds(const struct object *o, const struct transform *place)
{
    bool join = o->kind == OBJECT_UNION || o->kind == OBJECT_MERGE;
    struct bounds all = join ? BOUNDS_EMPTY : BOUNDS_ALL;

    for (size_t i = 0; i < o->n_child; i++) {
        const struct object *child = o->child[i];
        if (child->kind == OBJECT_LIGHT)
            continue;
        struct bounds b = bounds_under(child, place);
        bool is_rest = (child->flags & OBJECT_INVERSE) != 0;
        if (o->kind == OBJECT_DIFFERENCE && i > 0)
            is_rest = !is_rest;
        if (join)
            all = bounds_join(all, b);
        else if (!is_rest)
            all = bounds_meet(all, b);
    }
    return all;
}

/* What is inverse reaches everywhere inside, but its surface does not: the
 * bounds are those of the surface. */
static struct bounds surface_bounds(const struct object *o, const struct transform *place)
{
    struct bounds b = BOUNDS_EMPTY;

    if (o->more->unsupported)
        return bounds_move(&o->more->reach, place);
    switch (o->kind) {
    case OBJECT_SHAPE:
        b = o->ops->bounds ? o->ops->bounds(o->shape) : BOUNDS_ALL;
        return bounds_move(&b, place);
    case OBJECT_MESH:
        return bounds_move(&o->mesh->box, place);
    case OBJECT_LIGHT:
        return b;
    default:
        return children_bounds(o, place);
    }
}

/* A clip's or bound's box replaces a larger one (facts sdl.md 2.9). */
static struct bounds cut_by(struct bounds b, const struct object *const *cut, size_t n,
                            const struct transform *outer)
{
    struct bounds box = BOUNDS_ALL;

    for (size_t i = 0; i < n; i++) {
        struct bounds one = bounds_under(cut[i], outer);
        if (!(cut[i]->flags & OBJECT_INVERSE))
            box = bounds_meet(box, one);
    }
    bool smaller = is_finite(&box) && (!is_finite(&b) || volume(&box) < volume(&b));
    return n > 0 && smaller ? box : b;
}

static struct bounds bounds_under(const struct object *o, const struct transform *outer)
{
    struct transform place = transform_compose(outer, o->place);
    struct bounds b = surface_bounds(o, &place);

    b = cut_by(b, o->more->clip, o->more->n_clip, outer);
    return cut_by(b, o->more->bound, o->more->n_bound, outer);
}

struct bounds object_inner_bounds(const struct object *o)
{
    return surface_bounds(o, &transform_identity);
}

struct bounds object_bounds(const struct object *o)
{
    return bounds_under(o, &transform_identity);
}
