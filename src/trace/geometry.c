/* geometry.c: rays against everything. */
#include "trace/geometry.h"

#include <stdlib.h>
#include <string.h>

#include "trace/beam.h"
#include "trace/convex.h"
#include "trace/many.h"
#include "trace/stream.h"
#include "trace/world.h"

enum { MOST_CROSSINGS = SHAPE_MOST_HITS };   /* kept at a time; more are found by looking again */

/* What stood in a light's way last time, to be asked first. */
struct blocker {
    uint32_t item, instance;
    bool is_known;
};

/* What rays that lie together may meet: all of a small scene, or what a beam
 * found.  Bits of few: may block light, may filter it. */
struct choice { const struct few *few; uint64_t opaque, clear, list; };

/* How many rays make a beam, and how many go by themselves first because
 * beams did not pay. */
struct pace { int size, rest, wait; };

enum { MOST_LISTS = 16 };

/* Crossings of light that were found ahead: those of each ray in order. */
enum { MOST_KEPT = 512, KEPT_END, KEPT_TOO_MANY };
struct kept { struct meeting m; uint32_t next; };

/* A barrier that is a list of them: its first's number below. */
#define BARRIER_KEPT ((uint64_t)1 << 61)

/* A packet of rays on its way through the choice. */
struct volley {
    struct packet rays;
    struct inverses inverse;            /* once something asks */
    bool has_inverse;
    struct found found;
    struct leaf_view view;
    double far[PACKET];
    uint32_t on_the_way;                /* of the choice */
};

struct scratch {
    const struct plan *plan;
    struct csg_scratch csg;
    struct convex_work *convex;
    struct geometry_counts counts;
    struct blocker *blocker;            /* a light */
    size_t n_blocker;
    struct pace nearest, *blocked;      /* blocked: a light */
    struct few beam;                    /* the last beam's */
    struct stream *stream;
    uint32_t list[MOST_LISTS][FEW];     /* what beams of shadow rays found, for their crossings */
    int n_list;
    struct kept kept[MOST_KEPT];
    uint32_t n_kept;
    struct volley volley;
    struct meeting crossing[MOST_CROSSINGS];
};

struct scratch *scratch_new(const struct plan *p, struct arena *mem)
{
    struct scratch *s = arena_alloc_aligned(mem, sizeof *s, _Alignof(struct scratch));

    s->plan = p;
    csg_scratch_init(&s->csg, p->geometry->csg, p->geometry->n_csg, mem);
    s->convex = arena_alloc_aligned(mem, p->geometry->n_csg ? sizeof *s->convex : 1, 64);
    s->csg.box_tests = &s->counts.box_tests;
    s->n_blocker = p->n_light;
    s->blocker = arena_array(mem, p->n_light + 1, sizeof *s->blocker);
    s->blocked = arena_array(mem, p->n_light + 1, sizeof *s->blocked);
    s->stream = arena_alloc(mem, sizeof *s->stream);
    return s;
}

struct geometry_counts scratch_counts(const struct scratch *s) { return s->counts; }

/* --- leaves ---------------------------------------------------------------- */

vec3 leaf_normal(const struct leaf *l, struct ray ray, const struct hit *h)
{
    vec3 n = l->ops ? l->ops->normal(l->shape, ray_at(ray, h->t), h) : mesh_normal(l->mesh, h);

    if (l->placement)
        n = mat_normal(&l->placement->place.from, n);
    return l->inverse ? vec_neg(n) : n;
}

/* A patch without an inside has none when inverted, either. */
bool leaf_inside(const struct leaf *l, vec3 p)
{
    if (l->placement)
        p = mat_point(&l->placement->place.from, p);
    if (l->ops)
        return l->ops->inside && l->ops->inside(l->shape, p) != l->inverse;
    return mesh_has_inside(l->mesh) && mesh_inside(l->mesh, p) != l->inverse;
}

struct bounds leaf_bounds(const struct leaf *l)
{
    struct bounds b = l->ops ? l->ops->bounds(l->shape) : l->mesh->bounds;

    if (!l->placement)
        return b;
    b = bounds_move(&b, &l->placement->place);
    double pad = l->placement->fuzz * fmax(vec_largest(b.low), vec_largest(b.high));
    vec3 by = vec(pad, pad, pad);
    return (struct bounds) { vec_sub(b.low, by), vec_add(b.high, by) };
}

static bool nearest_by_hits(const struct leaf *l, struct ray ray, double near, double far,
                            struct hit *out)
{
    struct hit hit[SHAPE_MOST_HITS];
    int n = l->ops->hits(l->shape, ray, hit);

    for (int i = 0; i < n; i++)
        if (hit[i].t > near && hit[i].t < far) {
            *out = hit[i];
            return true;
        }
    return false;
}

/* Rays go by address: copying a struct that was just written stalls. */
INLINE bool shape_nearest(const struct leaf *l, struct scratch *s, const struct ray *ray,
                          double near, double far, struct hit *out)
{
    if (LIKELY(l->ops != NULL && l->ops->nearest != NULL))
        return l->ops->nearest(l->shape, ray, near, far, out);
    if (!l->ops)
        return mesh_nearest(l->mesh, *ray, near, far, out, &s->counts.box_tests);
    return nearest_by_hits(l, *ray, near, far, out);
}

INLINE bool leaf_nearest(const struct leaf *l, struct scratch *s, const struct ray *ray,
                         double near, double far, struct hit *out)
{
    s->counts.leaf_tests++;
    if (!l->placement)
        return shape_nearest(l, s, ray, near, far, out);
    struct ray inner = placed_ray(&l->placement->place, *ray);
    return shape_nearest(l, s, &inner, near, far, out);
}

/* --- one search through a space and the instances in it -------------------- */

struct search {
    const struct plan *plan;
    struct scratch *s;
    struct ray ray;                     /* in the space */
    uint32_t instance;
    uint8_t mask;
    double far;                         /* all of it: t < far */
    struct meeting *best;               /* its t is the far that is left */
    /* for crossings only */
    bool asks_opaque;                   /* what is opaque ends the search */
    unsigned *tally;                    /* where crossings are counted, not kept; or NULL */
    double after_t;
    int64_t after;                      /* rank of the last one that was visited */
    size_t n_crossing;
    bool is_full;
};

static uint32_t surface_of_leaf(const struct search *s, const struct leaf *l)
{
    return l->surface != NO_LEAF ? l->surface : s->plan->instance[s->instance].surface;
}

static bool is_opaque(const struct search *s, const struct leaf *l)
{
    return s->plan->surface[surface_of_leaf(s, l)].is_opaque;
}


/* The items of a space: those of the tree on the way, and the unbounded. */
typedef bool visit_items(void *arg, const uint32_t item[], uint32_t bits, double *far);

INLINE bool search_space(struct search *s, const struct space *space, visit_items *visit)
{
    double far = s->far;

    if (space->few) {
        s->s->counts.box_tests += (unsigned)space->few->n;
        return visit(s, space->few->item, few_aim(space->few, &s->ray, far), &far);
    }
    for (size_t i = 0; i < space->n_unbounded; i++)
        if (visit(s, space->unbounded + i, 1, &far))
            return true;
    return bvh_walk(&space->tree, s->ray, 0, far, visit, s, &s->s->counts.box_tests);
}

static struct search search_instance(const struct search *s, uint32_t number)
{
    const struct instance *i = &s->plan->instance[number];
    struct search in = *s;

