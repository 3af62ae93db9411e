/* bounce.c: reflected and refracted rays (facts shading.md 2.7, 3.1, 3.3, 3.4). */
#include "trace/shade.h"
#include "trace/shadow.h"

static double ior_of(const struct insides *in, uint32_t list)
{
    return list ? surface_ior(in->item[list].surface) : 1;
}

double fresnel_index(const struct worker *w, uint32_t hit, const struct surface *s)
{
    const struct insides *in = &w->insides;
    uint32_t list = w->now.inside[hit];
    double own = surface_ior(s);

    if (!list)
        return own;
    if (!insides_holds(in, list, s, w->meeting[hit].instance))
        return own / ior_of(in, list);
    if (!in->item[list].before)
        return 1 / own;
    return ior_of(in, list) / own;
}

/* One point that rays leave. */
struct corner {
    struct worker *w;
    const struct batch *b;
    int i;
    uint32_t hit;                       /* number of the ray that came */
    vec3 point, normal, dir;            /* normal: turned to the viewer */
    double slack;
    const struct surface *surface;
};

static struct corner corner_at(struct worker *w, const struct batch *b, int i)
{
    return (struct corner) {
        w, b, i, b->hit[i], vec(b->x[i], b->y[i], b->z[i]),
        vec(b->nx[i], b->ny[i], b->nz[i]), vec(b->dx[i], b->dy[i], b->dz[i]),
        w->point[b->hit[i]].slack, b->surface[i] };
}

static rgb weight_of(const struct corner *c)
{
    const struct wave *w = &c->w->now;

    return rgb_scale(rgb_of(w->red[c->hit], w->green[c->hit], w->blue[c->hit]),
                     c->b->share[c->i]);
}

/* Is a further ray allowed (3.1)?  What is refused is black. */
static bool is_allowed(const struct corner *c, float adc)
{
    const struct settings *s = &c->w->plan->scene->settings;

    return c->w->now.depth[c->hit] + 1 < s->max_trace_level && (double)adc >= s->adc_bailout;
}

static vec3 mirrored(vec3 d, vec3 n)
{
    return vec_fma(d, -2 * vec_dot(d, n), n);
}

static struct wave_ray ray_from(const struct corner *c, vec3 dir, double side)
{
    const struct wave *w = &c->w->now;

    return (struct wave_ray) {
        .ray = { vec_fma(c->point, side * c->slack, c->normal), vec_unit_again(dir) },
        .weight = weight_of(c), .pixel = w->pixel[c->hit], .inside = w->inside[c->hit],
        .depth = (uint16_t)(w->depth[c->hit] + 1), .mask = w->mask[c->hit] };
}

static void reflect(const struct corner *c, rgb share, float adc, float power)
{
    struct worker *w = c->w;

    if (!is_allowed(c, adc))
        return;
    struct wave_ray r = ray_from(c, mirrored(c->dir, c->normal), 1);
    r.weight = rgb_mul(r.weight, share);
    if (power != 1) {
        r.pixel = film_branch(&w->film, r.pixel, r.weight, power);
        r.weight = rgb_of(1, 1, 1);
    }
    r.adc = adc;
    r.mask = RAY_REFLECTED;
    w->counts.reflected++;
    wave_push(&w->next, &r);
}

/* The index across the surface, and the interiors behind it. */
static double cross(const struct corner *c, uint32_t *list)
{
    struct insides *in = &c->w->insides;
    uint32_t instance = c->w->meeting[c->hit].instance, now = *list;
    double own = surface_ior(c->surface);

    if (now && inside_is(&in->item[now], c->surface, instance)) {
        *list = insides_leave(in, now, c->surface, instance);
        return own / ior_of(in, *list);
    }
    if (insides_holds(in, now, c->surface, instance)) {
        *list = insides_leave(in, now, c->surface, instance);
        return 1;
    }
    *list = insides_enter(in, now, c->surface, instance);
    return ior_of(in, now) / own;
}

/* What the way to this surface took, if it led through the surface's own inside. */
static rgb faded_on_the_way(const struct corner *c)
{
    const struct worker *w = c->w;

    if (!c->surface->interior
        || !insides_holds(&w->insides, w->now.inside[c->hit], c->surface,
                          w->meeting[c->hit].instance))
        return rgb_of(1, 1, 1);
    return interior_fade(c->surface->interior, w->meeting[c->hit].t);
}

/* finish { refraction } of old scenes dims what comes through. */
static rgb old_refraction(const struct corner *c, rgb light)
{
    const struct texture *t = c->surface->texture;

    if (t->kind != TEXTURE_PLAIN || t->finish->refraction == 1)
        return light;
    return rgb_scale(light, (float)t->finish->refraction);
}

static float largest(rgb c)
{
    float r = fabsf(c.r), g = fabsf(c.g), b = fabsf(c.b);
    float most = r > g ? r : g;

    return most > b ? most : b;
}

/* Through the surface, or back from it if the angle is too flat: then true. */
static bool refract(const struct corner *c, rgb filter, float trans)
{
    struct worker *w = c->w;
    float adc = w->now.adc[c->hit] * largest(filter);
    uint32_t behind = w->now.inside[c->hit];
    double eta = cross(c, &behind);
    double cosine = fabs(vec_dot(c->dir, c->normal));
    double t = 1 + eta * eta * (cosine * cosine - 1);
    rgb fade = faded_on_the_way(c);

    if (t < 0) {
        reflect(c, fade, adc, 1);
        return true;
    }
    if (!is_allowed(c, adc))
        return false;
    bool is_straight = fabs(eta - 1) < 1e-10;
    vec3 dir = is_straight ? c->dir
                           : vec_fma(vec_scale(c->dir, eta), eta * cosine - sqrt(t), c->normal);
    struct wave_ray r = ray_from(c, dir, -1);
    r.weight = old_refraction(c, rgb_mul(r.weight, rgb_mul(filter, fade)));
    r.alpha = w->now.alpha[c->hit] * c->b->share[c->i] * rgb_grey(fade) * trans;
    r.adc = adc;
    r.inside = behind;
    r.depth = (uint16_t)(r.depth - is_straight);
    w->counts.refracted++;
    wave_push(&w->next, &r);
    return false;
}

/* Point by point, so that the order of a pixel's rays depends on that pixel only. */
void bounce(struct worker *w, const struct batch *b, const struct leaving *l)
{
    for (int i = 0; i < b->n; i++) {
        struct corner c = corner_at(w, b, i);
        bool is_total = false;
        if (l->trans[i] > 0)
            is_total = refract(&c, rgb_of(l->fr[i], l->fg[i], l->fb[i]), l->trans[i]);
        if (is_total)
            continue;
        for (int k = 0; k < l->n_mirror; k++) {
            const struct mirror_layer *m = &l->mirror[k];
            rgb share = rgb_of(m->r[i], m->g[i], m->b[i]);
            if (share.r != 0 || share.g != 0 || share.b != 0)
                reflect(&c, share, m->adc[i], m->power);
        }
    }
}
