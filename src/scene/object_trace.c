/* object_trace.c: one ray against one object, without a plan: trace(). */
#include "scene/object.h"

/* The way from the object asked about down to the leaf being tried. */
struct step {
    const struct step *outer;
    const struct object *object;
    size_t child;                       /* which child of outer->object it is */
};

struct search {
    struct ray ray;                     /* in the outermost space */
    double nearest;                     /* closest t so far, INFINITY: none */
    vec3 normal;
};

static const double start = 1e-6;       /* a surface nearer than this is the ray's own */

/* Is a point on child of o's surface part of o's surface?  p in o's inner space. */
static bool remains(const struct object *o, size_t child, vec3 p)
{
    for (size_t i = 0; i < o->n_child; i++) {
        if (i == child || o->child[i]->kind == OBJECT_LIGHT || o->kind == OBJECT_UNION)
            continue;
        bool must = o->kind == OBJECT_INTERSECTION || (o->kind == OBJECT_DIFFERENCE && i == 0);
        if (object_inside(o->child[i], p) != must)
            return false;
    }
    return true;
}

/* p: in the outer space of s->object; *inner: in its inner space.  Clips and
 * combinations of every node from the outermost to s. */
static bool visible(const struct step *s, vec3 world, vec3 *inner, bool *flipped)
{
    vec3 p = world;

    if (s->outer) {
        if (!visible(s->outer, world, &p, flipped) || !remains(s->outer->object, s->child, p))
            return false;
        if (s->outer->object->kind == OBJECT_DIFFERENCE && s->child > 0)
            *flipped = !*flipped;
    }
    const struct object_more *more = s->object->more;
    for (size_t i = 0; i < more->n_clip; i++)
        if (!object_inside(more->clip[i], p))
            return false;
    if (s->object->flags & OBJECT_INVERSE)
        *flipped = !*flipped;
    *inner = mat_point(&s->object->place->from, p);
    return true;
}

static void offer(struct search *f, const struct step *s, const struct transform *place,
                  double t, vec3 normal)
{
    bool flipped = false;
    vec3 inner;

    if (!(t > start) || !(t < f->nearest)
        || !visible(s, ray_at(f->ray, t), &inner, &flipped))
        return;
    f->nearest = t;
    f->normal = vec_unit(mat_normal(&place->from, normal));
    if (flipped)
        f->normal = vec_neg(f->normal);
}

static struct ray inner_ray(struct ray r, const struct transform *place)
{
    return (struct ray) { mat_point(&place->from, r.origin), mat_direction(&place->from, r.dir) };
}

static void try_shape(struct search *f, const struct step *s, const struct transform *place)
{
    const struct object *o = s->object;
    struct ray r = inner_ray(f->ray, place);
    struct hit hit[SHAPE_MOST_HITS];
    int n = o->ops->hits(o->shape, r, hit);

    for (int i = 0; i < n; i++)
        offer(f, s, place, hit[i].t, o->ops->normal(o->shape, ray_at(r, hit[i].t), &hit[i]));
}

static vec3 face_normal(const struct mesh *m, size_t face, vec3 flat, double u, double v)
{
    const uint32_t *n = m->face_normal ? m->face_normal[face].of : NULL;

    if (!n || n[0] == MESH_NONE || !m->normal)
        return flat;
    return vec_add(vec_scale(m->normal[n[0]], 1 - u - v),
                   vec_add(vec_scale(m->normal[n[1]], u), vec_scale(m->normal[n[2]], v)));
}

static void try_face(struct search *f, const struct step *s, const struct transform *place,
                     struct ray r, size_t face)
{
    const struct mesh *m = s->object->mesh;
    const uint32_t *corner = m->face[face].of;
    vec3 a = m->vertex[corner[0]];
    vec3 ab = vec_sub(m->vertex[corner[1]], a), ac = vec_sub(m->vertex[corner[2]], a);
    vec3 h = vec_cross(r.dir, ac), to = vec_sub(r.origin, a), q = vec_cross(to, ab);
    double det = vec_dot(ab, h);

    if (det == 0)
        return;
    double u = vec_dot(to, h) / det, v = vec_dot(r.dir, q) / det;
    if (u < 0 || v < 0 || u + v > 1)
        return;
    offer(f, s, place, vec_dot(ac, q) / det, face_normal(m, face, vec_cross(ac, ab), u, v));
}

static void slab(double o, double d, double low, double high, double *near, double *far)
{
    if (d == 0) {
        if (o < low || o > high)
            *near = INFINITY;
        return;
    }
    double a = (low - o) / d, b = (high - o) / d;
    *near = fmax(*near, fmin(a, b));
    *far = fmin(*far, fmax(a, b));
}

/* Could the ray meet the box nearer than what is known?  A little larger than
 * the box, so that what lies in its faces is not lost. */
static bool reaches(const struct bounds *b, struct ray r, double far)
{
    double near = 0, pad = 1e-9 * (1 + fmax(vec_largest(b->low), vec_largest(b->high)));

    if (!isfinite(pad))
        return true;
    slab(r.origin.x, r.dir.x, b->low.x - pad, b->high.x + pad, &near, &far);
    slab(r.origin.y, r.dir.y, b->low.y - pad, b->high.y + pad, &near, &far);
    slab(r.origin.z, r.dir.z, b->low.z - pad, b->high.z + pad, &near, &far);
    return near <= far;
}

/* ray: in the outer space of s->object; outer: outermost from that space. */
static void try_object(struct search *f, const struct step *s, const struct transform *outer,
                       struct ray ray)
{
    const struct object *o = s->object;
    struct transform place = transform_compose(outer, o->place);
    struct ray r = inner_ray(ray, o->place);
    struct bounds box = o->n_child ? o->more->box : object_inner_bounds(o);

    if (!reaches(&box, r, f->nearest))
        return;
    if (o->kind == OBJECT_SHAPE)
        try_shape(f, s, &place);
    else if (o->kind == OBJECT_MESH)
        for (size_t i = 0; i < o->mesh->n_face; i++)
            try_face(f, s, &place, r, i);
    for (size_t i = 0; i < o->n_child; i++) {
        struct step inner = { s, o->child[i], i };
        try_object(f, &inner, &place, r);
    }
}

bool object_trace(const struct object *o, vec3 origin, vec3 dir, vec3 *point, vec3 *normal)
{
    struct search f = { .ray = { origin, vec_unit(dir) }, .nearest = INFINITY };
    struct step top = { NULL, o, 0 };

    *point = *normal = vec(0, 0, 0);
    if (!(vec_largest(f.ray.dir) > 0))
        return false;
    try_object(&f, &top, &transform_identity, f.ray);
    if (isinf(f.nearest))
        return false;
    *point = ray_at(f.ray, f.nearest);
    *normal = f.normal;
    return true;
}
