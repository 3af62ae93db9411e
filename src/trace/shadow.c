/* shadow.c: how much of a lamp's light comes through (facts shading.md 4.3, 4.6). */
#include "trace/shadow.h"

#include "trace/area.h"

#include <string.h>

/* Below this POV-Ray takes light for none. */
static const float no_light = 1e-10f;

void spot_of(const struct surface *s, const struct surface_point *p, double spot[5])
{
    spot[0] = s->uv_mapping ? p->uv.u : p->local.x;
    spot[1] = s->uv_mapping ? p->uv.v : p->local.y;
    spot[2] = s->uv_mapping ? 0 : p->local.z;
    spot[3] = p->uv.u;
    spot[4] = p->uv.v;
}

static float faded(float keep, double distance, const struct interior *in)
{
    double k = keep, d = distance / in->fade_distance;

    if (in->fade_power >= 1000)
        return (float)exp(-(1 - k) * d);
    return (float)(k + (1 - k) / (1 + pow(d, in->fade_power)));
}

rgb interior_fade(const struct interior *in, double distance)
{
    if (!in || !(fabs(in->fade_distance) > 0))
        return rgb_of(1, 1, 1);
    return rgb_of(faded(in->fade_colour.r, distance, in), faded(in->fade_colour.g, distance, in),
                  faded(in->fade_colour.b, distance, in));
}

/* ---- one shadow ray ---- */

struct passing {
    struct worker *w;
    struct ray ray;
    rgb light;
    uint32_t inside;
    double entered;                     /* t of the crossing before */
};

static rgb plain_filter(const struct program *p)
{
    const colour c = p->colour;

    return rgb_of(c.r * c.f + c.t, c.g * c.f + c.t, c.b * c.f + c.t);
}

static rgb filter_of(const struct program *p, const struct spots *s)
{
    rgb out[BATCH];

    if (p->is_plain)
        return plain_filter(p);
    program_filter(p, s, out);
    return out[0];
}

static const struct program *face_program(const struct program *whole, uint32_t number)
{
    return number == MESH_NONE ? whole : whole->face[number];
}

static rgb surface_filter(const struct surface *s, const struct surface_point *p, bool from_inside)
{
    double at[5];
    const struct program *whole = from_inside && s->interior_program ? s->interior_program
                                                                     : s->program;

    spot_of(s, p, at);
    struct spots spot = { 1, &at[0], &at[1], &at[2], &at[3], &at[4] };
    if (!whole->face || p->texture[0] == MESH_NONE)
        return filter_of(whole, &spot);
    rgb sum = rgb_of(0, 0, 0);
    for (int k = 0; k < 3; k++)
        sum = rgb_add(sum, rgb_scale(filter_of(face_program(whole, p->texture[k]), &spot),
                                     p->weight[k]));
    return sum;
}

/* Sharpened light behind glass: POV-Ray's imitation of caustics. */
static float caustic(const struct surface *s, vec3 normal, vec3 dir)
{
    if (!s->interior || !(s->interior->caustics != 0))
        return 1;
    return (float)(1 + pow(fabs(vec_dot(vec_unit(normal), dir)), 45 * s->interior->caustics));
}

static int layers_of(const struct program *p) { return p->kind == PROGRAM_LAYERS ? p->n_layer : 1; }

static void cross_interior(struct passing *p, const struct meeting *m, const struct surface *s)
{
    struct insides *in = &p->w->insides;

    if (insides_holds(in, p->inside, s, m->instance)) {
        if (s->interior && s->interior->fade_power > 0)
            p->light = rgb_mul(p->light, interior_fade(s->interior, m->t - p->entered));
        p->inside = insides_leave(in, p->inside, s, m->instance);
    } else {
        p->inside = insides_enter(in, p->inside, s, m->instance);
    }
    p->entered = m->t;
}

/* What light takes from a surface that differs from place to place. */
static void pass_point(struct passing *p, const struct meeting *m, const struct surface *s)
{
    struct surface_point at;

    geometry_point(p->w->plan, &p->ray, m, &at);
    bool from_inside = vec_dot(at.normal, p->ray.dir) > 0;
    p->light = rgb_mul(p->light, surface_filter(s, &at, from_inside));
    float sharper = caustic(s, at.normal, p->ray.dir);
    for (int k = layers_of(s->program); sharper != 1 && k > 0; k--)
        p->light = rgb_scale(p->light, sharper);
}

