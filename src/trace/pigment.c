/* pigment.c: pigments ready for use, evaluated for arrays of points
 * (facts patterns.md 3.1, 4, 6). */
#include "trace/pigment.h"

#include <string.h>

#include "math/kernel.h"
#include "scene/picture.h"
#include "scene/tune.h"

/* ---- making ---- */

struct chain chain_of(const struct transform *outer, const struct transform *own, bool from_uv,
                      const struct turbulence *turbulence)
{
    struct transform all = from_uv ? *own : transform_compose(outer, own);

    return (struct chain) { .from = all.from, .is_identity = all.is_identity, .from_uv = from_uv,
                            .turbulence = *turbulence,
                            .has_turbulence = vec_largest(turbulence->amount) > 0 };
}

const struct gauge *gauge_new(struct arena *mem, const struct chain *chain,
                              const struct pattern_use *use, const struct map_entry *entry,
                              size_t n_entry)
{
    struct gauge *g = arena_alloc(mem, sizeof *g);
    float *key = arena_array(mem, n_entry, sizeof *key);

    for (size_t i = 0; i < n_entry; i++)
        key[i] = (float)entry[i].value;
    g->chain = *chain;
    g->chain.has_turbulence &= !(use->ops && use->ops->keeps_point);
    g->use = *use;
    /* This build's own row: the engine is compiled for several instruction sets. */
    const struct pattern_ops *own = use->ops ? pattern_find(use->ops->name) : NULL;
    if (own)
        g->use.ops = own;
    g->key = key;
    g->n_key = (int)n_entry;
    return g;
}

static bool is_clear(colour c) { return c.f != 0 || c.t != 0; }

static void colour_entries(struct paint *q, struct arena *mem, const struct pigment *p,
                           const struct chain *chain)
{
    colour *c = arena_array(mem, p->n_entry, sizeof *c);

    for (size_t i = 0; i < p->n_entry; i++) {
        c[i] = p->entry[i].colour;
        q->can_transmit |= is_clear(c[i]);
    }
    q->entry_colour = c;
    q->gauge = gauge_new(mem, chain, p->pattern, p->entry, p->n_entry);
}

static void pigment_entries(struct paint *q, struct arena *mem, const struct pigment *p,
                            const struct chain *chain)
{
    const struct paint **paint = arena_array(mem, p->n_entry, sizeof *paint);
    float *weight = arena_array(mem, p->n_entry, sizeof *weight);
    double total = 0;

    for (size_t i = 0; i < p->n_entry; i++) {
        paint[i] = paint_new(mem, p->entry[i].pigment, &transform_identity);
        q->can_transmit |= paint[i]->can_transmit;
        q->wants_uv |= paint[i]->wants_uv;
        total += (float)p->entry[i].value;
    }
    for (size_t i = 0; i < p->n_entry; i++)
        weight[i] = (float)(total != 0 ? (float)p->entry[i].value / total
                                       : 1.0 / (double)p->n_entry);
    q->entry = paint;
    q->weight = weight;
    q->gauge = gauge_new(mem, chain, p->pattern, p->entry, p->n_entry);
}

const struct paint *paint_new(struct arena *mem, const struct pigment *p,
                              const struct transform *outer)
{
    struct paint *q = arena_alloc(mem, sizeof *q);

    q->kind = p->kind;
    q->colour = p->colour;
    q->wants_uv = p->uv_mapping;
    if (p->kind == PIGMENT_COLOUR) {            /* each of many objects may have one */
        q->can_transmit = is_clear(p->colour);
        return q;
    }
    struct chain chain = chain_of(outer, p->place, p->uv_mapping, &p->pattern->turbulence);
    switch (p->kind) {
    case PIGMENT_COLOUR:
        break;
    case PIGMENT_COLOUR_MAP:
        colour_entries(q, mem, p, &chain);
        break;
    case PIGMENT_PIGMENT_MAP:
    case PIGMENT_AVERAGE:
        pigment_entries(q, mem, p, &chain);
        break;
    case PIGMENT_IMAGE:
        q->image = arena_copy(mem, p->image, sizeof *p->image);
        q->can_transmit = p->image->image->has_transparency || p->image->once
                          || p->image->filter_all != 0 || p->image->transmit_all != 0;
        q->gauge = gauge_new(mem, &chain, p->pattern, NULL, 0);
        break;
    }
    return q;
}

/* ---- from a point to a pattern's number ---- */

KERNEL static void move(const mat34 *m, int n, const double *restrict x, const double *restrict y,
                        const double *restrict z, double *restrict ox, double *restrict oy,
                        double *restrict oz)
{
    const mat34 a = *m;

    for (int i = 0; i < n; i++) {
        ox[i] = a.m[0][0] * x[i] + a.m[0][1] * y[i] + a.m[0][2] * z[i] + a.m[0][3];
        oy[i] = a.m[1][0] * x[i] + a.m[1][1] * y[i] + a.m[1][2] * z[i] + a.m[1][3];
        oz[i] = a.m[2][0] * x[i] + a.m[2][1] * y[i] + a.m[2][2] * z[i] + a.m[2][3];
    }
}

