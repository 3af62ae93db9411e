/* flatten.c: from the tree of objects that the user wrote to leaves, CSG
 * roots, instances, and trees of boxes over them. */
#include <float.h>
#include <stdlib.h>
#include <string.h>

#include "tree/brick.h"
#include "trace/polytope.h"
#include "trace/share.h"
#include "trace/surface.h"
#include "trace/world.h"

/* What a node passes down to its children (facts sdl.md 6.3). */
struct context {
    const struct placement *placement;  /* of the space that the node stands in; NULL: identity */
    struct look look;
    const struct transform *interior_texture_place;
    unsigned flags;
    bool inverse;
    bool is_inherited;                  /* in an instance: leaves take the look of the instance */
    bool is_whole;                      /* within split_union off: who sees it is decided above */
};

struct list { uint32_t *item; size_t n, room; };

/* What a space holds.  Each thing's bounds are worked out when it is added,
 * and again for the tree: keeping them would take more memory than all else. */
struct items {
    struct list all, unbounded;         /* in the order in which they were added */
    struct bounds whole;                /* of those that are bounded */
};

/* An instance's space, and for which look and flags it was made. */
struct made_space {
    const void *children;
    unsigned flags;
    bool inverse, is_inherited;
    uint32_t space;
};

/* A look that was asked for lately, and its surface. */
struct known_look { struct look look; uint32_t surface; };

enum { KNOWN_LOOKS = 64 };

struct builder {
    struct plan *plan;
    struct geometry *geometry;
    struct arena scrap;
    unsigned threads;
    struct share share;                 /* which children are placed how often */
    size_t room_leaf, room_instance, room_csg, room_space, n_made, room_made;
    struct made_space *made;
    struct items *items;                /* of the space under construction */
    uint32_t space;                     /* its number */
    const struct mesh_tree **mesh_tree;
    const struct mesh **mesh;
    size_t n_mesh, room_mesh, room_tree;
    struct known_look known[KNOWN_LOOKS];
    const struct shape_ops *from, *to;  /* the last row that was looked up */
    size_t n_empty, n_bound, n_cutaway;
};

/* --- small things ---------------------------------------------------------- */

static bool bounds_are_finite(struct bounds b) { return vec_is_finite(b.low) && vec_is_finite(b.high); }

static bool bounds_are_empty(struct bounds b)
{
    return !(b.low.x <= b.high.x && b.low.y <= b.high.y && b.low.z <= b.high.z);
}

static void list_add(struct builder *b, struct list *l, uint32_t item)
{
    l->item = arena_grow(&b->scrap, l->item, l->n, &l->room, sizeof *l->item);
    l->item[l->n++] = item;
}

static void items_add(struct builder *b, uint32_t item, struct bounds bounds)
{
    struct items *to = b->items;

    list_add(b, &to->all, item);
    if (bounds_are_finite(bounds))
        to->whole = bounds_join(to->whole, bounds);
    else
        list_add(b, &to->unbounded, item);
}

static bool mat_is_finite(const mat34 *m)
{
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 4; j++)
            if (!isfinite(m->m[i][j]))
                return false;
    return true;
}

/* The rounding of a point's way through both matrices: their condition
 * times a few half ulps. */
static double fuzz_of(const struct transform *t)
{
    return mat_norm(&t->to) * mat_norm(&t->from) * 0x1p-52;
}

/* Inner placed in outer; shared with outer when nothing is added. */
static const struct placement *placed(struct builder *b, const struct placement *outer,
                                      const struct transform *inner)
{
    if (inner->is_identity)
        return outer;
    struct placement *p = arena_alloc(b->plan->mem, sizeof *p);
    p->place = outer ? transform_compose(&outer->place, inner) : *inner;
    p->stretch = mat_norm(&p->place.to);
    p->fuzz = fuzz_of(&p->place);
    return p;
}

static const struct transform *transform_of(const struct placement *p)
{
    return p ? &p->place : &transform_identity;
}

/* This build's own row: the engine is compiled for several instruction sets. */
static const struct shape_ops *own_row(struct builder *b, const struct shape_ops *ops)
{
    if (b->from != ops) {
        b->from = ops;
        b->to = shape_find(ops->name);
    }
    return b->to;
}

static uint8_t mask_of(unsigned flags)
{
    return (flags & OBJECT_NO_IMAGE ? 0 : RAY_PRIMARY)
           | (flags & OBJECT_NO_REFLECTION ? 0 : RAY_REFLECTED)
           | (flags & OBJECT_NO_SHADOW ? 0 : RAY_SHADOW);
}

/* --- looks ----------------------------------------------------------------- */

/* Facts shading.md 3.5: of a union that is not split, what a member says of
 * the rays that see it does not count. */
static unsigned flags_within(const struct context *outer, const struct object *o)
{
    const unsigned seen_by = OBJECT_NO_IMAGE | OBJECT_NO_REFLECTION | OBJECT_NO_SHADOW;
    unsigned unheard = OBJECT_INVERSE | (outer->is_whole ? seen_by : 0);

    return (outer->flags & ~(o->flags_given & ~unheard)) | (o->flags & ~unheard);
}

