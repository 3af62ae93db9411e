/* bvh_build.c: building a tree of boxes.
 *
 * Things that lie together are put into cells by counting; then each cell is
 * a small tree by itself, and the cells are the leaves of the tree above
 * them.  Dividing a few hundred things again and again happens in the
 * processor's cache, which dividing a million does not.
 *
 * A node takes its (up to) eight children by splitting the largest of them
 * again and again. */
#include "tree/bvh.h"

#include <string.h>

#include "base/jobs.h"
#include "tree/cells.h"
#include "tree/split.h"

enum {
    SPLIT_BY_COUNT = 16,        /* levels after which ranges are halved, so that depth is bounded: */
    MOST_DEPTH = 2 * (16 + 11), /* below and above cells; 2^32 items halved three times a level; 7 * this < BVH_STACK */
    CELL = 1024,                /* items that lie together */
    FULL_LEAVES = 6,            /* a node's, when as many as can be are leaves of one */
    UNDIVIDED = 4096,           /* as many are quick enough to divide without cells */
    PART = 4096,                /* items that make a job of their own, ... */
    MOST_PARTS = 64,            /* ... or more, so that this is enough for all */
};

/* An item's box in the tree's own unit: as struct box, without what is free
 * there.  There are as many as items, and a box is made once. */
struct side { float low[3], high[3]; };

/* A tree, or a part of one.  Where leaves begin is counted from offset. */
struct builder {
    struct arena *mem;
    struct ref *ref, *spare;
    unsigned leaf_size, enough;
    uint32_t offset;
    struct bvh_node *node;
    size_t n_node, room;
};

/* What is split first: the largest or the fullest. */
static float urgency(const struct range *r, uint32_t enough, bool by_number)
{
    if (r->n <= enough)
        return -1;
    return by_number ? (float)r->n : box_area(&r->box);
}

static int worth_splitting(const float urgency[], int n)
{
    int best = 0;

    for (int i = 1; i < n; i++)
        if (urgency[i] > urgency[best])
            best = i;
    return urgency[best] < 0 ? -1 : best;
}

/* Splits the n ranges until there are eight or each has enough or less;
 * returns how many there are. */
static int divide(struct builder *b, int depth, uint32_t enough, bool by_number, struct range r[LANES], int n)
{
    float urgent[LANES];
    int i;

    for (i = 0; i < n; i++)
        urgent[i] = urgency(&r[i], enough, by_number);
    while (n < LANES && (i = worth_splitting(urgent, n)) >= 0) {
        struct range half[2];
        range_split(&r[i], b->ref, b->spare, depth >= SPLIT_BY_COUNT, half);
        r[i] = half[0];
        r[n] = half[1];
        urgent[i] = urgency(&r[i], enough, by_number);
        urgent[n] = urgency(&r[n], enough, by_number);
        n++;
    }
    return n;
}

/* In a node above leaves the fullest are split, so that all become leaves of
 * it; slots that are left are put to use.  A range that would fill a node is
 * left to one: half empty nodes are no quicker, and there would be twice as
 * many. */
static int children(struct builder *b, const struct range *whole, int depth, struct range r[LANES])
{
    r[0] = *whole;
    if (whole->n > LANES * b->leaf_size)
        return divide(b, depth, FULL_LEAVES * b->leaf_size, false, r, 1);
    int n = divide(b, depth, b->leaf_size, true, r, 1);
    return divide(b, depth, b->enough, false, r, n);
}

static void slot_box(struct bvh_node *n, int slot, const struct box *b)
{
    for (int axis = 0; axis < 3; axis++) {
        n->side[0][axis][slot] = b->side[axis];
        n->side[1][axis][slot] = -b->side[4 + axis];
    }
}

/* No ray meets a box that is infinitely far away, whichever side is taken
 * for the low one. */
static void clear(struct bvh_node *n)
{
    static const struct box nowhere = { { INFINITY, INFINITY, INFINITY, 0,
                                          -INFINITY, -INFINITY, -INFINITY, 0 } };

    *n = (struct bvh_node) { .count = { 0 } };
    for (int slot = 0; slot < LANES; slot++)
        slot_box(n, slot, &nowhere);
}

static uint32_t build_node(struct builder *b, const struct range *whole, int depth)
{
    struct range r[LANES];
    int n = children(b, whole, depth, r);

    b->node = arena_grow(b->mem, b->node, b->n_node, &b->room, sizeof *b->node);
    uint32_t self = (uint32_t)b->n_node++;
    clear(&b->node[self]);
    for (int i = 0; i < n; i++) {
        bool is_leaf = r[i].n <= b->leaf_size;
        uint32_t child = is_leaf ? b->offset + r[i].first : build_node(b, &r[i], depth + 1);
        struct bvh_node *node = &b->node[self];
        slot_box(node, i, &r[i].box);
        node->child[i] = child;
        node->count[i] = is_leaf ? r[i].n : 0;
    }
    return self;
}

/* --- the cells --------------------------------------------------------------------------- */

