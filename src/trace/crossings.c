/* crossings.c: what light passes through on its way, a ray at a time. */
#include <string.h>

#include "trace/search.h"

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
    for (; at > 0 && comes_after(&m[at - 1], h, own); at--)
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

bool keep_item(struct search *s, uint32_t item)
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
    (void)far;
    return first_of(arg, item, bits, keep_item);
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
    struct blocker none, *last = last_blocker(s->s, light, &none);

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

/* ---- counted ---- */

uint32_t scratch_tally(struct scratch *s, int n)
{
    uint32_t first = s->n_tallied;

    if (s->plan->n_tally == 0 || first + (uint32_t)n > MOST_TALLIED)
        return NO_TALLY;
    memset(s->tallied[first], 0, (size_t)n * sizeof s->tallied[0]);
    s->n_tallied += (uint32_t)n;
    return first;
}

static bool is_tallied(const unsigned count[], int n)
{
    unsigned any = 0;

    for (int k = 0; k < n; k++)
        any |= count[k];
    return any != 0;
}

void scratch_tallied(const struct scratch *s, uint32_t first, int n, uint64_t *barrier)
{
    for (int i = 0; i < n; i++) {
        uint32_t row = first + (uint32_t)i;
        if (barrier[i] == 0 && is_tallied(s->tallied[row], s->plan->n_tally))
            barrier[i] = BARRIER_TALLIED | row;
    }
}

bool geometry_tally(const struct plan *p, struct scratch *s, struct ray ray, double far,
                    uint32_t light, uint64_t barrier, unsigned count[])
{
    struct meeting by;
    struct search search = { .plan = p, .s = s, .ray = ray, .instance = NO_INSTANCE,
                             .mask = RAY_SHADOW, .far = far, .best = &by, .tally = count };

    if (barrier & BARRIER_TALLIED) {
        memcpy(count, s->tallied[(uint32_t)barrier], (size_t)p->n_tally * sizeof *count);
        return true;
    }
    memset(count, 0, (size_t)p->n_tally * sizeof *count);
    if (barrier & BARRIER_KEPT) {
        for (uint32_t i = (uint32_t)barrier; i != KEPT_END; i = s->kept[i].next)
            count[p->surface[p->leaf[s->kept[i].m.leaf].surface].tally]++;
        return true;
    }
    return !search_barrier(&search, &p->geometry->space[0], light, barrier);
}

const unsigned *geometry_tallied(const struct scratch *s, uint64_t barrier)
{
    bool is_row = barrier != BARRIER_OPAQUE && (barrier & BARRIER_TALLIED);

    return is_row ? s->tallied[(uint32_t)barrier] : NULL;
}

/* ---- in order ---- */

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

    if (barrier & BARRIER_TALLIED)
        barrier = BARRIER_CLEAR;
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
