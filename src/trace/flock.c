/* flock.c: many rays that go down the world's tree together. */
#include <string.h>

#include "trace/flock_own.h"

/* ---- who comes to a leaf of the tree ---- */

/* A leaf of the world whose shape can say at once where all rays meet it. */
static const struct leaf *spanned(const struct plan *p, uint32_t item)
{
    const struct leaf *l = &p->leaf[item_number(item)];
    bool is_plain = item_kind(item) == ITEM_LEAF && l->ops && l->ops->spans && !l->placement
                    && !(l->ops->is_leaky && l->ops->is_leaky(l->shape));

    return is_plain ? l : NULL;
}

/* The rays that came, in columns, a few more than there are to fill a register. */
struct arrivals {
    const uint8_t *ray, *bits;          /* as of stream_visit */
    int n;
    double column[6][STREAM], far[STREAM];
    double enter[STREAM], leave[STREAM];
    int64_t asks[STREAM];               /* bits again, 0 behind the last */
};

static void arrive(struct arrivals *a, const struct flock *f, const uint8_t ray[],
                   const uint8_t bits[], int n)
{
    const double *from[] = { f->rays->x, f->rays->y, f->rays->z,
                             f->rays->dx, f->rays->dy, f->rays->dz };

    a->ray = ray;
    a->bits = bits;
    a->n = n;
    for (int k = 0; k < n || k % WIDE; k++) {
        int i = ray[k < n ? k : n - 1];
        for (int c = 0; c < 6; c++)
            a->column[c][k] = from[c][i];
        a->far[k] = f->far[i];
        a->asks[k] = k < n ? bits[k] : 0;
    }
}

/* Of a register of rays: which ask about a leaf's item. */
INLINE wide_mask arrivals_ask(const struct arrivals *a, int k, int item)
{
    return wide_ints_below(wide_ints_of(0), wide_load_ints(a->asks + k) & wide_ints_of(1 << item));
}

/* Where they enter and leave a leaf. */
static void arrivals_cut(struct arrivals *a, const struct leaf *l)
{
    int n = (a->n + WIDE - 1) / WIDE * WIDE;
    const struct rays rays = { n, a->column[0], a->column[1], a->column[2],
                               a->column[3], a->column[4], a->column[5] };

    l->ops->spans(l->shape, &rays, a->enter, a->leave);
}

/* Gathering rays pays where each asks about some things. */
static bool is_crowd(const uint8_t bits[], int n)
{
    enum { CROWD = 6 };
    int asks = 0;

    for (int k = 0; k < n; k++)
        asks += __builtin_popcount(bits[k]);
    return asks >= CROWD && asks >= 2 * n;
}

/* ---- the nearest ---- */

/* What of a leaf each ray that came may meet first: a number, or these. */
enum { MEETS_NONE = 8, MEETS_ANY };
struct firsts { double t[STREAM]; int64_t item[STREAM]; };

static void firsts_start(struct firsts *f, const struct arrivals *a)
{
    for (int k = 0; k < a->n; k += WIDE) {
        wide_store(f->t + k, wide_load(a->far + k));
        wide_store_ints(f->item + k, wide_ints_of(MEETS_NONE));
    }
}

/* Meetings at the same t, and rays left to hits(), are looked at one by one. */
static void firsts_take(struct firsts *f, const struct arrivals *a, int item)
{
    const wide none = wide_of(0);

    for (int k = 0; k < a->n; k += WIDE) {
        wide enter = wide_load(a->enter + k), best = wide_load(f->t + k);
        wide_ints first = wide_load_ints(f->item + k);
        wide t = wide_pick(wide_below(none, enter), enter, wide_load(a->leave + k));
        wide_mask is_asked = arrivals_ask(a, k, item);
        wide_mask is_met = is_asked & wide_below(none, t) & wide_below(t, best);
        wide_mask is_tie = wide_equal(t, best) & wide_ints_below(first, wide_ints_of(MEETS_NONE));
        wide_mask is_open = wide_ints_below(wide_ints_of(MEETS_NONE), first)
                            | (is_asked & (is_tie | wide_not(wide_equal(t, t))));
        first = wide_pick_ints(is_met, wide_ints_of(item), first);
        wide_store(f->t + k, wide_pick(is_met, t, best));
        wide_store_ints(f->item + k, wide_pick_ints(is_open, wide_ints_of(MEETS_ANY), first));
    }
}