/* What o itself says takes the place of what its parent said.  The texture's
 * space ends where o stands. */
static struct context within(struct builder *b, const struct context *outer, const struct object *o)
{
    struct context c = *outer;

    c.placement = placed(b, outer->placement, o->place);
    c.flags = flags_within(outer, o);
    c.inverse ^= (o->flags & OBJECT_INVERSE) != 0;
    c.is_whole |= o->keep_whole;
    if (o->texture) {
        c.look.texture = o->texture;
        c.look.place = transform_of(outer->placement);
        c.look.uv_mapping = (o->flags & OBJECT_UV_MAPPING) != 0;
        c.is_inherited = false;
    }
    if (o->more->interior_texture) {
        c.look.interior_texture = o->more->interior_texture;
        c.interior_texture_place = transform_of(outer->placement);
    }
    if (o->more->interior) {
        c.look.interior = o->more->interior;
        c.look.solid = o;
    }
    return c;
}

static void count_left_out(struct builder *b, const struct object *o)
{
    b->n_bound += o->more->n_bound > 0 && o->kind != OBJECT_SHAPE && o->kind != OBJECT_MESH;
    b->n_cutaway += (o->flags & OBJECT_CUTAWAY_TEXTURES) != 0;
}

/* An interior texture from another level is moved to the texture's space. */
static const struct texture *interior_texture_of(struct builder *b, const struct context *c,
                                                 const struct transform *place)
{
    if (!c->look.interior_texture || c->interior_texture_place == place)
        return c->look.interior_texture;
    struct transform back = transform_inverse(place);
    struct transform between = transform_compose(&back, c->interior_texture_place);
    return texture_move(b->plan->mem, c->look.interior_texture, &between);
}

static bool looks_equal(const struct look *a, const struct look *b)
{
    return a->texture == b->texture && a->interior_texture == b->interior_texture
           && a->place == b->place && a->interior == b->interior && a->solid == b->solid
           && a->mesh == b->mesh && a->object_flags == b->object_flags
           && a->uv_mapping == b->uv_mapping;
}

/* Where a look stands if it is known: no texture, none is there yet. */
static struct known_look *known_look(struct builder *b, const struct look *l)
{
    uintptr_t by = (uintptr_t)l->texture >> 4 ^ (uintptr_t)l->solid >> 5 ^ (uintptr_t)l->place >> 6;

    return &b->known[(by ^ by >> 6) % KNOWN_LOOKS];
}

static uint32_t surface_for(struct builder *b, const struct context *c, const struct mesh *mesh)
{
    struct look look = c->look;

    if (c->is_inherited)
        return NO_LEAF;
    if (!look.texture)
        look.texture = &texture_default;
    if (!look.place)
        look.place = &transform_identity;
    look.interior_texture = interior_texture_of(b, c, look.place);
    look.object_flags = c->flags;
    look.double_illuminate = (c->flags & OBJECT_DOUBLE_ILLUMINATE) != 0;
    look.hollow = (c->flags & OBJECT_HOLLOW) != 0;
    look.mesh = mesh && mesh->n_texture ? mesh : NULL;
    struct known_look *known = known_look(b, &look);
    if (!looks_equal(&look, &known->look))
        *known = (struct known_look) { look, surface_of(b->plan, &look) };
    return known->surface;
}

/* --- leaves ---------------------------------------------------------------- */

/* Looked for from the newest back: copies mostly stand together. */
static const struct mesh_tree *mesh_of(struct builder *b, const struct mesh *m)
{
    for (size_t i = b->n_mesh; i-- > 0;)
        if (b->mesh[i] == m)
            return b->mesh_tree[i];
    b->mesh = arena_grow(&b->scrap, b->mesh, b->n_mesh, &b->room_mesh, sizeof *b->mesh);
    b->mesh_tree = arena_grow(&b->scrap, b->mesh_tree, b->n_mesh, &b->room_tree,
                              sizeof *b->mesh_tree);
    b->mesh[b->n_mesh] = m;
    b->mesh_tree[b->n_mesh] = mesh_tree_new(m, b->threads, b->plan->mem);
    return b->mesh_tree[b->n_mesh++];
}

/* The leaf of a shape or mesh whose context is c, and its bounds; NO_LEAF:
 * there is nothing to see. */
static uint32_t add_leaf(struct builder *b, const struct object *o, const struct context *c,
                         bool is_silent, struct bounds *bounds)
{
    struct plan *p = b->plan;
    struct leaf l = { .placement = c->placement, .mask = mask_of(c->flags), .inverse = c->inverse };

    if (o->kind == OBJECT_MESH) {
        l.mesh = mesh_of(b, o->mesh);
    } else {
        l.ops = own_row(b, o->ops);
        l.shape = o->shape;
    }
    if (!l.shape || (c->placement && (!mat_is_finite(&c->placement->place.to)
                                      || !mat_is_finite(&c->placement->place.from)))
        || bounds_are_empty(*bounds = leaf_bounds(&l))) {
        b->n_empty++;
        return NO_LEAF;
    }
    l.surface = is_silent ? 0 : surface_for(b, c, o->kind == OBJECT_MESH ? o->mesh : NULL);
    p->leaf = arena_grow(&b->scrap, p->leaf, p->n_leaf, &b->room_leaf, sizeof *p->leaf);
    p->leaf[p->n_leaf] = l;
    return (uint32_t)p->n_leaf++;
}

