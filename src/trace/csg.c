/* csg.c: one sweep along the ray decides what of a CSG is seen. */
#include "trace/csg.h"

#include <stdlib.h>
#include <string.h>

#include "math/wide.h"
#include "trace/convex.h"
#include "trace/world.h"

enum { PARTS_A_LEAF = 2, MOST_MESH_HITS = 1 << 14 };

static bool holds(const struct csg_node *n, uint32_t count)
{
    return n->kind == CSG_INTERSECTION ? count == n->n_child : count > 0;
}

/* A child of node at has changed sides: so may the nodes above. */
void csg_count(const struct csg_node node[], uint32_t count[], uint32_t at, int by)
{
    while (at != NO_LEAF) {
        bool before = holds(&node[at], count[at]);
        count[at] += (uint32_t)by;
        if (holds(&node[at], count[at]) == before)
            return;
        at = node[at].parent;
    }
}

/* --- building -------------------------------------------------------------- */

static int most_hits(const struct leaf *l)
{
    if (l->ops)
        return l->ops->most_hits;
    size_t faces = l->mesh->tree.n_item;
    return faces < MOST_MESH_HITS ? (int)faces : MOST_MESH_HITS;
}

/* --- boxes of few parts ---------------------------------------------------- */

/* As many boxes at once as a register holds against one ray; cheaper than
 * aiming at a tree. */
enum { MOST_BOXES = 32 };

struct batch { wide side[2][3]; };      /* low and high, padded */

struct part_boxes {
    size_t n;                           /* batches */
    struct batch *batch;
    uint32_t part[MOST_BOXES];
};

/* Wider than all rounding of the slabs' three operations. */
static const double rounding = 0x1p-49;

/* A ray in a face's plane gives 0 * infinity, which changes nothing. */
INLINE void batch_clip(const struct batch *b, int axis, double origin, double inverse,
                       wide *begin, wide *end)
{
    bool down = inverse < 0;

    *begin = wide_max((b->side[down][axis] - origin) * inverse, *begin);
    *end = wide_min((b->side[!down][axis] - origin) * inverse, *end);
}

/* Bit k: the ray meets box k between 0 and far. */
static uint32_t boxes_met(const struct part_boxes *b, struct ray ray, double far)
{
    vec3 inverse = vec(1 / ray.dir.x, 1 / ray.dir.y, 1 / ray.dir.z);
    uint32_t bits = 0;

    for (size_t i = 0; i < b->n; i++) {
        wide begin = wide_of(0), end = wide_of(far);
        batch_clip(&b->batch[i], 0, ray.origin.x, inverse.x, &begin, &end);
        batch_clip(&b->batch[i], 1, ray.origin.y, inverse.y, &begin, &end);
        batch_clip(&b->batch[i], 2, ray.origin.z, inverse.z, &begin, &end);
        bits |= wide_not_above(begin, end * (1 + rounding)) << (i * WIDE);
    }
    return bits;
}

static void set_box(struct batch *o, size_t at, struct bounds b)
{
    for (int axis = 0; axis < 3; axis++) {
        double low = vec_get(b.low, axis), high = vec_get(b.high, axis);
        double pad = rounding * fmax(fabs(low), fabs(high));
        o->side[0][axis][at] = low - pad;
        o->side[1][axis][at] = high + pad;
    }
}

bool csg_is_cut_only(const struct csg *c, const struct csg_part *part)
{
    for (uint32_t at = part->parent; at != NO_LEAF; at = c->node[at].parent)
        if (c->node[at].kind != CSG_INTERSECTION && c->node[at].n_child > 1)
            return false;
    return true;
}

/* Of a difference or an intersection, solids that the whole lies in. */
static bool is_required(const struct csg *c, const struct csg_part *part)
{
    return part->alternates && !part->is_asked && !c->leaf[part->leaf].inverse
           && csg_is_cut_only(c, part);
}

struct finite { const struct csg *csg; const uint32_t *part; };

static struct bounds part_bounds(const void *of, size_t i)
{
    const struct finite *f = of;
    return leaf_bounds(&f->csg->leaf[f->csg->part[f->part[i]].leaf]);
}

/* No ray meets the boxes that are left over, which are inside out. */
static void make_boxes(struct csg *c, const struct finite *f, size_t n, struct arena *mem)
{
    struct part_boxes *b = arena_alloc(mem, sizeof *b);
    const struct bounds nowhere = { { 1, 1, 1 }, { -1, -1, -1 } };

    b->n = (n + WIDE - 1) / WIDE;
    b->batch = arena_alloc_aligned(mem, (b->n + 1) * sizeof *b->batch, sizeof(wide));
    for (size_t i = 0; i < b->n * WIDE; i++)
        set_box(&b->batch[i / WIDE], i % WIDE,
                i < n ? part_bounds(f, i) : nowhere);
    for (size_t i = 0; i < n; i++) {
        b->part[i] = f->part[i];
        c->required |= (uint32_t)is_required(c, &c->part[f->part[i]]) << i;
    }
    c->boxes = b;
}

