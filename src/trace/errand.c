/* errand.c: rays on their way to things that are placed often. */
#include "trace/errand.h"

#include "trace/volley.h"

void errands_add(struct errands *e, const struct instance *to, uint32_t number, int i, const struct ray *ray)
{
    const struct ray inner = placed_ray(&to->place, *ray);
    int k = e->n++;

    e->root = to->root;
    e->ray[k] = (uint8_t)i;
    e->instance[k] = number;
    e->column[0][k] = inner.origin.x;
    e->column[1][k] = inner.origin.y;
    e->column[2][k] = inner.origin.z;
    e->column[3][k] = inner.dir.x;
    e->column[4][k] = inner.dir.y;
    e->column[5][k] = inner.dir.z;
}

static void fill_up(double v[], int n)
{
    for (int i = n; i % WIDE; i++)
        v[i] = v[n - 1];
}

/* ---- down a space's tree ---- */

struct descent {
    struct search search;               /* of the errand whose turn it is */
    const struct errands *errands;
    const struct space *space;
    double *far;
    const uint8_t *mask;                /* of the nearest */
    struct meeting *met;
    uint64_t *barrier;                  /* of shadow rays */
    struct blocker *last;
};

static struct search *turn(struct descent *d, int k)
{
    struct search *s = &d->search;

    s->ray = errands_ray(d->errands, k);
    s->instance = d->errands->instance[k];
    s->far = d->far[k];
    return s;
}

static void meet(struct descent *d, int k, const uint32_t item[], unsigned bits)
{
    struct search *s = turn(d, k);
    double far;

    s->mask = d->mask[k];
    s->best = &d->met[k];
    visit_nearest(s, item, bits, &far);
    if (far < d->far[k]) {
        d->far[k] = far;
        stream_set_far(s->s->inner, k, far);
    }
}

static void block(struct descent *d, int k, const uint32_t item[], unsigned bits)
{
    struct search *s = turn(d, k);
    double unused;

    if (!visit_blocked(s, item, bits, &unused))
        return;
    *d->last = (struct blocker) { s->best->leaf, s->best->instance, true };
    d->barrier[k] = BARRIER_OPAQUE;
    d->far[k] = -1;
    stream_end(s->s->inner, k);
}

static void visit(void *arg, uint32_t first, const uint8_t ray[], uint8_t bits[], int n)
{
    struct descent *d = arg;

    for (int k = 0; k < n; k++)
        (d->barrier ? block : meet)(d, ray[k], d->space->tree.item + first, bits[k]);
}

static void descend(struct descent *d)
{
    const struct rays rays = errands_rays(d->errands);
    struct scratch *s = d->search.s;

    for (size_t i = 0; i < d->space->n_unbounded; i++)
        for (int k = 0; k < rays.n; k++)
            (d->barrier ? block : meet)(d, k, &d->space->unbounded[i], 1);
    stream_aim(s->inner, &d->space->tree, &rays, d->far);
    stream_walk(s->inner, &d->space->tree, !d->barrier, visit, d, &s->counts.box_tests);
}

/* ---- all of a space ---- */

void errands_nearest(const struct plan *p, struct scratch *s, const struct errands *e, double far[],
                     const uint8_t mask[], struct meeting met[])
{
    const struct space *space = &p->geometry->space[e->root];

    fill_up(far, e->n);
    if (space->few) {
        const struct choice all = { .few = space->few };
        const struct rays rays = errands_rays(e);
        s->volley = &s->volleys[1];
        nearest_of_choice(p, s, &all, &rays, far, mask, met);
        s->volley = &s->volleys[0];
        return;
    }
    for (int k = 0; k < e->n; k++)
        met[k] = (struct meeting) { .t = far[k], .leaf = NO_LEAF, .instance = NO_INSTANCE };
    descend(&(struct descent) { .search = { .plan = p, .s = s }, .errands = e, .space = space,
                                .far = far, .mask = mask, .met = met });
}

void errands_blocked(const struct plan *p, struct scratch *s, const struct errands *e, double far[],
                     uint64_t barrier[], struct blocker *last)
{
    const struct space *space = &p->geometry->space[e->root];
    const struct rays rays = errands_rays(e);
    struct meeting by;

    if (!space->few) {
        memset(barrier, 0, (size_t)e->n * sizeof *barrier);
        descend(&(struct descent) { .search = { .plan = p, .s = s, .mask = RAY_SHADOW, .best = &by },
                                    .errands = e, .space = space, .far = far, .barrier = barrier,
                                    .last = last });
        return;
    }
    const struct choice all = { space->few, UINT64_MAX, 0, 0 };
    s->volley = &s->volleys[1];
    blocked_by_choice(p, s, &all, &rays, far, barrier);
    s->volley = &s->volleys[0];
    for (int k = 0; k < e->n; k++)
        if (barrier[k] == BARRIER_OPAQUE)
            *last = (struct blocker) { item_of(ITEM_INSTANCE, e->instance[k]), NO_INSTANCE, true };
}
