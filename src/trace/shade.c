/* shade.c: points become light on the film (facts shading.md 2.3, 2.4, 2.6). */
#include "trace/shade.h"

#include <float.h>
#include <string.h>

#include "math/kernel.h"
#include "math/vmath.h"
#include "trace/shadow.h"

static const float no_light = 1e-10f;   /* POV-Ray takes less for none */

/* What a layer's pigment and finish meet at a batch of points. */
struct coat {
    const struct gloss *gloss;
    struct colours colour;
    float opaque[BATCH];
    float r[BATCH], g[BATCH], b[BATCH]; /* the light that leaves it */
};

/* A batch in single precision, for everything that is colour. */
struct view {
    float nx[BATCH], ny[BATCH], nz[BATCH];
    float dx[BATCH], dy[BATCH], dz[BATCH];
};

/* How one lamp lights a batch. */
struct arrival {
    float x[BATCH], y[BATCH], z[BATCH]; /* unit, to the lamp */
    float cosine[BATCH];                /* to the layer's normal */
    float r[BATCH], g[BATCH], b[BATCH]; /* its light, shadows taken off; 0 where it is not seen */
    float scatter[BATCH];               /* diffuse or diffuse_back */
    float shine[BATCH];                 /* 1 where highlights are possible */
    bool any;
};

/* ---- light arriving ---- */

KERNEL static void cosines(int n, const struct view *restrict v, struct arrival *restrict a)
{
    for (int i = 0; i < n; i++)
        a->cosine[i] = v->nx[i] * a->x[i] + v->ny[i] * a->y[i] + v->nz[i] * a->z[i];
}

KERNEL static void narrow(int n, const double *restrict from, float *restrict to)
{
    for (int i = 0; i < n; i++)
        to[i] = (float)from[i];
}

static size_t shadow_slot(const struct batch *b, int i, uint32_t lamp)
{
    return (size_t)lamp * BATCH + b->slot[i];
}

/* Which side of the surface the lamp lights: 2.4, step 2. */
static bool is_back(const struct batch *b, int i, const struct arrival *a)
{
    return a->cosine[i] < no_light && !b->surface[i]->double_illuminate;
}

static bool is_lit(const struct batch *b, const struct gloss *g, int i, const struct beams *beam,
                   const struct arrival *a)
{
    return beam->share[i] != 0 && !(is_back(b, i, a) && g->diffuse_back == 0);
}

/* Looks for the shadows that matter and are not known from another layer. */
static void find_shadows(struct worker *w, const struct batch *b, const struct gloss *g,
                         uint32_t lamp, const struct beams *beam, const struct arrival *a)
{
    struct shadow_query q[BATCH];
    size_t slot[BATCH];
    rgb through[BATCH];
    int n = 0;

    for (int i = 0; i < b->n; i++) {
        size_t at = shadow_slot(b, i, lamp);
        if (!is_lit(b, g, i, beam, a) || w->shadows.known[at])
            continue;
        q[n] = (struct shadow_query) {
            vec(b->x[i], b->y[i], b->z[i]), vec(b->nx[i], b->ny[i], b->nz[i]),
            vec(beam->dx[i], beam->dy[i], beam->dz[i]), w->point[b->hit[i]].slack, beam->far[i],
            lamp, w->now.inside[b->hit[i]] };
        slot[n++] = at;
    }
    if (n)
        shadow_through(w, n, q, through);
    for (int k = 0; k < n; k++) {
        w->shadows.through[slot[k]] = through[k];
        w->shadows.known[slot[k]] = true;
    }
}

static void arrive(struct worker *w, const struct batch *b, const struct gloss *g, int i,
                   uint32_t lamp, const struct beams *beam, struct arrival *a)
{
    const struct lamp *l = &w->shader->lamp[lamp];
    bool back = is_back(b, i, a);
    rgb light = rgb_scale(l->colour, beam->share[i]);

    a->r[i] = a->g[i] = a->b[i] = a->scatter[i] = a->shine[i] = 0;
    if (!is_lit(b, g, i, beam, a))
        return;
    if (!l->shadowless)
        light = rgb_mul(light, w->shadows.through[shadow_slot(b, i, lamp)]);
    if (largerf(fabsf(light.r), largerf(fabsf(light.g), fabsf(light.b))) < no_light)
        return;
    a->r[i] = light.r;
    a->g[i] = light.g;
    a->b[i] = light.b;
    a->scatter[i] = back ? g->diffuse_back : g->diffuse;
    a->shine[i] = !back && !l->shadowless;
    a->any = true;
}

