/* convex.c: what is seen of CSG of convex solids, many rays at a time. */
#include "trace/convex.h"

#include "trace/world.h"

/* --- building -------------------------------------------------------------- */

static bool is_convex(const struct csg *c, const struct csg_part *part)
{
    const struct leaf *l = &c->leaf[part->leaf];

    if (!l->ops || !l->ops->spans || !part->alternates || part->is_silent)
        return false;
    return csg_is_cut_only(c, part);
}

struct convex *convex_new(const struct csg *c, struct arena *mem)
{
    struct convex *v;

    if (c->n_part > CONVEX_PARTS)
        return NULL;
    for (uint32_t i = 0; i < c->n_part; i++)
        if (!is_convex(c, &c->part[i]))
            return NULL;
    v = arena_alloc(mem, sizeof *v);
    for (uint32_t i = 0; i < c->n_part; i++)
        if (!c->leaf[c->part[i].leaf].inverse)
            v->part[v->n_part++] = i;
    v->n_required = v->n_part;
    for (uint32_t i = 0; i < c->n_part; i++)
        if (c->leaf[c->part[i].leaf].inverse)
            v->part[v->n_part++] = i;
    return v;
}

/* --- rays ------------------------------------------------------------------ */

static int filled_up(int n) { return (n + 7) & ~7; }

static void gather_lane(struct convex_work *w, const struct packet *p, int i)
{
    for (int axis = 0; axis < 3; axis++) {
        w->ray[axis][w->n] = p->o[axis][i];
        w->ray[3 + axis][w->n] = p->d[axis][i];
    }
    w->number[w->n++] = i;
}

static void gather_register(struct convex_work *w, const struct packet *p, int at)
{
    for (int axis = 0; axis < 3; axis++) {
        wide_store(w->ray[axis] + w->n, wide_load(p->o[axis] + at));
        wide_store(w->ray[3 + axis] + w->n, wide_load(p->d[axis] + at));
    }
    for (int i = 0; i < WIDE; i++)
        w->number[w->n + i] = at + i;
    w->n += WIDE;
}

bool convex_gather(struct convex_work *w, const struct packet *p, const struct lanes_asked *asked,
                   int *at)
{
    int i = *at;

    w->n = 0;
    for (; i < p->n && w->n + WIDE <= CONVEX_RAYS; i += WIDE) {
        unsigned bits = asked->bits[i / WIDE];
        if (bits == (1u << WIDE) - 1)
            gather_register(w, p, i);
        else
            for (; bits; bits &= bits - 1)
                gather_lane(w, p, i + __builtin_ctz(bits));
    }
    *at = i;
    return w->n > 0;
}

KERNEL static void place_rays(const mat34 *from, int n, const convex_row *restrict ray,
                              convex_row *restrict out)
{
    const mat34 own = *from;

    for (int i = 0; i < n; i++) {
        vec3 p = mat_point(&own, vec(ray[0][i], ray[1][i], ray[2][i]));
        vec3 d = mat_direction(&own, vec(ray[3][i], ray[4][i], ray[5][i]));
        out[0][i] = p.x;
        out[1][i] = p.y;
        out[2][i] = p.z;
        out[3][i] = d.x;
        out[4][i] = d.y;
        out[5][i] = d.z;
    }
}

/* Parts that stand alike see the same rays. */
struct cast { const struct csg *csg; struct convex_work *w; int n; const struct placement *placed; };

static void find_spans(struct cast *a, uint32_t k)
{
    const struct leaf *l = &a->csg->leaf[a->csg->part[a->csg->convex->part[k]].leaf];
    struct convex_work *w = a->w;
    const convex_row *ray = w->ray;

    if (l->placement) {
        if (l->placement != a->placed)
            place_rays(&l->placement->place.from, a->n, w->ray, w->placed);
        a->placed = l->placement;
        ray = w->placed;
    }
    l->ops->spans(l->shape, &(struct rays) { a->n, ray[0], ray[1], ray[2], ray[3], ray[4], ray[5] },
                  w->near[k], w->away[k]);
}

/* --- spans ----------------------------------------------------------------- */

/* What is left inside of all, and how many rays are left. */
KERNEL static int64_t narrow(int n, const double *restrict near, const double *restrict away,
                             const double *restrict far, double *restrict begin,
                             double *restrict end)
{
    int64_t left = 0;

    for (int i = 0; i < n; i++) {
        begin[i] = larger(near[i], begin[i]);
        end[i] = smaller(away[i], end[i]);
        left += (begin[i] <= end[i]) & (end[i] > 0) & (begin[i] < far[i]);
    }
    return left;
}

