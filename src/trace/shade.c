/* shade.c: points become light on the film: batches of them, layer by layer
 * (facts shading.md 2.3, 2.6). */
#include "trace/shade.h"

#include <string.h>

#include "math/kernel.h"
#include "trace/coat.h"
#include "trace/shadow.h"

/* ---- layers ---- */

/* What is gathered from the top layer down. */
struct stack {
    float r[BATCH], g[BATCH], b[BATCH];         /* the light so far */
    float fr[BATCH], fg[BATCH], fb[BATCH];      /* what gets through so far */
    float trans[BATCH], alive[BATCH];           /* its brightness; 1 while that is enough */
};

static void stack_start(struct stack *s, int n)
{
    for (int i = 0; i < whole(n); i++)
        s->r[i] = s->g[i] = s->b[i] = 0;
    for (int i = 0; i < whole(n); i++)
        s->fr[i] = s->fg[i] = s->fb[i] = s->trans[i] = s->alive[i] = 1;
}

KERNEL static void stack_light(int n, const struct coat *restrict c, struct stack *restrict s)
{
    for (int i = 0; i < whole(n); i++) {
        s->r[i] += s->alive[i] * s->fr[i] * c->r[i];
        s->g[i] += s->alive[i] * s->fg[i] * c->g[i];
        s->b[i] += s->alive[i] * s->fb[i] * c->b[i];
    }
}

KERNEL static void stack_filter(int n, const struct colours *restrict c, struct stack *restrict s)
{
    for (int i = 0; i < whole(n); i++) {
        s->fr[i] *= c->r[i] * c->f[i] + c->t[i];
        s->fg[i] *= c->g[i] * c->f[i] + c->t[i];
        s->fb[i] *= c->b[i] * c->f[i] + c->t[i];
    }
}

static float left(float share) { return share > 0 ? 1 - share : 1; }

/* conserve_energy: what was reflected does not get through as well. */
static void stack_conserve(int n, const struct mirror_layer *m, struct stack *s)
{
    for (int i = 0; i < n; i++) {
        s->fr[i] *= left(m->r[i]);
        s->fg[i] *= left(m->g[i]);
        s->fb[i] *= left(m->b[i]);
    }
}

/* Once too little gets through, a point stays dead. */
KERNEL static void stack_judge(int n, double adc_bailout, struct stack *restrict s)
{
    for (int i = 0; i < whole(n); i++) {
        float grey = fabsf(0.297f * s->fr[i] + 0.589f * s->fg[i] + 0.114f * s->fb[i]);
        float trans = grey < 1 ? grey : 1;
        bool is_alive = (s->alive[i] != 0) & ((double)trans > adc_bailout);
        s->trans[i] = trans;
        s->alive[i] = is_alive ? 1 : 0;
    }
}

static bool any_alive(const struct stack *s, int n)
{
    float sum = 0;

    for (int i = 0; i < n; i++)
        sum += s->alive[i];
    return sum != 0;
}

KERNEL static void weigh(int n, const float *restrict share, struct stack *restrict s)
{
    for (int i = 0; i < whole(n); i++) {
        s->r[i] *= share[i];
        s->g[i] *= share[i];
        s->b[i] *= share[i];
    }
}

static void expose(struct worker *w, const struct batch *b, const struct stack *s)
{
    const struct wave *now = &w->now;

    for (int i = 0; i < b->at.n; i++) {
        uint32_t k = b->at.index[i];
        film_add(&w->film, now->pixel[k], rgb_of(s->r[i] * now->red[k], s->g[i] * now->green[k],
                                                 s->b[i] * now->blue[k]));
    }
}

static void reserve_mirrors(struct worker *w, int n)
{
    if (n <= w->room_mirror)
        return;
    w->room_mirror = n;
    w->mirror = arena_array(&w->mem, (size_t)n, sizeof *w->mirror);
}

/* True: something of what is behind the layer can be seen. */
static bool add_layer(struct worker *w, const struct batch *b, const struct view *v, int k,
                      struct stack *s, int *n_mirror)
{
    const struct layer *layer = &b->program[0]->layer[k];
    struct mirror_layer *m = NULL;
    struct coat c;

    coat_light(w, b, v, s->alive, k, &c);
    stack_light(b->at.n, &c, s);
    if (layer->gloss->has_mirror) {
        m = &w->mirror[(*n_mirror)++];
        coat_mirror(w, b, v, &c, s->trans, s->alive, m);
    }
    if (!layer->can_transmit)
        return false;
    stack_filter(b->at.n, &c.colour, s);
    if (m && layer->gloss->conserve_energy)
        stack_conserve(b->at.n, m, s);
    stack_judge(b->at.n, w->plan->scene->settings.adc_bailout, s);
    return any_alive(s, b->at.n);
}