/* Rounded outwards; high is negated as in struct box. */
static struct side side_of(const struct bvh *tree, struct bounds b)
{
    vec3 low = vec_sub(b.low, tree->middle), high = vec_sub(tree->middle, b.high);
    double side[] = { low.x, low.y, low.z, high.x, high.y, high.z };
    float out[6];

    for (int i = 0; i < 6; i++) {
        float f = (float)(side[i] * tree->scale);
        out[i] = f - (fabsf(f) * FLT_EPSILON + FLT_MIN);
    }
    return (struct side) { { out[0], out[1], out[2] }, { out[3], out[4], out[5] } };
}

static struct ref ref_of(const struct side *s, uint32_t item)
{
    return (struct ref) { { { s->low[0], s->low[1], s->low[2], 0, s->high[0], s->high[1], s->high[2], 0 } },
                          item, 1 };
}

static double middle_along(const struct side *s, int axis)
{
    return 0.5 * ((double)s->low[axis] - (double)s->high[axis]);
}

static vec3 middle_of(const void *of, uint32_t item)
{
    const struct side *s = (const struct side *)of + item;

    return vec(middle_along(s, 0), middle_along(s, 1), middle_along(s, 2));
}

/* Some cells that follow each other, and the small trees that they become:
 * a node of the part's, or a leaf where there is no more than that. */
struct part {
    struct arena mem;
    struct bvh_node *node;
    size_t n_node;
    const struct cell *cell;
    size_t n;
    struct ref *whole;                  /* of each cell: its box and weight */
    uint32_t *root;
};

/* What a thread builds its parts in, one after the other. */
struct yard {
    struct arena mem;
    struct builder builder;
};

struct parts {
    const struct side *side;
    uint32_t *item;
    unsigned leaf_size, enough;
    struct arena *mem;
    struct yard *yard;                  /* of each thread */
    uint32_t most;                      /* that a cell holds */
    struct part *part;
    size_t n;
};

static void build_cell(const struct parts *all, struct builder *b, struct part *p, size_t i)
{
    struct cell c = p->cell[i];
    struct range whole = { .n = c.n };

    for (uint32_t k = 0; k < c.n; k++)
        b->ref[k] = ref_of(&all->side[all->item[c.first + k]], all->item[c.first + k]);
    range_measure(&whole, b->ref);
    p->whole[i] = (struct ref) { whole.box, 0, whole.weight };
    b->offset = c.first;
    if (c.n > b->leaf_size)
        p->root[i] = build_node(b, &whole, 0);
    for (uint32_t k = 0; k < c.n; k++)
        all->item[c.first + k] = b->ref[k].item;
}

static struct builder *builder_in(struct yard *y, const struct parts *all)
{
    struct builder *b = &y->builder;

    if (!b->mem) {
        arena_init(&y->mem, all->mem->budget);
        *b = (struct builder) { .mem = &y->mem, .leaf_size = all->leaf_size, .enough = all->enough };
        b->ref = arena_array(&y->mem, 2 * (size_t)all->most, sizeof *b->ref);
        b->spare = b->ref + all->most;
    }
    b->n_node = 0;
    return b;
}

static void build_part(void *arg, size_t i, unsigned worker)
{
    const struct parts *all = arg;
    struct part *p = &all->part[i];
    struct builder *b = builder_in(&all->yard[worker], all);

    for (size_t k = 0; k < p->n; k++)
        build_cell(all, b, p, k);
    arena_init(&p->mem, all->mem->budget);
    p->node = arena_copy(&p->mem, b->node, b->n_node * sizeof *b->node);
    p->n_node = b->n_node;
}

/* The small trees of all parts. */
static void build_parts(struct parts *all, unsigned threads)
{
    all->yard = arena_array(all->mem, threads, sizeof *all->yard);
    jobs_run(threads, all->n, build_part, all);
    for (unsigned i = 0; i < threads; i++)
        arena_free(&all->yard[i].mem);
}

static void cut_into_parts(struct parts *all, const struct cells *c, size_t n)
{
    struct ref *whole = arena_array(all->mem, c->n, sizeof *whole);
    uint32_t *root = arena_array(all->mem, c->n, sizeof *root);
    uint32_t end = 0, enough = (uint32_t)(n / MOST_PARTS);

    all->part = arena_array(all->mem, c->n, sizeof *all->part);
    for (size_t i = 0; i < c->n; i++) {
        if (c->cell[i].first >= end) {
            all->part[all->n++] = (struct part) { .cell = &c->cell[i], .whole = &whole[i], .root = &root[i] };
            end = c->cell[i].first + (enough > PART ? enough : PART);
        }
        all->part[all->n - 1].n++;
        all->most = c->cell[i].n > all->most ? c->cell[i].n : all->most;
    }
}

/* --- putting it together ------------------------------------------------------------------ */

/* The tree above the cells, whose leaves are single cells. */
static void build_top(struct builder *top, const struct parts *all, size_t n_cell)
{
    struct range whole = { .n = (uint32_t)n_cell };

    if (n_cell == 1 && all->part[0].n_node > 0)
        return;                         /* which is all of the tree */
    top->ref = arena_array(top->mem, 2 * n_cell, sizeof *top->ref);
    top->spare = top->ref + n_cell;
    memcpy(top->ref, all->part[0].whole, n_cell * sizeof *top->ref);
    for (size_t i = 0; i < n_cell; i++)
        top->ref[i].item = (uint32_t)i;
    range_measure(&whole, top->ref);
    build_node(top, &whole, 0);
}

