/* many.c: leaves against packets of rays. */
#include "trace/many.h"

#include "trace/mesh.h"

void packet_fill(struct packet *p, const struct rays *r)
{
    const double *from[] = { r->x, r->y, r->z, r->dx, r->dy, r->dz };

    p->n = r->n;
    p->has_inverse = false;
    for (int k = 0; k < 6; k++) {
        double *to = k < 3 ? p->o[k] : p->d[k - 3];
        memcpy(to, from[k], (size_t)r->n * sizeof *to);
        for (int i = r->n; i % WIDE; i++)
            to[i] = to[r->n - 1];
    }
}

struct lanes_asked packet_all(const struct packet *p)
{
    struct lanes_asked a;

    for (int at = 0, k = 0; at < p->n; at += WIDE, k++)
        a.bits[k] = (uint8_t)(p->n - at >= WIDE ? (1 << WIDE) - 1 : (1 << (p->n - at)) - 1);
    return a;
}

bool lanes_any(const struct lanes_asked *a, const struct packet *p)
{
    unsigned any = 0;

    for (int k = 0; k * WIDE < p->n; k++)
        any |= a->bits[k];
    return any;
}

void lanes_note(const struct lanes_asked *a, const struct packet *p, int k, uint64_t of[])
{
    for (int at = 0, n = 0; at < p->n; at += WIDE, n++)
        for (unsigned bits = a->bits[n]; bits; bits &= bits - 1)
            of[at + __builtin_ctz(bits)] |= (uint64_t)1 << k;
}

/* ---- the leaf ---- */

bool leaf_takes_many(const struct leaf *l)
{
    return l->ops ? l->ops->hits_many != NULL : mesh_is_tiny(l->mesh);
}

bool leaf_is_quick(const struct leaf *l)
{
    return l->ops && l->ops->is_quick && !l->placement;
}

/* In the order of mat.h's operations. */
INLINE wide row_point(const double m[4], struct wide3 p)
{
    return m[0] * p.x + m[1] * p.y + m[2] * p.z + m[3];
}

INLINE wide row_direction(const double m[4], struct wide3 d)
{
    return m[0] * d.x + m[1] * d.y + m[2] * d.z;
}

static void packet_place(const mat34 *m, const struct packet *p, const struct lanes_asked *asked,
                         bool is_prepared, struct packet *out)
{
    out->n = p->n;
    out->has_inverse = is_prepared;
    for (int at = 0, k = 0; at < p->n; at += WIDE, k++) {
        if (!asked->bits[k])
            continue;
        struct wide_ray r = packet_rays(p, at);
        for (int axis = 0; axis < 3; axis++) {
            wide_store(out->o[axis] + at, row_point(m->m[axis], r.o));
            wide d = row_direction(m->m[axis], r.d);
            wide_store(out->d[axis] + at, d);
            if (is_prepared)
                wide_store(out->inverse[axis] + at, 1 / d);
        }
    }
}

static int hits_of(const struct leaf *l, struct ray ray, struct hit out[])
{
    unsigned long long unused = 0;

    if (l->ops && l->ops->many_is_first)
        return l->ops->nearest(l->shape, &ray, 0, INFINITY, out);
    if (l->ops)
        return l->ops->hits(l->shape, ray, out);
    return mesh_nearest(l->mesh, ray, 0, INFINITY, out, &unused);
}

static void put_hits(struct crossings *c, int i, const struct hit hit[], int n)
{
    for (int k = 0; k < c->most; k++) {
        c->t[k][i] = k < n ? hit[k].t : NAN;
        c->slack[k][i] = k < n ? hit[k].slack : 0;
        c->part[k][i] = k < n ? (int64_t)hit[k].part : 0;
    }
    c->u[i] = (double)hit[0].u;
    c->v[i] = (double)hit[0].v;
}

static void decide_unsure(const struct leaf *l, const struct packet *p, struct crossings *c)
{
    struct hit hit[2];

    for (int k = 0; k * WIDE < p->n; k++)
        for (unsigned bits = c->unsure[k]; UNLIKELY(bits); bits &= bits - 1) {
            int lane = __builtin_ctz(bits), i = k * WIDE + lane;
            int n = hits_of(l, packet_ray(p, i), hit);
            if (!n)
                continue;
            put_hits(c, i, hit, n);
            c->met[k] |= (uint8_t)(1 << lane);
        }
}

static bool has_slabs(const struct leaf *l) { return l->ops && l->ops->has_slabs; }