/* --- CSG ------------------------------------------------------------------- */

struct csg_builder {
    struct builder *b;
    struct csg_node *node;
    struct csg_part *part;
    uint32_t *at_rest;
    size_t n_node, n_part, room_node, room_part, room_rest;
    struct list everything;             /* parents of parts that were left out and hold every point */
    struct bounds seen;                 /* of all surfaces */
    uint32_t surface_leaf;
};

static uint32_t add_node(struct csg_builder *c, uint32_t parent, enum csg_kind kind)
{
    struct arena *mem = &c->b->scrap;

    c->node = arena_grow(mem, c->node, c->n_node, &c->room_node, sizeof *c->node);
    c->at_rest = arena_grow(mem, c->at_rest, c->n_node, &c->room_rest, sizeof *c->at_rest);
    c->node[c->n_node] = (struct csg_node) { parent, 0, kind };
    c->at_rest[c->n_node] = 0;
    if (parent != NO_LEAF)
        c->node[parent].n_child++;
    return (uint32_t)c->n_node++;
}

static bool is_leaky(const struct leaf *l)
{
    if (!l->ops)
        return !l->mesh->is_closed;
    return l->ops->is_leaky && l->ops->is_leaky(l->shape);
}

static bool has_inside(const struct leaf *l)
{
    return l->ops ? l->ops->inside != NULL : mesh_has_inside(l->mesh);
}

static bool has_interior(const struct plan *p, uint32_t leaf)
{
    uint32_t surface = p->leaf[leaf].surface;

    return surface != NO_LEAF && p->surface[surface].interior != NULL;
}

/* Where points may be inside of it. */
static struct bounds solid_bounds(const struct leaf *l, const struct csg_part *part)
{
    bool behind_all = part->is_asked && l->ops && !l->ops->is_solid;     /* a disc */

    return l->inverse || behind_all ? BOUNDS_ALL : leaf_bounds(l);
}

static struct bounds csg_leaf(struct csg_builder *c, const struct object *o,
                              const struct context *within_o, uint32_t parent, bool is_silent)
{
    struct builder *b = c->b;
    struct bounds bounds;
    uint32_t number = add_leaf(b, o, within_o, is_silent, &bounds);

    c->node[parent].n_child++;
    if (number == NO_LEAF) {            /* nothing, or inverted: everything */
        if (within_o->inverse)
            list_add(b, &c->everything, parent);
        return within_o->inverse ? BOUNDS_ALL : BOUNDS_EMPTY;
    }
    const struct leaf *l = &b->plan->leaf[number];
    bool is_solid = l->ops ? l->ops->is_solid : mesh_has_inside(l->mesh);
    struct csg_part part = { .leaf = number, .parent = parent, .is_silent = is_silent,
                             .alternates = is_solid && !is_leaky(l),
                             .is_infinite = !bounds_are_finite(bounds) };
    part.is_asked = !part.alternates && has_inside(l);
    c->part = arena_grow(&b->scrap, c->part, c->n_part, &c->room_part, sizeof *c->part);
    c->part[c->n_part++] = part;
    if (!is_silent) {
        c->seen = bounds_join(c->seen, bounds);
        if (c->surface_leaf == NO_LEAF
            || (!has_interior(b->plan, c->surface_leaf) && has_interior(b->plan, number)))
            c->surface_leaf = number;
    }
    return solid_bounds(l, &part);
}

static struct bounds csg_object(struct csg_builder *c, const struct object *o,
                                const struct context *outer, uint32_t parent, bool is_silent);

static enum csg_kind kind_of(const struct object *o, bool inverse)
{
    if (o->kind == OBJECT_UNION || o->kind == OBJECT_MERGE)
        return inverse ? CSG_INTERSECTION : o->kind == OBJECT_UNION ? CSG_UNION : CSG_MERGE;
    return inverse ? CSG_MERGE : CSG_INTERSECTION;
}

/* In the space of the whole. */
static struct half_space half_space_of(const struct leaf *l)
{
    struct half_space h = l->ops->half_space(l->shape);
    double sign = l->inverse ? -1 : 1;

    if (l->placement) {
        const mat34 *from = &l->placement->place.from;
        h.distance -= vec_dot(h.normal, mat_point(from, vec(0, 0, 0)));
        h.normal = mat_normal(from, h.normal);
    }
    double k = sign / vec_length(h.normal);
    return (struct half_space) { vec_scale(h.normal, k), h.distance * k };
}

/* Planes bound together what none of them bounds alone. */
static struct bounds bounds_by_planes(const struct csg_builder *c, size_t first_part, uint32_t node,
                                      struct bounds all)
{
    struct half_space face[POLYTOPE_FACES];
    int n = 0;

