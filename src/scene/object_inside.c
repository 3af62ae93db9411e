/* object_inside.c: is a point inside of an object? */
#include "scene/parts.h"

bool object_has_inside(const struct object *o)
{
    size_t n = 0;

    if (o->kind == OBJECT_SHAPE)
        return o->ops->inside != NULL;  /* what is behind a disc is inside of it */
    if (o->kind == OBJECT_MESH)
        return vec_largest(o->mesh->inside_vector) > 0;
    for (size_t i = 0; i < o->n_child; i++) {
        if (o->child[i]->kind == OBJECT_LIGHT)
            continue;
        if (!object_has_inside(o->child[i]))
            return false;
        n++;
    }
    return n > 0;
}

/* Crossings of the inside vector from p are counted. */
struct count { const struct mesh *mesh; const struct parts *parts; vec3 p; bool odd; };

static void count_face(struct count *c, size_t face)
{
    struct crossing at;

    c->odd ^= face_crosses(c->mesh, face, (struct ray) { c->p, c->mesh->inside_vector }, &at) && at.t > 0;
}

static bool count_faces(void *arg, const uint32_t item[], uint32_t bits, double *far)
{
    struct count *c = arg;

    (void)far;
    for (; bits; bits &= bits - 1)
        count_face(c, c->parts->part[item[__builtin_ctz(bits)]]);
    return false;
}

/* An odd number of crossings. */
static bool mesh_inside(const struct object *o, vec3 p, struct object_trees *trees)
{
    const struct mesh *m = o->mesh;
    struct count c = { m, NULL, p, false };
    unsigned long long tests = 0;

    if (!(vec_largest(m->inside_vector) > 0))
        return false;
    c.parts = object_parts(trees, o);
    if (c.parts)
        bvh_walk(&c.parts->tree, (struct ray) { p, m->inside_vector }, 0, INFINITY, count_faces, &c, &tests);
    else
        for (size_t i = 0; i < m->n_face; i++)
            count_face(&c, i);
    return c.odd;
}

/* Is p, in inner space, inside of a child, those before from and one to be
 * skipped left out? */
struct among {
    struct object_trees *trees;
    const struct object *object;
    const struct parts *parts;
    vec3 p;
    size_t from, skip;
};

static bool in_child(const struct among *a, size_t i)
{
    return i >= a->from && i != a->skip && object_inside(a->object->child[i], a->p, a->trees);
}

static bool in_item(void *arg, uint32_t item)
{
    const struct among *a = arg;

    return in_child(a, a->parts->part[item]);
}

static bool in_listed(const struct among *a, const uint32_t child[], size_t n)
{
    for (size_t i = 0; i < n; i++)
        if (in_child(a, child[i]))
            return true;
    return false;
}

bool object_inside_any(const struct object *o, vec3 p, size_t from, size_t skip, struct object_trees *trees)
{
    struct among a = { trees, o, object_parts(trees, o), p, from, skip };

    if (a.parts)
        return in_listed(&a, a.parts->loose, a.parts->n_loose)
               || in_listed(&a, a.parts->beyond, a.parts->n_beyond) || bvh_at(&a.parts->tree, p, in_item, &a);
    for (size_t i = 0; i < o->n_child; i++)
        if (in_child(&a, i))
            return true;
    return false;
}

bool object_inside_all(const struct object *o, vec3 p, size_t skip, struct object_trees *trees)
{
    for (size_t i = 0; i < o->n_child; i++)
        if (i != skip && o->child[i]->kind != OBJECT_LIGHT && !object_inside(o->child[i], p, trees))
            return false;
    return o->n_child > 0;
}

static bool inside_inner(const struct object *o, vec3 p, struct object_trees *trees)
{
    switch (o->kind) {
    case OBJECT_SHAPE:
        return o->ops->inside && o->ops->inside(o->shape, p);
    case OBJECT_MESH:
        return mesh_inside(o, p, trees);
    case OBJECT_UNION: case OBJECT_MERGE:
        return object_inside_any(o, p, 0, NO_CHILD, trees);
    case OBJECT_INTERSECTION:
        return object_inside_all(o, p, NO_CHILD, trees);
    case OBJECT_DIFFERENCE:
        return o->n_child > 0 && object_inside(o->child[0], p, trees)
               && !object_inside_any(o, p, 1, NO_CHILD, trees);
    case OBJECT_LIGHT:
        break;
    }
    return false;
}

/* Clips come first: outside of one is outside, inverse or not. */
bool object_inside(const struct object *o, vec3 p, struct object_trees *trees)
{
    for (size_t i = 0; i < o->more->n_clip; i++)
        if (!object_inside(o->more->clip[i], p, trees))
            return false;
    bool is_patch = (o->kind == OBJECT_SHAPE && !o->ops->inside) || o->kind == OBJECT_LIGHT;
    bool inverse = (o->flags & OBJECT_INVERSE) != 0 && !is_patch;
    vec3 inner = o->place->is_identity ? p : mat_point(&o->place->from, p);
    return inside_inner(o, inner, trees) != inverse;
}
