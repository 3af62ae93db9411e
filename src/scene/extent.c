/* extent.c: the box that POV-Ray keeps of an object.
 *
 * Scenes place things by min_extent and max_extent, so these must be as loose
 * as POV-Ray's are (facts sdl.md 2.9): single precision; a union's box turned
 * as a box, not its members; cylinders, cones and discs boxed in a frame of
 * their own first.  The tracer has tighter ones (object.c). */
#include <string.h>

#include "scene/object.h"

#define TRIANGLE_MARGIN 1e-10
#define DISC_HALF 0.001                 /* of a disc's thickness */
#define SUPERELLIPSOID_HALF 1.0001

static struct bounds extent_of(const struct object *o);

static bool is_whole(const struct bounds *b)
{
    return vec_is_finite(b->low) && vec_is_finite(b->high)
           && b->low.x <= b->high.x && b->low.y <= b->high.y && b->low.z <= b->high.z;
}

/* gcc 12 loses a plain cast to float and back where it works on pairs. */
static double single(double x)
{
    volatile float rounded = (float)x;
    return rounded;
}

static void keep(double *low, double *high)
{
    double size = single(*high - *low);

    *low = fabs(*low) < size * 1e-12 ? 0 : single(*low);    /* what rounding left */
    *high = single(*low + size);
}

/* As a corner and a size in single precision; without an end in one direction
 * it has none in any. */
static struct bounds kept(struct bounds b)
{
    if (!is_whole(&b))
        return BOUNDS_ALL;
    keep(&b.low.x, &b.high.x);
    keep(&b.low.y, &b.high.y);
    keep(&b.low.z, &b.high.z);
    return b;
}

static struct bounds moved(struct bounds b, const struct transform *place)
{
    return is_whole(&b) ? kept(bounds_move(&b, place)) : BOUNDS_ALL;
}

/* --- primitives ---------------------------------------------------------------- */

static vec3 point_arg(const struct object *o, int i)
{
    return *(const vec3 *)((const char *)o->shape + o->ops->args[i].offset);
}

static double number_arg(const struct object *o, int i)
{
    return *(const double *)((const char *)o->shape + o->ops->args[i].offset);
}

static bool is(const struct object *o, const char *name)
{
    return o->kind == OBJECT_SHAPE && strcmp(o->ops->name, name) == 0;
}

static struct bounds around(vec3 centre, vec3 half)
{
    return (struct bounds) { vec_sub(centre, half), vec_add(centre, half) };
}

static vec3 absolute(vec3 v) { return vec(fabs(v.x), fabs(v.y), fabs(v.z)); }

/* The box around a slanted one: centre and half edges. */
static struct bounds around_slanted(vec3 centre, const vec3 edge[3], const struct transform *place)
{
    vec3 half = vec(0, 0, 0);

    for (int i = 0; i < 3; i++)
        half = vec_add(half, absolute(mat_direction(&place->to, edge[i])));
    return kept(around(mat_point(&place->to, centre), half));
}

/* The frame whose z is n and that is turned from the world's no further than
 * that needs. */
static void turned_frame(vec3 n, vec3 frame[3])
{
    double flat = 1 / (1 + n.z);

    frame[0] = vec(1 - n.x * n.x * flat, -n.x * n.y * flat, -n.x);
    frame[1] = vec(-n.x * n.y * flat, 1 - n.y * n.y * flat, -n.y);
    frame[2] = n;
    if (n.z < -1 + 1e-9) {
        frame[0] = vec(1, 0, 0);
        frame[1] = vec(0, 1, 0);
    }
}

static struct bounds round_extent(vec3 centre, vec3 n, double radius, double half,
                                  const struct transform *place)
{
    vec3 edge[3];

    turned_frame(n, edge);
    edge[0] = vec_scale(edge[0], radius);
    edge[1] = vec_scale(edge[1], radius);
    edge[2] = vec_scale(edge[2], half);
    return around_slanted(centre, edge, place);
}

static struct bounds frustum_extent(const struct object *o)
{
    vec3 centre, edge[3];

    o->ops->hold(o->shape, &centre, edge);
    bool is_widest_first = is(o, "cylinder") || number_arg(o, 1) >= number_arg(o, 3);
    double half = vec_length(edge[2]), way = is_widest_first ? -1 : 1;
    return round_extent(centre, vec_scale(edge[2], way / half), vec_length(edge[0]), half,
                        o->place);
}