    for (size_t i = first_part; i < c->n_part && n < POLYTOPE_FACES; i++) {
        const struct leaf *l = &c->b->plan->leaf[c->part[i].leaf];
        if (c->part[i].parent == node && l->ops && l->ops->half_space)
            face[n++] = half_space_of(l);
    }
    return n > 0 ? polytope_bounds(n, face, all) : all;
}

static struct bounds csg_children(struct csg_builder *c, const struct object *o,
                                  const struct context *within_o, uint32_t parent, bool is_silent)
{
    enum csg_kind kind = kind_of(o, within_o->inverse);
    uint32_t node = add_node(c, parent, kind);
    bool meet = kind == CSG_INTERSECTION;
    struct bounds all = meet ? BOUNDS_ALL : BOUNDS_EMPTY;
    size_t first_part = c->n_part;

    for (size_t i = 0; i < o->n_child; i++) {
        struct context child = *within_o;
        child.inverse ^= o->kind == OBJECT_DIFFERENCE && i > 0;
        if (o->child[i]->kind == OBJECT_LIGHT)
            continue;
        struct bounds one = csg_object(c, o->child[i], &child, node, is_silent);
        all = meet ? bounds_meet(all, one) : bounds_join(all, one);
    }
    if (c->node[node].n_child == 0) {   /* nothing in nothing */
        c->node[node].kind = CSG_UNION;
        return BOUNDS_EMPTY;
    }
    return meet && !bounds_are_finite(all) ? bounds_by_planes(c, first_part, node, all) : all;
}

/* A clip is cut with, and shows no surface; inversion does not reach it. */
static struct bounds csg_clipped(struct csg_builder *c, const struct object *o,
                                 const struct context *outer, uint32_t parent, bool is_silent)
{
    uint32_t node = add_node(c, parent, CSG_INTERSECTION);
    struct object bare = *o;
    struct object_more bare_more = *o->more;
    struct context clip = *outer;

    bare_more.n_clip = 0;
    bare.more = &bare_more;
    clip.inverse = false;
    struct bounds all = csg_object(c, &bare, outer, node, is_silent);
    for (size_t i = 0; i < o->more->n_clip; i++)
        all = bounds_meet(all, csg_object(c, o->more->clip[i], &clip, node, true));
    return all;
}

static struct bounds csg_object(struct csg_builder *c, const struct object *o,
                                const struct context *outer, uint32_t parent, bool is_silent)
{
    if (o->more->n_clip)
        return csg_clipped(c, o, outer, parent, is_silent);
    struct context in = within(c->b, outer, o);
    count_left_out(c->b, o);
    if (o->kind == OBJECT_SHAPE || o->kind == OBJECT_MESH)
        return csg_leaf(c, o, &in, parent, is_silent);
    return csg_children(c, o, &in, parent, is_silent);
}

/* Far off, a finite solid that was inverted contains everything. */
static void settle_at_rest(struct csg_builder *c)
{
    for (size_t i = 0; i < c->n_part; i++) {
        const struct csg_part *part = &c->part[i];
        if (part->alternates && !part->is_infinite && c->b->plan->leaf[part->leaf].inverse)
            csg_count(c->node, c->at_rest, part->parent, 1);
    }
    for (size_t i = 0; i < c->everything.n; i++)
        csg_count(c->node, c->at_rest, c->everything.item[i], 1);
}

static void add_csg(struct builder *b, const struct object *o, const struct context *outer)
{
    struct geometry *g = b->geometry;
    size_t first_leaf = b->plan->n_leaf;
    struct csg_builder c = { .b = b, .seen = BOUNDS_EMPTY, .surface_leaf = NO_LEAF };
    struct arena *mem = b->plan->mem;

    /* The node above the root keeps every part's parent a node. */
    uint32_t top = add_node(&c, NO_LEAF, CSG_UNION);
    struct bounds bounds = bounds_meet(csg_object(&c, o, outer, top, false), c.seen);
    if (c.surface_leaf == NO_LEAF || bounds_are_empty(bounds)) {
        b->plan->n_leaf = first_leaf;
        b->n_empty++;
        return;
    }
    settle_at_rest(&c);
    g->csg = arena_grow(&b->scrap, g->csg, g->n_csg, &b->room_csg, sizeof *g->csg);
    g->csg[g->n_csg] = (struct csg) {
        .bounds = bounds, .n_node = c.n_node, .n_part = c.n_part,
        .node = arena_copy(mem, c.node, c.n_node * sizeof *c.node),
        .part = arena_copy(mem, c.part, c.n_part * sizeof *c.part),
        .at_rest = arena_copy(mem, c.at_rest, c.n_node * sizeof *c.at_rest),
        .surface_leaf = c.surface_leaf, .mask = mask_of(flags_within(outer, o)) };
    items_add(b, item_of(ITEM_CSG, (uint32_t)g->n_csg++), bounds);
}

/* --- instances ------------------------------------------------------------- */