/* The leaves that say at once where all meet them; the rest is returned. */
static unsigned firsts_find(struct firsts *f, struct arrivals *a, struct flock *flock,
                            const uint32_t item[])
{
    const uint8_t all = RAY_PRIMARY | RAY_REFLECTED;
    unsigned rest = 0;

    for (unsigned any = any_of(a->bits, a->n); any; any &= any - 1) {
        int j = __builtin_ctz(any);
        const struct leaf *l = spanned(flock->search.plan, item[j]);
        if (!l || (l->mask & all) != all) {
            rest |= 1u << j;
            continue;
        }
        arrivals_cut(a, l);
        flock->search.s->counts.leaf_tests += (unsigned)a->n;
        firsts_take(f, a, j);
    }
    return rest;
}

static void flock_meet(struct flock *f, int i, const uint32_t item[], unsigned bits)
{
    double far;

    flock_turn(f, i)->mask = f->mask[i];
    f->search.best = &f->out[i];
    visit_nearest(&f->search, item, bits, &far);
    if (far < f->far[i])
        flock_set_far(f, i, far);
}

static void meet_crowd(struct flock *f, const uint32_t item[], const uint8_t ray[],
                       const uint8_t bits[], int n)
{
    struct arrivals a;
    struct firsts first;

    arrive(&a, f, ray, bits, n);
    firsts_start(&first, &a);
    unsigned rest = firsts_find(&first, &a, f, item);
    for (int k = 0; k < n; k++) {
        unsigned one = first.item[k] == MEETS_ANY ? bits[k] : 1u << first.item[k] & 0xff;
        if (one | (rest & bits[k]))
            flock_meet(f, ray[k], item, one | (rest & bits[k]));
    }
}

static void flock_nearest(void *arg, uint32_t first, const uint8_t ray[], uint8_t bits[], int n)
{
    struct flock *f = arg;
    const uint32_t *item = f->search.plan->geometry->space[0].tree.item + first;

    if (f->search.plan->n_instance)
        flock_send(f, item, ray, bits, n);
    if (is_crowd(bits, n)) {
        meet_crowd(f, item, ray, bits, n);
        return;
    }
    for (int k = 0; k < n; k++)
        if (bits[k])
            flock_meet(f, ray[k], item, bits[k]);
}

