/* sky.c: what is seen where nothing is (facts shading.md 3.6), and fog (3.7). */
#include "trace/sky.h"

#include <math.h>

#include "math/noise.h"

static const double endless = 2e10;     /* POV-Ray's depth of a ray that meets nothing */

const struct sky *sky_new(struct arena *mem, const struct scene *scene)
{
    struct sky *s = arena_alloc(mem, sizeof *s);
    const struct sky_sphere *sphere = scene->sky_sphere;

    s->is_old = scene->settings.effective_version < 370;
    s->transmit = 1;
    if (scene->has_background) {
        s->transmit = s->is_old ? 1 : scene->background.t;
        s->background = rgb_scale(colour_rgb(scene->background), s->is_old ? 1 : 1 - s->transmit);
    }
    if (!sphere)
        return s;
    const struct paint **paint = arena_array(mem, sphere->n_pigment, sizeof *paint);
    for (size_t i = 0; i < sphere->n_pigment; i++)
        paint[i] = paint_new(mem, sphere->pigment[i], &sphere->place);
    s->paint = paint;
    s->n_paint = (int)sphere->n_pigment;
    s->emission = sphere->emission;
    return s;
}

/* ---- sky_sphere ---- */

/* Colours seen through so far, from the top pigment down. */
struct view {
    rgb light, filter;
    float f, t, trans;                  /* products of filter and transmit, for old scenes */
};

static rgb clear_part(colour c)
{
    return rgb_of(c.r * c.f + c.t, c.g * c.f + c.t, c.b * c.f + c.t);
}

static void lay_under(const struct sky *s, struct view *v, colour c)
{
    float opaque = 1 - c.f - c.t;

    if (s->is_old) {
        v->light = rgb_add(v->light, rgb_scale(colour_rgb(c), opaque * v->trans));
        v->filter = rgb_mul(v->filter, colour_rgb(c));
        v->f *= c.f;
        v->t *= c.t;
        v->trans = fabsf(v->f) + fabsf(v->t);
        return;
    }
    rgb own = rgb_mul(rgb_mul(colour_rgb(c), s->emission), v->filter);
    v->light = rgb_add(v->light, rgb_scale(own, opaque));
    v->filter = rgb_mul(v->filter, clear_part(c));
}

static void add_ray(struct worker *w, int i, const struct view *v)
{
    const struct sky *s = w->shader->sky;
    rgb weight = rgb_of(w->now.red[i], w->now.green[i], w->now.blue[i]), through = v->filter;

    if (s->is_old && s->n_paint)
        through = clear_part((colour) { through.r, through.g, through.b, v->f, v->t });
    rgb seen = rgb_add(v->light, rgb_mul(s->background, through));
    film_add(&w->film, w->now.pixel[i], rgb_mul(weight, seen));
    float transmit = s->is_old ? s->transmit : s->transmit * rgb_grey(through);
    w->film.sum[w->now.pixel[i]][3] += w->now.alpha[i] * transmit;
}

static void show_batch(struct worker *w, const int ray[], int n)
{
    const struct sky *s = w->shader->sky;
    double x[BATCH], y[BATCH], z[BATCH];
    struct view view[BATCH];
    struct colours c;

    for (int k = 0; k < n; k++) {
        x[k] = w->now.dx[ray[k]];
        y[k] = w->now.dy[ray[k]];
        z[k] = w->now.dz[ray[k]];
        view[k] = (struct view) { { 0, 0, 0 }, { 1, 1, 1 }, 1, 1, 1 };
    }
    for (int p = s->n_paint - 1; p >= 0; p--) {
        paint_colours(s->paint[p], &(struct spots) { n, x, y, z, x, y }, &c);
        for (int k = 0; k < n; k++)
            lay_under(s, &view[k], (colour) { c.r[k], c.g[k], c.b[k], c.f[k], c.t[k] });
    }
    for (int k = 0; k < n; k++)
        add_ray(w, ray[k], &view[k]);
}

