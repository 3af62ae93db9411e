/* volley_nearest.c: what the rays of a packet meet first. */
#include <string.h>

#include "trace/volley.h"

struct lanes_asked lanes_that_see(const struct packet *p, const uint8_t *mask, uint8_t by)
{
    struct lanes_asked a = packet_all(p);

    if ((by & RAY_PRIMARY) && (by & RAY_REFLECTED))
        return a;
    for (int i = 0; i < p->n; i++)
        if (!(mask[i] & by))
            lanes_drop(&a, i);
    return a;
}

/* The crossing at t.  False: numbers too large for the one way to see the solid that the
 * other saw. */
static bool leaf_hit_at(const struct leaf *l, struct ray ray, double t, struct hit *out)
{
    struct hit hit[SHAPE_MOST_HITS];
    int n = l->ops->hits(l->shape, leaf_ray(l, ray), hit);

    for (int i = 0; i < n; i++)
        if (hit[i].t == t) {
            *out = hit[i];
            return true;
        }
    return false;
}

void search_for(struct search *s, const struct rays *r, int i, const uint8_t *mask,
                struct meeting *out)
{
    s->ray = rays_at(r, i);
    s->mask = mask[i];
    s->best = &out[i];
    s->far = out[i].leaf == NO_LEAF ? out[i].t : beyond(out[i].t);
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

/* ---- CSG of convex solids, many rays at once ---- */

/* False: it shall be looked for otherwise. */
static bool take_convex(const struct plan *p, struct volley *v, int i, uint32_t number, double t)
{
    struct found *f = &v->found;
    int64_t rank = rank_of(NO_INSTANCE, number);
    struct hit h;

    if (t > f->t[i] || (t == f->t[i] && rank > f->rank[i]))
        return true;
    if (!leaf_hit_at(&p->leaf[number], packet_ray(&v->rays, i), t, &h))
        return false;
    f->t[i] = t;
    f->slack[i] = h.slack;
    f->u[i] = (double)h.u;
    f->v[i] = (double)h.v;
    f->part[i] = h.part;
    f->rank[i] = rank;
    return true;
}

/* Leaves in asked the rays for which this does not know. */
static void nearest_of_convex(const struct plan *p, struct scratch *s, const struct csg *csg,
                              struct lanes_asked *asked)
{
    struct volley *v = s->volley;
    struct convex_work *w = s->convex;

    for (int at = 0; convex_gather(w, &v->rays, asked, &at);) {
        for (int j = 0; j < w->n; j++)
            w->far[j] = beyond(v->found.t[w->number[j]]);
        convex_cast(csg, w);
        s->counts.csg_tests += (unsigned)w->n;
        for (int j = 0; j < w->n; j++) {
            if (w->part[j] == CONVEX_UNKNOWN)
                continue;
            if (w->part[j] == CONVEX_NOTHING
                || take_convex(p, v, w->number[j], csg->part[w->part[j]].leaf, w->t[j]))
                lanes_drop(asked, w->number[j]);
        }
    }
}

/* ---- what is placed often ---- */

static void take_from_copy(struct volley *v, int i, uint32_t instance, struct meeting *m)
{
    struct found *f = &v->found;

    m->instance = instance;
    if (m->leaf != NO_LEAF && (m->t < f->t[i] || rank_of(instance, m->leaf) < f->rank[i]))
        found_put(f, i, m);
}

static void nearest_of_copy(const struct plan *p, struct scratch *s, const struct instance *to,
                            uint32_t number, const uint8_t *mask, struct lanes_asked *asked)
{
    struct volley *v = s->volley;
    struct errands *e = &s->post->queue[0];
    struct meeting met[ERRANDS];
    double far[ERRANDS];
    uint8_t masks[ERRANDS];

    volley_errands(v, to, number, asked, e);
    for (int k = 0; k < e->n; k++) {
        far[k] = beyond(v->found.t[e->ray[k]]);
        masks[k] = mask[e->ray[k]];
    }
    errands_nearest(p, s, e, far, masks, met);
    for (int k = 0; k < e->n; k++)
        take_from_copy(v, e->ray[k], number, &met[k]);
}

/* ---- what is no hot leaf: CSG of convex solids first, the rest ray by ray ---- */

static void nearest_one_by_one(const struct plan *p, struct scratch *s, const struct few *few,
                               const struct rays *r, const uint8_t *mask, const uint64_t may[])
{
    struct search search = { .plan = p, .s = s, .instance = NO_INSTANCE };
    struct meeting best[PACKET];
    double far;

    for (int i = 0; i < r->n; i++) {
        if (!may[i])
            continue;
        found_get(&s->volley->found, i, &best[i]);
        search_for(&search, r, i, mask, best);
        visit_nearest(&search, few->item, (uint32_t)may[i], &far);
        if (best[i].leaf != NO_LEAF)
            found_put(&s->volley->found, i, &best[i]);
    }
}

static void nearest_of_rest(const struct plan *p, struct scratch *s, const struct few *few,
                            uint32_t things, const struct rays *r, const uint8_t *mask)
{
    struct volley *v = s->volley;
    uint64_t may[PACKET] = { 0 };

    for (; things; things &= things - 1) {
        int k = __builtin_ctz(things);
        const struct csg *csg = convex_of(p, few->item[k]);
        const struct instance *copy = copy_of(p, few->item[k]);
        struct lanes_asked asked = csg || copy ? lanes_that_see(&v->rays, mask, csg ? csg->mask : copy->mask)
                                               : packet_all(&v->rays);
        if (!volley_meets(v, few, k, v->found.t, &asked))
            continue;
        if (copy) {
            nearest_of_copy(p, s, copy, item_number(few->item[k]), mask, &asked);
            continue;
        }
        if (csg)
            nearest_of_convex(p, s, csg, &asked);
        lanes_note(&asked, &v->rays, k, may);
    }
    nearest_one_by_one(p, s, few, r, mask, may);
}

/* Returns those of the things that are no meshes. */
static uint32_t nearest_of_meshes(const struct plan *p, struct scratch *s, const struct few *few,
                                  uint32_t things, const uint8_t *mask)
{
    struct volley *v = s->volley;
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

void found_meetings(const struct plan *p, const struct found *f, int n,
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

/* ---- all of the choice ---- */

/* The rest last: by then it need not be looked for far away. */
void nearest_of_choice(const struct plan *p, struct scratch *s, const struct choice *c,
                       const struct rays *r, const double *far, const uint8_t *mask,
                       struct meeting *out)
{
    struct volley *v = s->volley;
    uint32_t rest = 0;

    volley_start(s, c, r, far);
    found_start(&v->found, &v->rays, far);
    for (uint32_t todo = v->on_the_way; todo; todo &= todo - 1) {
        int k = __builtin_ctz(todo);
        const struct leaf *l = hot_leaf(p, c->few->item[k]);
        if (!l) {
            rest |= 1u << k;
            continue;
        }
        struct lanes_asked asked = lanes_that_see(&v->rays, mask, l->mask);
        if (volley_leaf(s, l, c->few, k, v->found.t, &asked))
            found_take_leaf(&v->found, &v->rays, l, &v->view,
                            rank_of(NO_INSTANCE, item_number(c->few->item[k])));
    }
    rest = nearest_of_meshes(p, s, c->few, rest, mask);
    if (rest)
        nearest_of_rest(p, s, c->few, rest, r, mask);
    found_meetings(p, &v->found, r->n, out);
}