static void make_tree(struct csg *c, const struct finite *f, size_t n, struct arena *mem)
{
    bvh_build(&c->tree, n, part_bounds, f, NULL, PARTS_A_LEAF, 1, 1, mem);
    for (size_t i = 0; i < n; i++)
        c->tree.item[i] = f->part[c->tree.item[i]];
}

void csg_finish(struct csg *c, struct arena *mem)
{
    uint32_t *finite = arena_array(mem, c->n_part + 1, sizeof *finite);
    size_t n = 0;

    c->infinite = arena_array(mem, c->n_part + 1, sizeof *c->infinite);
    c->asked = arena_array(mem, c->n_part + 1, sizeof *c->asked);
    for (uint32_t i = 0; i < c->n_part; i++) {
        const struct csg_part *part = &c->part[i];
        c->most_events += (size_t)most_hits(&c->leaf[part->leaf]);
        if (part->is_asked)
            c->asked[c->n_asked++] = i;
        if (part->is_infinite)
            c->infinite[c->n_infinite++] = i;
        else
            finite[n++] = i;
    }
    (n <= MOST_BOXES ? make_boxes : make_tree)(c, &(struct finite) { c, finite }, n, mem);
    c->convex = convex_new(c, mem);
}

void csg_scratch_init(struct csg_scratch *s, const struct csg c[], size_t n, struct arena *mem)
{
    size_t nodes = 0, parts = 0;

    *s = (struct csg_scratch) { .hits_room = SHAPE_MOST_HITS };
    for (size_t i = 0; i < n; i++) {
        s->room = c[i].most_events > s->room ? c[i].most_events : s->room;
        nodes = c[i].n_node > nodes ? c[i].n_node : nodes;
        parts = c[i].n_part > parts ? c[i].n_part : parts;
        for (size_t k = 0; k < c[i].n_part; k++) {
            int most = most_hits(&c[i].leaf[c[i].part[k].leaf]);
            s->hits_room = most > s->hits_room ? most : s->hits_room;
        }
    }
    if (n == 0)
        return;
    s->event = arena_array(mem, s->room + 1, sizeof *s->event);
    s->key = arena_array(mem, s->room + 1, sizeof *s->key);
    s->count = arena_array(mem, nodes + 1, sizeof *s->count);
    s->before = arena_array(mem, nodes + 1, sizeof *s->before);
    s->asked_inside = arena_array(mem, parts + 1, sizeof *s->asked_inside);
    s->hits = arena_array(mem, (size_t)s->hits_room, sizeof *s->hits);
}

/* --- crossings ------------------------------------------------------------- */

struct sweep {
    const struct csg *csg;
    struct csg_scratch *s;
    struct ray ray;
    double reach;                       /* of the origin, in lengths of dir */
    double far;
    const struct placement *placement;  /* of the part before: many stand alike */
    struct ray placed;                  /* as it sees the ray */
};

static struct ray part_ray(struct sweep *w, const struct leaf *l)
{
    if (l->placement != w->placement) {
        w->placement = l->placement;
        w->placed = leaf_ray(l, w->ray);
    }
    return w->placed;
}

static int part_hits(struct sweep *w, const struct leaf *l, struct ray ray)
{
    if (l->ops)
        return l->ops->hits(l->shape, ray, w->s->hits);
    return mesh_hits(l->mesh, ray, -INFINITY, INFINITY, w->s->hits, w->s->hits_room,
                     w->s->box_tests);
}

static bool begins_inside(const struct leaf *l, struct ray ray, int n_hits)
{
    if (!l->ops)
        return false;
    if (n_hits == 0)                    /* a line beside a plane */
        return l->ops->inside(l->shape, ray.origin);
    return l->ops->starts_inside && l->ops->starts_inside(l->shape, ray.dir);
}

static int cut(struct sweep *w, uint32_t number)
{
    const struct csg_part *part = &w->csg->part[number];
    const struct leaf *l = &w->csg->leaf[part->leaf];
    struct ray ray = part_ray(w, l);
    int n = part_hits(w, l, ray);
    bool inside = part->is_infinite && begins_inside(l, ray, n);

    inside ^= l->inverse;
    if (part->is_infinite && part->alternates && inside)
        csg_count(w->csg->node, w->s->count, part->parent, 1);
    for (int i = 0; i < n; i++) {
        inside = !inside;
        uint32_t at = (uint32_t)w->s->n_event++;
        w->s->event[at] = (struct csg_event) { w->s->hits[i], number, inside };
        w->s->key[at] = (struct csg_key) { w->s->hits[i].t, at };
    }
    return n;
}