static void light_arrives(struct worker *w, const struct batch *b, const struct gloss *g,
                          const float *alive, const struct view *v, uint32_t lamp,
                          struct arrival *a)
{
    struct beams beam;

    lamp_beams(&w->shader->lamp[lamp], b->n, b->x, b->y, b->z, &beam);
    narrow(b->n, beam.dx, a->x);
    narrow(b->n, beam.dy, a->y);
    narrow(b->n, beam.dz, a->z);
    cosines(b->n, v, a);
    a->any = false;
    for (int i = 0; i < b->n; i++)
        if (alive[i] == 0)
            beam.share[i] = 0;
    if (!w->shader->lamp[lamp].shadowless)
        find_shadows(w, b, g, lamp, &beam, a);
    for (int i = 0; i < b->n; i++)
        arrive(w, b, g, i, lamp, &beam, a);
}

/* ---- diffuse light and highlights ---- */

KERNEL static void scatter(int n, const float *restrict power, const float *restrict much,
                           const float *restrict opaque, float *restrict out)
{
    for (int i = 0; i < n; i++)
        out[i] = power[i] * much[i] * opaque[i];
}

/* A repeatable number in 0..1 for a point, whatever order points come in. */
static float grain(const struct batch *b, int i, uint32_t lamp)
{
    uint64_t bits[3] = { 0 };
    uint64_t h = 0x9e3779b97f4a7c15 * (lamp + 1);
    const double at[] = { b->x[i], b->y[i], b->z[i] };

    memcpy(bits, at, sizeof bits);
    for (int k = 0; k < 3; k++) {
        h = (h ^ bits[k]) * 0xbf58476d1ce4e5b9;
        h ^= h >> 29;
    }
    return (float)(h >> 40) / (float)(1 << 24);
}

static void diffuse_light(const struct batch *b, const struct coat *c, const struct arrival *a,
                          uint32_t lamp, float *out)
{
    float level[BATCH], power[BATCH];
    bool is_lambert = c->gloss->brilliance == 1;

    for (int i = 0; i < b->n; i++)
        level[i] = fabsf(a->cosine[i]);
    if (!is_lambert)
        vmath_pow(b->n, level, c->gloss->brilliance, power);
    scatter(b->n, is_lambert ? level : power, a->scatter, c->opaque, out);
    for (int i = 0; c->gloss->crand != 0 && i < b->n; i++)
        out[i] -= grain(b, i, lamp) * c->gloss->crand;
}

/* The mirrored ray against the light. */
KERNEL static void phong_cosines(int n, const struct view *restrict v,
                                 const struct arrival *restrict a, float *restrict out)
{
    for (int i = 0; i < n; i++) {
        float dn = v->dx[i] * v->nx[i] + v->dy[i] * v->ny[i] + v->dz[i] * v->nz[i];
        float dl = v->dx[i] * a->x[i] + v->dy[i] * a->y[i] + v->dz[i] * a->z[i];
        out[i] = dl - 2 * dn * a->cosine[i];
    }
}

/* The half-way vector against the normal. */
KERNEL static void half_cosines(int n, const struct view *restrict v,
                                const struct arrival *restrict a, float *restrict out)
{
    for (int i = 0; i < n; i++) {
        float hx = a->x[i] - v->dx[i], hy = a->y[i] - v->dy[i], hz = a->z[i] - v->dz[i];
        float hn = hx * v->nx[i] + hy * v->ny[i] + hz * v->nz[i];
        float hh = hx * hx + hy * hy + hz * hz;
        out[i] = hn / sqrtf(hh > 1e-30f ? hh : 1e-30f);
    }
}

static void add_power(int n, float strength, float exponent, const float *cosine, float *sum)
{
    float level[BATCH];

    vmath_pow(n, cosine, exponent, level);
    for (int i = 0; i < n; i++)
        sum[i] += strength * level[i];
}

static void highlights(int n, const struct gloss *g, const struct view *v, const struct arrival *a,
                       float *out)
{
    const float least = 0.0008f;        /* POV-Ray's limit for tight highlights */
    float cosine[BATCH];

    memset(out, 0, (size_t)n * sizeof *out);
    if (g->phong != 0) {
        phong_cosines(n, v, a, cosine);
        for (int i = 0; g->phong_size >= 60 && i < n; i++)
            cosine[i] = cosine[i] <= least ? 0 : cosine[i];
        add_power(n, g->phong, g->phong_size, cosine, out);
    }
    if (g->specular != 0) {
        half_cosines(n, v, a, cosine);
        add_power(n, g->specular, g->shininess, cosine, out);
    }
    for (int i = 0; i < n; i++)
        out[i] *= a->shine[i];
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
    for (int i = 0; i < n; i++) {
        out->r[i] += diffuse[i] * c->r[i] * a->r[i];
        out->g[i] += diffuse[i] * c->g[i] * a->g[i];
        out->b[i] += diffuse[i] * c->b[i] * a->b[i];
    }
}