static struct bounds disc_extent(const struct object *o)
{
    return round_extent(point_arg(o, 0), point_arg(o, 1), number_arg(o, 2), DISC_HALF, o->place);
}

/* Half of the box of an ellipsoid or a cylinder along an axis, in their own
 * space; infinite for other quadrics. */
static double quadric_half(double square, double constant)
{
    return square > 0 ? sqrt(-constant / square) : INFINITY;
}

static double quadric_middle(double square, double linear)
{
    return square > 0 ? -linear / (2 * square) : linear == 0 ? 0 : NAN;
}

static struct bounds quadric_extent(const struct object *o)
{
    vec3 square = point_arg(o, 0), linear = point_arg(o, 2);
    vec3 middle = vec(quadric_middle(square.x, linear.x), quadric_middle(square.y, linear.y),
                      quadric_middle(square.z, linear.z));
    double constant = number_arg(o, 3) + vec_dot(linear, middle) / 2;
    bool plain = constant < 0 && vec_largest(point_arg(o, 1)) == 0
        && square.x >= 0 && square.y >= 0 && square.z >= 0;
    vec3 half = vec(quadric_half(square.x, constant), quadric_half(square.y, constant),
                    quadric_half(square.z, constant));

    return plain ? around(middle, half) : BOUNDS_ALL;
}

/* How much it scales alike in all directions; 0: it does not. */
static double even_scale(const struct transform *t)
{
    vec3 x = mat_direction(&t->to, vec(1, 0, 0)), y = mat_direction(&t->to, vec(0, 1, 0)),
         z = mat_direction(&t->to, vec(0, 0, 1));
    double s = vec_length(x), near = 1e-9 * s * s;
    bool even = fabs(vec_dot(x, y)) < near && fabs(vec_dot(y, z)) < near
        && fabs(vec_dot(z, x)) < near && fabs(vec_dot(y, y) - s * s) < near
        && fabs(vec_dot(z, z) - s * s) < near;

    return even ? s : 0;
}

/* A part of an intersection is boxed where it is when it is a sphere; other quadrics,
 * and those that stand alone, before they are moved. */
static struct bounds moved_quadric(const struct object *o)
{
    struct bounds b = quadric_extent(o);
    vec3 square = point_arg(o, 0), half = vec_scale(vec_sub(b.high, b.low), 0.5);
    double scale = square.x == square.y && square.y == square.z ? even_scale(o->place) : 0;

    if (scale > 0 && is_whole(&b))
        return around(mat_point(&o->place->to, vec_add(b.low, half)), vec_scale(half, scale));
    return bounds_move(&b, o->place);
}

static struct bounds sphere_extent(const struct object *o)
{
    double scale = even_scale(o->place), r = number_arg(o, 1) * scale;

    if (scale > 0)
        return kept(around(mat_point(&o->place->to, point_arg(o, 0)), vec(r, r, r)));
    return moved(kept(o->ops->bounds(o->shape)), o->place);
}

static void widen(double *low, double *high)
{
    double size = single(*high - *low + 2 * TRIANGLE_MARGIN);

    *low = single(*low - TRIANGLE_MARGIN);
    *high = single(*low + size);
}

static struct bounds triangle_extent(const struct object *o)
{
    int step = is(o, "triangle") ? 1 : 2;       /* between corners a smooth one has normals */
    struct bounds b = BOUNDS_EMPTY;

    for (int i = 0; i < 3; i++) {
        vec3 p = mat_point(&o->place->to, point_arg(o, i * step));
        b = bounds_join(b, (struct bounds) { p, p });
    }
    b = kept(b);
    widen(&b.low.x, &b.high.x);
    widen(&b.low.y, &b.high.y);
    widen(&b.low.z, &b.high.z);
    return b;
}