    in.ray = placed_ray(&i->place, s->ray);
    in.instance = number;
    return in;
}

static const struct space *instance_space(const struct search *s, uint32_t number)
{
    return &s->plan->geometry->space[s->plan->instance[number].root];
}

/* --- nearest --------------------------------------------------------------- */

/* Of equal t the first listed wins, whatever the order of the visits; so a
 * search goes just beyond the best t. */
static bool is_better(const struct search *s, double t, uint32_t leaf)
{
    const struct meeting *b = s->best;

    if (b->leaf == NO_LEAF || t != b->t)
        return t < b->t;
    return rank_of(s->instance, leaf) < rank_of(b->instance, b->leaf);
}

static double beyond(double t) { return t * (1 + 0x1p-52); }

static void take(struct search *s, const struct hit *h, uint32_t leaf, bool flipped)
{
    struct meeting *b = s->best;        /* member by member: wide copies of narrow stores stall */

    b->t = b->hit.t = h->t;
    b->hit.slack = h->slack;
    b->hit.u = h->u;
    b->hit.v = h->v;
    b->hit.part = h->part;
    b->leaf = leaf;
    b->instance = s->instance;
    b->flipped = flipped;
    s->far = beyond(h->t);
}

INLINE void meet_leaf(struct search *s, uint32_t number)
{
    const struct leaf *l = &s->plan->leaf[number];
    struct hit h;

    if ((l->mask & s->mask) && leaf_nearest(l, s->s, &s->ray, 0, s->far, &h)
        && is_better(s, h.t, number))
        take(s, &h, number, l->inverse);
}

struct csg_search { struct search *search; const struct csg *csg; };

static bool take_event(void *arg, const struct csg_event *e)
{
    struct csg_search *c = arg;
    uint32_t leaf = c->csg->part[e->part].leaf;

    if (is_better(c->search, e->hit.t, leaf))
        take(c->search, &e->hit, leaf, c->search->plan->leaf[leaf].inverse);
    return true;
}

static void meet_csg(struct search *s, uint32_t number)
{
    const struct csg *c = &s->plan->geometry->csg[number];

    s->s->counts.csg_tests++;
    if (c->mask & s->mask)
        csg_sweep(c, &s->s->csg, s->ray, s->far, take_event, &(struct csg_search) { s, c });
}

static void meet_instance(struct search *s, uint32_t number);

INLINE bool visit_nearest(void *arg, const uint32_t item[], uint32_t bits, double *far)
{
    struct search *s = arg;

    for (; bits; bits &= bits - 1) {
        uint32_t one = item[__builtin_ctz(bits)], number = item_number(one);
        switch (item_kind(one)) {
        case ITEM_LEAF:     meet_leaf(s, number); break;
        case ITEM_CSG:      meet_csg(s, number); break;
        case ITEM_INSTANCE: meet_instance(s, number); break;
        }
    }
    *far = s->far;
    return false;
}

static __attribute__((noinline)) void meet_instance(struct search *s, uint32_t number)
{
    if (!(s->plan->instance[number].mask & s->mask))
        return;
    struct search in = search_instance(s, number);
    search_space(&in, instance_space(s, number), visit_nearest);
    s->far = in.far;
}

bool geometry_nearest(const struct plan *p, struct scratch *s, struct ray ray, double far,
                      uint8_t mask, struct meeting *out)
{
    struct search search = { .plan = p, .s = s, .ray = ray, .instance = NO_INSTANCE, .mask = mask,
                             .far = far, .best = out };

    s->counts.rays++;
    *out = (struct meeting) { .t = far, .leaf = NO_LEAF, .instance = NO_INSTANCE };
    search_space(&search, &p->geometry->space[0], visit_nearest);
    return out->leaf != NO_LEAF;
}

/* --- blocked --------------------------------------------------------------- */

static bool blocks_event(void *arg, const struct csg_event *e)
{
    struct csg_search *c = arg;
    return is_opaque(c->search, &c->search->plan->leaf[c->csg->part[e->part].leaf]);
}

static bool blocks_csg(struct search *s, uint32_t number)
{
    const struct csg *c = &s->plan->geometry->csg[number];

    s->s->counts.csg_tests++;
    return (c->mask & RAY_SHADOW)
           && csg_sweep(c, &s->s->csg, s->ray, s->far, blocks_event,
                        &(struct csg_search) { s, c });
}

INLINE bool blocks_leaf(struct search *s, uint32_t number)
{
    const struct leaf *l = &s->plan->leaf[number];
    struct hit h;

    return (l->mask & RAY_SHADOW) && is_opaque(s, l)
           && leaf_nearest(l, s->s, &s->ray, 0, s->far, &h);
}

static bool blocks_instance(struct search *s, uint32_t number);

INLINE bool blocks(struct search *s, uint32_t item)
{
    switch (item_kind(item)) {
    case ITEM_LEAF: return blocks_leaf(s, item_number(item));
    case ITEM_CSG:  return blocks_csg(s, item_number(item));
    default:        return blocks_instance(s, item_number(item));
    }
}

/* best->leaf takes the item, for the cache. */
INLINE bool visit_blocked(void *arg, const uint32_t item[], uint32_t bits, double *far)
{
    struct search *s = arg;

    (void)far;
    for (; bits; bits &= bits - 1) {
        uint32_t one = item[__builtin_ctz(bits)];
        if (!blocks(s, one))
            continue;
        s->best->leaf = one;
        if (item_kind(one) != ITEM_INSTANCE)
            s->best->instance = s->instance;
        return true;
    }
    return false;
}

static __attribute__((noinline)) bool blocks_instance(struct search *s, uint32_t number)
{
    if (!(s->plan->instance[number].mask & RAY_SHADOW))
        return false;
    struct search in = search_instance(s, number);
    return search_space(&in, instance_space(s, number), visit_blocked);
}

static bool still_blocks(struct search *s, const struct blocker *b)
{
    if (!b->is_known)
        return false;
    if (b->instance == NO_INSTANCE)
        return blocks(s, b->item);
    struct search in = search_instance(s, b->instance);
    return blocks(&in, b->item);
}

bool geometry_blocked(const struct plan *p, struct scratch *s, struct ray ray, double far,
                      uint32_t light)
{
    struct blocker none = { .is_known = false };
    struct blocker *last = light < s->n_blocker ? &s->blocker[light] : &none;
    struct meeting by;
    struct search search = { .plan = p, .s = s, .ray = ray, .instance = NO_INSTANCE,
                             .mask = RAY_SHADOW, .far = far, .best = &by };

    s->counts.shadow_rays++;
    if (still_blocks(&search, last))
        return true;
    if (!search_space(&search, &p->geometry->space[0], visit_blocked))
        return false;
    *last = (struct blocker) { by.leaf, by.instance, true };
    return true;
}

/* --- arrays of rays -------------------------------------------------------- */

/* In small scenes all boxes are tried.  In others, rays that lie together go
 * down the tree as a beam, and what it finds is tried so: one thing after the
 * other, against all of the rays. */

static struct rays rays_from(const struct rays *r, int at, int most)
{
    int n = r->n - at < most ? r->n - at : most;

    return (struct rays) { n, r->x + at, r->y + at, r->z + at,
                           r->dx + at, r->dy + at, r->dz + at };
}

