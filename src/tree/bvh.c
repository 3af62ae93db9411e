/* bvh.c: aiming rays at a tree of boxes, and balls in it. */
#include "tree/bvh.h"

/* Rounding up in the last step pays for the roundings before it. */
void bvh_add_balls(struct bvh *b, bool (*ball)(const void *of, uint32_t item, vec3 *centre, double *radius),
                   bvh_fetch *fetch, const void *of, struct arena *mem)
{
    for (int i = 0; i < 4; i++)         /* eight are read at once, also at the end */
        b->ball[i] = arena_array(mem, b->n_item + LANES, sizeof *b->ball[i]);
    for (size_t i = 0; i < b->n_item; i++) {
        vec3 centre = b->middle;
        double radius = INFINITY;
        bvh_fetch_ahead(b, i, fetch, of);
        if (!ball(of, b->item[i], &centre, &radius))
            radius = INFINITY;
        centre = vec_scale(vec_sub(centre, b->middle), b->scale);
        b->ball[0][i] = (float)centre.x;
        b->ball[1][i] = (float)centre.y;
        b->ball[2][i] = (float)centre.z;
        b->ball[3][i] = radius < INFINITY ? (float)(radius * b->scale) * (1 + 16 * FLT_EPSILON)
                                          : INFINITY;
    }
}

/* Rays that start far away start anew just before the tree, so that floats
 * are enough: from there on everything is of the tree's size.  What rounding
 * is left, of this step and of the origin, moves the origin apart (stream.c
 * does the same for many rays at once). */
struct aim { double o, dir, inverse; };

INLINE struct aim aim_axis(double origin, double dir, double middle, double scale, double shorten)
{
    double d = dir * shorten;

    return (struct aim) { (origin - middle) * scale, d,
                          fabs(d) > bvh_flat ? 1 / d : copysign(1 / bvh_flat, d) };
}

INLINE void aim_clip(struct aim a, double half, double *begin, double *end)
{
    double reach = copysign(half, a.dir);
    double in = (-reach - a.o) * a.inverse, out = (reach - a.o) * a.inverse;

    in -= fabs(in) * 1e-12;
    out += fabs(out) * 1e-12;
    *begin = in > *begin ? in : *begin;
    *end = out < *end ? out : *end;
}

INLINE double aim_at(struct aim a, double begin) { return a.o + begin * a.dir; }

INLINE void aim_finish(struct bvh_ray *r, int axis, struct aim a, double begin, double apart)
{
    double at = aim_at(a, begin), shift = copysign(apart, a.dir);

    r->inverse[axis] = lanes_of((float)a.inverse);
    r->origin[0][axis] = lanes_of((float)(at + shift));
    r->origin[1][axis] = lanes_of((float)(at - shift));
    r->enter[axis] = signbit(a.dir) ? 1 : 0;
    r->at[axis] = (float)at;
    r->dir[axis] = (float)a.dir;
}

INLINE double largest(double a, double b, double c)
{
    a = fabs(a);
    b = fabs(b);
    c = fabs(c);
    a = a > b ? a : b;
    return a > c ? a : c;
}

bool bvh_aim(const struct bvh *b, struct ray ray, double near, double far, struct bvh_ray *out)
{
    double longest = largest(ray.dir.x, ray.dir.y, ray.dir.z), shorten = 1 / longest;
    struct aim x = aim_axis(ray.origin.x, ray.dir.x, b->middle.x, b->scale, shorten);
    struct aim y = aim_axis(ray.origin.y, ray.dir.y, b->middle.y, b->scale, shorten);
    struct aim z = aim_axis(ray.origin.z, ray.dir.z, b->middle.z, b->scale, shorten);
    double unit = longest * b->scale;
    double error = (largest(x.o, y.o, z.o) + 1) * bvh_step_error;
    double begin = near * unit, end = far * unit;

    aim_clip(x, b->half.x + error, &begin, &end);
    aim_clip(y, b->half.y + error, &begin, &end);
    aim_clip(z, b->half.z + error, &begin, &end);
    if (!(begin <= end))
        return false;
    begin -= fabs(begin) * 1e-12;
    if (!isfinite(aim_at(x, begin) + aim_at(y, begin) + aim_at(z, begin)))
        return false;                   /* it would seem to meet everything, boxes of empty slots too */
    out->start = begin;
    out->unit = unit;
    out->slop = fabs(begin) * bvh_step_error;
    double apart = bvh_float_error + error + 4 * out->slop;
    aim_finish(out, 0, x, begin, apart);
    aim_finish(out, 1, y, begin, apart);
    aim_finish(out, 2, z, begin, apart);
    out->apart = (float)(apart + bvh_ball_error);
    return true;
}

/* --- points ------------------------------------------------------------------------- */

struct spot { lanes low[3], high[3]; };     /* p with its rounding taken off and added */

static bool spot_of(const struct bvh *b, vec3 p, struct spot *s)
{
    vec3 at = vec_scale(vec_sub(p, b->middle), b->scale);
    const double c[3] = { at.x, at.y, at.z };

    if (!(vec_largest(at) < 2))         /* the tree reaches to 1 */
        return false;
    for (int axis = 0; axis < 3; axis++) {
        s->low[axis] = lanes_of((float)(c[axis] - 2 * bvh_float_error));
        s->high[axis] = lanes_of((float)(c[axis] + 2 * bvh_float_error));
    }
    return true;
}

static unsigned boxes_at(const struct bvh_node *n, const struct spot *s)
{
    unsigned bits = (1u << LANES) - 1;

    for (int axis = 0; axis < 3; axis++)
        bits &= lanes_not_above(lanes_load(n->side[0][axis]), s->high[axis])
                & lanes_not_above(s->low[axis], lanes_load(n->side[1][axis]));
    return bits;
}

bool bvh_at(const struct bvh *b, vec3 p, bool (*visit)(void *arg, uint32_t item), void *arg)
{
    uint32_t stack[BVH_STACK];
    int top = 0;
    struct spot s;

    if (b->n_node == 0 || !spot_of(b, p, &s))
        return false;
    for (stack[top++] = 0; top > 0; ) {
        const struct bvh_node *n = &b->node[stack[--top]];
        for (unsigned bits = boxes_at(n, &s); bits; bits &= bits - 1) {
            int i = __builtin_ctz(bits);
            if (n->count[i] == 0)
                stack[top++] = n->child[i];
            for (uint32_t k = 0; k < n->count[i]; k++)
                if (visit(arg, b->item[n->child[i] + k]))
                    return true;
        }
    }
    return false;
}