static struct bounds shape_extent(const struct object *o)
{
    if (is(o, "sphere"))
        return sphere_extent(o);
    if (is(o, "cylinder") || is(o, "cone"))
        return frustum_extent(o);
    if (is(o, "disc"))
        return disc_extent(o);
    if (is(o, "superellipsoid")) {
        double half = SUPERELLIPSOID_HALF;
        return moved(around(vec(0, 0, 0), vec(half, half, half)), o->place);
    }
    if (is(o, "triangle") || is(o, "smooth_triangle"))
        return triangle_extent(o);
    if (is(o, "quadric"))
        return moved(quadric_extent(o), o->place);
    return moved(o->ops->bounds ? o->ops->bounds(o->shape) : BOUNDS_ALL, o->place);
}

/* --- CSG ----------------------------------------------------------------------- */

static void cut_axis(double n, double d, double *low, double *high)
{
    if (n > 0)
        *high = d;
    else
        *low = -d;
}

/* What a plane leaves of space, if it stands upright on an axis. */
static struct bounds half_space(const struct object *o, bool is_rest)
{
    struct bounds b = BOUNDS_ALL;
    vec3 own = point_arg(o, 0), n = mat_normal(&o->place->from, own);
    double length = vec_length(n), near = 1e-9;

    n = vec_scale(n, (is_rest ? -1 : 1) / length);
    double d = vec_dot(n, mat_point(&o->place->to, vec_scale(own, number_arg(o, 1))));
    if (fabs(n.y) < near && fabs(n.z) < near)
        cut_axis(n.x, d, &b.low.x, &b.high.x);
    else if (fabs(n.x) < near && fabs(n.z) < near)
        cut_axis(n.y, d, &b.low.y, &b.high.y);
    else if (fabs(n.x) < near && fabs(n.y) < near)
        cut_axis(n.z, d, &b.low.z, &b.high.z);
    return b;
}

static struct bounds common_extent(const struct object *o)
{
    struct bounds all = BOUNDS_ALL;

    for (size_t i = 0; i < o->n_child; i++) {
        const struct object *child = o->child[i];
        bool is_rest = (child->flags & OBJECT_INVERSE) != 0;
        if (o->kind == OBJECT_DIFFERENCE && i > 0)
            is_rest = !is_rest;
        if (is(child, "plane"))
            all = bounds_meet(all, half_space(child, is_rest));
        else if (is(child, "quadric") && !is_rest)      /* may have an end in some directions only */
            all = bounds_meet(all, moved_quadric(child));
        else if (!is_rest)
            all = bounds_meet(all, extent_of(child));
    }
    return all;
}

static struct bounds joint_extent(const struct object *o)
{
    struct bounds all = BOUNDS_EMPTY;

    for (size_t i = 0; i < o->n_child; i++)
        all = bounds_join(all, extent_of(o->child[i]));
    return all;
}

static struct bounds whole_extent(const struct object *o)
{
    if (o->more->unsupported && !is_whole(&o->more->reach))
        return o->more->reach;          /* nothing is known: a size below 0 asks for no room */
    if (o->more->unsupported)
        return moved(o->more->reach, o->place);
    switch (o->kind) {
    case OBJECT_SHAPE: return shape_extent(o);
    case OBJECT_MESH: return moved(kept(o->mesh->box), o->place);
    case OBJECT_LIGHT: return BOUNDS_ALL;
    case OBJECT_UNION: case OBJECT_MERGE: return moved(kept(joint_extent(o)), o->place);
    default: return moved(kept(common_extent(o)), o->place);
    }
}

/* --- clips --------------------------------------------------------------------- */

static double volume(const struct bounds *b)
{
    return (b->high.x - b->low.x) * (b->high.y - b->low.y) * (b->high.z - b->low.z);
}

/* A clip's or bound's box replaces a larger one. */
static struct bounds cut_by(struct bounds b, const struct object *const *cut, size_t n)
{
    struct bounds box = BOUNDS_ALL;

    for (size_t i = 0; i < n; i++)
        if (!(cut[i]->flags & OBJECT_INVERSE))
            box = bounds_meet(box, extent_of(cut[i]));
    box = kept(box);
    bool smaller = is_whole(&box) && (!is_whole(&b) || volume(&box) < volume(&b));
    return smaller ? box : b;
}

static struct bounds extent_of(const struct object *o)
{
    struct bounds b = cut_by(whole_extent(o), o->more->clip, o->more->n_clip);

    return cut_by(b, o->more->bound, o->more->n_bound);
}

struct bounds object_extent(const struct object *o) { return extent_of(o); }