/* Where a part was cut away, the solid begins behind it. */
KERNEL static int64_t leap(int n, const double *restrict near, const double *restrict away,
                           double *restrict first)
{
    int64_t leapt = 0;

    for (int i = 0; i < n; i++) {
        bool covers = ((near[i] < first[i]) | (near[i] <= 0)) & (away[i] > first[i]);
        leapt += covers;
        first[i] = covers ? away[i] : first[i];
    }
    return leapt;
}

/* The way out of the solid for rays that begin in it. */
KERNEL static void shorten(int n, const double *restrict near, double *restrict end)
{
    for (int i = 0; i < n; i++)
        end[i] = ((near[i] > 0) & (near[i] < end[i])) ? near[i] : end[i];
}

KERNEL static void decide(int n, const double *restrict first, const double *restrict end,
                          const double *restrict whole_end, const double *restrict far,
                          double *restrict t)
{
    for (int i = 0; i < n; i++) {
        double at = first[i] > 0 ? first[i] : end[i];
        bool is_seen = (first[i] <= whole_end[i]) & (at > 0) & (at < far[i]);
        t[i] = is_seen ? at : INFINITY;
    }
}

/* --- doubt ----------------------------------------------------------------- */

/* Twice what csg.c looks at more closely, since t and reach are rounded. */
KERNEL static void find_margin(int n, const convex_row *restrict ray, const double *restrict t,
                               double *restrict margin)
{
    for (int i = 0; i < n; i++) {
        double o = vec_largest(vec(ray[0][i], ray[1][i], ray[2][i]));
        double d = vec_largest(vec(ray[3][i], ray[4][i], ray[5][i]));
        margin[i] = 2 * CSG_WORTH_A_LOOK * (t[i] + o / d);
    }
}

/* Ends of spans that may coincide with t; t itself is one. */
KERNEL static void count_close(int n, const double *restrict near, const double *restrict away,
                               const double *restrict t, const double *restrict margin,
                               double *restrict doubt)
{
    for (int i = 0; i < n; i++) {
        double a = fabs(near[i] - t[i]) <= margin[i] ? 1 : 0;
        double b = fabs(away[i] - t[i]) <= margin[i] ? 1 : 0;
        doubt[i] += near[i] != near[i] ? 2 : a + b;
    }
}

static uint32_t part_at(const struct cast *a, int i)
{
    const struct convex *v = a->csg->convex;
    uint32_t k = 0;

    while (a->w->near[k][i] != a->w->t[i] && a->w->away[k][i] != a->w->t[i])
        k++;
    return v->part[k];
}

/* --- the whole ------------------------------------------------------------- */

static bool cut_required(struct cast *a)
{
    struct convex_work *w = a->w;

    for (int i = 0; i < a->n; i++) {
        w->begin[i] = -INFINITY;
        w->end[i] = INFINITY;
    }
    for (uint32_t k = 0; k < a->csg->convex->n_required; k++) {
        find_spans(a, k);
        if (narrow(a->n, w->near[k], w->away[k], w->far, w->begin, w->end) == 0)
            return false;
    }
    return true;
}

static void cut_away(struct cast *a)
{
    const struct convex *v = a->csg->convex;
    struct convex_work *w = a->w;
    int64_t leapt = 1;

    for (int i = 0; i < a->n; i++)
        w->first[i] = larger(w->begin[i], 0);
    for (uint32_t k = v->n_required; k < v->n_part; k++)
        find_spans(a, k);
    for (uint32_t pass = v->n_required; pass < v->n_part && leapt; pass++) {
        leapt = 0;
        for (uint32_t k = v->n_required; k < v->n_part; k++)
            leapt += leap(a->n, w->near[k], w->away[k], w->first);
    }
}

static void see(struct cast *a)
{
    const struct convex *v = a->csg->convex;
    struct convex_work *w = a->w;
    double *out = w->doubt, *margin = w->begin;

    for (int i = 0; i < a->n; i++)
        out[i] = w->end[i];
    for (uint32_t k = v->n_required; k < v->n_part; k++)
        shorten(a->n, w->near[k], out);
    decide(a->n, w->first, out, w->end, w->far, w->t);
    find_margin(a->n, w->ray, w->t, margin);
    for (int i = 0; i < a->n; i++)
        w->doubt[i] = 0;
    for (uint32_t k = 0; k < v->n_part; k++)
        count_close(a->n, w->near[k], w->away[k], w->t, margin, w->doubt);
}

void convex_cast(const struct csg *c, struct convex_work *w)
{
    struct cast a = { c, w, filled_up(w->n), NULL };
    bool any = cut_required(&a);

    if (any) {
        cut_away(&a);
        see(&a);
    }
    for (int i = 0; i < w->n; i++)
        w->part[i] = !any || !(w->t[i] < INFINITY) ? CONVEX_NOTHING
                     : w->doubt[i] == 1            ? part_at(&a, i) : CONVEX_UNKNOWN;
}