static void place_part(struct bvh_node *to, const struct bvh_node *from, size_t n, uint32_t offset)
{
    for (size_t i = 0; i < n; i++) {
        to[i] = from[i];
        for (int slot = 0; slot < LANES; slot++)
            if (to[i].count[slot] == 0)
                to[i].child[slot] += offset;
    }
}

/* The parts stand behind the top in their own order, so that the tree does not
 * depend on the number of threads. */
static void assemble(struct bvh *tree, const struct builder *top, struct parts *all, struct arena *mem)
{
    size_t n = top->n_node;

    for (size_t i = 0; i < all->n; i++)
        n += all->part[i].n_node;
    tree->node = arena_alloc_aligned(mem, n * sizeof *tree->node, 64);
    tree->n_node = top->n_node;
    if (top->n_node)                    /* nothing: one part is the tree */
        memcpy(tree->node, top->node, top->n_node * sizeof *tree->node);
    for (size_t i = 0; i < all->n; i++) {
        struct part *p = &all->part[i];
        place_part(tree->node + tree->n_node, p->node, p->n_node, (uint32_t)tree->n_node);
        for (size_t k = 0; k < p->n; k++)
            p->root[k] += (uint32_t)tree->n_node;
        tree->n_node += p->n_node;
        arena_free(&p->mem);
    }
}

static void join_cells(struct bvh *tree, const struct builder *top, const struct parts *all, unsigned leaf_size)
{
    const struct part *first = &all->part[0];

    for (size_t i = 0; i < top->n_node; i++)
        for (int slot = 0; slot < LANES; slot++) {
            if (tree->node[i].count[slot] == 0)
                continue;
            uint32_t cell = top->ref[tree->node[i].child[slot]].item;
            bool is_leaf = first->cell[cell].n <= leaf_size;
            tree->node[i].count[slot] = is_leaf ? first->cell[cell].n : 0;
            tree->node[i].child[slot] = is_leaf ? first->cell[cell].first : first->root[cell];
        }
}

/* The unit in which everything lies in -1..1. */
static void measure(struct bvh *b, struct bounds all)
{
    int exponent;

    b->middle = vec_add(vec_scale(all.low, 0.5), vec_scale(all.high, 0.5));
    vec3 high = vec_sub(all.high, b->middle), low = vec_sub(b->middle, all.low);
    vec3 half = vec(fmax(high.x, low.x), fmax(high.y, low.y), fmax(high.z, low.z));
    double largest = vec_largest(half);
    frexp(largest, &exponent);
    b->scale = largest > 0 ? ldexp(1, exponent < -1000 ? 1000 : -exponent) : 1;
    b->half = vec_scale(half, b->scale);
}

/* The boxes of the tree's items. */
struct source {
    struct bounds (*box)(const void *of, size_t i);
    const void *of;
};

static struct bounds join_all(const struct source *s, size_t n)
{
    struct bounds all = BOUNDS_EMPTY;

    for (size_t i = 0; i < n; i++)
        all = bounds_join(all, s->box(s->of, i));
    return all;
}

static const struct side *begin(struct bvh *tree, const struct source *s, struct arena *mem,
                                struct arena *scrap)
{
    struct side *side = arena_array(scrap, tree->n_item, sizeof *side);

    measure(tree, tree->bounds);
    tree->item = arena_array(mem, tree->n_item, sizeof *tree->item);
    for (size_t i = 0; i < tree->n_item; i++) {
        side[i] = side_of(tree, s->box(s->of, i));
        tree->item[i] = (uint32_t)i;
    }
    return side;
}

void bvh_build(struct bvh *tree, size_t n, struct bounds (*box)(const void *of, size_t i),
               const void *of, const struct bounds *whole, unsigned leaf_size, unsigned enough,
               unsigned threads, struct arena *mem)
{
    struct source source = { box, of };
    struct arena scrap;

    *tree = (struct bvh) { .n_item = n };
    if (n == 0)
        return;
    arena_init(&scrap, mem->budget);
    tree->bounds = whole ? *whole : join_all(&source, n);
    struct cells cells = { .mem = &scrap };
    struct parts all = { .leaf_size = leaf_size, .enough = enough, .mem = &scrap };
    all.side = begin(tree, &source, mem, &scrap);
    all.item = tree->item;
    cells_make(&cells, tree->item, (uint32_t)n, n > UNDIVIDED ? CELL : UNDIVIDED, middle_of, all.side);
    cut_into_parts(&all, &cells, n);
    build_parts(&all, threads);
    struct builder top = { .mem = &scrap, .leaf_size = 1, .enough = 1 };
    build_top(&top, &all, cells.n);
    assemble(tree, &top, &all, mem);
    join_cells(tree, &top, &all, leaf_size);
    arena_free(&scrap);
}
