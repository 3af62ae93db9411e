/* parts.c: trees over the parts of objects. */
#include "scene/parts.h"

enum { FEW = 4, PARTS_A_LEAF = 4 };    /* as few are asked quicker without a tree */

static struct bounds face_box(const struct mesh *m, size_t face)
{
    struct bounds b = BOUNDS_EMPTY;

    for (int i = 0; i < 3; i++) {
        vec3 p = m->vertex[m->face[face].of[i]];
        b = bounds_join(b, (struct bounds) { p, p });
    }
    return b;
}

struct bounds object_inner_box(const struct object *o)
{
    return o->n_child && o->more->has_box ? o->more->box : object_inner_bounds(o);
}

/* Moeller and Trumbore, Fast, Minimum Storage Ray/Triangle Intersection (1997). */
bool face_crosses(const struct mesh *m, size_t face, struct ray r, struct crossing *out)
{
    const uint32_t *corner = m->face[face].of;
    vec3 a = m->vertex[corner[0]];
    vec3 ab = vec_sub(m->vertex[corner[1]], a), ac = vec_sub(m->vertex[corner[2]], a);
    vec3 h = vec_cross(r.dir, ac), to = vec_sub(r.origin, a), q = vec_cross(to, ab);
    double det = vec_dot(ab, h);

    if (det == 0)
        return false;
    *out = (struct crossing) { vec_dot(ac, q) / det, vec_dot(to, h) / det, vec_dot(r.dir, q) / det,
                               vec_cross(ac, ab) };
    return out->u >= 0 && out->v >= 0 && out->u + out->v <= 1;
}

/* Of the surface. */
static struct bounds child_box(const struct object *o)
{
    struct bounds b = object_inner_box(o);

    return bounds_move(&b, o->place);
}

static struct bounds part_box(const struct object *o, size_t i)
{
    return o->kind == OBJECT_MESH ? face_box(o->mesh, i) : child_box(o->child[i]);
}

static bool inside_reaches_beyond(const struct object *o)
{
    if (o->flags & OBJECT_INVERSE)
        return true;
    if (o->kind == OBJECT_SHAPE)
        return o->ops->inside && !o->ops->is_solid;
    if (o->kind == OBJECT_MESH)
        return vec_largest(o->mesh->inside_vector) > 0;
    for (size_t i = 0; i < o->n_child; i++)
        if (inside_reaches_beyond(o->child[i]))
            return true;
    return false;
}

static size_t part_count(const struct object *o)
{
    return o->kind == OBJECT_MESH ? o->mesh->n_face : o->n_child;
}

struct boxed { const struct object *object; const uint32_t *part; };

static struct bounds boxed_box(const void *of, size_t i)
{
    const struct boxed *b = of;

    return part_box(b->object, b->part[i]);
}

/* Parts of which there is nothing are neither. */
static size_t sort_by_box(struct parts *p, const struct object *o, size_t n)
{
    size_t n_boxed = 0;

    for (size_t i = 0; i < n; i++) {
        struct bounds b = part_box(o, i);
        if (vec_is_finite(b.low) && vec_is_finite(b.high))
            p->part[n_boxed++] = (uint32_t)i;
        else if (!(b.low.x > b.high.x))
            p->loose[p->n_loose++] = (uint32_t)i;
    }
    return n_boxed;
}

static void find_beyond(struct parts *p, const struct object *o, size_t n_boxed)
{
    for (size_t i = 0; o->kind != OBJECT_MESH && i < n_boxed; i++)
        if (inside_reaches_beyond(o->child[p->part[i]]))
            p->beyond[p->n_beyond++] = p->part[i];
}

static struct parts *sorted(const struct object *o, size_t n, struct arena *mem)
{
    struct parts *p = arena_alloc(mem, sizeof *p);

    p->part = arena_array(mem, n, sizeof *p->part);
    p->loose = arena_array(mem, n, sizeof *p->loose);
    p->beyond = arena_array(mem, n, sizeof *p->beyond);
    size_t n_boxed = sort_by_box(p, o, n);
    find_beyond(p, o, n_boxed);
    bvh_build(&p->tree, n_boxed, boxed_box, &(struct boxed) { o, p->part }, NULL, PARTS_A_LEAF,
              PARTS_A_LEAF, 1, mem);
    return p;
}

const struct parts *object_parts(struct object_trees *t, const struct object *o)
{
    size_t n = part_count(o);

    if (!t || n <= FEW)
        return NULL;
    const void *key = o->kind == OBJECT_MESH ? (const void *)o->mesh : (const void *)o->child;
    const void **known = intern_at(&t->known, t->mem, &key, sizeof key);
    if (!*known)
        *known = sorted(o, n, t->mem);
    return *known;
}