INLINE bool visit_part(void *arg, const uint32_t item[], uint32_t bits, double *far)
{
    (void)far;
    for (; bits; bits &= bits - 1)
        cut(arg, item[__builtin_ctz(bits)]);
    return false;
}

static int key_order(const void *a, const void *b)
{
    const struct csg_key *p = a, *q = b;

    return p->t != q->t ? (p->t < q->t ? -1 : 1) : (p->event > q->event) - (p->event < q->event);
}

/* Crossings of one part come in order, so this is mostly merging. */
static void sort_keys(struct csg_key k[], size_t n)
{
    if (n > 64) {
        qsort(k, n, sizeof *k, key_order);
        return;
    }
    for (size_t i = 1; i < n; i++) {
        struct csg_key one = k[i];
        size_t at = i;
        for (; at > 0 && k[at - 1].t > one.t; at--)
            k[at] = k[at - 1];
        k[at] = one;
    }
}

/* The crossing that comes in place i along the ray. */
INLINE const struct csg_event *event_at(const struct sweep *w, size_t i)
{
    return &w->s->event[w->s->key[i].event];
}

/* --- groups of crossings that coincide ------------------------------------- */

/* How far along the ray a crossing may be from where it was found: the
 * distance from its surface over the cosine. */
static double uncertainty(const struct sweep *w, const struct csg_event *e)
{
    const struct leaf *l = &w->csg->leaf[w->csg->part[e->part].leaf];
    vec3 n = vec_unit(leaf_normal(l, leaf_ray(l, w->ray), &e->hit));
    double across = fabs(vec_dot(n, w->ray.dir));

    return leaf_slack(l, w->ray, &e->hit) / across;
}

static bool coincide(const struct sweep *w, const struct csg_event *a, const struct csg_event *b)
{
    double gap = b->hit.t - a->hit.t;

    if (gap == 0)
        return true;
    if (gap > CSG_WORTH_A_LOOK * (fabs(a->hit.t) + w->reach))
        return false;
    return gap <= uncertainty(w, a) + uncertainty(w, b);
}

/* A part's second crossing is never thrown together with its first. */
static size_t group_end(const struct sweep *w, size_t first)
{
    size_t end = first + 1;

    for (; end < w->s->n_event; end++) {
        const struct csg_event *e = event_at(w, end);
        if (!coincide(w, event_at(w, first), e))
            return end;
        for (size_t i = first; i < end; i++)
            if (event_at(w, i)->part == e->part)
                return end;
    }
    return end;
}

/* --- what is seen ---------------------------------------------------------- */

/* At an intersection the solid must be there on the side where the part is;
 * at a merge it must be absent on the side where the part is not. */
static bool solid_shows(const struct sweep *w, const struct csg_event *e)
{
    const struct csg_node *node = w->csg->node;
    const uint32_t *within = e->enters ? w->s->count : w->s->before;
    const uint32_t *outside = e->enters ? w->s->before : w->s->count;

    for (uint32_t at = w->csg->part[e->part].parent; at != NO_LEAF; at = node[at].parent) {
        if (node[at].kind == CSG_INTERSECTION && !holds(&node[at], within[at]))
            return false;
        if (node[at].kind == CSG_MERGE && holds(&node[at], outside[at]))
            return false;
    }
    return true;
}

/* A patch counts if it is inside of all the others, whatever it contains
 * itself. */
static bool patch_shows(const struct sweep *w, const struct csg_event *e)
{
    const struct csg_node *node = w->csg->node;
    const struct csg_part *part = &w->csg->part[e->part];
    bool own = part->is_asked && w->s->asked_inside[e->part];

    for (uint32_t at = part->parent; at != NO_LEAF; at = node[at].parent) {
        uint32_t now = w->s->count[at], before = w->s->before[at];
        uint32_t others = (now > before ? now : before) - own;
        if (node[at].kind == CSG_INTERSECTION && others + 1 < node[at].n_child)
            return false;
        if (node[at].kind == CSG_MERGE && others > 0)
            return false;
        own = holds(&node[at], now);
    }
    return true;
}

static bool shows(const struct sweep *w, const struct csg_event *e)
{
    const struct csg_part *part = &w->csg->part[e->part];

    if (part->is_silent)
        return false;
    return part->alternates ? solid_shows(w, e) : patch_shows(w, e);
}

