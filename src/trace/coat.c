/* coat.c: one layer of a texture, and the light that leaves it (facts shading.md 2.3, 2.4, 2.6). */
#include "trace/coat.h"

#include <string.h>

#include "math/kernel.h"
#include "math/vmath.h"
#include "trace/grain.h"
#include "trace/shadow.h"

static const float no_light = 1e-10f;   /* POV-Ray takes less for none */

/* How one lamp lights a batch. */
struct arrival {
    float x[BATCH], y[BATCH], z[BATCH]; /* unit, to the lamp */
    float cosine[BATCH];                /* to the layer's normal */
    float r[BATCH], g[BATCH], b[BATCH]; /* its light, shadows taken off; 0 where it is not seen */
    float share[BATCH];                 /* of the lamp's light, were it not for shadows */
    float scatter[BATCH];               /* diffuse or diffuse_back */
    float shine[BATCH];                 /* 1 where highlights are possible */
};

KERNEL static void narrow(int n, const double *restrict from, float *restrict to)
{
    for (int i = 0; i < whole(n); i++)
        to[i] = (float)from[i];
}

void view_of(const struct batch *b, struct view *v)
{
    narrow(b->at.n, b->at.nx, v->nx);
    narrow(b->at.n, b->at.ny, v->ny);
    narrow(b->at.n, b->at.nz, v->nz);
    narrow(b->at.n, b->at.dx, v->dx);
    narrow(b->at.n, b->at.dy, v->dy);
    narrow(b->at.n, b->at.dz, v->dz);
}

/* ---- light arriving ---- */

KERNEL static void cosines(int n, const struct view *restrict v, struct arrival *restrict a)
{
    for (int i = 0; i < whole(n); i++)
        a->cosine[i] = v->nx[i] * a->x[i] + v->ny[i] * a->y[i] + v->nz[i] * a->z[i];
}

/* Which side of the surface the lamp lights, and how much of its light
 * counts: 2.4, step 2. */
KERNEL static void choose_side(int n, float diffuse, float diffuse_back,
                               const float *restrict alive, const float *restrict beam,
                               struct arrival *restrict a)
{
    for (int i = 0; i < whole(n); i++) {
        bool is_back = a->cosine[i] < no_light;
        float much = is_back ? diffuse_back : diffuse;
        a->scatter[i] = much;
        a->shine[i] = is_back ? 0 : 1;
        a->share[i] = alive[i] == 0 || (is_back && diffuse_back == 0) ? 0 : beam[i];
    }
}

/* double_illuminate: both sides are front sides. */
static void choose_both(const struct batch *b, const struct gloss *g, const float *alive,
                        const float *beam, struct arrival *a)
{
    for (int i = 0; i < b->at.n; i++)
        if (b->at.surface[i]->double_illuminate) {
            a->scatter[i] = g->diffuse;
            a->shine[i] = 1;
            a->share[i] = alive[i] == 0 ? 0 : beam[i];
        }
}

static int seen_by_lamp(int n, const float *share, uint16_t at[])
{
    int k = 0;

    for (int i = 0; i < n; i++) {
        at[k] = (uint16_t)i;
        k += share[i] != 0;
    }
    return k;
}

KERNEL static void dim(int n, const struct lit *restrict t, struct arrival *restrict a)
{
    for (int i = 0; i < whole(n); i++) {
        a->r[i] *= t->r[i];
        a->g[i] *= t->g[i];
        a->b[i] *= t->b[i];
    }
}

static float most_of(float r, float g, float b)
{
    return largerf(fabsf(r), largerf(fabsf(g), fabsf(b)));
}

/* What POV-Ray takes for no light is none. */
KERNEL static void drop_traces(int n, struct arrival *restrict a)
{
    for (int i = 0; i < whole(n); i++) {
        float keep = most_of(a->r[i], a->g[i], a->b[i]) < no_light ? 0 : 1;
        a->r[i] *= keep;
        a->g[i] *= keep;
        a->b[i] *= keep;
    }
}