static bool pass(void *arg, const struct meeting *m)
{
    struct passing *p = arg;
    const struct surface *s = surface_met(p->w->plan, m);

    if (s->is_even)
        p->light = rgb_mul(p->light, plain_filter(s->program));
    else
        pass_point(p, m, s);
    if (p->w->shader->has_fading)
        cross_interior(p, m, s);
    return rgb_max(p->light) > no_light;
}

/* Programs in their order, whatever the order of the crossings. */
static rgb tallied(struct worker *w, struct ray ray, double far, uint32_t lamp, uint64_t barrier)
{
    unsigned count[PLAN_TALLIES];
    rgb light = rgb_of(1, 1, 1);

    if (!geometry_tally(w->plan, w->scratch, ray, far, lamp, barrier, count))
        return rgb_of(0, 0, 0);
    for (int k = 0; k < w->plan->n_tally; k++) {
        rgb filter = plain_filter(w->plan->tally[k]);
        for (unsigned i = 0; i < count[k] && rgb_max(light) > no_light; i++)
            light = rgb_mul(light, filter);
    }
    return light;
}

static rgb filtered(struct worker *w, uint32_t inside, struct ray ray, double far, uint32_t lamp,
                    uint64_t barrier)
{
    if (w->plan->n_tally)
        return tallied(w, ray, far, lamp, barrier);
    uint32_t kept = w->insides.n;
    struct passing p = { w, ray, { 1, 1, 1 }, inside, 0 };
    bool is_open = geometry_crossings(w->plan, w->scratch, ray, far, lamp, barrier, pass, &p);
    w->insides.n = kept;
    return is_open ? p.light : rgb_of(0, 0, 0);
}

/* ---- many points, one lamp ---- */

/* As shadow_ray, for all points of the batch.  A ray of no length meets nothing. */
KERNEL static void leave(const struct points *restrict p, const struct beams *restrict beam,
                         struct shadow_rays *restrict r)
{
    for (int i = 0; i < whole(p->n); i++) {
        double cosine = p->nx[i] * beam->dx[i] + p->ny[i] * beam->dy[i] + p->nz[i] * beam->dz[i];
        double off = copysign(p->slack[i], cosine);
        r->x[i] = fma(off, p->nx[i], p->x[i]);
        r->y[i] = fma(off, p->ny[i], p->y[i]);
        r->z[i] = fma(off, p->nz[i], p->z[i]);
        r->dx[i] = beam->dx[i];
        r->dy[i] = beam->dy[i];
        r->dz[i] = beam->dz[i];
        r->far[i] = beam->far[i] > 0 ? beam->far[i] * shadow_nearly : 0;
    }
}

static void keep_wanted(struct shadow_rays *r, int n, const uint16_t at[])
{
    for (int k = 0; k < n; k++) {
        int i = at[k];
        r->x[k] = r->x[i];
        r->y[k] = r->y[i];
        r->z[k] = r->z[i];
        r->dx[k] = r->dx[i];
        r->dy[k] = r->dy[i];
        r->dz[k] = r->dz[i];
        r->far[k] = r->far[i];
    }
}

static rgb behind(struct worker *w, const struct shadow_rays *r, int k, uint32_t lamp,
                  uint32_t inside)
{
    const struct ray ray = { { r->x[k], r->y[k], r->z[k] }, { r->dx[k], r->dy[k], r->dz[k] } };

    return filtered(w, inside, ray, r->far[k], lamp, r->barrier[k]);
}

/* ---- rays whose crossings are counted, all at once ---- */

struct counted {
    int n;
    uint16_t at[BATCH];
    float r[BATCH], g[BATCH], b[BATCH];
    uint32_t count[PLAN_TALLIES][BATCH];
};

/* As tallied() does: light that is all but gone stays as it is. */
KERNEL static void filter_once(int n, rgb filter, uint32_t step, const uint32_t *restrict count,
                               float *restrict r, float *restrict g, float *restrict b)
{
    for (int i = 0; i < n; i++) {
        float most = largerf(r[i], largerf(g[i], b[i]));
        bool passes = (count[i] > step) & (most > no_light);
        r[i] = passes ? r[i] * filter.r : r[i];
        g[i] = passes ? g[i] * filter.g : g[i];
        b[i] = passes ? b[i] * filter.b : b[i];
    }
}

static uint32_t highest(int n, const uint32_t count[])
{
    uint32_t most = 0;

    for (int i = 0; i < n; i++)
        most = count[i] > most ? count[i] : most;
    return most;
}

