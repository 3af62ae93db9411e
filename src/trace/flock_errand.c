/* flock_errand.c: a flock's rays to instances, many at a time. */
#include <string.h>

#include "trace/flock_own.h"

static const struct space *space_of(const struct flock *f, uint32_t root)
{
    return &f->search.plan->geometry->space[root];
}

static void keep_nearer(struct flock *f, int i, uint32_t instance, const struct meeting *m)
{
    struct search *s = flock_turn(f, i);

    s->instance = instance;
    s->best = &f->out[i];
    if (m->leaf != NO_LEAF && is_better(s, m->t, m->leaf)) {
        search_take(s, &m->hit, m->leaf, m->flipped);
        flock_set_far(f, i, s->far);
    }
    s->instance = NO_INSTANCE;
}

static void look_for_nearest(struct flock *f, const struct errands *e)
{
    struct meeting met[ERRANDS];
    double far[ERRANDS];
    uint8_t mask[ERRANDS];

    for (int k = 0; k < e->n; k++) {
        far[k] = f->far[e->ray[k]];
        mask[k] = f->mask[e->ray[k]];
    }
    errands_nearest(f->search.plan, f->search.s, e, far, mask, met);
    for (int k = 0; k < e->n; k++)
        keep_nearer(f, e->ray[k], e->instance[k], &met[k]);
}

static void look_for_blockers(struct flock *f, const struct errands *e)
{
    uint64_t barrier[ERRANDS];
    double far[ERRANDS];

    for (int k = 0; k < e->n; k++)
        far[k] = f->barrier[e->ray[k]] == BARRIER_OPAQUE ? -1 : f->far[e->ray[k]];
    errands_blocked(f->search.plan, f->search.s, e, far, barrier, f->last);
    for (int k = 0; k < e->n; k++)
        if (barrier[k] == BARRIER_OPAQUE)
            flock_block(f, e->ray[k]);
}

/* ---- the queues ---- */

static void run(struct flock *f, struct errands *e)
{
    struct post *post = f->search.s->post;

    if (e->n == 0)
        return;
    (f->barrier ? look_for_blockers : look_for_nearest)(f, e);
    for (int k = 0; k < e->n; k++)
        post->waiting[e->ray[k]]--;
    e->n = 0;
}

static void run_all(struct flock *f)
{
    for (int i = 0; i < ERRAND_QUEUES; i++)
        run(f, &f->search.s->post->queue[i]);
}

void flock_errands_begin(const struct flock *f)
{
    struct post *post = f->search.s->post;

    if (f->search.plan->n_instance == 0)
        return;
    for (int i = 0; i < ERRAND_QUEUES; i++)
        post->queue[i].n = 0;
    memset(post->waiting, 0, sizeof post->waiting);
}

void flock_errands_end(struct flock *f)
{
    if (f->search.plan->n_instance)
        run_all(f);
}

static void send(struct flock *f, int i, uint32_t number, const struct instance *to)
{
    struct post *post = f->search.s->post;
    struct errands *e = post_queue(post, to->root);
    const struct ray ray = rays_at(f->rays, i);

    if (!errands_have_room(e, to->root))
        run(f, e);
    errands_add(e, to, number, i, &ray);
    post->waiting[i]++;
}

/* A ray whose errands wait goes too far, as what it meets is not known yet: of
 * the nearest, few may wait, and fewer where much is placed. */
static bool must_wait_no_longer(const struct flock *f, int i, uint32_t root)
{
    enum { MOST_WAITING = 6, MOST_TO_TREES = 4 };
    int most = space_of(f, root)->few ? MOST_WAITING : MOST_TO_TREES;

    return !f->barrier && f->search.s->post->waiting[i] >= most;
}

static void send_all(struct flock *f, uint32_t number, int bit, const uint8_t ray[], uint8_t bits[], int n)
{
    const struct instance *to = &f->search.plan->instance[number];

    for (int k = 0; k < n; k++) {
        int i = ray[k];
        if (!(bits[k] >> bit & 1))
            continue;
        bits[k] &= (uint8_t)~(1u << bit);
        if (!(to->mask & (f->barrier ? RAY_SHADOW : f->mask[i])))
            continue;
        if (must_wait_no_longer(f, i, to->root))
            run_all(f);
        send(f, i, number, to);
    }
}

void flock_send(struct flock *f, const uint32_t item[], const uint8_t ray[], uint8_t bits[], int n)
{
    for (unsigned any = any_of(bits, n); any; any &= any - 1) {
        int bit = __builtin_ctz(any);
        if (item_kind(item[bit]) == ITEM_INSTANCE)
            send_all(f, item_number(item[bit]), bit, ray, bits, n);
    }
}

void flock_blocked_by_instance(struct flock *f, uint32_t number)
{
    const struct instance *to = &f->search.plan->instance[number];

    for (int i = 0; i < f->rays->n; i++)
        if (f->barrier[i] != BARRIER_OPAQUE)
            send(f, i, number, to);
    run(f, post_queue(f->search.s->post, to->root));
}