/* What may be met, in c; false: too much.  n: how much it is. */
static bool beam(const struct space *space, struct scratch *s, const struct rays *r,
                 const double *far, struct choice *c)
{
    uint32_t place[FEW];
    const struct bounds everywhere = BOUNDS_ALL;
    int n = space->n_unbounded > FEW ? BEAM_TOO_MUCH
            : beam_walk(&space->tree, r, far, place, FEW - (int)space->n_unbounded,
                        &s->counts.box_tests);

    if (n < 0)
        return false;
    s->beam.n = 0;
    *c = (struct choice) { .few = &s->beam };
    for (int i = 0; i < n; i++) {
        const struct candidate *one = &space->candidate[place[i]];
        c->opaque |= (uint64_t)one->is_opaque << i;
        c->clear |= (uint64_t)one->is_clear << i;
        few_add(&s->beam, space->tree.item[place[i]], &one->bounds);
    }
    for (size_t i = 0; i < space->n_unbounded; i++) {
        c->opaque |= (uint64_t)1 << s->beam.n;
        c->clear |= (uint64_t)1 << s->beam.n;
        few_add(&s->beam, space->unbounded[i], &everywhere);
    }
    return true;
}

/* Rays of the next group, which is a beam or not. */
static int next_group(struct pace *p, int left, bool *is_beam)
{
    enum { FIRST = 64 };
    int most = p->size ? p->size : FIRST;

    if (p->rest > 0 || left < BEAM_LEAST) {
        int n = p->rest > 0 && p->rest < left ? p->rest : left;
        p->rest -= n < p->rest ? n : p->rest;
        *is_beam = false;
        return n;
    }
    *is_beam = true;
    return left < most + BEAM_LEAST && left <= PACKET ? left : most;
}

/* After a beam of n rays: larger or smaller ones, or none for a while. */
static void beam_went_well(struct pace *p, int n, int found)
{
    enum { ROOM_FOR_MORE = 10 };
    int more = 2 * n < PACKET ? 2 * n : PACKET;

    p->wait = 0;
    p->size = found <= ROOM_FOR_MORE ? more : n < BEAM_LEAST ? BEAM_LEAST : n;
}

static void beam_went_badly(struct pace *p, int n)
{
    enum { SMALLEST = 16, FIRST_WAIT = 128, LONGEST_WAIT = 8192 };

    p->size = n / 2;
    if (p->size >= SMALLEST)
        return;
    p->size = SMALLEST;
    p->wait = p->wait == 0 ? FIRST_WAIT : p->wait < LONGEST_WAIT ? 2 * p->wait : p->wait;
    p->rest = p->wait;
}

/* NULL: not that kind of CSG, or not CSG at all. */
static const struct csg *convex_of(const struct plan *p, uint32_t item)
{
    const struct csg *c = &p->geometry->csg[item_number(item)];

    return item_kind(item) == ITEM_CSG && c->convex ? c : NULL;
}

/* The crossing at t, which is known to be there. */
static struct hit leaf_hit_at(const struct leaf *l, struct ray ray, double t)
{
    struct hit hit[SHAPE_MOST_HITS];
    int i = 0;

    l->ops->hits(l->shape, leaf_ray(l, ray), hit);
    while (hit[i].t != t)
        i++;
    return hit[i];
}

/* What search knows of ray i; its hits go to out[i]. */
static void search_for(struct search *s, const struct rays *r, int i, const uint8_t *mask,
                       struct meeting *out)
{
    s->ray = rays_at(r, i);
    s->mask = mask[i];
    s->best = &out[i];
    s->far = out[i].leaf == NO_LEAF ? INFINITY : beyond(out[i].t);
}

static void take_convex(struct search *s, const struct csg *c, uint32_t part, double t)
{
    uint32_t number = c->part[part].leaf;
    const struct leaf *l = &s->plan->leaf[number];

    if (!(c->mask & s->mask) || !is_better(s, t, number))
        return;
    struct hit h = leaf_hit_at(l, s->ray, t);
    take(s, &h, number, l->inverse);
}

/* CSG of convex solids goes first, many rays at once; where that does not
 * know, the bit of may stays. */
static void nearest_of_convex(struct search *s, const struct few *few, uint32_t k,
                              const struct rays *r, const uint8_t *mask, uint64_t *may,
                              struct meeting *out)
{
    const struct csg *csg = convex_of(s->plan, few->item[k]);
    struct convex_work *w = s->s->convex;

    for (int at = 0; csg && convex_gather(w, r, may, k, &at);) {
        for (int j = 0; j < w->n; j++) {
            search_for(s, r, w->number[j], mask, out);
            w->far[j] = s->far;
        }
        convex_cast(csg, w);
        s->s->counts.csg_tests += (unsigned)w->n;
        for (int j = 0; j < w->n; j++) {
            int i = w->number[j];
            if (w->part[j] == CONVEX_UNKNOWN)
                continue;
            may[i] &= ~((uint64_t)1 << k);
            if (w->part[j] == CONVEX_NOTHING)
                continue;
            search_for(s, r, i, mask, out);
            take_convex(s, csg, w->part[j], w->t[j]);
        }
    }
}

static void volley_start(struct scratch *s, const struct choice *c, const struct rays *r,
                         const double *far)
{
    struct volley *v = &s->volley;

    packet_fill(&v->rays, r);
    v->has_inverse = false;
    v->on_the_way = few_on_the_way(c->few, &v->rays, far);
    s->counts.box_tests += (unsigned long long)r->n * (unsigned)c->few->n;
}

/* Leaves in asked the rays that may meet the box of item k. */
static bool volley_meets(struct volley *v, const struct few *few, int k, const double *far,
                         struct lanes_asked *asked)
{
    if (!v->has_inverse)
        few_prepare(&v->rays, &v->inverse);
    v->has_inverse = true;
    return few_meet(few, k, &v->rays, &v->inverse, far, asked->bits);
}

/* Asks a leaf about those of the asked rays that meet its box.  False: none. */
static bool volley_leaf(struct scratch *s, const struct leaf *l, const struct few *few, int k,
                        const double *far, struct lanes_asked *asked)
{
    struct volley *v = &s->volley;

    if (leaf_is_quick(l) ? !lanes_any(asked, &v->rays)
                         : !volley_meets(v, few, k, far, asked))
        return false;
    s->counts.leaf_tests += (unsigned)v->rays.n;
    leaf_hits_many(l, &v->rays, asked, &v->view);
    return true;
}

/* The same for a mesh with a tree of its own.  is_any: no matter which of the
 * crossings before far. */
static bool volley_mesh(struct scratch *s, const struct leaf *l, const struct few *few, int k,
                        const double *far, bool is_any, struct lanes_asked *asked)
{
    struct volley *v = &s->volley;
    struct lanes_asked all = packet_all(&v->rays);
    double until[PACKET];

    if (!volley_meets(v, few, k, far, asked))
        return false;
    for (int i = 0; i < v->rays.n; i++) {
        bool is_asked = asked->bits[i / WIDE] >> i % WIDE & 1;
        until[i] = !is_asked ? -1 : is_any ? far[i] : beyond(far[i]);
        s->counts.leaf_tests += is_asked;
    }
    mesh_nearest_stream(l->mesh, s->stream, leaf_packet(l, &v->rays, &all, &v->view), until, is_any,
                        &v->view.crossings, &s->counts.box_tests);
    return true;
}