/* Nothing but a background: the same light for all. */
static void show_plain(struct worker *w)
{
    const struct sky *s = w->shader->sky;
    const struct view all = { { 0, 0, 0 }, { 1, 1, 1 }, 1, 1, 1 };

    if (s->transmit == 0 && s->background.r == 0 && s->background.g == 0 && s->background.b == 0)
        return;
    for (int i = 0; i < w->now.n; i++)
        if (w->meeting[i].leaf == NO_LEAF)
            add_ray(w, i, &all);
}

static void show_painted(struct worker *w)
{
    int ray[BATCH], n = 0;

    for (int i = 0; i < w->now.n; i++) {
        if (w->meeting[i].leaf != NO_LEAF)
            continue;
        ray[n++] = i;
        if (n == BATCH) {
            show_batch(w, ray, n);
            n = 0;
        }
    }
    if (n)
        show_batch(w, ray, n);
}

void sky_show(struct worker *w)
{
    if (w->shader->sky->n_paint)
        show_painted(w);
    else
        show_plain(w);
}

/* ---- fog ---- */

/* The mean density of a ground fog over heights s to e: 1 below 0, 1 / (1 + h h) above. */
static double ground_density(double s, double e)
{
    if (s <= 0 && e <= 0)
        return 1;
    if (s <= 0)
        return (atan(e) - s) / (e - s);
    if (e <= 0)
        return (atan(s) - e) / (s - e);
    if (fabs(s - e) <= 1e-10)
        return 1 / (s * s + 1);
    return (atan(s) - atan(e)) / (s - e);
}

static double density(const struct fog *f, struct ray ray, double depth)
{
    if (f->type != 2)
        return 1;
    vec3 up = vec_unit(mat_direction(&f->place.to, f->up));
    double start = (vec_dot(ray.origin, up) - f->offset) / f->alt;
    double end = (vec_dot(ray_at(ray, depth), up) - f->offset) / f->alt;
    return ground_density(start, end);
}

static double stirred(const struct fog *f, int generator, struct ray ray, double depth)
{
    if (!(vec_largest(f->turbulence) > 0))
        return depth;
    vec3 p = vec_mul(ray_at(ray, depth / 2), f->turbulence);
    double t = noise_turbulence(generator, p, f->octaves, (float)f->omega, (float)f->lambda);
    return depth * (1 - exp(-depth / f->distance) * fmin(1, t * f->turb_depth));
}

/* What is left of light from the far end, and what the fog adds. */
static rgb one_fog(const struct fog *f, int generator, struct ray ray, double depth, rgb *add)
{
    double way = stirred(f, generator, ray, depth);
    float left = (float)exp(-way * density(f, ray, depth) / f->distance);
    rgb c = colour_rgb(f->colour);

    left = left > f->colour.t ? left : f->colour.t;
    *add = rgb_add(*add, rgb_scale(c, 1 - left));
    float keep = left * (1 - f->colour.f), tint = left * f->colour.f;
    return rgb_of(keep + tint * c.r, keep + tint * c.g, keep + tint * c.b);
}

static bool in_open_air(const struct worker *w, uint32_t list)
{
    for (; list; list = w->insides.item[list].before)
        if (!w->insides.item[list].surface->hollow)
            return false;
    return true;
}

static void fog_ray(struct worker *w, int i)
{
    const struct scene *s = w->plan->scene;
    double depth = w->meeting[i].leaf == NO_LEAF ? endless : w->meeting[i].t;
    rgb weight = rgb_of(w->now.red[i], w->now.green[i], w->now.blue[i]);
    rgb left = rgb_of(1, 1, 1), add = rgb_of(0, 0, 0);

    for (size_t k = 0; k < s->n_fog; k++)
        if (fabs(s->fog[k]->distance) > 1e-10)
            left = rgb_mul(left, one_fog(s->fog[k], s->settings.noise_generator,
                                         wave_at(&w->now, i), depth, &add));
    film_add(&w->film, w->now.pixel[i], rgb_mul(weight, add));
    w->now.red[i] *= left.r;
    w->now.green[i] *= left.g;
    w->now.blue[i] *= left.b;
    w->now.alpha[i] *= rgb_grey(left);
}

void sky_fog(struct worker *w)
{
    if (w->plan->scene->n_fog == 0)
        return;
    for (int i = 0; i < w->now.n; i++)
        if (in_open_air(w, w->now.inside[i]))
            fog_ray(w, i);
}
