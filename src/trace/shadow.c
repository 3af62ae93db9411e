/* shadow.c: how much of a lamp's light comes through (facts shading.md 4.3, 4.6). */
#include "trace/shadow.h"

/* A lamp that stands exactly on a surface is not shadowed by it. */
static const double nearly = 1 - 1e-9;

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

static rgb filter_of(const struct program *p, const struct spots *s)
{
    rgb out[BATCH];

    if (p->is_plain) {
        colour c = p->layer[0].paint->colour;
        return rgb_of(c.r * c.f + c.t, c.g * c.f + c.t, c.b * c.f + c.t);
    }
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

static bool pass(void *arg, const struct meeting *m)
{
    struct passing *p = arg;
    struct surface_point at;

    geometry_point(p->w->plan, &p->ray, m, &at);
    const struct surface *s = &p->w->plan->surface[at.surface];
    bool from_inside = vec_dot(at.normal, p->ray.dir) > 0;
    p->light = rgb_mul(p->light, surface_filter(s, &at, from_inside));
    float sharper = caustic(s, at.normal, p->ray.dir);
    for (int k = layers_of(s->program); sharper != 1 && k > 0; k--)
        p->light = rgb_scale(p->light, sharper);
    cross_interior(p, m, s);
    return rgb_max(p->light) > no_light;
}

/* Starts outside of the surface's error bound, on the side that the light is on. */
static struct ray shadow_ray(const struct shadow_query *q, vec3 direction)
{
    double off = copysign(q->slack, vec_dot(q->normal, direction));

    return (struct ray) { vec_fma(q->point, off, q->normal), direction };
}

static rgb filtered(struct worker *w, const struct shadow_query *q, struct ray ray, double far,
                    uint64_t barrier)
{
    uint32_t kept = w->insides.n;
    struct passing p = { w, ray, { 1, 1, 1 }, q->inside, 0 };

    geometry_crossings(w->plan, w->scratch, ray, far, barrier, pass, &p);
    w->insides.n = kept;
    return p.light;
}

static rgb along(struct worker *w, const struct shadow_query *q, vec3 direction, double far)
{
    struct ray ray = shadow_ray(q, direction);

    if (!(far > 0))
        return rgb_of(1, 1, 1);
    if (geometry_blocked(w->plan, w->scratch, ray, far * nearly, q->lamp))
        return rgb_of(0, 0, 0);
    return w->plan->has_transparency ? filtered(w, q, ray, far * nearly, BARRIER_ANY)
                                     : rgb_of(1, 1, 1);
}

/* ---- area lights: a grid of samples, looked at where they differ ---- */

struct grid {
    struct worker *w;
    const struct shadow_query *q;
    const struct lamp *lamp;
    rgb *sample;
};

static rgb grid_sample(const struct grid *g, int i, int j)
{
    rgb *one = &g->sample[i * g->lamp->area.n2 + j];

    if (one->r >= 0)
        return *one;
    vec3 p = lamp_area_point(g->lamp, g->q->direction, i, j);
    vec3 way = vec_sub(p, g->q->point);
    *one = along(g->w, g->q, vec_unit(way), vec_length(way));
    return *one;
}

static bool differ(const struct grid *g, rgb a, rgb b)
{
    rgb c = g->lamp->colour;

    return fabsf((a.r - b.r) * c.r) + fabsf((a.g - b.g) * c.g) + fabsf((a.b - b.b) * c.b) > 0.1f;
}

static rgb mean(const rgb c[4])
{
    return rgb_scale(rgb_add(rgb_add(c[0], c[1]), rgb_add(c[2], c[3])), 0.25f);
}

struct patch { int u1, v1, u2, v2; };

static rgb patch_light(const struct grid *g, struct patch p, int level)
{
    rgb c[4] = { grid_sample(g, p.u1, p.v1), grid_sample(g, p.u2, p.v1),
                 grid_sample(g, p.u2, p.v2), grid_sample(g, p.u1, p.v2) };
    bool fine = p.u2 - p.u1 <= 1 && p.v2 - p.v1 <= 1;

    if (fine || !(level < g->lamp->area.adaptive || differ(g, c[0], c[1]) || differ(g, c[1], c[2])
                  || differ(g, c[2], c[3]) || differ(g, c[3], c[0])))
        return mean(c);
    int ulow = (p.u1 + p.u2) / 2, uhigh = (p.u1 + p.u2 + 1) / 2;
    int vlow = (p.v1 + p.v2) / 2, vhigh = (p.v1 + p.v2 + 1) / 2;
    const struct patch quarter[] = { { p.u1, p.v1, ulow, vlow }, { uhigh, p.v1, p.u2, vlow },
                                     { uhigh, vhigh, p.u2, p.v2 }, { p.u1, vhigh, ulow, p.v2 } };
    for (int k = 0; k < 4; k++)
        c[k] = patch_light(g, quarter[k], level + 1);
    return mean(c);
}

static rgb area_through(struct worker *w, const struct shadow_query *q, const struct lamp *l)
{
    struct grid g = { w, q, l, w->grid };

    for (int i = 0; i < l->area.n1 * l->area.n2; i++)
        g.sample[i].r = -1;
    return patch_light(&g, (struct patch) { 0, 0, l->area.n1 - 1, l->area.n2 - 1 }, 0);
}

/* ---- many points, one lamp ---- */

/* A ray of no length meets nothing. */
static void add_ray(struct shadow_rays *r, int i, const struct shadow_query *q)
{
    struct ray ray = shadow_ray(q, q->direction);

    r->x[i] = ray.origin.x;
    r->y[i] = ray.origin.y;
    r->z[i] = ray.origin.z;
    r->dx[i] = ray.dir.x;
    r->dy[i] = ray.dir.y;
    r->dz[i] = ray.dir.z;
    r->far[i] = q->far > 0 ? q->far * nearly : 0;
}

static rgb behind(struct worker *w, const struct shadow_rays *r, int i,
                  const struct shadow_query *q)
{
    if (r->barrier[i] == 0)
        return rgb_of(1, 1, 1);
    if (r->barrier[i] == BARRIER_OPAQUE)
        return rgb_of(0, 0, 0);
    return filtered(w, q, shadow_ray(q, q->direction), r->far[i], r->barrier[i]);
}

static void straight_through(struct worker *w, int n, const struct shadow_query *q, rgb *through)
{
    struct shadow_rays *r = &w->shadow_rays;
    const struct rays rays = { n, r->x, r->y, r->z, r->dx, r->dy, r->dz };

    for (int i = 0; i < n; i++)
        add_ray(r, i, &q[i]);
    geometry_blocked_many(w->plan, w->scratch, &rays, r->far, q->lamp, r->barrier);
    for (int i = 0; i < n; i++)
        through[i] = behind(w, r, i, &q[i]);
}

void shadow_through(struct worker *w, int n, const struct shadow_query *q, rgb *through)
{
    const struct lamp *l = &w->shader->lamp[q->lamp];

    if (!l->is_area) {
        straight_through(w, n, q, through);
        return;
    }
    for (int i = 0; i < n; i++)
        through[i] = area_through(w, &q[i], l);
}
