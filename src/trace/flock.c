/* flock.c: many rays that go down the world's tree together. */
#include "trace/flock.h"

#include <string.h>

#include "trace/volley.h"

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

/* ---- the nearest ---- */

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

void nearest_of_streams(const struct plan *p, struct scratch *s, const struct rays *rays,
                        const uint8_t *mask, struct meeting *out)
{
    for (int at = 0; at < rays->n; at += STREAM) {
        struct rays some = rays_from(rays, at, STREAM);
        nearest_of_stream(p, s, &some, mask + at, out + at);
    }
}

/* ---- what blocks light ---- */

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
void blocked_by_streams(const struct plan *p, struct scratch *s, const struct rays *rays,
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