/* The mesh that an item is; NULL: it is none, or a tiny one. */
static const struct leaf *mesh_leaf(const struct plan *p, uint32_t item)
{
    const struct leaf *l = &p->leaf[item_number(item)];

    return item_kind(item) == ITEM_LEAF && !l->ops && !mesh_is_tiny(l->mesh) ? l : NULL;
}

/* The leaf that an item is, if it can be asked about many rays; else NULL. */
static const struct leaf *hot_leaf(const struct plan *p, uint32_t item)
{
    const struct leaf *l = &p->leaf[item_number(item)];

    return item_kind(item) == ITEM_LEAF && leaf_takes_many(l) ? l : NULL;
}

/* The rays that may see a leaf: seldom not all. */
static struct lanes_asked lanes_that_see(const struct packet *p, const uint8_t *mask, uint8_t by)
{
    struct lanes_asked a = packet_all(p);

    if ((by & RAY_PRIMARY) && (by & RAY_REFLECTED))
        return a;
    for (int i = 0; i < p->n; i++)
        if (!(mask[i] & by))
            a.bits[i / WIDE] &= (uint8_t)~(1 << i % WIDE);
    return a;
}

static void found_get(const struct found *f, int i, struct meeting *out)
{
    out->t = out->hit.t = f->t[i];
    out->hit.slack = f->slack[i];
    out->hit.u = (float)f->u[i];
    out->hit.v = (float)f->v[i];
    out->hit.part = (uint32_t)f->part[i];
    out->leaf = f->rank[i] == NO_RANK ? NO_LEAF : rank_leaf(f->rank[i]);
    out->instance = rank_instance(f->rank[i]);
}

static void found_put(struct found *f, int i, const struct meeting *m)
{
    f->t[i] = m->t;
    f->slack[i] = m->hit.slack;
    f->u[i] = (double)m->hit.u;
    f->v[i] = (double)m->hit.v;
    f->part[i] = m->hit.part;
    f->rank[i] = rank_of(m->instance, m->leaf);
}

/* Which of some of the choice's things each of the asked rays may meet. */
static void volley_aim(struct scratch *s, const struct few *few, uint32_t things,
                       const double *far, const struct lanes_asked *asked, uint64_t may[])
{
    struct volley *v = &s->volley;

    memset(may, 0, (size_t)v->rays.n * sizeof *may);
    for (; things; things &= things - 1) {
        int k = __builtin_ctz(things);
        struct lanes_asked meets = *asked;
        if (!volley_meets(v, few, k, far, &meets))
            continue;
        for (int i = 0; i < v->rays.n; i++)
            may[i] |= (uint64_t)(meets.bits[i / WIDE] >> i % WIDE & 1) << k;
    }
}

/* What is no hot leaf: CSG of convex solids first, the rest ray by ray. */
static void nearest_of_rest(const struct plan *p, struct scratch *s, const struct few *few,
                            uint32_t things, const struct rays *r, const uint8_t *mask)
{
    struct volley *v = &s->volley;
    struct meeting best[PACKET];
    struct search search = { .plan = p, .s = s, .instance = NO_INSTANCE };
    struct lanes_asked all = packet_all(&v->rays);
    uint64_t may[PACKET];
    double far;

    volley_aim(s, few, things, v->found.t, &all, may);
    for (int i = 0; i < r->n; i++)
        found_get(&v->found, i, &best[i]);
    for (uint32_t k = 0; k < (uint32_t)few->n; k++)
        if (things >> k & 1)
            nearest_of_convex(&search, few, k, r, mask, may, best);
    for (int i = 0; i < r->n; i++) {
        if (may[i]) {
            search_for(&search, r, i, mask, best);
            visit_nearest(&search, few->item, (uint32_t)may[i], &far);
        }
        if (best[i].leaf != NO_LEAF)
            found_put(&v->found, i, &best[i]);
    }
}

/* Returns those of the things that are no meshes. */
static uint32_t nearest_of_meshes(const struct plan *p, struct scratch *s, const struct few *few,
                                  uint32_t things, const uint8_t *mask)
{
    struct volley *v = &s->volley;
    uint32_t rest = 0;

    for (; things; things &= things - 1) {
        int k = __builtin_ctz(things);
        const struct leaf *l = mesh_leaf(p, few->item[k]);
        if (!l) {
            rest |= 1u << k;
            continue;
        }
        struct lanes_asked asked = lanes_that_see(&v->rays, mask, l->mask);
        if (volley_mesh(s, l, few, k, v->found.t, false, &asked))
            found_take(&v->found, &v->rays, &v->view.crossings,
                       rank_of(NO_INSTANCE, item_number(few->item[k])));
    }
    return rest;
}

static void found_meetings(const struct plan *p, const struct found *f, int n,
                           struct meeting *out)
{
    for (int i = 0; i < n; i++) {
        out[i].leaf = NO_LEAF;
        if (f->rank[i] == NO_RANK)
            continue;
        found_get(f, i, &out[i]);
        out[i].flipped = p->leaf[out[i].leaf].inverse;
    }
}

/* The rest last: by then it need not be looked for far away. */
static void nearest_of_choice(const struct plan *p, struct scratch *s, const struct choice *c,
                              const struct rays *r, const uint8_t *mask, struct meeting *out)
{
    struct volley *v = &s->volley;
    uint32_t rest = 0;

    volley_start(s, c, r, NULL);
    found_start(&v->found, &v->rays, NULL);
    for (uint32_t todo = v->on_the_way; todo; todo &= todo - 1) {
        int k = __builtin_ctz(todo);
        const struct leaf *l = hot_leaf(p, c->few->item[k]);
        if (!l) {
            rest |= 1u << k;
            continue;
        }
        struct lanes_asked asked = lanes_that_see(&v->rays, mask, l->mask);
        if (volley_leaf(s, l, c->few, k, v->found.t, &asked))
            found_take(&v->found, &v->rays, &v->view.crossings,
                       rank_of(NO_INSTANCE, item_number(c->few->item[k])));
    }
    rest = nearest_of_meshes(p, s, c->few, rest, mask);
    if (rest)
        nearest_of_rest(p, s, c->few, rest, r, mask);
    found_meetings(p, &v->found, r->n, out);
    s->counts.rays += (unsigned)r->n;
}

/* Rays that go down the world's tree together. */
struct flock {
    struct search search;               /* of the ray whose turn it is */
    const struct rays *rays;
    const uint8_t *mask;
    struct meeting *out;
    double far[STREAM];
    uint64_t *barrier;                  /* of shadow rays */
    struct blocker *last;
};

static struct search *turn(struct flock *f, int i)
{
    struct search *s = &f->search;

    s->ray = rays_at(f->rays, i);
    s->far = f->far[i];
    return s;
}

static void flock_nearest(void *arg, uint32_t first, const uint8_t ray[], const uint8_t bits[], int n)
{
    struct flock *f = arg;
    struct scratch *s = f->search.s;
    const uint32_t *item = s->plan->geometry->space[0].tree.item + first;

    for (int k = 0; k < n; k++) {
        int i = ray[k];
        double far;
        turn(f, i)->mask = f->mask[i];
        f->search.best = &f->out[i];
        visit_nearest(&f->search, item, bits[k], &far);
        if (far < f->far[i]) {
            f->far[i] = far;
            stream_set_far(s->stream, i, far);
        }
    }
}

