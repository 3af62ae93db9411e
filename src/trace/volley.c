/* volley.c: packets of rays on their way through a choice of things. */
#include "trace/volley.h"

void volley_start(struct scratch *s, const struct choice *c, const struct rays *r,
                  const double *far)
{
    struct volley *v = s->volley;

    packet_fill(&v->rays, r);
    v->on_the_way = few_on_the_way(c->few, &v->rays, far);
    s->counts.box_tests += (unsigned long long)r->n * (unsigned)c->few->n;
}

bool volley_meets(struct volley *v, const struct few *few, int k, const double *far,
                  struct lanes_asked *asked)
{
    packet_prepare(&v->rays);
    return few_meet(few, k, &v->rays, far, asked->bits);
}

bool volley_leaf(struct scratch *s, const struct leaf *l, const struct few *few, int k,
                 const double *far, struct lanes_asked *asked)
{
    struct volley *v = s->volley;

    if (leaf_is_quick(l) ? !lanes_any(asked, &v->rays)
                         : !volley_meets(v, few, k, far, asked))
        return false;
    s->counts.leaf_tests += (unsigned)v->rays.n;
    leaf_hits_many(l, &v->rays, asked, &v->view);
    return true;
}

bool volley_mesh(struct scratch *s, const struct leaf *l, const struct few *few, int k,
                 const double *far, bool is_any, struct lanes_asked *asked)
{
    struct volley *v = s->volley;
    struct lanes_asked all = packet_all(&v->rays);
    double until[PACKET];

    if (!volley_meets(v, few, k, far, asked))
        return false;
    for (int i = 0; i < v->rays.n; i++) {
        bool is_asked = lanes_has(asked, i);
        until[i] = !is_asked ? -1 : is_any ? far[i] : beyond(far[i]);
        s->counts.leaf_tests += is_asked;
    }
    mesh_nearest_stream(l->mesh, s->inner, leaf_packet(l, &v->rays, &all, &v->view), until, is_any,
                        &v->view.crossings, &s->counts.box_tests);
    return true;
}

const struct leaf *mesh_leaf(const struct plan *p, uint32_t item)
{
    const struct leaf *l = &p->leaf[item_number(item)];

    return item_kind(item) == ITEM_LEAF && !l->ops && !mesh_is_tiny(l->mesh) ? l : NULL;
}

const struct leaf *hot_leaf(const struct plan *p, uint32_t item)
{
    const struct leaf *l = &p->leaf[item_number(item)];

    return item_kind(item) == ITEM_LEAF && leaf_takes_many(l) ? l : NULL;
}

const struct csg *convex_of(const struct plan *p, uint32_t item)
{
    const struct csg *c = &p->geometry->csg[item_number(item)];

    return item_kind(item) == ITEM_CSG && c->convex ? c : NULL;
}

const struct instance *copy_of(const struct plan *p, uint32_t item)
{
    return item_kind(item) == ITEM_INSTANCE ? &p->instance[item_number(item)] : NULL;
}

void volley_errands(const struct volley *v, const struct instance *to, uint32_t number,
                    const struct lanes_asked *asked, struct errands *e)
{
    e->n = 0;
    for (int i = 0; i < v->rays.n; i++) {
        const struct ray ray = packet_ray(&v->rays, i);
        if (lanes_has(asked, i))
            errands_add(e, to, number, i, &ray);
    }
}

void volley_aim(struct scratch *s, const struct few *few, uint32_t things,
                const double *far, const struct lanes_asked *asked, uint64_t may[])
{
    struct volley *v = s->volley;

    memset(may, 0, (size_t)v->rays.n * sizeof *may);
    for (; things; things &= things - 1) {
        int k = __builtin_ctz(things);
        struct lanes_asked meets = *asked;
        if (volley_meets(v, few, k, far, &meets))
            lanes_note(&meets, &v->rays, k, may);
    }
}
