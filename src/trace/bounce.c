/* bounce.c: reflected and refracted rays (facts shading.md 2.7, 3.1, 3.3, 3.4). */
#include "trace/shade.h"

#include "math/kernel.h"
#include "trace/shadow.h"

static double ior_of(const struct insides *in, uint32_t list)
{
    return list ? surface_ior(in->item[list].surface) : 1;
}

double fresnel_index(const struct worker *w, uint32_t ray, const struct surface *s)
{
    const struct insides *in = &w->insides;
    uint32_t list = w->now.inside[ray];
    double own = surface_ior(s);

    if (!list)
        return own;
    if (!insides_holds(in, list, s, w->meeting[ray].instance))
        return own / ior_of(in, list);
    if (!in->item[list].before)
        return 1 / own;
    return ior_of(in, list) / own;
}

/* ---- rays that leave ---- */

/* New rays of the next wave whose way is not known yet.
 * direction = along * d + aside * n, of the ray that came and of the normal. */
struct exits {
    int n;
    uint16_t at[BATCH];                 /* the point */
    double along[BATCH], aside[BATCH];
    double side[BATCH];                 /* of the surface: 1 or -1 */
};

struct corner {
    struct worker *w;
    const struct batch *b;
    const struct leaving *l;
    int max_trace_level;
    double adc_bailout;
    double cosine[BATCH];               /* of the ray that came and the normal: negative */
    struct exits exits;
};

/* As vec_unit_again, to the bit, but for what is far from unit length. */
static void aim(const struct points *restrict p, const struct exits *restrict e,
                double *restrict x, double *restrict y, double *restrict z,
                double *restrict dx, double *restrict dy, double *restrict dz)
{
    for (int k = 0; k < e->n; k++) {
        int i = e->at[k];
        double off = e->side[k] * p->slack[i];
        double a = fma(e->aside[k], p->nx[i], p->dx[i] * e->along[k]);
        double b = fma(e->aside[k], p->ny[i], p->dy[i] * e->along[k]);
        double c = fma(e->aside[k], p->nz[i], p->dz[i] * e->along[k]);
        double square = a * a + b * b + c * c;
        double scale = fabs(square - 1) < 1e-8 ? 1.5 - 0.5 * square : 1 / sqrt(square);
        x[k] = fma(off, p->nx[i], p->x[i]);
        y[k] = fma(off, p->ny[i], p->y[i]);
        z[k] = fma(off, p->nz[i], p->z[i]);
        dx[k] = a * scale;
        dy[k] = b * scale;
        dz[k] = c * scale;
    }
}

static void leave(struct corner *c)
{
    struct exits *e = &c->exits;
    struct wave *next = &c->w->next;
    int n = next->n;

    aim(&c->b->at, e, next->x + n, next->y + n, next->z + n, next->dx + n, next->dy + n,
        next->dz + n);
    next->n += e->n;
    e->n = 0;
    wave_reserve(next, next->n + BATCH);
}

/* One more from point i, of this weight beside what the ray that came had;
 * its number in the next wave. */
static int add_exit(struct corner *c, int i, rgb weight, float adc, double along, double aside,
                    double side)
{
    const struct wave *now = &c->w->now;
    struct wave *next = &c->w->next;
    struct exits *e = &c->exits;

    if (e->n == BATCH)
        leave(c);
    uint32_t ray = c->b->at.index[i];
    float share = c->b->share[i];
    int k = e->n++, to = next->n + k;
    e->at[k] = (uint16_t)i;
    e->along[k] = along;
    e->aside[k] = aside;
    e->side[k] = side;
    next->red[to] = now->red[ray] * share * weight.r;
    next->green[to] = now->green[ray] * share * weight.g;
    next->blue[to] = now->blue[ray] * share * weight.b;
    next->alpha[to] = 0;
    next->adc[to] = adc;
    next->pixel[to] = now->pixel[ray];
    next->inside[to] = now->inside[ray];
    next->depth[to] = (uint16_t)(now->depth[ray] + 1);
    next->mask[to] = now->mask[ray];
    return to;
}

/* Is a further ray allowed (3.1)?  What is refused is black. */
static bool is_allowed(const struct corner *c, int i, float adc)
{
    return c->w->now.depth[c->b->at.index[i]] + 1 < c->max_trace_level
           && (double)adc >= c->adc_bailout;
}

/* reflection_exponent: what is seen is gathered by itself first. */
static void branch_off(struct worker *w, int ray, float power)
{
    struct wave *next = &w->next;
    rgb weight = rgb_of(next->red[ray], next->green[ray], next->blue[ray]);

    next->pixel[ray] = film_branch(&w->film, next->pixel[ray], weight, power);
    next->red[ray] = next->green[ray] = next->blue[ray] = 1;
}

static void reflect(struct corner *c, int i, rgb share, float adc, float power)
{
    if (!is_allowed(c, i, adc))
        return;
    int ray = add_exit(c, i, share, adc, 1, -2 * c->cosine[i], 1);
    c->w->next.mask[ray] = RAY_REFLECTED;
    c->w->counts.reflected++;
    if (power != 1)
        branch_off(c->w, ray, power);
}