/* The hot ones of the unbounded, all rays at once: a plane, most often. */
static void found_of_unbounded(const struct plan *p, struct scratch *s, const uint8_t *mask)
{
    const struct space *world = &p->geometry->space[0];
    struct volley *v = &s->volley;

    for (size_t k = 0; k < world->n_unbounded; k++) {
        const struct leaf *l = hot_leaf(p, world->unbounded[k]);
        if (!l)
            continue;
        struct lanes_asked asked = lanes_that_see(&v->rays, mask, l->mask);
        s->counts.leaf_tests += (unsigned)v->rays.n;
        leaf_hits_many(l, &v->rays, &asked, &v->view);
        found_take(&v->found, &v->rays, &v->view.crossings,
                   rank_of(NO_INSTANCE, item_number(world->unbounded[k])));
    }
}

static void nearest_of_cold(struct flock *f)
{
    const struct space *world = &f->search.plan->geometry->space[0];
    double far;

    for (size_t k = 0; k < world->n_unbounded; k++) {
        if (hot_leaf(f->search.plan, world->unbounded[k]))
            continue;
        for (int i = 0; i < f->rays->n; i++) {
            search_for(&f->search, f->rays, i, f->mask, f->out);
            visit_nearest(&f->search, world->unbounded + k, 1, &far);
        }
    }
}

static void nearest_of_unbounded(struct flock *f)
{
    struct volley *v = &f->search.s->volley;
    const int n = f->rays->n;

    for (int i = 0; i < n; i++)
        f->out[i] = (struct meeting) { .t = INFINITY, .leaf = NO_LEAF, .instance = NO_INSTANCE };
    if (f->search.plan->geometry->space[0].n_unbounded) {
        packet_fill(&v->rays, f->rays);
        found_start(&v->found, &v->rays, NULL);
        found_of_unbounded(f->search.plan, f->search.s, f->mask);
        found_meetings(f->search.plan, &v->found, n, f->out);
        nearest_of_cold(f);
    }
    for (int i = 0; i < n; i++)
        f->far[i] = beyond(f->out[i].t);
}

static void nearest_of_stream(const struct plan *p, struct scratch *s, const struct rays *r,
                              const uint8_t *mask, struct meeting *out)
{
    const struct bvh *tree = &p->geometry->space[0].tree;
    struct flock f = { .search = { .plan = p, .s = s, .instance = NO_INSTANCE }, .rays = r,
                       .mask = mask, .out = out };

    nearest_of_unbounded(&f);
    s->counts.rays += (unsigned)r->n;
    if (tree->n_node == 0)
        return;
    stream_aim(s->stream, tree, r, f.far);
    stream_walk(s->stream, tree, true, flock_nearest, &f, &s->counts.box_tests);
}

static void nearest_of_streams(const struct plan *p, struct scratch *s, const struct rays *rays,
                               const uint8_t *mask, struct meeting *out)
{
    for (int at = 0; at < rays->n; at += STREAM) {
        struct rays some = rays_from(rays, at, STREAM);
        nearest_of_stream(p, s, &some, mask + at, out + at);
    }
}

static void nearest_of_few(const struct plan *p, struct scratch *s, const struct rays *rays,
                           const uint8_t *mask, struct meeting *out)
{
    const struct choice all = { .few = p->geometry->space[0].few };

    for (int at = 0; at < rays->n; at += PACKET) {
        struct rays some = rays_from(rays, at, PACKET);
        nearest_of_choice(p, s, &all, &some, mask + at, out + at);
    }
}

static void nearest_of_beams(const struct plan *p, struct scratch *s, const struct rays *rays,
                             const uint8_t *mask, struct meeting *out)
{
    struct choice c;
    bool is_beam;

    for (int at = 0, n; at < rays->n; at += n) {
        struct rays some = rays_from(rays, at, next_group(&s->nearest, rays->n - at, &is_beam));
        n = some.n;
        if (!is_beam) {
            nearest_of_streams(p, s, &some, mask + at, out + at);
        } else if (beam(&p->geometry->space[0], s, &some, NULL, &c)) {
            beam_went_well(&s->nearest, n, c.few->n);
            nearest_of_choice(p, s, &c, &some, mask + at, out + at);
        } else {
            beam_went_badly(&s->nearest, n);
            n = 0;
        }
    }
}

void geometry_nearest_many(const struct plan *p, struct scratch *s, const struct rays *rays,
                           const uint8_t *mask, struct meeting *out)
{
    const struct space *world = &p->geometry->space[0];

    (world->few ? nearest_of_few : world->candidate ? nearest_of_beams : nearest_of_streams)
        (p, s, rays, mask, out);
}

/* ---- what stands between ---- */

static bool is_blocker(const struct plan *p, const struct leaf *l)
{
    return (l->mask & RAY_SHADOW) && p->surface[l->surface].is_opaque;
}

/* Takes the rays out of open that item k blocks; true: all are. */
static bool close_many(const struct plan *p, struct scratch *s, const struct few *few, int k,
                       const double *far, struct lanes_asked *open)
{
    struct volley *v = &s->volley;
    const struct leaf *l = hot_leaf(p, few->item[k]);
    struct lanes_asked asked = *open;

    if (is_blocker(p, l) && volley_leaf(s, l, few, k, far, &asked))
        crossings_close(&v->view.crossings, &v->rays, far, open);
    return !lanes_any(open, &v->rays);
}

/* The same for meshes with trees; returns those of the things that are none. */
static uint32_t close_by_meshes(const struct plan *p, struct scratch *s, const struct few *few,
                                uint32_t things, const double *far, struct lanes_asked *open)
{
    struct volley *v = &s->volley;
    uint32_t rest = 0;

    for (; things; things &= things - 1) {
        int k = __builtin_ctz(things);
        const struct leaf *l = mesh_leaf(p, few->item[k]);
        struct lanes_asked asked = *open;
        if (!l)
            rest |= 1u << k;
        else if (is_blocker(p, l) && volley_mesh(s, l, few, k, far, true, &asked))
            crossings_close(&v->view.crossings, &v->rays, far, open);
    }
    return rest;
}

/* What stood in the way of the ray before (a bit) is tried first. */
static bool one_is_blocked(struct search *s, const struct few *few, uint32_t may, uint32_t *last)
{
    double unused;

    if (may & *last && visit_blocked(s, few->item, may & *last, &unused))
        return true;
    for (may &= ~*last; may; may &= may - 1)
        if (visit_blocked(s, few->item, may & -may, &unused)) {
            *last = may & -may;
            return true;
        }
    return false;
}

static void close_lane(struct lanes_asked *open, int i)
{
    open->bits[i / WIDE] &= (uint8_t)~(1 << i % WIDE);
}

/* The same for shadow rays, whose bits go where the way is free. */
static void blocked_by_convex(struct search *s, const struct few *few, uint32_t k,
                              const struct rays *r, const double *far, uint64_t *may,
                              struct lanes_asked *open)
{
    const struct csg *csg = convex_of(s->plan, few->item[k]);
    struct convex_work *w = s->s->convex;

    for (int at = 0; csg && (csg->mask & RAY_SHADOW) && convex_gather(w, r, may, k, &at);) {
        for (int j = 0; j < w->n; j++)
            w->far[j] = far[w->number[j]];
        convex_cast(csg, w);
        s->s->counts.csg_tests += (unsigned)w->n;
        for (int j = 0; j < w->n; j++) {
            int i = w->number[j];
            if (w->part[j] == CONVEX_UNKNOWN)
                continue;
            if (w->part[j] == CONVEX_NOTHING) {
                may[i] &= ~((uint64_t)1 << k);
            } else if (is_opaque(s, &s->plan->leaf[csg->part[w->part[j]].leaf])) {
                may[i] = 0;
                close_lane(open, i);
            }
        }
    }
}