/* Parts whose crossings say nothing are asked about the group's point. */
static void ask(struct sweep *w, vec3 p)
{
    for (size_t i = 0; i < w->csg->n_asked; i++) {
        uint32_t number = w->csg->asked[i];
        const struct csg_part *part = &w->csg->part[number];
        bool inside = leaf_inside(&w->csg->leaf[part->leaf], p);
        if (inside == w->s->asked_inside[number])
            continue;
        w->s->asked_inside[number] = inside;
        csg_count(w->csg->node, w->s->count, part->parent, inside ? 1 : -1);
        csg_count(w->csg->node, w->s->before, part->parent, inside ? 1 : -1);
    }
}

static void pass(struct sweep *w, size_t first, size_t end)
{
    for (size_t i = first; i < end; i++) {
        const struct csg_event *e = event_at(w, i);
        const struct csg_part *part = &w->csg->part[e->part];
        if (part->alternates)
            csg_count(w->csg->node, w->s->count, part->parent, e->enters ? 1 : -1);
    }
}

static void settle(struct sweep *w, size_t first, size_t end)
{
    for (size_t i = first; i < end; i++) {
        uint32_t at = w->csg->part[event_at(w, i)->part].parent;
        for (; at != NO_LEAF && w->s->before[at] != w->s->count[at]; at = w->csg->node[at].parent)
            w->s->before[at] = w->s->count[at];
    }
}

/* Of surfaces that coincide the last listed shows, as in POV-Ray (facts
 * shading.md 0.1). */
static const struct csg_event *winner(const struct sweep *w, size_t first, size_t end)
{
    const struct csg_event *best = NULL;

    for (size_t i = first; i < end; i++) {
        const struct csg_event *e = event_at(w, i);
        if (shows(w, e) && (!best || e->part > best->part))
            best = e;
    }
    return best;
}

/* False: a required part is missed or lies behind, and so nothing is seen. */
static bool cut_required(struct sweep *w, uint32_t bits)
{
    for (; bits; bits &= bits - 1)
        if (cut(w, w->csg->boxes->part[__builtin_ctz(bits)]) == 0
            || !(w->s->key[w->s->n_event - 1].t > 0))
            return false;
    return true;
}

static void cut_others(struct sweep *w, uint32_t bits)
{
    const struct csg *c = w->csg;

    for (size_t i = 0; i < c->n_infinite; i++)
        cut(w, c->infinite[i]);
    if (!c->boxes)
        bvh_walk(&c->tree, w->ray, 0, w->far, visit_part, w, w->s->box_tests);
    for (; bits; bits &= bits - 1)
        cut(w, c->boxes->part[__builtin_ctz(bits)]);
}

/* False: nothing is seen. */
static bool gather(struct sweep *w)
{
    const struct csg *c = w->csg;
    struct csg_scratch *s = w->s;
    uint32_t near = 0;

    s->n_event = 0;
    if (c->boxes) {
        near = boxes_met(c->boxes, w->ray, w->far);
        *s->box_tests += c->boxes->n * WIDE;
        if (c->required & ~near)
            return false;
    }
    memcpy(s->count, c->at_rest, c->n_node * sizeof *s->count);
    for (size_t i = 0; i < c->n_asked; i++)
        s->asked_inside[c->asked[i]] = false;
    if (!cut_required(w, c->required))
        return false;
    cut_others(w, near & ~c->required);
    memcpy(s->before, s->count, c->n_node * sizeof *s->count);
    sort_keys(s->key, s->n_event);
    return true;
}

bool csg_sweep(const struct csg *c, struct csg_scratch *s, struct ray ray, double far,
               bool (*visit)(void *arg, const struct csg_event *e), void *arg)
{
    double length = vec_largest(ray.dir);
    struct sweep w = { c, s, ray, vec_largest(ray.origin) / length, far, NULL, ray };

    if (!gather(&w))
        return false;
    for (size_t first = 0, end; first < s->n_event; first = end) {
        double t = s->key[first].t;
        if (t >= far)
            return false;
        end = group_end(&w, first);
        if (c->n_asked && t > 0)
            ask(&w, ray_at(ray, t));
        pass(&w, first, end);
        /* A ray begins beyond the surface that it leaves, and so beyond
         * all that coincides with that. */
        const struct csg_event *e = t > 0 ? winner(&w, first, end) : NULL;
        if (e && e->hit.t < far && visit(arg, e))
            return true;
        settle(&w, first, end);
    }
    return false;
}

bool csg_inside(const struct csg *c, struct csg_scratch *s, vec3 p)
{
    memcpy(s->count, c->at_rest, c->n_node * sizeof *s->count);
    for (size_t i = 0; i < c->n_part; i++) {
        const struct csg_part *part = &c->part[i];
        const struct leaf *l = &c->leaf[part->leaf];
        bool counted = part->alternates && !part->is_infinite && l->inverse;
        int by = leaf_inside(l, p) - counted;
        if (by)
            csg_count(c->node, s->count, part->parent, by);
    }
    return holds(&c->node[0], s->count[0]);
}