static void add_object(struct builder *b, const struct object *o, const struct context *outer);
static uint32_t new_space(struct builder *b);
static void finish_space(struct builder *b, uint32_t number, struct items *items);
static struct bounds instance_bounds(const struct builder *b, const struct instance *i);

static void add_children(struct builder *b, const struct object *o, const struct context *c)
{
    for (size_t i = 0; i < o->n_child; i++)
        add_object(b, o->child[i], c);
}

/* CSG as it stands in its own space: what it says itself is in the context. */
static void add_bare_csg(struct builder *b, const struct object *o, const struct context *c)
{
    struct object bare = *o;
    struct object_more more = *o->more;

    more.interior = NULL;
    more.interior_texture = NULL;
    more.n_bound = 0;
    bare.more = &more;
    bare.texture = NULL;
    bare.place = &transform_identity;
    bare.flags &= ~(OBJECT_INVERSE | OBJECT_CUTAWAY_TEXTURES);
    add_csg(b, &bare, c);
}

/* The children's space for this look and these flags, made when new. */
static uint32_t space_for(struct builder *b, const struct object *o, const struct context *c)
{
    for (size_t i = b->n_made; i-- > 0;) {
        const struct made_space *m = &b->made[i];
        if (m->children == o->child && m->flags == c->flags && m->inverse == c->inverse
            && m->is_inherited == c->is_inherited)
            return m->space;
    }
    struct items items = { .whole = BOUNDS_EMPTY }, *outer_items = b->items;
    uint32_t outer_space = b->space;
    b->items = &items;
    b->space = new_space(b);
    struct made_space made = { o->child, c->flags, c->inverse, c->is_inherited, b->space };
    struct context in = *c;
    in.placement = NULL;
    (o->kind == OBJECT_UNION ? add_children : add_bare_csg)(b, o, &in);
    finish_space(b, b->space, &items);
    b->items = outer_items;
    b->space = outer_space;
    b->made = arena_grow(&b->scrap, b->made, b->n_made, &b->room_made, sizeof *b->made);
    b->made[b->n_made++] = made;
    return made.space;
}

/* Children that all inherit their look get it from the instance; if none
 * inherits anything there is nothing to do; a mixture is not shared. */
static bool can_be_shared(const struct shared *s, const struct context *c, bool *inherits)
{
    bool needs = (c->look.texture && s->lacks_texture)
                 || (c->look.interior_texture && s->lacks_interior_texture)
                 || (c->look.interior && s->lacks_interior);

    *inherits = needs;
    return !needs || !s->has_look;
}

static bool add_instance(struct builder *b, const struct object *o, const struct context *c)
{
    struct plan *p = b->plan;
    const struct shared *shared = b->space == 0 ? share_find(&b->share, o) : NULL;
    bool inherits;

    if (!shared || !share_is_worth_it(shared, o->kind != OBJECT_UNION) || !can_be_shared(shared, c, &inherits))
        return false;
    struct context in = *c;
    uint32_t surface = inherits ? surface_for(b, c, NULL) : NO_LEAF;
    in.is_inherited = inherits;
    uint32_t root = space_for(b, o, &in);
    struct instance one = { *transform_of(c->placement), 1, 0, root, surface, mask_of(c->flags) };
    one.stretch = mat_norm(&one.place.to);
    one.fuzz = fuzz_of(&one.place);
    struct bounds bounds = instance_bounds(b, &one);
    if (bounds_are_empty(bounds))
        return true;
    p->instance = arena_grow(&b->scrap, p->instance, p->n_instance, &b->room_instance,
                             sizeof *p->instance);
    p->instance[p->n_instance] = one;
    items_add(b, item_of(ITEM_INSTANCE, (uint32_t)p->n_instance++), bounds);
    return true;
}

/* --- objects --------------------------------------------------------------- */

static bool is_csg(const struct object *o)
{
    return o->more->n_clip > 0 || o->kind == OBJECT_INTERSECTION || o->kind == OBJECT_DIFFERENCE
           || o->kind == OBJECT_MERGE;
}

/* Clips are not placed with what they cut. */
static bool add_csg_instance(struct builder *b, const struct object *o, const struct context *outer)
{
    if (o->more->n_clip > 0 || b->space != 0 || !share_find(&b->share, o))
        return false;
    struct context c = within(b, outer, o);
    return !c.inverse && add_instance(b, o, &c);
}

static void add_object(struct builder *b, const struct object *o, const struct context *outer)
{
    if (o->kind == OBJECT_LIGHT)
        return;
    if (is_csg(o)) {
        if (!add_csg_instance(b, o, outer))
            add_csg(b, o, outer);
        return;
    }
    struct context c = within(b, outer, o);
    count_left_out(b, o);
    if (o->kind == OBJECT_UNION) {
        if (!add_instance(b, o, &c))
            add_children(b, o, &c);
        return;
    }
    struct bounds bounds;
    uint32_t leaf = add_leaf(b, o, &c, false, &bounds);
    if (leaf != NO_LEAF)
        items_add(b, item_of(ITEM_LEAF, leaf), bounds);
}