/* The hot ones of the unbounded, all rays at once: a plane, most often. */
static void found_of_unbounded(const struct plan *p, struct scratch *s, const uint8_t *mask)
{
    const struct space *world = &p->geometry->space[0];
    struct volley *v = s->volley;

    for (size_t k = 0; k < world->n_unbounded; k++) {
        const struct leaf *l = hot_leaf(p, world->unbounded[k]);
        if (!l)
            continue;
        struct lanes_asked asked = lanes_that_see(&v->rays, mask, l->mask);
        s->counts.leaf_tests += (unsigned)v->rays.n;
        leaf_hits_many(l, &v->rays, &asked, &v->view);
        found_take_leaf(&v->found, &v->rays, l, &v->view,
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
    struct volley *v = f->search.s->volley;
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
    flock_errands_begin(&f);
    stream_walk(s->stream, tree, true, flock_nearest, &f, &s->counts.box_tests);
    flock_errands_end(&f);
}

void nearest_of_streams(const struct plan *p, struct scratch *s, const struct rays *rays,
                        const uint8_t *mask, struct meeting *out)
{
    for (int at = 0; at < rays->n; at += STREAM) {
        struct rays some = rays_from(rays, at, STREAM);
        nearest_of_stream(p, s, &some, mask + at, out + at);
    }
}

/* ---- what blocks light ---- */

static void flock_blocked(void *arg, uint32_t first, const uint8_t ray[], uint8_t bits[], int n)
{
    struct flock *f = arg;
    struct scratch *s = f->search.s;
    const uint32_t *item = s->plan->geometry->space[0].tree.item + first;

    if (s->plan->n_instance)
        flock_send(f, item, ray, bits, n);
    for (int k = 0; k < n; k++) {
        int i = ray[k];
        double far;
        if (!bits[k] || !visit_blocked(flock_turn(f, i), item, bits[k], &far))
            continue;
        *f->last = (struct blocker) { f->search.best->leaf, f->search.best->instance, true };
        flock_block(f, i);
    }
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
        if ((t > 0 && t < f->far[i]) || (isnan(t) && blocks(flock_turn(f, i), item)))
            flock_block(f, i);
    }
}

/* One thing, of the world or of an instance. */
static void blocked_by(struct flock *f, const struct blocker *b)
{
    const struct leaf *l = b->instance == NO_INSTANCE ? spanned(f->search.plan, b->item) : NULL;

    if (l)
        blocked_by_span(f, l, b->item);
    for (int i = 0; !l && i < f->rays->n; i++)
        if (f->barrier[i] != BARRIER_OPAQUE && still_blocks(flock_turn(f, i), b))
            flock_block(f, i);
}

/* What stood in the way last time is asked first. */
static void blocked_ahead(struct flock *f)
{
    const struct blocker b = *f->last;

    if (b.is_known && b.instance == NO_INSTANCE && item_kind(b.item) == ITEM_INSTANCE)
        flock_blocked_by_instance(f, item_number(b.item));
    else if (b.is_known)
        blocked_by(f, &b);
}

static void blocked_by_unbounded(struct flock *f)
{
    const struct space *world = &f->search.plan->geometry->space[0];

    for (size_t k = 0; k < world->n_unbounded; k++)
        blocked_by(f, &(struct blocker) { world->unbounded[k], NO_INSTANCE, true });
}

/* ---- what light passes through, counted ---- */

/* One ray against one thing. */
static void tally_one(struct flock *f, int i, const uint32_t *item)
{
    struct search *s = flock_turn(f, i);

    if (f->barrier[i] == BARRIER_OPAQUE)
        return;
    s->tally = s->s->tallied[f->row + (uint32_t)i];
    if (!keep_item(s, *item))
        return;
    if (item_kind(*item) != ITEM_INSTANCE)
        *s->best = (struct meeting) { .leaf = *item, .instance = NO_INSTANCE };
    *f->last = (struct blocker) { s->best->leaf, s->best->instance, true };
    flock_block(f, i);
}

/* How often each ray crosses the leaf; true: some are left to hits(). */
static bool count_cuts(const struct arrivals *a, int item, int64_t count[])
{
    const wide none = wide_of(0);
    const wide_ints zero = wide_ints_of(0), one = wide_ints_of(1);
    uint32_t left = 0;

    for (int k = 0; k < a->n; k += WIDE) {
        wide enter = wide_load(a->enter + k), leave = wide_load(a->leave + k);
        wide far = wide_load(a->far + k);
        wide_mask is_asked = arrivals_ask(a, k, item);
        wide_mask enters = is_asked & wide_below(none, enter) & wide_below(enter, far);
        wide_mask leaves = is_asked & wide_below(none, leave) & wide_below(leave, far);
        wide_store_ints(count + k, wide_pick_ints(enters, one, zero) + wide_pick_ints(leaves, one, zero));
        left |= wide_bits(is_asked & wide_not(wide_equal(enter, enter)));
    }
    return left != 0;
}

static void tally_leaf(struct flock *f, struct arrivals *a, const struct leaf *l, int item,
                       const uint32_t *own)
{
    unsigned (*row)[PLAN_TALLIES] = f->search.s->tallied + f->row;
    unsigned tally = f->search.plan->surface[l->surface].tally;
    int64_t count[STREAM];

    arrivals_cut(a, l);
    bool is_left = count_cuts(a, item, count);
    for (int k = 0; k < a->n; k++)
        row[a->ray[k]][tally] += (unsigned)count[k];
    for (int k = 0; k < a->n && is_left; k++)
        if (isnan(a->enter[k]) && a->bits[k] >> item & 1)
            tally_one(f, a->ray[k], own);
}

static void tally_crowd(struct flock *f, const uint32_t item[], const uint8_t ray[],
                        const uint8_t bits[], int n)
{
    struct arrivals a;

    arrive(&a, f, ray, bits, n);
    f->search.s->counts.leaf_tests += (unsigned)n;
    for (unsigned any = any_of(bits, n); any; any &= any - 1) {
        int j = __builtin_ctz(any);
        const struct leaf *l = spanned(f->search.plan, item[j]);
        bool is_filter = l && !is_opaque(&f->search, l) && (l->mask & RAY_SHADOW);
        if (is_filter)
            tally_leaf(f, &a, l, j, item + j);
        for (int k = 0; !is_filter && k < n; k++)
            if (bits[k] >> j & 1)
                tally_one(f, ray[k], item + j);
    }
}

static void flock_tallied(void *arg, uint32_t first, const uint8_t ray[], uint8_t bits[], int n)
{
    struct flock *f = arg;

    tally_crowd(f, f->search.plan->geometry->space[0].tree.item + first, ray, bits, n);
}

static void tally_unbounded(struct flock *f)
{
    const struct space *world = &f->search.plan->geometry->space[0];
    uint8_t ray[STREAM], bits[STREAM];

    for (int i = 0; i < f->rays->n; i++) {
        ray[i] = (uint8_t)i;
        bits[i] = 1;
    }
    for (size_t k = 0; k < world->n_unbounded; k++)
        tally_crowd(f, world->unbounded + k, ray, bits, f->rays->n);
}

/* ---- shadow rays ---- */

static void blocked_by_stream(const struct plan *p, struct scratch *s, const struct rays *r,
                              const double *far, uint32_t row, struct blocker *last,
                              uint64_t *barrier)
{
    const struct bvh *tree = &p->geometry->space[0].tree;
    bool is_tally = row != NO_TALLY;
    struct meeting by;
    struct flock f = { .search = { .plan = p, .s = s, .instance = NO_INSTANCE, .mask = RAY_SHADOW,
                                   .best = &by, .asks_opaque = is_tally },
                       .rays = r, .barrier = barrier, .last = last, .row = row };

    s->counts.shadow_rays += (unsigned)r->n;
    memcpy(f.far, far, (size_t)r->n * sizeof *far);
    memset(barrier, 0, (size_t)r->n * sizeof *barrier);
    stream_aim(s->stream, tree, r, far);
    flock_errands_begin(&f);
    blocked_ahead(&f);
    (is_tally ? tally_unbounded : blocked_by_unbounded)(&f);
    stream_walk(s->stream, tree, false, is_tally ? flock_tallied : flock_blocked, &f,
                &s->counts.box_tests);
    flock_errands_end(&f);
    if (is_tally)
        scratch_tallied(s, row, r->n, barrier);
}

/* Where what filters light cannot be counted, all is asked at once, later. */
void blocked_by_streams(const struct plan *p, struct scratch *s, const struct rays *rays,
                        const double *far, struct blocker *last, uint64_t *barrier)
{
    uint32_t row = p->has_transparency ? scratch_tally(s, rays->n) : NO_TALLY;

    for (int i = 0; i < rays->n && p->has_transparency; i++)
        barrier[i] = BARRIER_ANY;
    if (p->has_transparency && row == NO_TALLY)
        return;
    for (int at = 0; at < rays->n; at += STREAM) {
        struct rays some = rays_from(rays, at, STREAM);
        uint32_t first = row == NO_TALLY ? NO_TALLY : row + (uint32_t)at;
        blocked_by_stream(p, s, &some, far + at, first, last, barrier + at);
    }
}