KERNEL static void colour_light(int n, rgb colour, struct arrival *restrict a)
{
    for (int i = 0; i < whole(n); i++) {
        a->r[i] = colour.r * a->share[i];
        a->g[i] = colour.g * a->share[i];
        a->b[i] = colour.b * a->share[i];
    }
}

/* False: none at all. */
static bool light_arrives(struct worker *w, const struct batch *b, const struct gloss *g,
                          const float *alive, const struct view *v, uint32_t lamp,
                          struct arrival *a)
{
    const struct lamp *l = &w->shader->lamp[lamp];
    const struct points *p = &b->at;
    struct beams beam;
    uint16_t at[BATCH + 1];
    struct lit through;

    lamp_beams(l, p->n, p->x, p->y, p->z, &beam);
    narrow(p->n, beam.dx, a->x);
    narrow(p->n, beam.dy, a->y);
    narrow(p->n, beam.dz, a->z);
    cosines(p->n, v, a);
    choose_side(p->n, g->diffuse, g->diffuse_back, alive, beam.share, a);
    if (w->shader->has_double)
        choose_both(b, g, alive, beam.share, a);
    int n = seen_by_lamp(p->n, a->share, at);
    if (n == 0)
        return false;
    colour_light(p->n, l->colour, a);
    if (!l->shadowless) {
        shadow_through(w, b, &beam, lamp, n, at, &through);
        dim(p->n, &through, a);
    }
    drop_traces(p->n, a);
    return true;
}

/* ---- diffuse light and highlights ---- */

KERNEL static void scatter(int n, const float *restrict power, const float *restrict much,
                           const float *restrict opaque, float *restrict out)
{
    for (int i = 0; i < whole(n); i++)
        out[i] = power[i] * much[i] * opaque[i];
}

static void diffuse_light(const struct batch *b, const struct coat *c, const struct arrival *a,
                          uint32_t lamp, float *out)
{
    float level[BATCH], power[BATCH];
    bool is_lambert = c->gloss->brilliance == 1;

    for (int i = 0; i < whole(b->at.n); i++)
        level[i] = fabsf(a->cosine[i]);
    if (!is_lambert)
        vmath_pow(whole(b->at.n), level, c->gloss->brilliance, power);
    scatter(b->at.n, is_lambert ? level : power, a->scatter, c->opaque, out);
    for (int i = 0; c->gloss->crand != 0 && i < b->at.n; i++)
        out[i] -= grain_at(vec(b->at.x[i], b->at.y[i], b->at.z[i]), lamp) * c->gloss->crand;
}

/* The mirrored ray against the light. */
KERNEL static void phong_cosines(int n, const struct view *restrict v,
                                 const struct arrival *restrict a, float *restrict out)
{
    for (int i = 0; i < whole(n); i++) {
        float dn = v->dx[i] * v->nx[i] + v->dy[i] * v->ny[i] + v->dz[i] * v->nz[i];
        float dl = v->dx[i] * a->x[i] + v->dy[i] * a->y[i] + v->dz[i] * a->z[i];
        out[i] = dl - 2 * dn * a->cosine[i];
    }
}

/* The half-way vector against the normal. */
KERNEL static void half_cosines(int n, const struct view *restrict v,
                                const struct arrival *restrict a, float *restrict out)
{
    for (int i = 0; i < whole(n); i++) {
        float hx = a->x[i] - v->dx[i], hy = a->y[i] - v->dy[i], hz = a->z[i] - v->dz[i];
        float hn = hx * v->nx[i] + hy * v->ny[i] + hz * v->nz[i];
        float hh = hx * hx + hy * hy + hz * hz;
        out[i] = hn / sqrtf(hh > 1e-30f ? hh : 1e-30f);
    }
}

/* No highlight where no light is. */
KERNEL static void keep_lit(int n, const struct arrival *restrict a, float *restrict cosine)
{
    for (int i = 0; i < whole(n); i++) {
        float light = most_of(a->r[i], a->g[i], a->b[i]) * a->shine[i];
        cosine[i] = light > 0 && cosine[i] > 0 ? cosine[i] : 0;
    }
}

static bool any_positive(const float *x)
{
    float sum = 0;

    for (int i = 0; i < STRIDE; i++)
        sum += x[i];
    return sum > 0;
}