static void close_by_rest(const struct plan *p, struct scratch *s, const struct few *few,
                          uint32_t things, const struct rays *r, const double *far,
                          struct lanes_asked *open)
{
    struct volley *v = &s->volley;
    struct meeting by;
    struct search search = { .plan = p, .s = s, .instance = NO_INSTANCE, .mask = RAY_SHADOW,
                             .best = &by };
    uint64_t may[PACKET];
    uint32_t last = 0;

    volley_aim(s, few, things, far, open, may);
    for (uint32_t k = 0; k < (uint32_t)few->n; k++)
        if (things >> k & 1)
            blocked_by_convex(&search, few, k, r, far, may, open);
    for (int i = 0; i < v->rays.n; i++) {
        if (!may[i])
            continue;
        search.ray = packet_ray(&v->rays, i);
        search.far = far[i];
        if (one_is_blocked(&search, few, (uint32_t)may[i], &last))
            close_lane(open, i);
    }
}

/* Leaves in open the rays that nothing opaque blocks. */
static void close_blocked(const struct plan *p, struct scratch *s, const struct choice *c,
                          const struct rays *r, const double *far, struct lanes_asked *open)
{
    uint32_t todo = (uint32_t)c->opaque & s->volley.on_the_way, rest = 0;

    for (; todo; todo &= todo - 1) {
        int k = __builtin_ctz(todo);
        if (!hot_leaf(p, c->few->item[k]))
            rest |= 1u << k;
        else if (close_many(p, s, c->few, k, far, open))
            return;
    }
    rest = close_by_meshes(p, s, c->few, rest, far, open);
    if (rest)
        close_by_rest(p, s, c->few, rest, r, far, open);
}

/* ---- what light passes through, found ahead ---- */

static bool is_filter(const struct plan *p, const struct leaf *l)
{
    return (l->mask & RAY_SHADOW) && !p->surface[l->surface].is_opaque;
}

static bool comes_after(const struct meeting *m, const struct hit *h, int64_t rank)
{
    return m->t > h->t || (m->t == h->t && rank_of(m->instance, m->leaf) > rank);
}

/* Into the list that begins at first, in the order of geometry_crossings. */
static void keep_ahead(const struct plan *p, struct scratch *s, uint32_t *first,
                       const struct hit *h, uint32_t leaf)
{
    uint32_t *link = first;

    if (*first == KEPT_TOO_MANY)
        return;
    if (s->n_kept == MOST_KEPT) {
        *first = KEPT_TOO_MANY;
        return;
    }
    while (*link != KEPT_END
           && !comes_after(&s->kept[*link].m, h, rank_of(NO_INSTANCE, leaf)))
        link = &s->kept[*link].next;
    s->kept[s->n_kept] = (struct kept) { { h->t, *h, leaf, NO_INSTANCE, p->leaf[leaf].inverse },
                                         *link };
    *link = s->n_kept++;
}

static void keep_crossings(const struct plan *p, struct scratch *s, uint32_t leaf,
                           const double *far, uint32_t first[])
{
    const struct crossings *c = &s->volley.view.crossings;
    struct hit hit[2];

    for (int k = 0; k * WIDE < s->volley.rays.n; k++)
        for (unsigned bits = c->met[k]; bits; bits &= bits - 1) {
            int i = k * WIDE + __builtin_ctz(bits), n = crossings_at(c, i, hit);
            for (int j = 0; j < n; j++)
                if (hit[j].t > 0 && hit[j].t < far[i])
                    keep_ahead(p, s, &first[i], &hit[j], leaf);
        }
}

/* All that the open rays cross of these hot leaves, a list a ray. */
static void look_ahead(const struct plan *p, struct scratch *s, const struct few *few,
                       uint32_t things, const double *far, const struct lanes_asked *open,
                       uint64_t *barrier)
{
    uint32_t first[PACKET];

    for (int i = 0; i < s->volley.rays.n; i++)
        first[i] = KEPT_END;
    for (; things; things &= things - 1) {
        int k = __builtin_ctz(things);
        const struct leaf *l = hot_leaf(p, few->item[k]);
        struct lanes_asked asked = *open;
        if (is_filter(p, l) && volley_leaf(s, l, few, k, far, &asked))
            keep_crossings(p, s, item_number(few->item[k]), far, first);
    }
    for (int i = 0; i < s->volley.rays.n; i++)
        if (first[i] != KEPT_END)
            barrier[i] = first[i] == KEPT_TOO_MANY ? BARRIER_CLEAR : BARRIER_KEPT | first[i];
}

/* Of a mesh hits_many tells the nearest crossing only. */
static uint32_t all_hot(const struct plan *p, const struct few *few, uint32_t things)
{
    uint32_t hot = 0;

    for (; things; things &= things - 1) {
        const struct leaf *l = hot_leaf(p, few->item[__builtin_ctz(things)]);
        hot |= l && l->ops ? things & -things : 0;
    }
    return hot;
}

/* The barriers of rays that nothing opaque blocks.  Those that may meet
 * something that is no hot leaf look at all of it later, ray by ray. */
static void look_at_clear(const struct plan *p, struct scratch *s, const struct choice *c,
                          const double *far, struct lanes_asked *open, uint64_t *barrier)
{
    uint32_t things = (uint32_t)c->clear & s->volley.on_the_way;
    uint32_t hot = all_hot(p, c->few, things);
    struct lanes_asked late = *open;
    uint64_t may[PACKET];

    if (things != hot) {
        volley_aim(s, c->few, things & ~hot, far, open, may);
        for (int i = 0; i < s->volley.rays.n; i++)
            close_lane(may[i] ? open : &late, i);
        volley_aim(s, c->few, things, far, &late, may);
        for (int i = 0; i < s->volley.rays.n; i++)
            if (may[i])
                barrier[i] = may[i] | c->list;
    }
    if (hot)
        look_ahead(p, s, c->few, hot, far, open, barrier);
}

static void blocked_by_choice(const struct plan *p, struct scratch *s, const struct choice *c,
                              const struct rays *r, const double *far, uint64_t *barrier)
{
    struct volley *v = &s->volley;

    volley_start(s, c, r, far);
    memcpy(v->far, far, (size_t)r->n * sizeof *far);
    struct lanes_asked open = packet_all(&v->rays);
    close_blocked(p, s, c, r, v->far, &open);
    for (int i = 0; i < r->n; i++)
        barrier[i] = open.bits[i / WIDE] >> i % WIDE & 1 ? 0 : BARRIER_OPAQUE;
    if (p->has_transparency)
        look_at_clear(p, s, c, v->far, &open, barrier);
    s->counts.shadow_rays += (unsigned)r->n;
}

static void block(struct flock *f, int i)
{
    f->barrier[i] = BARRIER_OPAQUE;
    stream_end(f->search.s->stream, i);
}

static void flock_blocked(void *arg, uint32_t first, const uint8_t ray[], const uint8_t bits[], int n)
{
    struct flock *f = arg;
    struct scratch *s = f->search.s;
    const uint32_t *item = s->plan->geometry->space[0].tree.item + first;

    for (int k = 0; k < n; k++) {
        int i = ray[k];
        double far;
        if (!visit_blocked(turn(f, i), item, bits[k], &far))
            continue;
        *f->last = (struct blocker) { f->search.best->leaf, f->search.best->instance, true };
        block(f, i);
    }
}