static void filter_counted(const struct plan *p, struct counted *c)
{
    for (int i = 0; i < whole(c->n); i++)
        c->r[i] = c->g[i] = c->b[i] = 1;
    for (int k = 0; k < p->n_tally; k++) {
        for (int i = c->n; i < whole(c->n); i++)
            c->count[k][i] = 0;
        uint32_t most = highest(c->n, c->count[k]);
        rgb filter = plain_filter(p->tally[k]);
        for (uint32_t step = 0; step < most; step++)
            filter_once(whole(c->n), filter, step, c->count[k], c->r, c->g, c->b);
    }
}

static void counted_add(struct counted *c, int n_tally, const unsigned count[], uint16_t at)
{
    for (int k = 0; k < n_tally; k++)
        c->count[k][c->n] = count[k];
    c->at[c->n++] = at;
}

static void put_counted(const struct plan *p, struct counted *c, struct lit *out)
{
    filter_counted(p, c);
    for (int k = 0; k < c->n; k++)
        lit_put(out, c->at[k], rgb_of(c->r[k], c->g[k], c->b[k]));
}

/* ---- a batch ---- */

void shadow_rays_pass(struct worker *w, const struct batch *b, uint32_t lamp, int n, const uint16_t at[],
                      struct lit *out)
{
    struct shadow_rays *r = &w->shadow_rays;
    const struct rays rays = { n, r->x, r->y, r->z, r->dx, r->dy, r->dz };
    struct counted counted;             /* large: what is not used stays as it is */

    geometry_blocked_many(w->plan, w->scratch, &rays, r->far, lamp, r->barrier);
    counted.n = 0;
    for (int k = 0; k < n; k++) {
        uint64_t barrier = r->barrier[k];
        const unsigned *count = barrier == 0 ? NULL : geometry_tallied(w->scratch, barrier);
        float open = barrier == 0 ? 1 : 0;
        lit_put(out, k, rgb_of(open, open, open));
        if (count)
            counted_add(&counted, w->plan->n_tally, count, (uint16_t)k);
        else if (barrier != 0 && barrier != BARRIER_OPAQUE)
            lit_put(out, k, behind(w, r, k, lamp, w->now.inside[b->at.index[at[k]]]));
    }
    if (counted.n)
        put_counted(w->plan, &counted, out);
}

static void straight_through(struct worker *w, const struct batch *b, const struct beams *beam,
                             uint32_t lamp, int n, const uint16_t at[], struct lit *out)
{
    struct lit through;

    leave(&b->at, beam, &w->shadow_rays);
    if (n == b->at.n) {                 /* at[k] is k */
        shadow_rays_pass(w, b, lamp, n, at, out);
        return;
    }
    keep_wanted(&w->shadow_rays, n, at);
    shadow_rays_pass(w, b, lamp, n, at, &through);
    for (int k = 0; k < n; k++)
        lit_put(out, at[k], rgb_of(through.r[k], through.g[k], through.b[k]));
}

static void look(struct worker *w, const struct batch *b, const struct beams *beam, uint32_t lamp,
                 int n, const uint16_t at[], struct lit *out)
{
    if (w->shader->lamp[lamp].is_area)
        area_through(w, b, beam, lamp, n, at, out);
    else
        straight_through(w, b, beam, lamp, n, at, out);
}

/* ---- known from another layer ---- */

void shadow_forget(struct worker *w, int n)
{
    for (size_t k = 0; k < w->shader->n_lamp; k++)
        memset(w->shadows.known + k * BATCH, 0, (size_t)n * sizeof *w->shadows.known);
}

static void look_once(struct worker *w, const struct batch *b, const struct beams *beam,
                      uint32_t lamp, int n, const uint16_t at[], struct lit *out)
{
    bool *known = w->shadows.known + (size_t)lamp * BATCH;
    rgb *through = w->shadows.through + (size_t)lamp * BATCH;
    uint16_t unknown[BATCH];
    int n_unknown = 0;

    for (int k = 0; k < n; k++)
        if (!known[b->slot[at[k]]])
            unknown[n_unknown++] = at[k];
    if (n_unknown)
        look(w, b, beam, lamp, n_unknown, unknown, out);
    for (int k = 0; k < n_unknown; k++) {
        int i = unknown[k];
        through[b->slot[i]] = rgb_of(out->r[i], out->g[i], out->b[i]);
        known[b->slot[i]] = true;
    }
    for (int k = 0; k < n; k++)
        lit_put(out, at[k], through[b->slot[at[k]]]);
}

void shadow_through(struct worker *w, const struct batch *b, const struct beams *beam,
                    uint32_t lamp, int n, const uint16_t at[], struct lit *out)
{
    memset(out, 0, sizeof *out);
    if (w->shadows.is_kept)
        look_once(w, b, beam, lamp, n, at, out);
    else
        look(w, b, beam, lamp, n, at, out);
}