static void shade_layers(struct worker *w, const struct batch *b)
{
    const struct program *p = b->program[0];
    bool is_clear = true;
    struct stack s;
    struct view v;
    int n_mirror = 0;

    reserve_mirrors(w, p->n_layer);
    view_of(b, &v);
    stack_start(&s, b->at.n);
    for (int k = 0; k < p->n_layer && is_clear; k++)
        is_clear = add_layer(w, b, &v, k, &s, &n_mirror);
    weigh(b->at.n, b->share, &s);
    expose(w, b, &s);
    for (int i = 0; is_clear && i < b->at.n; i++)
        s.trans[i] *= s.alive[i];
    if (n_mirror || is_clear)
        bounce(w, b, &(struct leaving) { s.fr, s.fg, s.fb, is_clear ? s.trans : NULL, w->mirror,
                                         n_mirror });
}

/* ---- texture maps: every entry with those points that it has a share in ---- */

static void copy_point(struct batch *to, int k, const struct batch *from, int i)
{
    struct points *p = &to->at;
    const struct points *q = &from->at;

    p->index[k] = q->index[i];
    p->surface[k] = q->surface[i];
    p->x[k] = q->x[i];
    p->y[k] = q->y[i];
    p->z[k] = q->z[i];
    p->nx[k] = q->nx[i];
    p->ny[k] = q->ny[i];
    p->nz[k] = q->nz[i];
    p->dx[k] = q->dx[i];
    p->dy[k] = q->dy[i];
    p->dz[k] = q->dz[i];
    p->slack[k] = q->slack[i];
    to->slot[k] = from->slot[i];
    to->u[k] = from->u[i];
    to->v[k] = from->v[i];
}

/* Up to whole(n). */
static void fill_up(struct batch *b)
{
    int last = b->at.n - 1;

    for (int i = b->at.n; i < whole(b->at.n); i++) {
        copy_point(b, i, b, last);
        b->program[i] = b->program[last];
    }
}

static void shade_batch(struct worker *w, const struct batch *b);

static void shade_entry(struct worker *w, const struct batch *b, const struct program *entry,
                        const struct spots *s, const float *share)
{
    struct batch part;

    part.at.n = 0;
    for (int i = 0; i < b->at.n; i++) {
        if (share[i] == 0)
            continue;
        int k = part.at.n++;
        copy_point(&part, k, b, i);
        part.program[k] = entry;
        part.share[k] = b->share[i] * share[i];
        part.sx[k] = s->x[i];
        part.sy[k] = s->y[i];
        part.sz[k] = s->z[i];
    }
    if (part.at.n == 0)
        return;
    fill_up(&part);
    shade_batch(w, &part);
}

static void shade_map(struct worker *w, const struct batch *b)
{
    const struct program *p = b->program[0];
    double x[BATCH], y[BATCH], z[BATCH];
    struct map_place where[BATCH];
    struct spots s = { b->at.n, b->sx, b->sy, b->sz, b->u, b->v };
    float share[BATCH];

    gauge_read(p->gauge, &s, x, y, z, where);
    struct spots inner = { b->at.n, x, y, z, b->u, b->v };
    for (int e = 0; e < p->gauge->n_key; e++) {
        for (int i = 0; i < b->at.n; i++)
            share[i] = where[i].before == e ? 1 - where[i].share
                     : where[i].after == e ? where[i].share : 0;
        shade_entry(w, b, p->entry[e], &inner, share);
    }
}

static void shade_average(struct worker *w, const struct batch *b)
{
    const struct program *p = b->program[0];
    double x[BATCH], y[BATCH], z[BATCH];
    struct spots s = { b->at.n, b->sx, b->sy, b->sz, b->u, b->v };
    float share[BATCH];

    chain_walk(&p->gauge->chain, &s, x, y, z);
    struct spots inner = { b->at.n, x, y, z, b->u, b->v };
    for (int e = 0; e < p->gauge->n_key; e++) {
        for (int i = 0; i < b->at.n; i++)
            share[i] = p->weight[e];
        shade_entry(w, b, p->entry[e], &inner, share);
    }
}

static void shade_batch(struct worker *w, const struct batch *b)
{
    switch (b->program[0]->kind) {
    case PROGRAM_LAYERS:
        shade_layers(w, b);
        break;
    case PROGRAM_MAP:
        shade_map(w, b);
        break;
    case PROGRAM_AVERAGE:
        shade_average(w, b);
        break;
    }
}

/* ---- points as textures see them ---- */

static void place_points(struct worker *w, struct batch *b)
{
    const struct points *p = &b->at;

    for (int i = 0; i < p->n; i++) {
        uint32_t k = p->index[i];
        const struct ray ray = wave_at(&w->now, (int)k);
        struct surface_point at;
        double spot[5];
        geometry_point(w->plan, &ray, &w->meeting[k], &at);
        spot_of(p->surface[i], &at, spot);
        b->sx[i] = spot[0];
        b->sy[i] = spot[1];
        b->sz[i] = spot[2];
        b->u[i] = spot[3];
        b->v[i] = spot[4];
    }
}

