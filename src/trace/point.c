/* point.c: the surface where a ray met it, one at a time and in arrays. */
#include "trace/geometry.h"

#include <float.h>
#include <string.h>

#include "trace/world.h"

static const double point_rounding = 0x1p-51;   /* of adding slack to a point, and of the point */

static void mesh_textures(const struct leaf *l, const struct hit *h, struct surface_point *out)
{
    const struct three *texture = l->mesh->mesh->face_texture;

    for (int k = 0; k < 3; k++)
        out->texture[k] = texture ? texture[h->part].of[k] : MESH_NONE;
    out->weight[0] = 1 - h->u - h->v;
    out->weight[1] = h->u;
    out->weight[2] = h->v;
}

static vec2 uv_at(const struct leaf *l, struct ray ray, const struct hit *h, vec3 world)
{
    vec2 otherwise = { world.x, world.y };

    if (!l->ops)
        return mesh_uv(l->mesh, h, otherwise);
    return l->ops->uv ? l->ops->uv(l->shape, ray_at(ray, h->t), h) : otherwise;
}

/* Where a shape of the world stands in its own space: nothing to transform. */
static void plain_point(const struct leaf *l, const struct meeting *m,
                        struct surface_point *out)
{
    vec3 n = l->ops ? l->ops->normal(l->shape, out->point, &m->hit) : mesh_normal(l->mesh, &m->hit);

    out->normal = l->inverse ? vec_neg(n) : n;
    out->surface = l->surface;
    out->local = out->point;
    out->slack = m->hit.slack;
}

static void placed_point(const struct plan *p, const struct leaf *l, const struct ray *ray,
                         const struct meeting *m, struct surface_point *out)
{
    const struct instance *in = m->instance == NO_INSTANCE ? NULL : &p->instance[m->instance];
    struct ray outer = in ? placed_ray(&in->place, *ray) : *ray;
    vec3 normal = leaf_normal(l, leaf_ray(l, outer), &m->hit);
    double slack = leaf_slack(l, outer, &m->hit);

    out->surface = l->surface;
    out->local = out->point;
    if (in) {
        normal = mat_normal(&in->place.from, normal);
        slack = placed_slack(&in->place, in->stretch, in->fuzz, slack, *ray, m->t);
        if (l->surface == NO_LEAF)
            out->surface = in->surface;
        else
            out->local = ray_at(outer, m->t);
    }
    out->normal = normal;
    out->slack = slack;
}

static struct ray innermost(const struct plan *p, const struct leaf *l, const struct ray *ray,
                            const struct meeting *m)
{
    return leaf_ray(l, m->instance == NO_INSTANCE
                           ? *ray : placed_ray(&p->instance[m->instance].place, *ray));
}

/* Twice the slack: the next ray's own search is as uncertain as this one. */
void geometry_point(const struct plan *p, const struct ray *ray, const struct meeting *m,
                    struct surface_point *out)
{
    const struct leaf *l = &p->leaf[m->leaf];

    out->point = ray_at(*ray, m->t);
    if (l->placement || m->instance != NO_INSTANCE)
        placed_point(p, l, ray, m, out);
    else
        plain_point(l, m, out);
    out->slack = 2 * out->slack + point_rounding * vec_largest(out->point);
    out->uv = p->surface[out->surface].wants_uv
                  ? uv_at(l, innermost(p, l, ray, m), &m->hit, out->point) : (vec2) { 0, 0 };
    if (l->ops)
        memset(out->texture, 0xff, sizeof out->texture);
    else
        mesh_textures(l, &m->hit, out);
}

/* --- arrays ---------------------------------------------------------------- */

/* The first that did not meet the same thing as the one at i. */
static int run_end(const struct points *p, const struct meeting *m, int i)
{
    const struct meeting *first = &m[p->index[i]];
    int end = i + 1;

    while (end < p->n && m[p->index[end]].leaf == first->leaf
           && m[p->index[end]].instance == first->instance)
        end++;
    return end;
}

static void pick(const struct rays *rays, const struct meeting *m, struct points *p)
{
    for (int i = 0; i < p->n; i++) {
        uint32_t k = p->index[i];
        double t = m[k].t;
        p->dx[i] = rays->dx[k];
        p->dy[i] = rays->dy[k];
        p->dz[i] = rays->dz[k];
        p->x[i] = fma(t, rays->dx[k], rays->x[k]);
        p->y[i] = fma(t, rays->dy[k], rays->y[k]);
        p->z[i] = fma(t, rays->dz[k], rays->z[k]);
        p->slack[i] = m[k].hit.slack;
    }
}

static void put_normal(struct points *p, int i, vec3 n)
{
    p->nx[i] = n.x;
    p->ny[i] = n.y;
    p->nz[i] = n.z;
}

