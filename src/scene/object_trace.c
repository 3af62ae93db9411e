/* object_trace.c: one ray against one object, without a plan: trace(). */
#include "scene/parts.h"

/* The way from the object asked about down to the leaf being tried. */
struct step {
    const struct step *outer;
    const struct object *object;
    size_t child;                       /* which child of outer->object it is */
};

struct search {
    struct ray ray;                     /* in the outermost space */
    struct object_trees *trees;
    double nearest;                     /* closest t so far, INFINITY: none */
    vec3 normal;
    bool takes_equal;                   /* what is tried comes before what nearest is of */
    size_t n_taken;
};

static const double start = 1e-6;       /* a surface nearer than this is the ray's own */

/* Is a point on child of o's surface part of o's surface?  p in o's inner space. */
static bool remains(const struct object *o, size_t child, vec3 p, struct object_trees *trees)
{
    switch (o->kind) {
    case OBJECT_MERGE:
        return !object_inside_any(o, p, 0, child, trees);
    case OBJECT_INTERSECTION:
        return object_inside_all(o, p, child, trees);
    case OBJECT_DIFFERENCE:
        return (child == 0 || object_inside(o->child[0], p, trees))
               && !object_inside_any(o, p, 1, child, trees);
    default:
        return true;
    }
}

/* p: in the outer space of s->object; *inner: in its inner space.  Clips and
 * combinations of every node from the outermost to s. */
static bool visible(const struct step *s, vec3 world, struct object_trees *trees, vec3 *inner, bool *flipped)
{
    vec3 p = world;

    if (s->outer) {
        if (!visible(s->outer, world, trees, &p, flipped)
            || !remains(s->outer->object, s->child, p, trees))
            return false;
        if (s->outer->object->kind == OBJECT_DIFFERENCE && s->child > 0)
            *flipped = !*flipped;
    }
    const struct object_more *more = s->object->more;
    for (size_t i = 0; i < more->n_clip; i++)
        if (!object_inside(more->clip[i], p, trees))
            return false;
    if (s->object->flags & OBJECT_INVERSE)
        *flipped = !*flipped;
    *inner = mat_point(&s->object->place->from, p);
    return true;
}

/* Outermost from the inner space of s->object. */
static struct transform place_of(const struct step *s)
{
    struct transform outer = s->outer ? place_of(s->outer) : transform_identity;

    return transform_compose(&outer, s->object->place);
}

/* Is t a place to look at? */
static bool is_nearer(const struct search *f, double t)
{
    return t > start && (t < f->nearest || (f->takes_equal && t == f->nearest));
}

/* normal: in the inner space of s->object. */
static void offer(struct search *f, const struct step *s, double t, vec3 normal)
{
    bool flipped = false;
    vec3 inner;

    if (!visible(s, ray_at(f->ray, t), f->trees, &inner, &flipped))
        return;
    struct transform place = place_of(s);
    f->nearest = t;
    f->takes_equal = false;
    f->n_taken++;
    f->normal = vec_unit(mat_normal(&place.from, normal));
    if (flipped)
        f->normal = vec_neg(f->normal);
}

static struct ray inner_ray(struct ray r, const struct transform *place)
{
    return (struct ray) { mat_point(&place->from, r.origin), mat_direction(&place->from, r.dir) };
}

/* Directions that scenes compute along a plane are off by rounding; the hit
 * would be somewhere at the end of the world.  POV-Ray's limit (facts
 * numerics.md, EPSILON). */
static bool runs_along(vec3 dir, vec3 normal)
{
    return fabs(vec_dot(vec_unit(normal), vec_unit(dir))) < 1e-10;
}

/* Of a leaf the ray is the outermost one, moved once, so that copies in
 * copies lose nothing. */
static void try_shape(struct search *f, const struct step *s)
{
    const struct object *o = s->object;
    struct transform place = place_of(s);
    struct ray r = inner_ray(f->ray, &place);
    struct hit hit[SHAPE_MOST_HITS];
    int n = o->ops->hits(o->shape, r, hit);

    for (int i = 0; i < n; i++) {
        if (!is_nearer(f, hit[i].t))
            continue;
        vec3 normal = o->ops->normal(o->shape, ray_at(r, hit[i].t), &hit[i]);
        if (!o->ops->is_infinite || !runs_along(r.dir, normal))
            offer(f, s, hit[i].t, normal);
    }
}