/* ---- refraction ---- */

/* The index across the surface, and the interiors behind it. */
static double cross(const struct corner *c, int i, uint32_t *list)
{
    struct insides *in = &c->w->insides;
    const struct surface *s = c->b->at.surface[i];
    uint32_t instance = c->w->meeting[c->b->at.index[i]].instance, now = *list;
    double own = surface_ior(s);

    if (now && inside_is(&in->item[now], s, instance)) {
        *list = insides_leave(in, now, s, instance);
        return own / ior_of(in, *list);
    }
    if (insides_holds(in, now, s, instance)) {
        *list = insides_leave(in, now, s, instance);
        return 1;
    }
    *list = insides_enter(in, now, s, instance);
    return ior_of(in, now) / own;
}

/* What the way to this surface took, if it led through the surface's own inside. */
static rgb faded_on_the_way(const struct corner *c, int i)
{
    const struct worker *w = c->w;
    const struct surface *s = c->b->at.surface[i];
    uint32_t ray = c->b->at.index[i];

    if (!s->interior
        || !insides_holds(&w->insides, w->now.inside[ray], s, w->meeting[ray].instance))
        return rgb_of(1, 1, 1);
    return interior_fade(s->interior, w->meeting[ray].t);
}

/* finish { refraction } of old scenes dims what comes through. */
static float old_refraction(const struct surface *s)
{
    const struct texture *t = s->texture;

    return t->kind == TEXTURE_PLAIN ? (float)t->finish->refraction : 1;
}

static float largest(rgb c)
{
    float r = fabsf(c.r), g = fabsf(c.g), b = fabsf(c.b);
    float most = r > g ? r : g;

    return most > b ? most : b;
}

static void refract_one(struct corner *c, int i, rgb weight, float adc, float alpha, double eta,
                        double root, uint32_t behind)
{
    struct wave *next = &c->w->next;
    bool is_straight = fabs(eta - 1) < 1e-10;
    double along = is_straight ? 1 : eta;
    double aside = is_straight ? 0 : eta * fabs(c->cosine[i]) - root;
    int ray = add_exit(c, i, weight, adc, along, aside, -1);

    next->alpha[ray] = alpha;
    next->inside[ray] = behind;
    next->depth[ray] = (uint16_t)(next->depth[ray] - is_straight);
    c->w->counts.refracted++;
}

/* Through the surface, or back from it if the angle is too flat: then true. */
static bool refract(struct corner *c, int i)
{
    const struct wave *now = &c->w->now;
    uint32_t ray = c->b->at.index[i], behind = now->inside[ray];
    rgb filter = rgb_of(c->l->fr[i], c->l->fg[i], c->l->fb[i]);
    float adc = now->adc[ray] * largest(filter);
    double eta = cross(c, i, &behind), cosine = c->cosine[i];
    double t = 1 + eta * eta * (cosine * cosine - 1);
    rgb fade = c->w->shader->has_fading ? faded_on_the_way(c, i) : rgb_of(1, 1, 1);

    if (t < 0) {
        reflect(c, i, fade, adc, 1);
        return true;
    }
    if (!is_allowed(c, i, adc))
        return false;
    rgb weight = rgb_scale(rgb_mul(filter, fade), old_refraction(c->b->at.surface[i]));
    float alpha = now->alpha[ray] * c->b->share[i] * rgb_grey(fade) * c->l->trans[i];
    refract_one(c, i, weight, adc, alpha, eta, sqrt(t), behind);
    return false;
}

/* ---- all ---- */

static void mirror(struct corner *c, int i)
{
    for (int k = 0; k < c->l->n_mirror; k++) {
        const struct mirror_layer *m = &c->l->mirror[k];
        rgb share = rgb_of(m->r[i], m->g[i], m->b[i]);
        if (share.r != 0 || share.g != 0 || share.b != 0)
            reflect(c, i, share, m->adc[i], m->power);
    }
}

KERNEL static void cosines(const struct points *restrict p, double *restrict out)
{
    for (int i = 0; i < whole(p->n); i++)
        out[i] = p->dx[i] * p->nx[i] + p->dy[i] * p->ny[i] + p->dz[i] * p->nz[i];
}

/* Point by point, so that the order of a pixel's rays depends on that pixel only. */
void bounce(struct worker *w, const struct batch *b, const struct leaving *l)
{
    struct corner c;                    /* large: what is not used stays as it is */

    c.w = w;
    c.b = b;
    c.l = l;
    c.exits.n = 0;
    c.max_trace_level = w->plan->scene->settings.max_trace_level;
    c.adc_bailout = w->plan->scene->settings.adc_bailout;
    wave_reserve(&w->next, w->next.n + BATCH);
    cosines(&b->at, c.cosine);
    for (int i = 0; i < b->at.n; i++) {
        bool is_total = l->trans && l->trans[i] > 0 && refract(&c, i);
        if (!is_total)
            mirror(&c, i);
    }
    if (c.exits.n)
        leave(&c);
}