/* A leaf of the world whose shape can say at once where all rays meet it. */
static const struct leaf *spanned(const struct plan *p, uint32_t item)
{
    const struct leaf *l = &p->leaf[item_number(item)];
    bool is_plain = item_kind(item) == ITEM_LEAF && l->ops && l->ops->spans && !l->placement
                    && !(l->ops->is_leaky && l->ops->is_leaky(l->shape));

    return is_plain ? l : NULL;
}

/* All rays against one thing; those that are left to hits() ask it. */
static void blocked_by_span(struct flock *f, const struct leaf *l, uint32_t item)
{
    double near[STREAM], far[STREAM];

    if (!(l->mask & RAY_SHADOW) || !is_opaque(&f->search, l))
        return;
    l->ops->spans(l->shape, f->rays, near, far);
    f->search.s->counts.leaf_tests += (unsigned)f->rays->n;
    for (int i = 0; i < f->rays->n; i++) {
        double t = near[i] > 0 ? near[i] : far[i];
        if ((t > 0 && t < f->far[i]) || (isnan(t) && blocks(turn(f, i), item)))
            block(f, i);
    }
}

/* One thing, of the world or of an instance. */
static void blocked_by(struct flock *f, const struct blocker *b)
{
    const struct leaf *l = b->instance == NO_INSTANCE ? spanned(f->search.plan, b->item) : NULL;

    if (l)
        blocked_by_span(f, l, b->item);
    for (int i = 0; !l && i < f->rays->n; i++)
        if (f->barrier[i] != BARRIER_OPAQUE && still_blocks(turn(f, i), b))
            block(f, i);
}

/* What stood in the way last time is asked first. */
static void blocked_ahead(struct flock *f)
{
    const struct space *world = &f->search.plan->geometry->space[0];

    if (f->last->is_known)
        blocked_by(f, f->last);
    for (size_t k = 0; k < world->n_unbounded; k++)
        blocked_by(f, &(struct blocker) { world->unbounded[k], NO_INSTANCE, true });
}

static void blocked_by_stream(const struct plan *p, struct scratch *s, const struct rays *r,
                              const double *far, struct blocker *last, uint64_t *barrier)
{
    const struct bvh *tree = &p->geometry->space[0].tree;
    struct meeting by;
    struct flock f = { .search = { .plan = p, .s = s, .instance = NO_INSTANCE, .mask = RAY_SHADOW,
                                   .best = &by },
                       .rays = r, .barrier = barrier, .last = last };

    s->counts.shadow_rays += (unsigned)r->n;
    memcpy(f.far, far, (size_t)r->n * sizeof *far);
    memset(barrier, 0, (size_t)r->n * sizeof *barrier);
    stream_aim(s->stream, tree, r, far);
    blocked_ahead(&f);
    stream_walk(s->stream, tree, false, flock_blocked, &f, &s->counts.box_tests);
}

/* Where light may be filtered, all is asked at once, later. */
static void blocked_by_streams(const struct plan *p, struct scratch *s, const struct rays *rays,
                               const double *far, struct blocker *last, uint64_t *barrier)
{
    for (int i = 0; i < rays->n && p->has_transparency; i++)
        barrier[i] = BARRIER_ANY;
    if (p->has_transparency)
        return;
    for (int at = 0; at < rays->n; at += STREAM) {
        struct rays some = rays_from(rays, at, STREAM);
        blocked_by_stream(p, s, &some, far + at, last, barrier + at);
    }
}

static void blocked_by_few(const struct plan *p, struct scratch *s, const struct rays *rays,
                           const double *far, uint64_t *barrier)
{
    const struct space *world = &p->geometry->space[0];
    const struct choice all = { world->few, world->opaque, world->clear, 0 };

    for (int at = 0; at < rays->n; at += PACKET) {
        struct rays some = rays_from(rays, at, PACKET);
        blocked_by_choice(p, s, &all, &some, far + at, barrier + at);
    }
}

/* Keeps what the beam may cross, and says where in the upper half. */
static uint64_t keep_list(struct scratch *s, const struct few *few)
{
    if (s->n_list == MOST_LISTS)
        return BARRIER_CLEAR;
    memcpy(s->list[s->n_list], few->item, (size_t)few->n * sizeof few->item[0]);
    return (uint64_t)++s->n_list << FEW;
}

static void blocked_by_beams(const struct plan *p, struct scratch *s, const struct rays *rays,
                             const double *far, uint32_t light, struct blocker *last,
                             uint64_t *barrier)
{
    struct pace *pace = &s->blocked[light < s->n_blocker ? light : s->n_blocker];
    struct choice c;
    bool is_beam;

    s->n_list = 0;
    for (int at = 0, n; at < rays->n; at += n) {
        struct rays some = rays_from(rays, at, next_group(pace, rays->n - at, &is_beam));
        n = some.n;
        if (!is_beam) {
            blocked_by_streams(p, s, &some, far + at, last, barrier + at);
        } else if (beam(&p->geometry->space[0], s, &some, far + at, &c)) {
            beam_went_well(pace, n, c.few->n);
            c.list = p->has_transparency && c.clear ? keep_list(s, c.few) : 0;
            blocked_by_choice(p, s, &c, &some, far + at, barrier + at);
        } else {
            beam_went_badly(pace, n);
            n = 0;
        }
    }
}

void geometry_blocked_many(const struct plan *p, struct scratch *s, const struct rays *rays,
                           const double *far, uint32_t light, uint64_t *barrier)
{
    const struct space *world = &p->geometry->space[0];
    struct blocker none = { .is_known = false };
    struct blocker *last = light < s->n_blocker ? &s->blocker[light] : &none;

    s->n_kept = 0;
    if (world->few)
        blocked_by_few(p, s, rays, far, barrier);
    else if (world->candidate)
        blocked_by_beams(p, s, rays, far, light, last, barrier);
    else
        blocked_by_streams(p, s, rays, far, last, barrier);
}

/* --- crossings ------------------------------------------------------------- */

/* Keeps the nearest MOST_CROSSINGS in order. */
static void keep(struct search *s, const struct hit *h, uint32_t leaf)
{
    struct meeting *m = s->s->crossing;
    int64_t own = rank_of(s->instance, leaf);
    size_t at = s->n_crossing;

    if (h->t < s->after_t || (h->t == s->after_t && own <= s->after))
        return;
    if (at == MOST_CROSSINGS) {
        at--;
        s->is_full = true;
        if (h->t > m[at].t || (h->t == m[at].t && own > rank_of(m[at].instance, m[at].leaf)))
            return;
    } else {
        s->n_crossing++;
    }
    for (; at > 0 && (m[at - 1].t > h->t || (m[at - 1].t == h->t
                                             && rank_of(m[at - 1].instance, m[at - 1].leaf) > own)); at--)
        m[at] = m[at - 1];
    m[at] = (struct meeting) { h->t, *h, leaf, s->instance, s->plan->leaf[leaf].inverse };
}

/* Crossings of the leaf, which let light through. */
static int clear_hits(struct search *s, const struct leaf *l, struct hit hit[])
{
    struct ray ray = leaf_ray(l, s->ray);
    int n;

    s->s->counts.leaf_tests++;
    if (l->ops)
        return l->ops->hits(l->shape, ray, hit);
    n = mesh_hits(l->mesh, ray, nextafter(s->after_t, -INFINITY), s->far, hit, MOST_CROSSINGS,
                  &s->s->counts.box_tests);
    s->is_full |= n == MOST_CROSSINGS;
    return n;
}