static vec3 face_normal(const struct mesh *m, size_t face, vec3 flat, double u, double v)
{
    const uint32_t *n = m->face_normal ? m->face_normal[face].of : NULL;

    if (!n || n[0] == MESH_NONE || !m->normal)
        return flat;
    return vec_add(vec_scale(m->normal[n[0]], 1 - u - v),
                   vec_add(vec_scale(m->normal[n[1]], u), vec_scale(m->normal[n[2]], v)));
}

static void try_face(struct search *f, const struct step *s, struct ray r, size_t face)
{
    const struct mesh *m = s->object->mesh;
    struct crossing at;

    if (face_crosses(m, face, r, &at) && is_nearer(f, at.t))
        offer(f, s, at.t, face_normal(m, face, at.flat, at.u, at.v));
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

static void try_object(struct search *f, const struct step *s, struct ray ray);

/* Through the parts of one object, in any order: of two at the same t the one
 * that stands first counts, as if all were tried in their order. */
struct walk {
    struct search *search;
    const struct step *step;
    const struct parts *parts;
    struct ray ray;                     /* in the object's inner space */
    size_t holder;                      /* the part that nearest is of */
    bool none_holds;
};

static void try_part(struct walk *w, size_t i)
{
    struct search *f = w->search;
    size_t before = f->n_taken;
    bool takes_equal = f->takes_equal;

    if (!w->none_holds)
        f->takes_equal = i < w->holder;
    if (w->step->object->kind == OBJECT_MESH) {
        try_face(f, w->step, w->ray, i);
    } else {
        struct step inner = { w->step, w->step->object->child[i], i };
        try_object(f, &inner, w->ray);
    }
    if (f->n_taken == before) {
        f->takes_equal = takes_equal;
        return;
    }
    w->holder = i;
    w->none_holds = false;
}

static bool try_items(void *arg, const uint32_t item[], uint32_t bits, double *far)
{
    struct walk *w = arg;

    for (; bits; bits &= bits - 1)
        try_part(w, w->parts->part[item[__builtin_ctz(bits)]]);
    *far = w->search->nearest;
    return false;
}

static void try_parts(struct search *f, const struct step *s, struct ray r, size_t n)
{
    struct walk w = { f, s, object_parts(f->trees, s->object), r, 0, true };
    unsigned long long tests = 0;

    if (!w.parts) {
        for (size_t i = 0; i < n; i++)
            try_part(&w, i);
        return;
    }
    for (size_t i = 0; i < w.parts->n_loose; i++)
        try_part(&w, w.parts->loose[i]);
    bvh_walk(&w.parts->tree, r, 0, f->nearest, try_items, &w, &tests);
}

/* ray: in the outer space of s->object. */
static void try_object(struct search *f, const struct step *s, struct ray ray)
{
    const struct object *o = s->object;
    struct ray r = inner_ray(ray, o->place);
    struct bounds box = object_inner_box(o);

    if (!reaches(&box, r, f->nearest))
        return;
    if (o->kind == OBJECT_SHAPE)
        try_shape(f, s);
    else
        try_parts(f, s, r, o->kind == OBJECT_MESH ? o->mesh->n_face : o->n_child);
}

bool object_trace(const struct object *o, vec3 origin, vec3 dir, struct object_trees *trees, vec3 *point,
                  vec3 *normal)
{
    struct search f = { .ray = { origin, vec_unit(dir) }, .trees = trees, .nearest = INFINITY };
    struct step top = { NULL, o, 0 };

    *point = *normal = vec(0, 0, 0);
    if (!(vec_largest(f.ray.dir) > 0))
        return false;
    try_object(&f, &top, f.ray);
    if (isinf(f.nearest))
        return false;
    *point = ray_at(f.ray, f.nearest);
    *normal = f.normal;
    return true;
}