static void add_power(int n, float strength, float exponent, const float *cosine, float *sum)
{
    float level[STRIDE];

    for (int k = 0; k < n; k += STRIDE) {
        if (!any_positive(cosine + k))
            continue;
        vmath_pow(STRIDE, cosine + k, exponent, level);
        for (int i = 0; i < STRIDE; i++)
            sum[k + i] += strength * level[i];
    }
}

static void highlights(int n, const struct gloss *g, const struct view *v, const struct arrival *a,
                       float *out)
{
    const float least = 0.0008f;        /* POV-Ray's limit for tight highlights */
    float cosine[BATCH];

    memset(out, 0, (size_t)whole(n) * sizeof *out);
    if (g->phong != 0) {
        phong_cosines(n, v, a, cosine);
        for (int i = 0; g->phong_size >= 60 && i < whole(n); i++)
            cosine[i] = cosine[i] <= least ? 0 : cosine[i];
        keep_lit(n, a, cosine);
        add_power(n, g->phong, g->phong_size, cosine, out);
    }
    if (g->specular != 0) {
        half_cosines(n, v, a, cosine);
        keep_lit(n, a, cosine);
        add_power(n, g->specular, g->shininess, cosine, out);
    }
}

/* How much a metal keeps of its colour at this angle: 2.4, step 5. */
static float metal_share(float cosine)
{
    float x = acosf(fminf(1, fmaxf(-1, cosine)));
    float d = fabsf(x) / (float)(M_PI / 2) - 1.12f;
    float fresnel = 0.014567225f / (d * d) - 0.011612903f;

    return 1 - fminf(1, fmaxf(0, fresnel));
}

static rgb metal_tint(float metallic, float cosine, colour c)
{
    float k = metallic * metal_share(cosine);

    return rgb_of(1 + k * (c.r - 1), 1 + k * (c.g - 1), 1 + k * (c.b - 1));
}

static colour colour_at(const struct colours *c, int i)
{
    return (colour) { c->r[i], c->g[i], c->b[i], c->f[i], c->t[i] };
}

/* Thin film: 2.4, step 6. */
static float film_factor(const struct gloss *g, float cosines, float wavelength)
{
    return 1 + g->irid * cosf(2 * (float)M_PI * g->irid_thickness * cosines / wavelength);
}

static rgb film_tint(const struct gloss *g, rgb wavelength, float cosines)
{
    return rgb_of(film_factor(g, cosines, wavelength.r), film_factor(g, cosines, wavelength.g),
                  film_factor(g, cosines, wavelength.b));
}

KERNEL static void add_light(int n, const struct arrival *restrict a, const float *restrict diffuse,
                             const struct colours *restrict c, struct coat *restrict out)
{
    for (int i = 0; i < whole(n); i++) {
        out->r[i] += diffuse[i] * c->r[i] * a->r[i];
        out->g[i] += diffuse[i] * c->g[i] * a->g[i];
        out->b[i] += diffuse[i] * c->b[i] * a->b[i];
    }
}

KERNEL static void add_shine(int n, const struct arrival *restrict a, const float *restrict shine,
                             struct coat *restrict out)
{
    for (int i = 0; i < whole(n); i++) {
        out->r[i] += shine[i] * a->r[i];
        out->g[i] += shine[i] * a->g[i];
        out->b[i] += shine[i] * a->b[i];
    }
}

/* Metals and thin films, a point at a time. */
static void add_tinted(const struct worker *w, int n, const struct view *v,
                       const struct arrival *a, const float *diffuse, const float *shine,
                       struct coat *c)
{
    const struct gloss *g = c->gloss;