void chain_walk(const struct chain *c, const struct spots *s, double *x, double *y,
                       double *z)
{
    static const double zero[BATCH];
    size_t bytes = (size_t)s->n * sizeof *x;
    const double *fx = c->from_uv ? s->u : s->x, *fy = c->from_uv ? s->v : s->y;
    const double *fz = c->from_uv ? zero : s->z;

    if (c->is_identity) {
        memcpy(x, fx, bytes);
        memcpy(y, fy, bytes);
        memcpy(z, fz, bytes);
    } else {
        move(&c->from, s->n, fx, fy, fz, x, y, z);
    }
    if (c->has_turbulence)
        for (int i = 0; i < s->n; i++)
            stir(&c->turbulence, &x[i], &y[i], &z[i]);
}

void gauge_read(const struct gauge *g, const struct spots *s, double *x, double *y, double *z,
                struct map_place *where)
{
    double value[BATCH];

    chain_walk(&g->chain, s, x, y, z);
    g->use.ops->values(g->use.self, s->n, x, y, z, value);
    for (int i = 0; i < s->n; i++)
        where[i] = look_up(g->key, g->n_key, tune(&g->use, value[i]));
}

/* ---- colours ---- */

static void put(struct colours *out, int i, colour c)
{
    out->r[i] = c.r;
    out->g[i] = c.g;
    out->b[i] = c.b;
    out->f[i] = c.f;
    out->t[i] = c.t;
}

static void map_colours(const struct paint *p, const struct spots *s, struct colours *out)
{
    double x[BATCH], y[BATCH], z[BATCH];
    struct map_place where[BATCH];

    gauge_read(p->gauge, s, x, y, z, where);
    for (int i = 0; i < s->n; i++) {
        colour c = p->entry_colour[where[i].before];
        if (where[i].share != 0)
            c = colour_between(c, p->entry_colour[where[i].after], where[i].share);
        put(out, i, c);
    }
}

static void add_scaled(struct colours *out, int to, const struct colours *in, int from, float w)
{
    out->r[to] += w * in->r[from];
    out->g[to] += w * in->g[from];
    out->b[to] += w * in->b[from];
    out->f[to] += w * in->f[from];
    out->t[to] += w * in->t[from];
}

/* Looks with one paint at those of the points that it has a share in. */
static void add_paint(const struct paint *p, const struct spots *s, const float *share,
                      struct colours *out)
{
    double x[BATCH], y[BATCH], z[BATCH], u[BATCH], v[BATCH];
    int from[BATCH], n = 0;
    struct colours c;

    for (int i = 0; i < s->n; i++) {
        if (share[i] == 0)
            continue;
        x[n] = s->x[i];
        y[n] = s->y[i];
        z[n] = s->z[i];
        u[n] = s->u[i];
        v[n] = s->v[i];
        from[n++] = i;
    }
    if (n == 0)
        return;
    paint_colours(p, &(struct spots) { n, x, y, z, u, v }, &c);
    for (int k = 0; k < n; k++)
        add_scaled(out, from[k], &c, k, share[from[k]]);
}

static void blend_pigments(const struct paint *p, const struct spots *s, struct colours *out)
{
    double x[BATCH], y[BATCH], z[BATCH];
    struct map_place where[BATCH];
    float share[BATCH];

    gauge_read(p->gauge, s, x, y, z, where);
    struct spots inner = { s->n, x, y, z, s->u, s->v };
    for (int e = 0; e < p->gauge->n_key; e++) {
        for (int i = 0; i < s->n; i++)
            share[i] = where[i].before == e ? 1 - where[i].share
                     : where[i].after == e ? where[i].share : 0;
        add_paint(p->entry[e], &inner, share, out);
    }
}

static void average_pigments(const struct paint *p, const struct spots *s, struct colours *out)
{
    double x[BATCH], y[BATCH], z[BATCH];
    float share[BATCH];

    chain_walk(&p->gauge->chain, s, x, y, z);
    struct spots inner = { s->n, x, y, z, s->u, s->v };
    for (int e = 0; e < p->gauge->n_key; e++) {
        for (int i = 0; i < s->n; i++)
            share[i] = p->weight[e];
        add_paint(p->entry[e], &inner, share, out);
    }
}

static void image_colours(const struct paint *p, const struct spots *s, struct colours *out)
{
    double x[BATCH], y[BATCH], z[BATCH];
    struct picture_place at[BATCH];
    bool is_there[BATCH];

    chain_walk(&p->gauge->chain, s, x, y, z);
    for (int i = 0; i < s->n; i++)
        is_there[i] = picture_find(p->image, vec(x[i], y[i], z[i]), &at[i]);
    for (int i = 0; i < s->n; i++)
        put(out, i, is_there[i] ? picture_at(p->image, &at[i]) : picture_outside);
}

void paint_colours(const struct paint *p, const struct spots *s, struct colours *out)
{
    switch (p->kind) {
    case PIGMENT_COLOUR:
        for (int i = 0; i < s->n; i++)
            put(out, i, p->colour);
        break;
    case PIGMENT_COLOUR_MAP:
        map_colours(p, s, out);
        break;
    case PIGMENT_PIGMENT_MAP:
        memset(out, 0, sizeof *out);
        blend_pigments(p, s, out);
        break;
    case PIGMENT_AVERAGE:
        memset(out, 0, sizeof *out);
        average_pigments(p, s, out);
        break;
    case PIGMENT_IMAGE:
        image_colours(p, s, out);
        break;
    }
}