const struct packet *leaf_packet(const struct leaf *l, const struct packet *p,
                                 const struct lanes_asked *asked, struct leaf_view *view)
{
    if (!l->placement)
        return p;
    packet_place(&l->placement->place.from, p, asked, has_slabs(l), &view->placed);
    return &view->placed;
}

void leaf_hits_many(const struct leaf *l, struct packet *rays, const struct lanes_asked *asked,
                    struct leaf_view *view)
{
    if (has_slabs(l) && !l->placement)
        packet_prepare(rays);
    const struct packet *p = leaf_packet(l, rays, asked, view);
    if (l->ops)
        l->ops->hits_many(l->shape, p, asked->bits, &view->crossings);
    else
        mesh_nearest_many(l->mesh, p, asked->bits, &view->crossings);
    decide_unsure(l, p, &view->crossings);
}

/* ---- what was found ---- */

void found_start(struct found *f, const struct packet *p, const double *far)
{
    for (int i = 0; i < p->n; i += WIDE) {
        wide_store(f->t + i, far ? wide_load(far + i) : wide_of(INFINITY));
        wide_store_ints(f->rank + i, wide_ints_of(NO_RANK));
    }
}

/* The first crossing beyond 0 of each ray; t is NaN or below if there is none. */
struct first { wide t, slack; wide_ints part; };

INLINE struct first first_of(const struct crossings *c, int at)
{
    struct first f = { wide_load(c->t[0] + at), wide_load(c->slack[0] + at),
                       wide_load_ints(c->part[0] + at) };

    if (c->most == 1)
        return f;
    wide_mask ahead = wide_below(wide_of(0), f.t);
    f.t = wide_pick(ahead, f.t, wide_load(c->t[1] + at));
    f.slack = wide_pick(ahead, f.slack, wide_load(c->slack[1] + at));
    f.part = wide_pick_ints(ahead, f.part, wide_load_ints(c->part[1] + at));
    return f;
}

INLINE void replace(double *p, wide_mask m, wide v)
{
    wide_store(p, wide_pick(m, v, wide_load(p)));
}

INLINE void replace_ints(int64_t *p, wide_mask m, wide_ints v)
{
    wide_store_ints(p, wide_pick_ints(m, v, wide_load_ints(p)));
}

void found_take(struct found *f, const struct packet *p, const struct crossings *c, int64_t rank)
{
    for (int at = 0, k = 0; at < p->n; at += WIDE, k++) {
        if (!c->met[k])
            continue;
        struct first new = first_of(c, at);
        wide old = wide_load(f->t + at);
        wide_mask better = wide_below(new.t, old)
                           | (wide_equal(new.t, old)
                              & wide_ints_below(wide_ints_of(rank), wide_load_ints(f->rank + at)));
        better &= wide_mask_of(c->met[k]) & wide_below(wide_of(0), new.t);
        if (!wide_bits(better))
            continue;
        replace(f->t + at, better, new.t);
        replace(f->slack + at, better, new.slack);
        replace(f->u + at, better, c->has_weights ? wide_load(c->u + at) : wide_of(0));
        replace(f->v + at, better, c->has_weights ? wide_load(c->v + at) : wide_of(0));
        replace_ints(f->part + at, better, new.part);
        replace_ints(f->rank + at, better, wide_ints_of(rank));
    }
}

void found_take_leaf(struct found *f, const struct packet *p, const struct leaf *l, struct leaf_view *view,
                     int64_t rank)
{
    if (l->ops && l->ops->lead)
        l->ops->lead(l->shape, l->placement ? &view->placed : p, &view->crossings);
    found_take(f, p, &view->crossings, rank);
}

void crossings_close(const struct crossings *c, const struct packet *p, const double far[],
                     struct lanes_asked *open)
{
    for (int at = 0, k = 0; at < p->n; at += WIDE, k++) {
        if (!c->met[k])
            continue;
        wide t = first_of(c, at).t;
        wide_mask closed = wide_below(wide_of(0), t) & wide_below(t, wide_load(far + at));
        open->bits[k] &= (uint8_t)~(wide_bits(closed) & c->met[k]);
    }
}

int crossings_at(const struct crossings *c, int i, struct hit out[2])
{
    int n = 0;

    if (!(c->met[i / WIDE] >> i % WIDE & 1))
        return 0;
    for (int k = 0; k < c->most; k++)
        if (!isnan(c->t[k][i]))
            out[n++] = (struct hit) { .t = c->t[k][i], .slack = c->slack[k][i],
                                      .u = c->has_weights ? (float)c->u[i] : 0,
                                      .v = c->has_weights ? (float)c->v[i] : 0,
                                      .part = (uint32_t)c->part[k][i] };
    return n;
}
