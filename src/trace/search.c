/* search.c: one ray against everything. */
#include "trace/search.h"

bool nearest_by_hits(const struct leaf *l, struct ray ray, double near, double far,
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

struct search search_instance(const struct search *s, uint32_t number)
{
    const struct instance *i = &s->plan->instance[number];
    struct search in = *s;

    in.ray = placed_ray(&i->place, s->ray);
    in.instance = number;
    return in;
}

/* ---- the nearest ---- */

void search_take(struct search *s, const struct hit *h, uint32_t leaf, bool flipped)
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

static bool take_event(void *arg, const struct csg_event *e)
{
    struct csg_search *c = arg;
    uint32_t leaf = c->csg->part[e->part].leaf;

    if (is_better(c->search, e->hit.t, leaf))
        search_take(c->search, &e->hit, leaf, c->search->plan->leaf[leaf].inverse);
    return true;
}

void meet_csg(struct search *s, uint32_t number)
{
    const struct csg *c = &s->plan->geometry->csg[number];

    s->s->counts.csg_tests++;
    if (c->mask & s->mask)
        csg_sweep(c, &s->s->csg, s->ray, s->far, take_event, &(struct csg_search) { s, c });
}

void meet_instance(struct search *s, uint32_t number)
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

/* ---- what blocks light ---- */

static bool blocks_event(void *arg, const struct csg_event *e)
{
    struct csg_search *c = arg;
    return is_opaque(c->search, &c->search->plan->leaf[c->csg->part[e->part].leaf]);
}

bool blocks_csg(struct search *s, uint32_t number)
{
    const struct csg *c = &s->plan->geometry->csg[number];

    s->s->counts.csg_tests++;
    return (c->mask & RAY_SHADOW)
           && csg_sweep(c, &s->s->csg, s->ray, s->far, blocks_event,
                        &(struct csg_search) { s, c });
}

bool blocks_instance(struct search *s, uint32_t number)
{
    if (!(s->plan->instance[number].mask & RAY_SHADOW))
        return false;
    struct search in = search_instance(s, number);
    return search_space(&in, instance_space(s, number), visit_blocked);
}

bool still_blocks(struct search *s, const struct blocker *b)
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
    struct blocker none, *last = last_blocker(s, light, &none);
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