/* Neighbours mostly meet the same face, whose normal is the same all over. */
static void mesh_normals(const struct leaf *l, const struct meeting *m, struct points *p, int i,
                         int end)
{
    uint32_t face = MESH_NONE;
    vec3 n = { 0, 0, 0 };

    for (; i < end; i++) {
        const struct hit *h = &m[p->index[i]].hit;
        if (h->part != face)
            n = mesh_normal(l->mesh, h);
        face = mesh_is_flat(l->mesh, h->part) ? h->part : MESH_NONE;
        put_normal(p, i, n);
    }
}

static void shape_normals(const struct leaf *l, const struct meeting *m, struct points *p, int i,
                          int end)
{
    vec3 (*normal)(const void *, vec3, const struct hit *) = l->ops->normal;
    const void *shape = l->shape;

    for (; i < end; i++)
        put_normal(p, i, normal(shape, vec(p->x[i], p->y[i], p->z[i]), &m[p->index[i]].hit));
}

static void turn_over(struct points *p, int i, int end)
{
    for (; i < end; i++)
        put_normal(p, i, vec(-p->nx[i], -p->ny[i], -p->nz[i]));
}

static void plain_normals(const struct leaf *l, const struct meeting *m, struct points *p, int i,
                          int end)
{
    if (l->ops)
        shape_normals(l, m, p, i, end);
    else
        mesh_normals(l, m, p, i, end);
    if (l->inverse)
        turn_over(p, i, end);
}

static void placed_normals(const struct plan *plan, const struct leaf *l, const struct rays *rays,
                           const struct meeting *m, struct points *p, int i, int end)
{
    for (; i < end; i++) {
        uint32_t k = p->index[i];
        struct ray ray = { { rays->x[k], rays->y[k], rays->z[k] },
                           { rays->dx[k], rays->dy[k], rays->dz[k] } };
        struct surface_point at;
        at.point = vec(p->x[i], p->y[i], p->z[i]);
        placed_point(plan, l, &ray, &m[k], &at);
        put_normal(p, i, at.normal);
        p->slack[i] = at.slack;
    }
}

static void meet_run(const struct plan *plan, const struct rays *rays, const struct meeting *m,
                     struct points *p, int i, int end)
{
    const struct meeting *first = &m[p->index[i]];
    const struct leaf *l = &plan->leaf[first->leaf];
    const struct surface *s = surface_met(plan, first);

    for (int k = i; k < end; k++)
        p->surface[k] = s;
    if (l->placement || first->instance != NO_INSTANCE)
        placed_normals(plan, l, rays, m, p, i, end);
    else
        plain_normals(l, m, p, i, end);
}

static void fill_up(struct points *p)
{
    int last = p->n - 1;

    for (int i = p->n; i < whole(p->n); i++) {
        p->index[i] = p->index[last];
        p->dx[i] = p->dx[last];
        p->dy[i] = p->dy[last];
        p->dz[i] = p->dz[last];
        p->x[i] = p->x[last];
        p->y[i] = p->y[last];
        p->z[i] = p->z[last];
        p->nx[i] = p->nx[last];
        p->ny[i] = p->ny[last];
        p->nz[i] = p->nz[last];
        p->slack[i] = p->slack[last];
        p->surface[i] = p->surface[last];
    }
}

/* As geometry_point says, and vec_unit, to the bit. */
KERNEL static void finish(struct points *p)
{
    for (int i = 0; i < whole(p->n); i++) {
        double size = larger(fabs(p->x[i]), larger(fabs(p->y[i]), fabs(p->z[i])));
        p->slack[i] = 2 * p->slack[i] + point_rounding * size;
    }
    for (int i = 0; i < whole(p->n); i++) {
        double x = p->nx[i], y = p->ny[i], z = p->nz[i];
        double big = larger(fabs(x), larger(fabs(y), fabs(z)));
        double rescue = 1 / big;
        double scale = big < 1e-100 || big > 1e100 ? rescue : 1;
        double a = x * scale, b = y * scale, c = z * scale;
        double inverse = 1 / sqrt(a * a + b * b + c * c);
        bool is_none = !(big > 0) || big > DBL_MAX;
        inverse = x * p->dx[i] + y * p->dy[i] + z * p->dz[i] > 0 ? -inverse : inverse;
        p->nx[i] = is_none ? 0 : a * inverse;
        p->ny[i] = is_none ? 0 : b * inverse;
        p->nz[i] = is_none ? 0 : c * inverse;
    }
}

static void notice_side(struct points *p)
{
    for (int i = 0; i < p->n; i++)
        p->from_inside[i] = p->nx[i] * p->dx[i] + p->ny[i] * p->dy[i] + p->nz[i] * p->dz[i] > 0;
}

void geometry_points(const struct plan *plan, const struct rays *rays, const struct meeting *m,
                     struct points *p)
{
    pick(rays, m, p);
    for (int i = 0, end; i < p->n; i = end) {
        end = run_end(p, m, i);
        meet_run(plan, rays, m, p, i, end);
    }
    fill_up(p);
    notice_side(p);
    finish(p);
}