/* --- spaces ---------------------------------------------------------------- */

static uint32_t new_space(struct builder *b)
{
    struct geometry *g = b->geometry;

    g->space = arena_grow(&b->scrap, g->space, g->n_space, &b->room_space, sizeof *g->space);
    g->space[g->n_space] = (struct space) { .n_unbounded = 0 };
    return (uint32_t)g->n_space++;
}

static struct bounds space_bounds(const struct space *s)
{
    if (s->n_unbounded)
        return BOUNDS_ALL;
    if (s->tree.n_node == 0)
        return BOUNDS_EMPTY;
    vec3 half = vec_scale(s->tree.half, 1 / s->tree.scale);
    return (struct bounds) { vec_sub(s->tree.middle, half), vec_add(s->tree.middle, half) };
}

static struct bounds instance_bounds(const struct builder *b, const struct instance *i)
{
    struct bounds in = space_bounds(&b->geometry->space[i->root]);
    struct bounds out = bounds_move(&in, &i->place);
    double pad = i->fuzz * larger(vec_largest(out.low), vec_largest(out.high));
    vec3 by = vec(pad, pad, pad);

    return (struct bounds) { vec_sub(out.low, by), vec_add(out.high, by) };
}

static struct bounds item_bounds(const struct builder *b, uint32_t item)
{
    uint32_t number = item_number(item);

    switch (item_kind(item)) {
    case ITEM_LEAF: return leaf_bounds(&b->plan->leaf[number]);
    case ITEM_CSG:  return b->geometry->csg[number].bounds;
    case ITEM_INSTANCE: break;
    }
    return instance_bounds(b, &b->plan->instance[number]);
}

/* A transform that is not a similarity gives a ball that is larger than need
 * be; mat_norm is sqrt 3 times the scale of one that is. */
static double ball_stretch(const struct placement *p)
{
    const mat34 *m = &p->place.to;
    double column[3], most = 0, least = INFINITY;

    for (int i = 0; i < 3; i++) {
        column[i] = vec_length(vec(m->m[0][i], m->m[1][i], m->m[2][i]));
        most = larger(most, column[i]);
        least = smaller(least, column[i]);
    }
    bool is_similarity = p->stretch * p->stretch <= 3 * least * least * (1 + 1e-9)
                         && p->fuzz <= 3 * 0x1p-52 * (1 + 1e-9);
    return is_similarity ? most * (1 + 1e-8) : p->stretch;
}

static bool is_ball(const struct builder *b, uint32_t item)
{
    const struct leaf *l = &b->plan->leaf[item_number(item)];

    return item_kind(item) == ITEM_LEAF && l->ops && l->ops->is_ball;
}

static bool item_ball(const void *of, uint32_t item, vec3 *centre, double *radius)
{
    const struct builder *b = of;

    if (!is_ball(b, item))
        return false;
    const struct leaf *l = &b->plan->leaf[item_number(item)];
    struct bounds box = l->ops->bounds(l->shape);
    *centre = vec_add(vec_scale(box.low, 0.5), vec_scale(box.high, 0.5));
    *radius = larger(box.high.x - centre->x, larger(box.high.y - centre->y, box.high.z - centre->z));
    if (l->placement) {
        *centre = mat_point(&l->placement->place.to, *centre);
        *radius *= ball_stretch(l->placement);
    }
    return true;
}

static bool mostly_balls(const struct builder *b, const struct list *items)
{
    size_t n = 0;

    for (size_t i = 0; i < items->n; i++)
        n += is_ball(b, items->item[i]);
    return 2 * n > items->n;
}

/* --- bricks ---------------------------------------------------------------- */

static struct brick brick_of_bounds(struct bounds b)
{
    vec3 half = vec_scale(vec_sub(b.high, b.low), 0.5);
    double least = 0x1p-20 * vec_largest(half);         /* flat things need some thickness, too */

    return (struct brick) { vec_add(vec_scale(b.low, 0.5), vec_scale(b.high, 0.5)),
                            { vec(larger(half.x, least), 0, 0), vec(0, larger(half.y, least), 0),
                              vec(0, 0, larger(half.z, least)) } };
}

static void brick_move(struct brick *b, const struct transform *t)
{
    b->centre = mat_point(&t->to, b->centre);
    for (int i = 0; i < 3; i++)
        b->edge[i] = mat_direction(&t->to, b->edge[i]);
}

static const double fuzziest = 1e-9;            /* beyond this rounding is no trifle */

static bool leaf_brick(const struct leaf *l, struct brick *out)
{
    if (l->placement && l->placement->fuzz > fuzziest)
        return false;
    if (l->ops && l->ops->hold)
        l->ops->hold(l->shape, &out->centre, out->edge);
    else
        *out = brick_of_bounds(l->ops ? l->ops->bounds(l->shape) : l->mesh->bounds);
    if (l->placement)
        brick_move(out, &l->placement->place);
    return true;
}