/* Of things in the world, for textures that do not ask for uv. */
static bool are_in_place(const struct worker *w, const struct points *p)
{
    for (int i = 0; i < p->n; i++)
        if (p->surface[i]->wants_uv || w->meeting[p->index[i]].instance != NO_INSTANCE)
            return false;
    return true;
}

static void find_spots(struct worker *w, struct batch *b)
{
    const struct points *p = &b->at;
    size_t size = (size_t)p->n * sizeof(double);

    if (!are_in_place(w, p)) {
        place_points(w, b);
        return;
    }
    memcpy(b->sx, p->x, size);
    memcpy(b->sy, p->y, size);
    memcpy(b->sz, p->z, size);
    memset(b->u, 0, size);
    memset(b->v, 0, size);
}

/* ---- surfaces of more than one program: two sides, a mesh's faces ---- */

/* A program at a point of a batch. */
struct part { const struct program *program; float share; uint16_t i; };

static int add_face(const struct worker *w, const struct surface_point *at, uint16_t i,
                    const struct program *whole, struct part *out)
{
    int n = 0;

    if (at->texture[0] == at->texture[1] && at->texture[0] == at->texture[2]) {
        *out = (struct part) { whole->face[at->texture[0]], 1, i };
        return 1;
    }
    for (int k = 0; k < 3; k++)
        if ((double)at->weight[k] >= w->plan->scene->settings.adc_bailout)
            out[n++] = (struct part) { at->texture[k] == MESH_NONE ? whole
                                                                   : whole->face[at->texture[k]],
                                       at->weight[k], i };
    return n;
}

static int parts_of(const struct worker *w, const struct batch *b, int i, struct part *out)
{
    const struct surface *s = b->at.surface[i];
    uint32_t k = b->at.index[i];
    const struct program *p = b->at.from_inside[i] && s->interior_program ? s->interior_program
                                                                          : s->program;
    struct surface_point at;

    *out = (struct part) { p, 1, (uint16_t)i };
    if (!p->face)
        return 1;
    const struct ray ray = wave_at(&w->now, (int)k);
    geometry_point(w->plan, &ray, &w->meeting[k], &at);
    return at.texture[0] == MESH_NONE ? 1 : add_face(w, &at, (uint16_t)i, p, out);
}

/* Those of one group, out of the list. */
static int take_group(struct part *part, int n, uint32_t group, const struct batch *from,
                      struct batch *to)
{
    int rest = 0;

    to->at.n = 0;
    for (int j = 0; j < n; j++) {
        if (part[j].program->group != group || to->at.n == BATCH) {
            part[rest++] = part[j];
            continue;
        }
        int k = to->at.n++, i = part[j].i;
        copy_point(to, k, from, i);
        to->sx[k] = from->sx[i];
        to->sy[k] = from->sy[i];
        to->sz[k] = from->sz[i];
        to->program[k] = part[j].program;
        to->share[k] = part[j].share;
    }
    fill_up(to);
    return rest;
}

static uint32_t lowest_group(const struct part *part, int n)
{
    uint32_t lowest = part[0].program->group;

    for (int i = 1; i < n; i++)
        lowest = part[i].program->group < lowest ? part[i].program->group : lowest;
    return lowest;
}

static void shade_mixed(struct worker *w, const struct batch *b)
{
    struct part part[3 * BATCH];        /* a face may have three textures, one a corner */
    struct batch some;
    int n = 0;

    for (int i = 0; i < b->at.n; i++)
        n += parts_of(w, b, i, part + n);
    while (n) {
        n = take_group(part, n, lowest_group(part, n), b, &some);
        shade_batch(w, &some);
    }
}

/* ---- from rays that met something ---- */

static void start_batch(struct worker *w, int n, const struct wave_hit hit[], struct batch *b)
{
    const struct wave *r = &w->now;
    const struct rays rays = { r->n, r->x, r->y, r->z, r->dx, r->dy, r->dz };

    b->at.n = n;
    for (int i = 0; i < n; i++)
        b->at.index[i] = hit[i].ray;
    geometry_points(w->plan, &rays, w->meeting, &b->at);
    for (int i = 0; i < whole(n); i++) {
        b->slot[i] = (uint16_t)i;
        b->share[i] = 1;
        b->program[i] = b->at.surface[i]->program;
    }
}

static bool is_lit_once(const struct program *p)
{
    return p->kind == PROGRAM_LAYERS && p->n_layer == 1;
}

void shade_hits(struct worker *w, int n, const struct wave_hit hit[])
{
    struct batch b;

    start_batch(w, n, hit, &b);
    bool is_mixed = b.at.surface[0]->is_mixed;
    w->shadows.is_kept = is_mixed || !is_lit_once(b.program[0]);
    if (w->shadows.is_kept)
        shadow_forget(w, n);
    if (is_mixed || !b.program[0]->is_plain)
        find_spots(w, &b);
    if (is_mixed)
        shade_mixed(w, &b);
    else
        shade_batch(w, &b);
}
