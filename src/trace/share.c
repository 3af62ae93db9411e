/* share.c: which unions are placed more than once. */
#include "trace/share.h"

enum {
    SMALLEST = 3,               /* leaves: of fewer, a tree of their own is no quicker */
    LARGEST = 1 << 17,          /* leaves: of more, the parts are shared rather than the whole */
    WORTH = 500, WORTH_CSG = 10000,     /* leaves saved: fewer solids that are cut are quicker in beams */
};

static size_t slot_of(const struct share *s, const void *children)
{
    size_t at = ((uintptr_t)children >> 4) * 0x9e3779b97f4a7c15u >> 20;

    for (;; at++) {
        const struct shared *one = &s->table[at & (s->room - 1)];
        if (!one->children || one->children == children)
            return at & (s->room - 1);
    }
}

static void grow(struct share *s)
{
    struct shared *old = s->table;
    size_t room = s->room;

    s->room = room ? 2 * room : 64;
    s->table = arena_array(s->mem, s->room, sizeof *s->table);
    for (size_t i = 0; i < room; i++)
        if (old[i].children)
            s->table[slot_of(s, old[i].children)] = old[i];
}

static void absorb(struct shared *to, const struct shared *from)
{
    to->n_leaf += from->n_leaf;
    to->has_look |= from->has_look;
    to->lacks_texture |= from->lacks_texture;
    to->lacks_interior |= from->lacks_interior;
    to->lacks_interior_texture |= from->lacks_interior_texture;
}

/* What o says itself need not come from above. */
static void cover(struct shared *sum, const struct object *o)
{
    sum->has_look |= o->texture || o->more->interior || o->more->interior_texture;
    sum->lacks_texture &= !o->texture;
    sum->lacks_interior &= !o->more->interior;
    sum->lacks_interior_texture &= !o->more->interior_texture;
}

static struct shared look_at(struct share *s, const struct object *o);

/* n of its children are.  Of a difference the first tells, of an intersection all must be so. */
static bool is_endless(const struct object *o, size_t n, bool is_first)
{
    return o->kind == OBJECT_DIFFERENCE ? is_first : o->kind == OBJECT_INTERSECTION ? n == o->n_child : n > 0;
}

/* Children that were seen before are counted and not looked at again: a
 * thing inside of a shared thing is shared with it. */
static struct shared look_at_children(struct share *s, const struct object *o)
{
    struct shared sum = { .children = o->child, .n_use = 1 };
    size_t n_endless = 0;
    bool is_first = false;

    if (2 * s->n >= s->room)
        grow(s);
    struct shared *known = &s->table[slot_of(s, o->child)];
    if (known->children) {
        known->n_use++;
        return *known;
    }
    for (size_t i = 0; i < o->n_child; i++) {
        struct shared child = look_at(s, o->child[i]);
        absorb(&sum, &child);
        n_endless += child.is_endless;
        is_first |= i == 0 && child.is_endless;
    }
    sum.is_endless = is_endless(o, n_endless, is_first);
    while (2 * s->n >= s->room)
        grow(s);
    s->table[slot_of(s, o->child)] = sum;
    s->n++;
    return sum;
}

static struct shared look_at(struct share *s, const struct object *o)
{
    struct shared sum = { .n_leaf = 1, .lacks_texture = true, .lacks_interior = true,
                          .lacks_interior_texture = true,
                          .is_endless = o->kind == OBJECT_SHAPE && o->ops->is_infinite };

    if (o->kind == OBJECT_LIGHT)
        return (struct shared) { 0 };
    if (o->n_child > 0)
        sum = look_at_children(s, o);
    cover(&sum, o);
    return sum;
}

void share_init(struct share *s, const struct scene *scene, struct arena *mem)
{
    *s = (struct share) { .mem = mem };
    grow(s);
    for (size_t i = 0; i < scene->n_object; i++)
        look_at(s, scene->listed[i].like);
}

const struct shared *share_find(const struct share *s, const struct object *o)
{
    const struct shared *one = o->n_child ? &s->table[slot_of(s, o->child)] : NULL;

    return one && one->children ? one : NULL;
}

bool share_is_worth_it(const struct shared *s, bool is_csg)
{
    return s->n_leaf >= SMALLEST && s->n_leaf <= LARGEST
           && (s->n_use - 1) * s->n_leaf >= (is_csg ? WORTH_CSG : WORTH);
}
