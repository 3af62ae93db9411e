/* leaf.c: what is said of one leaf at a time. */
#include "trace/world.h"

vec3 leaf_normal(const struct leaf *l, struct ray ray, const struct hit *h)
{
    vec3 n = l->ops ? l->ops->normal(l->shape, ray_at(ray, h->t), h) : mesh_normal(l->mesh, h);

    if (l->placement)
        n = mat_normal(&l->placement->place.from, n);
    return l->inverse ? vec_neg(n) : n;
}

/* A patch without an inside has none when inverted, either. */
bool leaf_inside(const struct leaf *l, vec3 p)
{
    if (l->placement)
        p = mat_point(&l->placement->place.from, p);
    if (l->ops)
        return l->ops->inside && l->ops->inside(l->shape, p) != l->inverse;
    return mesh_has_inside(l->mesh) && mesh_inside(l->mesh, p) != l->inverse;
}

struct bounds leaf_bounds(const struct leaf *l)
{
    struct bounds b = l->ops ? l->ops->bounds(l->shape) : l->mesh->bounds;

    if (!l->placement)
        return b;
    b = bounds_move(&b, &l->placement->place);
    double pad = l->placement->fuzz * larger(vec_largest(b.low), vec_largest(b.high));
    vec3 by = vec(pad, pad, pad);
    return (struct bounds) { vec_sub(b.low, by), vec_add(b.high, by) };
}

struct bounds leaf_crust(const struct leaf *l)
{
    bool has_own = l->ops && l->ops->crust && !l->placement;

    return has_own ? l->ops->crust(l->shape) : leaf_bounds(l);
}