static bool item_brick(const void *of, uint32_t item, struct brick *out)
{
    const struct builder *b = of;
    uint32_t number = item_number(item);

    switch (item_kind(item)) {
    case ITEM_LEAF: return leaf_brick(&b->plan->leaf[number], out);
    case ITEM_CSG:  *out = brick_of_bounds(b->geometry->csg[number].bounds); return true;
    case ITEM_INSTANCE: break;
    }
    const struct instance *i = &b->plan->instance[number];
    if (i->fuzz > fuzziest)
        return false;
    *out = brick_of_bounds(space_bounds(&b->geometry->space[i->root]));
    brick_move(out, &i->place);
    return true;
}

/* As much of a placement as bricks are made of. */
static void place_fetch(const struct transform *place, const double *fuzz)
{
    __builtin_prefetch(&place->to.m[0]);
    __builtin_prefetch(&place->to.m[2]);
    __builtin_prefetch(fuzz);
}

static void leaf_fetch(const struct leaf *l)
{
    __builtin_prefetch(l->shape);
    if (l->placement)
        place_fetch(&l->placement->place, &l->placement->fuzz);
}

static void item_fetch(const void *of, uint32_t item, bool is_near)
{
    const struct builder *b = of;
    const struct plan *p = b->plan;
    uint32_t number = item_number(item);

    if (item_kind(item) == ITEM_INSTANCE && !is_near)
        place_fetch(&p->instance[number].place, &p->instance[number].fuzz);
    else if (item_kind(item) == ITEM_LEAF && !is_near)
        __builtin_prefetch(&p->leaf[number]);
    else if (item_kind(item) == ITEM_LEAF)
        leaf_fetch(&p->leaf[number]);
}

/* May the item block light, may it let some through? */
static struct candidate candidate_of(const struct builder *b, uint32_t item, struct bounds bounds)
{
    const struct leaf *l = &b->plan->leaf[item_number(item)];

    if (item_kind(item) != ITEM_LEAF || l->surface == NO_LEAF)
        return (struct candidate) { bounds, true, true };
    if (!(l->mask & RAY_SHADOW))
        return (struct candidate) { bounds, false, false };
    bool is_opaque = b->plan->surface[l->surface].is_opaque;
    return (struct candidate) { bounds, is_opaque, !is_opaque };
}

static struct few *few_of(struct builder *b, const struct list *items, struct space *s)
{
    if (items->n > FEW)
        return NULL;
    struct few *f = arena_alloc(b->plan->mem, sizeof *f);
    for (size_t i = 0; i < items->n; i++) {
        struct bounds box = item_bounds(b, items->item[i]);
        struct candidate c = candidate_of(b, items->item[i], box);
        s->opaque |= (uint64_t)c.is_opaque << f->n;
        s->clear |= (uint64_t)c.is_clear << f->n;
        if (item_kind(items->item[i]) == ITEM_LEAF)
            box = leaf_crust(&b->plan->leaf[item_number(items->item[i])]);
        few_add(f, items->item[i], &box);
    }
    return f;
}

/* Both lists have the same order; the lists stay one where nothing is
 * without bounds. */
static void take_out_unbounded(struct items *items)
{
    struct list *all = &items->all;
    size_t n = 0, k = 0;

    if (items->unbounded.n == 0)
        return;
    for (size_t i = 0; i < all->n; i++) {
        if (k < items->unbounded.n && all->item[i] == items->unbounded.item[k])
            k++;
        else
            all->item[n++] = all->item[i];
    }
    all->n = n;
}

struct bounded { const struct builder *builder; const struct list *list; };

static struct bounds nth(const void *of, size_t i)
{
    const struct bounded *b = of;

    return item_bounds(b->builder, b->list->item[i]);
}

static struct candidate *candidates_of(const struct builder *b, const struct bvh *tree)
{
    struct candidate *c = arena_array(b->plan->mem, tree->n_item + 1, sizeof *c);

    for (size_t i = 0; i < tree->n_item; i++)
        c[i] = candidate_of(b, tree->item[i], item_bounds(b, tree->item[i]));
    return c;
}

/* Balls or bricks, which hold the tree's items more tightly. */
static void wrap_items(struct builder *b, struct bvh *tree, const struct list *items)
{
    if (mostly_balls(b, items))
        bvh_add_balls(tree, item_ball, item_fetch, b, b->plan->mem);
    else if (items->n > FEW)
        bvh_add_bricks(tree, &(struct brick_source) { item_brick, item_fetch, b }, b->plan->mem);
}

/* May points be within it, in an interior?  That of a copy may be the copy's own. */
static bool is_filled(const struct builder *b, uint32_t item)
{
    const struct plan *p = b->plan;
    uint32_t number = item_number(item);

    if (item_kind(item) == ITEM_INSTANCE)
        return b->geometry->space[p->instance[number].root].n_filled > 0;
    bool is_csg = item_kind(item) == ITEM_CSG;
    const struct leaf *l = &p->leaf[is_csg ? b->geometry->csg[number].surface_leaf : number];
    return (is_csg || has_inside(l)) && (l->surface == NO_LEAF || p->surface[l->surface].interior);
}

