/* volley_blocked.c: what stands between the points and the light of a packet of
 * shadow rays. */
#include <string.h>

#include "trace/volley.h"

/* Within an instance, where a leaf's surface may be the instance's, all is opaque. */
static bool lets_none_through(const struct plan *p, const struct leaf *l)
{
    return !p->has_transparency || p->surface[l->surface].is_opaque;
}

static bool is_blocker(const struct plan *p, const struct leaf *l)
{
    return (l->mask & RAY_SHADOW) && lets_none_through(p, l);
}

/* Takes the rays out of open that item k blocks; true: all are. */
static bool close_many(const struct plan *p, struct scratch *s, const struct few *few, int k,
                       const double *far, struct lanes_asked *open)
{
    struct volley *v = s->volley;
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
    struct volley *v = s->volley;
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

/* Leaves in asked the rays for which this does not know; takes out of open
 * those that are blocked. */
static void close_by_convex(const struct plan *p, struct scratch *s, const struct csg *csg,
                            const double *far, struct lanes_asked *asked, struct lanes_asked *open)
{
    struct convex_work *w = s->convex;

    for (int at = 0; convex_gather(w, &s->volley->rays, asked, &at);) {
        for (int j = 0; j < w->n; j++)
            w->far[j] = far[w->number[j]];
        convex_cast(csg, w);
        s->counts.csg_tests += (unsigned)w->n;
        for (int j = 0; j < w->n; j++) {
            bool is_met = w->part[j] < CONVEX_UNKNOWN;
            bool is_blocked = is_met && lets_none_through(p, &p->leaf[csg->part[w->part[j]].leaf]);
            if (w->part[j] == CONVEX_NOTHING || is_blocked)
                lanes_drop(asked, w->number[j]);
            if (is_blocked)
                lanes_drop(open, w->number[j]);
        }
    }
}

static void close_one_by_one(const struct plan *p, struct scratch *s, const struct few *few,
                             const double *far, const uint64_t may[], struct lanes_asked *open)
{
    struct volley *v = s->volley;
    struct meeting by;
    struct search search = { .plan = p, .s = s, .instance = NO_INSTANCE, .mask = RAY_SHADOW,
                             .best = &by };
    uint32_t last = 0;

    for (int i = 0; i < v->rays.n; i++) {
        if (!may[i] || !lanes_has(open, i))
            continue;
        search.ray = packet_ray(&v->rays, i);
        search.far = far[i];
        if (one_is_blocked(&search, few, (uint32_t)may[i], &last))
            lanes_drop(open, i);
    }
}

/* Where light passes through nothing. */
static void close_by_copy(const struct plan *p, struct scratch *s, const struct instance *to,
                          uint32_t number, const double *far, const struct lanes_asked *asked,
                          struct lanes_asked *open)
{
    struct errands *e = &s->post->queue[0];
    uint64_t barrier[ERRANDS];
    double until[ERRANDS];
    struct blocker unused;

    volley_errands(s->volley, to, number, asked, e);
    for (int k = 0; k < e->n; k++)
        until[k] = far[e->ray[k]];
    errands_blocked(p, s, e, until, barrier, &unused);
    for (int k = 0; k < e->n; k++)
        if (barrier[k] == BARRIER_OPAQUE)
            lanes_drop(open, e->ray[k]);
}

/* CSG of convex solids first, the rest ray by ray. */
static void close_by_rest(const struct plan *p, struct scratch *s, const struct few *few,
                          uint32_t things, const double *far, struct lanes_asked *open)
{
    struct volley *v = s->volley;
    uint64_t may[PACKET] = { 0 };

    for (; things; things &= things - 1) {
        int k = __builtin_ctz(things);
        const struct csg *csg = convex_of(p, few->item[k]);
        struct lanes_asked asked = *open;
        const struct instance *copy = copy_of(p, few->item[k]);
        uint8_t mask = csg ? csg->mask : copy ? copy->mask : RAY_SHADOW;
        if (!volley_meets(v, few, k, far, &asked) || !(mask & RAY_SHADOW))
            continue;
        if (copy && !p->has_transparency) {
            close_by_copy(p, s, copy, item_number(few->item[k]), far, &asked, open);
            continue;
        }
        if (csg)
            close_by_convex(p, s, csg, far, &asked, open);
        lanes_note(&asked, &v->rays, k, may);
    }
    close_one_by_one(p, s, few, far, may, open);
}

/* Leaves in open the rays that nothing opaque blocks. */
static void close_blocked(const struct plan *p, struct scratch *s, const struct choice *c,
                          const double *far, struct lanes_asked *open)
{
    uint32_t todo = (uint32_t)c->opaque & s->volley->on_the_way, rest = 0;

    for (; todo; todo &= todo - 1) {
        int k = __builtin_ctz(todo);
        if (!hot_leaf(p, c->few->item[k]))
            rest |= 1u << k;
        else if (close_many(p, s, c->few, k, far, open))
            return;
    }
    rest = close_by_meshes(p, s, c->few, rest, far, open);
    if (rest)
        close_by_rest(p, s, c->few, rest, far, open);
}

/* ---- what light passes through, found ahead ---- */

static bool is_filter(const struct plan *p, const struct leaf *l)
{
    return (l->mask & RAY_SHADOW) && !p->surface[l->surface].is_opaque;
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
    const struct crossings *c = &s->volley->view.crossings;
    struct hit hit[2];

    for (int k = 0; k * WIDE < s->volley->rays.n; k++)
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

    for (int i = 0; i < s->volley->rays.n; i++)
        first[i] = KEPT_END;
    for (; things; things &= things - 1) {
        int k = __builtin_ctz(things);
        const struct leaf *l = hot_leaf(p, few->item[k]);
        struct lanes_asked asked = *open;
        if (is_filter(p, l) && volley_leaf(s, l, few, k, far, &asked))
            keep_crossings(p, s, item_number(few->item[k]), far, first);
    }
    for (int i = 0; i < s->volley->rays.n; i++)
        if (first[i] != KEPT_END)
            barrier[i] = first[i] == KEPT_TOO_MANY ? BARRIER_CLEAR : BARRIER_KEPT | first[i];
}

/* The same where it is enough to count. */
static void tally_crossings(struct scratch *s, uint32_t tally, const double *far, uint32_t row)
{
    const struct crossings *c = &s->volley->view.crossings;

    for (int at = 0, k = 0; at < s->volley->rays.n; at += WIDE, k++) {
        wide limit = wide_load(far + at);
        for (int i = 0; c->met[k] && i < c->most; i++) {
            wide t = wide_load(c->t[i] + at);
            wide_mask is_between = wide_below(wide_of(0), t) & wide_below(t, limit);
            for (unsigned bits = wide_bits(is_between) & c->met[k]; bits; bits &= bits - 1)
                s->tallied[row + (uint32_t)(at + __builtin_ctz(bits))][tally]++;
        }
    }
}

static void tally_ahead(const struct plan *p, struct scratch *s, const struct few *few,
                        uint32_t things, const double *far, const struct lanes_asked *open,
                        uint32_t row, uint64_t *barrier)
{
    for (; things; things &= things - 1) {
        int k = __builtin_ctz(things);
        const struct leaf *l = hot_leaf(p, few->item[k]);
        struct lanes_asked asked = *open;
        if (is_filter(p, l) && volley_leaf(s, l, few, k, far, &asked))
            tally_crossings(s, p->surface[l->surface].tally, far, row);
    }
    scratch_tallied(s, row, s->volley->rays.n, barrier);
}

/* Those of which hits_many tells all crossings. */
static uint32_t all_hot(const struct plan *p, const struct few *few, uint32_t things)
{
    uint32_t hot = 0;

    for (; things; things &= things - 1) {
        const struct leaf *l = hot_leaf(p, few->item[__builtin_ctz(things)]);
        hot |= l && l->ops && !l->ops->many_is_first ? things & -things : 0;
    }
    return hot;
}

/* The barriers of rays that nothing opaque blocks.  Those that may meet
 * something that is no hot leaf look at all of it later, ray by ray. */
static void look_at_clear(const struct plan *p, struct scratch *s, const struct choice *c,
                          const double *far, struct lanes_asked *open, uint64_t *barrier)
{
    uint32_t things = (uint32_t)c->clear & s->volley->on_the_way;
    uint32_t hot = all_hot(p, c->few, things);
    struct lanes_asked late = *open;
    uint64_t may[PACKET];

    if (things != hot) {
        volley_aim(s, c->few, things & ~hot, far, open, may);
        for (int i = 0; i < s->volley->rays.n; i++)
            lanes_drop(may[i] ? open : &late, i);
        volley_aim(s, c->few, things, far, &late, may);
        for (int i = 0; i < s->volley->rays.n; i++)
            if (may[i])
                barrier[i] = may[i] | c->list;
    }
    uint32_t row = hot ? scratch_tally(s, s->volley->rays.n) : NO_TALLY;
    if (row != NO_TALLY)
        tally_ahead(p, s, c->few, hot, far, open, row, barrier);
    else if (hot)
        look_ahead(p, s, c->few, hot, far, open, barrier);
}

/* ---- all of the choice ---- */

void blocked_by_choice(const struct plan *p, struct scratch *s, const struct choice *c,
                       const struct rays *r, const double *far, uint64_t *barrier)
{
    struct volley *v = s->volley;

    memcpy(v->far, far, (size_t)r->n * sizeof *far);
    for (int i = r->n; i % WIDE; i++)
        v->far[i] = far[r->n - 1];
    volley_start(s, c, r, v->far);
    struct lanes_asked open = packet_all(&v->rays);
    close_blocked(p, s, c, v->far, &open);
    for (int i = 0; i < r->n; i++)
        barrier[i] = lanes_has(&open, i) ? 0 : BARRIER_OPAQUE;
    if (p->has_transparency)
        look_at_clear(p, s, c, v->far, &open, barrier);
}