    for (int i = 0; i < n; i++) {
        colour own = colour_at(&c->colour, i);
        rgb light = rgb_of(a->r[i], a->g[i], a->b[i]);
        rgb tint = g->metallic != 0 ? metal_tint(g->metallic, a->cosine[i], own)
                                    : rgb_of(1, 1, 1);
        rgb sum = rgb_add(rgb_scale(colour_rgb(own), diffuse[i]), rgb_scale(tint, shine[i]));
        sum = rgb_mul(sum, light);
        if (g->irid != 0) {
            float dn = v->dx[i] * v->nx[i] + v->dy[i] * v->ny[i] + v->dz[i] * v->nz[i];
            sum = rgb_mul(sum, film_tint(g, w->plan->scene->settings.irid_wavelength,
                                         fabsf(a->cosine[i]) + fabsf(dn)));
        }
        c->r[i] += sum.r;
        c->g[i] += sum.g;
        c->b[i] += sum.b;
    }
}

static void lamp_lights(struct worker *w, const struct batch *b, const struct view *v,
                        const float *alive, uint32_t lamp, struct coat *c)
{
    const struct gloss *g = c->gloss;
    bool shines = g->has_highlight && !w->shader->lamp[lamp].shadowless;
    float diffuse[BATCH], shine[BATCH];
    struct arrival a;

    if (!light_arrives(w, b, g, alive, v, lamp, &a))
        return;
    diffuse_light(b, c, &a, lamp, diffuse);
    if (shines)
        highlights(b->at.n, g, v, &a, shine);
    if (g->irid != 0 || (shines && g->metallic != 0)) {
        if (!shines)
            memset(shine, 0, sizeof shine);
        add_tinted(w, b->at.n, v, &a, diffuse, shine, c);
        return;
    }
    add_light(b->at.n, &a, diffuse, &c->colour, c);
    if (shines)
        add_shine(b->at.n, &a, shine, c);
}

/* ---- its own colour and light ---- */

static void plain_colours(const struct batch *b, struct colours *out)
{
    for (int i = 0; i < whole(b->at.n); i++) {
        const colour *c = &b->program[i]->colour;
        out->r[i] = c->r;
        out->g[i] = c->g;
        out->b[i] = c->b;
        out->f[i] = c->f;
        out->t[i] = c->t;
    }
}

static void fill_up(int n, float column[])
{
    for (int i = n; i < whole(n); i++)
        column[i] = column[n - 1];
}

static void coat_colours(const struct batch *b, int layer, struct colours *out)
{
    const struct program *p = b->program[0];

    if (p->is_plain) {
        plain_colours(b, out);
        return;
    }
    paint_colours(p->layer[layer].paint,
                  &(struct spots) { b->at.n, b->sx, b->sy, b->sz, b->u, b->v }, out);
    fill_up(b->at.n, out->r);
    fill_up(b->at.n, out->g);
    fill_up(b->at.n, out->b);
    fill_up(b->at.n, out->f);
    fill_up(b->at.n, out->t);
}

/* Before 3.7 filter counted as far as the colour was bright (2.3). */
static void old_opacity(int n, const struct colours *c, float *out)
{
    for (int i = 0; i < whole(n); i++)
        out[i] = 1 - c->f[i] * largerf(c->r[i], largerf(c->g[i], c->b[i])) - c->t[i];
}

KERNEL static void opacity(int n, const struct colours *restrict c, float *restrict out)
{
    for (int i = 0; i < whole(n); i++)
        out[i] = 1 - c->f[i] - c->t[i];
}

KERNEL static void own_light(int n, rgb glow, struct coat *restrict c)
{
    for (int i = 0; i < whole(n); i++) {
        c->r[i] = c->colour.r[i] * glow.r * c->opaque[i];
        c->g[i] = c->colour.g[i] * glow.g * c->opaque[i];
        c->b[i] = c->colour.b[i] * glow.b * c->opaque[i];
    }
}

void coat_light(struct worker *w, const struct batch *b, const struct view *v, const float *alive,
                int layer, struct coat *c)
{
    const struct gloss *g = b->program[0]->layer[layer].gloss;

    c->gloss = g;
    coat_colours(b, layer, &c->colour);
    if (w->plan->scene->settings.effective_version < 370)
        old_opacity(b->at.n, &c->colour, c->opaque);
    else
        opacity(b->at.n, &c->colour, c->opaque);
    own_light(b->at.n, rgb_add(g->ambient, g->emission), c);
    for (size_t k = 0; k < w->shader->n_lamp; k++)
        lamp_lights(w, b, v, alive, (uint32_t)k, c);
}