KERNEL static void add_shine(int n, const struct arrival *restrict a, const float *restrict shine,
                             struct coat *restrict out)
{
    for (int i = 0; i < n; i++) {
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

    light_arrives(w, b, g, alive, v, lamp, &a);
    if (!a.any)
        return;
    diffuse_light(b, c, &a, lamp, diffuse);
    if (shines)
        highlights(b->n, g, v, &a, shine);
    if (g->irid != 0 || (shines && g->metallic != 0)) {
        if (!shines)
            memset(shine, 0, sizeof shine);
        add_tinted(w, b->n, v, &a, diffuse, shine, c);
        return;
    }
    add_light(b->n, &a, diffuse, &c->colour, c);
    if (shines)
        add_shine(b->n, &a, shine, c);
}

/* ---- one layer ---- */

static void coat_colours(const struct batch *b, int layer, struct colours *out)
{
    const struct program *p = b->program[0];

    if (p->is_plain)
        for (int i = 0; i < b->n; i++) {
            colour c = b->program[i]->layer[0].paint->colour;
            out->r[i] = c.r;
            out->g[i] = c.g;
            out->b[i] = c.b;
            out->f[i] = c.f;
            out->t[i] = c.t;
        }
    else
        paint_colours(p->layer[layer].paint,
                      &(struct spots) { b->n, b->sx, b->sy, b->sz, b->u, b->v }, out);
}

/* Before 3.7 filter counted as far as the colour was bright (2.3). */
static void opacity(int n, const struct colours *c, bool is_old, float *out)
{
    for (int i = 0; i < n; i++) {
        float bright = is_old ? largerf(c->r[i], largerf(c->g[i], c->b[i])) : 1;
        out[i] = 1 - c->f[i] * bright - c->t[i];
    }
}

static void own_light(int n, struct coat *c)
{
    rgb glow = rgb_add(c->gloss->ambient, c->gloss->emission);

    for (int i = 0; i < n; i++) {
        c->r[i] = c->colour.r[i] * glow.r * c->opaque[i];
        c->g[i] = c->colour.g[i] * glow.g * c->opaque[i];
        c->b[i] = c->colour.b[i] * glow.b * c->opaque[i];
    }
}

static void light_coat(struct worker *w, const struct batch *b, const struct view *v,
                       const float *alive, int layer, struct coat *c)
{
    c->gloss = b->program[0]->layer[layer].gloss;
    coat_colours(b, layer, &c->colour);
    opacity(b->n, &c->colour, w->plan->scene->settings.effective_version < 370, c->opaque);
    own_light(b->n, c);
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

static void mirror_coat(const struct worker *w, const struct batch *b, const struct view *v,
                        const struct coat *c, const float *trans, const float *alive,
                        struct mirror_layer *out)
{
    const struct gloss *g = c->gloss;

    out->power = g->mirror.power;
    for (int i = 0; i < b->n; i++) {
        float cosine = -(v->dx[i] * v->nx[i] + v->dy[i] * v->ny[i] + v->dz[i] * v->nz[i]);
        rgb share = g->mirror.fresnel
            ? fresnel_share(g, fresnel_index(w, b->hit[i], b->surface[i]), cosine)
            : angle_share(g, cosine);
        float most = fmaxf(rgb_max(g->mirror.low), rgb_max(g->mirror.high));
        if (g->mirror.metallic != 0)
            share = rgb_mul(share, metal_tint(g->mirror.metallic, cosine, colour_at(&c->colour, i)));
        if (g->irid != 0)
            share = rgb_mul(share, film_tint(g, w->plan->scene->settings.irid_wavelength,
                                             2 * fabsf(cosine)));
        if (g->mirror.fresnel)
            most = rgb_max(share);
        share = rgb_scale(share, alive[i]);
        out->r[i] = share.r;
        out->g[i] = share.g;
        out->b[i] = share.b;
        out->adc[i] = w->now.adc[b->hit[i]] * trans[i] * most;
    }
}

/* ---- layers ---- */

/* What is gathered from the top layer down. */
struct stack {
    float r[BATCH], g[BATCH], b[BATCH];         /* the light so far */
    float fr[BATCH], fg[BATCH], fb[BATCH];      /* what gets through so far */
    float trans[BATCH], alive[BATCH];           /* its brightness; 1 while that is enough */
};

static void stack_start(struct stack *s, int n)
{
    for (int i = 0; i < n; i++)
        s->r[i] = s->g[i] = s->b[i] = 0;
    for (int i = 0; i < n; i++)
        s->fr[i] = s->fg[i] = s->fb[i] = s->trans[i] = s->alive[i] = 1;
}

KERNEL static void stack_light(int n, const struct coat *restrict c, struct stack *restrict s)
{
    for (int i = 0; i < n; i++) {
        s->r[i] += s->alive[i] * s->fr[i] * c->r[i];
        s->g[i] += s->alive[i] * s->fg[i] * c->g[i];
        s->b[i] += s->alive[i] * s->fb[i] * c->b[i];
    }
}

static float left(float share) { return share > 0 ? 1 - share : 1; }

static void stack_filter(int n, const struct coat *c, const struct mirror_layer *m,
                         double adc_bailout, struct stack *s)
{
    for (int i = 0; i < n; i++) {
        if (s->alive[i] == 0)
            continue;
        s->fr[i] *= c->colour.r[i] * c->colour.f[i] + c->colour.t[i];
        s->fg[i] *= c->colour.g[i] * c->colour.f[i] + c->colour.t[i];
        s->fb[i] *= c->colour.b[i] * c->colour.f[i] + c->colour.t[i];
        if (m && c->gloss->conserve_energy) {
            s->fr[i] *= left(m->r[i]);
            s->fg[i] *= left(m->g[i]);
            s->fb[i] *= left(m->b[i]);
        }
        float grey = fabsf(rgb_grey(rgb_of(s->fr[i], s->fg[i], s->fb[i])));
        s->trans[i] = grey < 1 ? grey : 1;
        s->alive[i] = (double)s->trans[i] > adc_bailout;
    }
}

static void expose(struct worker *w, const struct batch *b, const struct stack *s)
{
    for (int i = 0; i < b->n; i++) {
        uint32_t k = b->hit[i];
        rgb light = rgb_scale(rgb_of(s->r[i], s->g[i], s->b[i]), b->share[i]);
        rgb weight = rgb_of(w->now.red[k], w->now.green[k], w->now.blue[k]);
        film_add(&w->film, w->now.pixel[k], rgb_mul(light, weight));
    }
}

static void reserve_mirrors(struct worker *w, int n)
{
    if (n <= w->room_mirror)
        return;
    w->room_mirror = n;
    w->mirror = arena_array(&w->mem, (size_t)n, sizeof *w->mirror);
}

static bool any_alive(const struct stack *s, int n)
{
    for (int i = 0; i < n; i++)
        if (s->alive[i] != 0)
            return true;
    return false;
}

static void view_of(const struct batch *b, struct view *v)
{
    narrow(b->n, b->nx, v->nx);
    narrow(b->n, b->ny, v->ny);
    narrow(b->n, b->nz, v->nz);
    narrow(b->n, b->dx, v->dx);
    narrow(b->n, b->dy, v->dy);
    narrow(b->n, b->dz, v->dz);
}

static void shade_layers(struct worker *w, const struct batch *b)
{
    const struct program *p = b->program[0];
    double bailout = w->plan->scene->settings.adc_bailout;
    struct stack s;
    struct coat c;
    struct view v;
    int n_mirror = 0;

    reserve_mirrors(w, p->n_layer);
    view_of(b, &v);
    stack_start(&s, b->n);
    for (int k = 0; k < p->n_layer && any_alive(&s, b->n); k++) {
        struct mirror_layer *m = NULL;
        light_coat(w, b, &v, s.alive, k, &c);
        stack_light(b->n, &c, &s);
        if (c.gloss->has_mirror) {
            m = &w->mirror[n_mirror++];
            mirror_coat(w, b, &v, &c, s.trans, s.alive, m);
        }
        stack_filter(b->n, &c, m, bailout, &s);
    }
    expose(w, b, &s);
    for (int i = 0; i < b->n; i++)
        s.trans[i] *= s.alive[i];
    if (n_mirror || any_alive(&s, b->n))
        bounce(w, b, &(struct leaving) { s.fr, s.fg, s.fb, s.trans, w->mirror, n_mirror });
}

/* ---- texture maps: every entry with those points that it has a share in ---- */

static void copy_point(struct batch *to, int k, const struct batch *from, int i)
{
    to->hit[k] = from->hit[i];
    to->slot[k] = from->slot[i];
    to->surface[k] = from->surface[i];
    to->x[k] = from->x[i];
    to->y[k] = from->y[i];
    to->z[k] = from->z[i];
    to->u[k] = from->u[i];
    to->v[k] = from->v[i];
    to->nx[k] = from->nx[i];
    to->ny[k] = from->ny[i];
    to->nz[k] = from->nz[i];
    to->dx[k] = from->dx[i];
    to->dy[k] = from->dy[i];
    to->dz[k] = from->dz[i];
}

static void shade_batch(struct worker *w, const struct batch *b);

static void shade_entry(struct worker *w, const struct batch *b, const struct program *entry,
                        const struct spots *s, const float *share)
{
    struct batch part;

    part.n = 0;
    for (int i = 0; i < b->n; i++) {
        if (share[i] == 0)
            continue;
        int k = part.n++;
        copy_point(&part, k, b, i);
        part.program[k] = entry;
        part.share[k] = b->share[i] * share[i];
        part.sx[k] = s->x[i];
        part.sy[k] = s->y[i];
        part.sz[k] = s->z[i];
    }
    if (part.n)
        shade_batch(w, &part);
}

static void shade_map(struct worker *w, const struct batch *b)
{
    const struct program *p = b->program[0];
    double x[BATCH], y[BATCH], z[BATCH];
    struct map_place where[BATCH];
    struct spots s = { b->n, b->sx, b->sy, b->sz, b->u, b->v };
    float share[BATCH];

    gauge_read(p->gauge, &s, x, y, z, where);
    struct spots inner = { b->n, x, y, z, b->u, b->v };
    for (int e = 0; e < p->gauge->n_key; e++) {
        for (int i = 0; i < b->n; i++)
            share[i] = where[i].before == e ? 1 - where[i].share
                     : where[i].after == e ? where[i].share : 0;
        shade_entry(w, b, p->entry[e], &inner, share);
    }
}

static void shade_average(struct worker *w, const struct batch *b)
{
    const struct program *p = b->program[0];
    double x[BATCH], y[BATCH], z[BATCH];
    struct spots s = { b->n, b->sx, b->sy, b->sz, b->u, b->v };
    float share[BATCH];

    chain_walk(&p->gauge->chain, &s, x, y, z);
    struct spots inner = { b->n, x, y, z, b->u, b->v };
    for (int e = 0; e < p->gauge->n_key; e++) {
        for (int i = 0; i < b->n; i++)
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

/* ---- gathering ---- */

static void gather(const struct worker *w, const struct task *task, int i, struct batch *b)
{
    uint32_t hit = task[i].hit;
    const struct surface_point *p = &w->point[hit];
    const struct surface *s = &w->plan->surface[p->surface];
    vec3 d = wave_at(&w->now, (int)hit).dir;
    vec3 n = vec_dot(p->normal, d) > 0 ? vec_neg(p->normal) : p->normal;
    double at[5];

    spot_of(s, p, at);
    b->hit[i] = hit;
    b->slot[i] = (uint16_t)i;
    b->share[i] = task[i].share;
    b->program[i] = task[i].program;
    b->surface[i] = s;
    b->x[i] = p->point.x;
    b->y[i] = p->point.y;
    b->z[i] = p->point.z;
    b->sx[i] = at[0];
    b->sy[i] = at[1];
    b->sz[i] = at[2];
    b->u[i] = at[3];
    b->v[i] = at[4];
    b->nx[i] = n.x;
    b->ny[i] = n.y;
    b->nz[i] = n.z;
    b->dx[i] = d.x;
    b->dy[i] = d.y;
    b->dz[i] = d.z;
}

/* As vec_unit, to the bit, for arrays. */
KERNEL static void unit_length(int n, double *restrict x, double *restrict y, double *restrict z)
{
    for (int i = 0; i < n; i++) {
        double big = larger(fabs(x[i]), larger(fabs(y[i]), fabs(z[i])));
        double rescue = 1 / big;
        double scale = big < 1e-100 || big > 1e100 ? rescue : 1;
        double a = x[i] * scale, b = y[i] * scale, c = z[i] * scale;
        double inverse = 1 / sqrt(a * a + b * b + c * c);
        bool is_none = !(big > 0) || big > DBL_MAX;
        x[i] = is_none ? 0 : a * inverse;
        y[i] = is_none ? 0 : b * inverse;
        z[i] = is_none ? 0 : c * inverse;
    }
}

void shade_tasks(struct worker *w, const struct task *task, int n)
{
    struct batch b;

    b.n = n;
    for (int i = 0; i < n; i++)
        gather(w, task, i, &b);
    unit_length(n, b.nx, b.ny, b.nz);
    for (size_t k = 0; k < w->shader->n_lamp; k++)
        memset(w->shadows.known + k * BATCH, 0, (size_t)n * sizeof *w->shadows.known);
    shade_batch(w, &b);
}