static void find_filled(struct builder *b, const struct list *items, struct space *s)
{
    struct list filled = { 0 };

    for (size_t i = 0; i < items->n; i++)
        if (is_filled(b, items->item[i]))
            list_add(b, &filled, items->item[i]);
    s->n_filled = filled.n;
    s->filled = arena_copy(b->plan->mem, filled.item, filled.n * sizeof *filled.item);
}

static void finish_space(struct builder *b, uint32_t number, struct items *items)
{
    enum { ITEMS_A_LEAF = 8, MOST_CANDIDATES = 1 << 14 };
    struct list *bounded = &items->all, *unbounded = &items->unbounded;
    struct space s = { .n_unbounded = unbounded->n };

    find_filled(b, &items->all, &s);
    s.few = few_of(b, &items->all, &s);
    take_out_unbounded(items);
    bvh_build(&s.tree, bounded->n, nth, &(struct bounded) { b, bounded }, &items->whole, ITEMS_A_LEAF,
              1, b->threads, b->plan->mem);
    for (size_t i = 0; i < bounded->n; i++)
        s.tree.item[i] = bounded->item[s.tree.item[i]];
    if (number == 0 && bounded->n <= MOST_CANDIDATES)
        s.candidate = candidates_of(b, &s.tree);
    wrap_items(b, &s.tree, bounded);
    s.unbounded = arena_copy(b->plan->mem, unbounded->item, unbounded->n * sizeof *unbounded->item);
    b->geometry->space[number] = s;
}

/* --- the whole scene ------------------------------------------------------- */

static const struct context top = { .is_inherited = false };

static bool is_endless(const struct builder *b, const struct object *o)
{
    const struct shared *shared = share_find(&b->share, o);

    return o->kind == OBJECT_SHAPE ? o->ops->is_infinite : shared && shared->is_endless;
}

/* Of hits at the same place that of the first leaf counts.  What has no end
 * comes first, wherever it is listed: on a floor that a box's face lies in,
 * the floor is seen, as POV-Ray has it. */
static void add_objects(struct builder *b, const struct scene *s, bool endless)
{
    for (size_t i = 0; i < s->n_object; i++) {
        struct object room;
        if (is_endless(b, s->listed[i].like) == endless)
            add_object(b, scene_object(s, i, &room), &top);
    }
}

/* The shape of a light lets the light out. */
static void add_lamps(struct builder *b)
{
    const struct scene *s = b->plan->scene;

    for (size_t i = 0; i < s->n_light; i++)
        if (s->light[i].looks_like) {
            struct object o = *s->light[i].looks_like;
            o.flags |= OBJECT_NO_SHADOW;
            o.flags_given |= OBJECT_NO_SHADOW;
            add_object(b, &o, &top);
        }
}

/* No more leaves and placements will come: they leave scrap, and the objects
 * they were made of are left, before the largest tree needs memory. */
static void take_leaves(struct builder *b, struct scene *s)
{
    struct plan *p = b->plan;

    scene_forget_objects(s);
    p->leaf = arena_take(p->mem, &b->scrap, p->leaf, p->n_leaf, sizeof *p->leaf);
    p->instance = arena_take(p->mem, &b->scrap, p->instance, p->n_instance, sizeof *p->instance);
}

/* What else grew in scrap moves to the plan; the CSG roots learn where the
 * leaves ended up. */
static void settle(struct builder *b)
{
    struct plan *p = b->plan;
    struct geometry *g = b->geometry;

    g->csg = arena_copy(p->mem, g->csg, g->n_csg * sizeof *g->csg);
    for (size_t i = 0; i < g->n_csg; i++) {
        g->csg[i].leaf = p->leaf;
        csg_finish(&g->csg[i], p->mem);
    }
}

static void note_what_is_left_out(const struct builder *b)
{
    struct plan *p = b->plan;

    if (b->n_empty)
        plan_note(p, "%zu empty shapes are left out", b->n_empty);
    if (b->n_bound)
        plan_note(p, "bounded_by is not needed and left out (%zu objects)", b->n_bound);
    if (b->n_cutaway)
        plan_note(p, "cutaway_textures is not supported: cut surfaces look as usual (%zu objects)",
                  b->n_cutaway);
}

void geometry_build(struct plan *p, struct scene *s, unsigned threads)
{
    struct builder b = { .plan = p, .threads = threads };
    struct items items = { .whole = BOUNDS_EMPTY };

    arena_init(&b.scrap, p->mem->budget);
    b.geometry = arena_alloc(p->mem, sizeof *b.geometry);
    p->geometry = b.geometry;
    share_init(&b.share, s, &b.scrap);
    b.items = &items;
    b.space = new_space(&b);
    add_objects(&b, s, true);
    add_objects(&b, s, false);
    add_lamps(&b);
    take_leaves(&b, s);
    finish_space(&b, 0, &items);
    settle(&b);
    b.geometry->space = arena_copy(p->mem, b.geometry->space,
                                   b.geometry->n_space * sizeof *b.geometry->space);
    note_what_is_left_out(&b);
    arena_free(&b.scrap);
}