static bool is_between(const struct search *s, double t) { return t > 0 && t < s->far; }

static void keep_leaf(struct search *s, uint32_t number)
{
    const struct leaf *l = &s->plan->leaf[number];
    struct hit hit[SHAPE_MOST_HITS];

    if (!(l->mask & RAY_SHADOW) || is_opaque(s, l))
        return;
    int n = clear_hits(s, l, hit);
    if (s->tally) {
        unsigned *count = &s->tally[s->plan->surface[surface_of_leaf(s, l)].tally];
        for (int i = 0; i < n; i++)
            *count += is_between(s, hit[i].t);
        return;
    }
    for (int i = 0; i < n; i++)
        if (is_between(s, hit[i].t))
            keep(s, &hit[i], number);
}

static bool keep_event(void *arg, const struct csg_event *e)
{
    struct csg_search *c = arg;
    uint32_t leaf = c->csg->part[e->part].leaf;

    const struct leaf *l = &c->search->plan->leaf[leaf];

    if (is_opaque(c->search, l))
        return c->search->asks_opaque;
    if (c->search->tally)
        c->search->tally[c->search->plan->surface[surface_of_leaf(c->search, l)].tally]++;
    else
        keep(c->search, &e->hit, leaf);
    return false;
}

static bool keep_csg(struct search *s, uint32_t number)
{
    const struct csg *c = &s->plan->geometry->csg[number];

    s->s->counts.csg_tests++;
    return (c->mask & RAY_SHADOW)
           && csg_sweep(c, &s->s->csg, s->ray, s->far, keep_event, &(struct csg_search) { s, c });
}

static bool keep_instance(struct search *s, uint32_t number);

/* True: opaque, and that was asked. */
INLINE bool keep_item(struct search *s, uint32_t item)
{
    uint32_t number = item_number(item);

    switch (item_kind(item)) {
    case ITEM_CSG:      return keep_csg(s, number);
    case ITEM_INSTANCE: return keep_instance(s, number);
    case ITEM_LEAF:     break;
    }
    if (s->asks_opaque && blocks_leaf(s, number))
        return true;
    keep_leaf(s, number);
    return false;
}

INLINE bool visit_crossings(void *arg, const uint32_t item[], uint32_t bits, double *far)
{
    struct search *s = arg;

    (void)far;
    for (; bits; bits &= bits - 1) {
        uint32_t one = item[__builtin_ctz(bits)];
        if (!keep_item(s, one))
            continue;
        s->best->leaf = one;
        if (item_kind(one) != ITEM_INSTANCE)
            s->best->instance = s->instance;
        return true;
    }
    return false;
}

static __attribute__((noinline)) bool keep_instance(struct search *s, uint32_t number)
{
    if (!(s->plan->instance[number].mask & RAY_SHADOW))
        return false;
    struct search in = search_instance(s, number);
    bool is_blocked = search_space(&in, instance_space(s, number), visit_crossings);
    s->n_crossing = in.n_crossing;
    s->is_full = in.is_full;
    return is_blocked;
}

static bool search_all(struct search *s, const struct space *space, uint32_t light)
{
    struct blocker none = { .is_known = false };
    struct blocker *last = light < s->s->n_blocker ? &s->s->blocker[light] : &none;

    s->asks_opaque = true;
    if (still_blocks(s, last))
        return true;
    if (!search_space(s, space, visit_crossings))
        return false;
    *last = (struct blocker) { s->best->leaf, s->best->instance, true };
    return true;
}

/* True: blocked. */
static bool search_barrier(struct search *s, const struct space *space, uint32_t light,
                           uint64_t barrier)
{
    uint32_t list = (uint32_t)(barrier >> FEW);
    double far = s->far;

    s->s->counts.shadow_rays++;
    if (barrier == BARRIER_ANY)
        return search_all(s, space, light);
    if (barrier & BARRIER_CLEAR)
        return search_space(s, space, visit_crossings);
    return visit_crossings(s, list ? s->s->list[list - 1] : space->few->item, (uint32_t)barrier,
                           &far);
}

bool geometry_tally(const struct plan *p, struct scratch *s, struct ray ray, double far,
                    uint32_t light, uint64_t barrier, unsigned count[])
{
    struct meeting by;
    struct search search = { .plan = p, .s = s, .ray = ray, .instance = NO_INSTANCE,
                             .mask = RAY_SHADOW, .far = far, .best = &by, .tally = count };

    memset(count, 0, (size_t)p->n_tally * sizeof *count);
    if (barrier & BARRIER_KEPT) {
        for (uint32_t i = (uint32_t)barrier; i != KEPT_END; i = s->kept[i].next)
            count[p->surface[p->leaf[s->kept[i].m.leaf].surface].tally]++;
        return true;
    }
    return !search_barrier(&search, &p->geometry->space[0], light, barrier);
}

static void visit_kept(const struct scratch *s, uint32_t first,
                       bool (*visit)(void *arg, const struct meeting *m), void *arg)
{
    while (first != KEPT_END && visit(arg, &s->kept[first].m))
        first = s->kept[first].next;
}

/* When more were found than could be kept, the search is repeated beyond the
 * last one visited. */
bool geometry_crossings(const struct plan *p, struct scratch *s, struct ray ray, double far,
                        uint32_t light, uint64_t barrier,
                        bool (*visit)(void *arg, const struct meeting *m), void *arg)
{
    double after_t = 0;
    int64_t after = 0;
    bool more = true;

    if (barrier & BARRIER_KEPT) {
        visit_kept(s, (uint32_t)barrier, visit, arg);
        return true;
    }
    while (more) {
        struct meeting by;
        struct search search = { .plan = p, .s = s, .ray = ray, .instance = NO_INSTANCE,
                                 .mask = RAY_SHADOW, .far = far, .best = &by, .after_t = after_t,
                                 .after = after };
        if (search_barrier(&search, &p->geometry->space[0], light, barrier))
            return false;
        for (size_t i = 0; i < search.n_crossing; i++)
            if (!visit(arg, &s->crossing[i]))
                return true;
        more = search.is_full;
        if (more) {
            const struct meeting *last = &s->crossing[search.n_crossing - 1];
            after_t = last->t;
            after = rank_of(last->instance, last->leaf);
        }
    }
    return true;
}

/* --- inside ---------------------------------------------------------------- */

static bool item_holds(const struct plan *p, struct scratch *s, uint32_t item, vec3 point)
{
    uint32_t number = item_number(item);

    if (item_kind(item) == ITEM_CSG)
        return csg_inside(&p->geometry->csg[number], &s->csg, point);
    return leaf_inside(&p->leaf[number], point);
}

size_t geometry_inside(const struct plan *p, struct scratch *s, vec3 point, uint32_t surface[],
                       size_t room)
{
    const struct geometry *g = p->geometry;
    size_t n = 0;

    for (size_t i = 0; i < g->n_filled && n < room; i++) {
        uint32_t item = g->filled[i], number = item_number(item);
        if (item_holds(p, s, item, point))
            surface[n++] = p->leaf[item_kind(item) == ITEM_CSG ? g->csg[number].surface_leaf
                                                               : number].surface;
    }
    return n;
}