/* ---- how much a layer reflects (2.6) ---- */

/* low facing the viewer, high at grazing angles. */
static rgb between(rgb low, rgb high, float share)
{
    return rgb_add(rgb_scale(high, share), rgb_scale(low, 1 - share));
}

static rgb fresnel_share(const struct gloss *g, double k, double c)
{
    double s = k * k + c * c - 1;

    if (s <= 0)
        return g->mirror.high;
    double r = sqrt(s), d = (r - c) / (r + c), e = (c * (r + c) - 1) / (c * (r - c) + 1);
    double share = 0.5 * d * d * (1 + e * e);
    return between(g->mirror.low, g->mirror.high, (float)fmin(1, fmax(0, share)));
}

static rgb angle_share(const struct gloss *g, float c)
{
    float base = fmaxf(0, 1 - c);
    float q = g->mirror.falloff == 1 ? base : powf(base, g->mirror.falloff);

    return between(g->mirror.low, g->mirror.high, q < 1e-10f ? 0 : q);
}

/* Neither of the unusual words: the same for all angles but for a share of the grazing. */
KERNEL static void plain_mirror(int n, const struct gloss *g, const float *restrict cosine,
                                const float *restrict alive, struct mirror_layer *restrict out)
{
    const rgb low = g->mirror.low, high = g->mirror.high;

    for (int i = 0; i < whole(n); i++) {
        float q = largerf(0, 1 - cosine[i]);
        q = q < 1e-10f ? 0 : q;
        out->r[i] = (high.r * q + low.r * (1 - q)) * alive[i];
        out->g[i] = (high.g * q + low.g * (1 - q)) * alive[i];
        out->b[i] = (high.b * q + low.b * (1 - q)) * alive[i];
    }
}

/* One point of any mirror; its largest share. */
static float odd_mirror(const struct worker *w, const struct batch *b, const struct coat *c, int i,
                        float cosine, float alive, struct mirror_layer *out)
{
    const struct gloss *g = c->gloss;
    float most = fmaxf(rgb_max(g->mirror.low), rgb_max(g->mirror.high));
    rgb share = g->mirror.fresnel
        ? fresnel_share(g, fresnel_index(w, b->at.index[i], b->at.surface[i]), cosine)
        : angle_share(g, cosine);

    if (g->mirror.metallic != 0)
        share = rgb_mul(share, metal_tint(g->mirror.metallic, cosine, colour_at(&c->colour, i)));
    if (g->irid != 0)
        share = rgb_mul(share, film_tint(g, w->plan->scene->settings.irid_wavelength,
                                         2 * fabsf(cosine)));
    if (g->mirror.fresnel)
        most = rgb_max(share);
    share = rgb_scale(share, alive);
    out->r[i] = share.r;
    out->g[i] = share.g;
    out->b[i] = share.b;
    return most;
}

KERNEL static void view_cosines(int n, const struct view *restrict v, float *restrict out)
{
    for (int i = 0; i < whole(n); i++)
        out[i] = -(v->dx[i] * v->nx[i] + v->dy[i] * v->ny[i] + v->dz[i] * v->nz[i]);
}

void coat_mirror(const struct worker *w, const struct batch *b, const struct view *v,
                 const struct coat *c, const float *trans, const float *alive,
                 struct mirror_layer *out)
{
    const struct gloss *g = c->gloss;
    float most = fmaxf(rgb_max(g->mirror.low), rgb_max(g->mirror.high)), cosine[BATCH];
    bool is_odd = g->mirror.fresnel || g->mirror.metallic != 0 || g->irid != 0
                  || g->mirror.falloff != 1;

    out->power = g->mirror.power;
    view_cosines(b->at.n, v, cosine);
    if (!is_odd)
        plain_mirror(b->at.n, g, cosine, alive, out);
    for (int i = 0; i < b->at.n; i++) {
        if (is_odd)
            most = odd_mirror(w, b, c, i, cosine[i], alive[i], out);
        out->adc[i] = w->now.adc[b->at.index[i]] * trans[i] * most;
    }
}
