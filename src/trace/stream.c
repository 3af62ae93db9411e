/* stream.c: many rays go down a tree together. */
#include "trace/stream.h"

#include <string.h>

#include "math/wide.h"
#include "tree/brick.h"

/* --- aiming: bvh_aim, as many rays at once as a register holds ------------- */

typedef float wide_floats __attribute__((vector_size(WIDE * sizeof(float))));

struct axis { wide o, d, inverse; };

INLINE struct axis axis_of(const double *origin, const double *dir, double middle, double scale,
                           wide shorten)
{
    wide d = wide_load(dir) * shorten;
    wide flat = wide_of(bvh_flat);
    wide least = wide_copysign(flat, d);

    return (struct axis) { (wide_load(origin) - middle) * scale, d,
                           1 / wide_pick(wide_below(flat, wide_abs(d)), d, least) };
}

INLINE void axis_clip(const struct axis *a, wide half, wide *begin, wide *end)
{
    wide one = (-half - a->o) * a->inverse, other = (half - a->o) * a->inverse;
    wide in = wide_min(one, other), out = wide_max(one, other);

    *begin = wide_max(in - wide_abs(in) * 1e-12, *begin);
    *end = wide_min(out + wide_abs(out) * 1e-12, *end);
}

INLINE void put_floats(float *to, wide a)
{
    wide_floats f = __builtin_convertvector(a, wide_floats);

    memcpy(to, &f, sizeof f);
}

INLINE wide axis_at(const struct axis *a, wide begin) { return a->o + begin * a->d; }

INLINE void axis_put(struct stream *s, int axis, int i, const struct axis *a, wide begin)
{
    wide at = axis_at(a, begin);

    put_floats(&s->inverse[axis][i], a->inverse);
    put_floats(&s->turn[axis][i], at * a->inverse);
    put_floats(&s->at[axis][i], at);
    put_floats(&s->dir[axis][i], a->d);
}

INLINE void limit_put(struct stream *s, int i, wide far, wide_mask meets)
{
    wide limit = wide_min(far, wide_of(FLT_MAX / 4)) * (1 + 16 * (double)FLT_EPSILON) + 2 * (double)FLT_MIN;

    put_floats(&s->limit[i], wide_pick(meets, limit, wide_of(-1)));
}

/* Rays that miss get what does no harm: they are never asked for. */
INLINE wide aim_some(struct stream *s, int i, const struct bvh *b, const double *ox,
                     const double *oy, const double *oz, const double *dx, const double *dy,
                     const double *dz, const double *far)
{
    wide longest = wide_max(wide_abs(wide_load(dx)),
                            wide_max(wide_abs(wide_load(dy)), wide_abs(wide_load(dz))));
    wide shorten = 1 / longest, unit = longest * b->scale;
    const struct axis x = axis_of(ox, dx, b->middle.x, b->scale, shorten);
    const struct axis y = axis_of(oy, dy, b->middle.y, b->scale, shorten);
    const struct axis z = axis_of(oz, dz, b->middle.z, b->scale, shorten);
    wide off = wide_max(wide_abs(x.o), wide_max(wide_abs(y.o), wide_abs(z.o)));
    wide error = (off + 1) * bvh_step_error;
    wide begin = wide_of(0), end = wide_load(far) * unit, last = end;

    axis_clip(&x, b->half.x + error, &begin, &end);
    axis_clip(&y, b->half.y + error, &begin, &end);
    axis_clip(&z, b->half.z + error, &begin, &end);
    wide_mask meets = wide_at_most(begin, end);
    begin = wide_pick(meets, begin - wide_abs(begin) * 1e-12, wide_of(0));
    meets &= wide_is_finite(axis_at(&x, begin) + axis_at(&y, begin) + axis_at(&z, begin));
    wide slop = wide_abs(begin) * bvh_step_error;
    axis_put(s, 0, i, &x, begin);
    axis_put(s, 1, i, &y, begin);
    axis_put(s, 2, i, &z, begin);
    put_floats(&s->over[i], 1 / (x.d * x.d + y.d * y.d + z.d * z.d));
    wide_store(&s->unit[i], unit);
    wide_store(&s->start[i], begin);
    wide_store(&s->slop[i], slop);
    limit_put(s, i, last - begin + slop, meets);
    return wide_pick(meets, error + 4 * slop, wide_of(0));
}

/* The last rays, too few for a register, are copied to where one can be read. */
static wide aim_rest(struct stream *s, const struct bvh *b, const struct rays *r, const double far[],
                     int i)
{
    double copy[7][WIDE] = { { 0 } };
    const double *from[] = { r->x, r->y, r->z, r->dx, r->dy, r->dz, far };

    for (int k = 0; k < 7; k++)
        memcpy(copy[k], from[k] + i, (size_t)(r->n - i) * sizeof(double));
    return aim_some(s, i, b, copy[0], copy[1], copy[2], copy[3], copy[4], copy[5], copy[6]);
}

static double highest_of(wide a)
{
    double most = 0;

    for (int i = 0; i < WIDE; i++)
        most = a[i] > most ? a[i] : most;
    return most;
}

void stream_aim(struct stream *s, const struct bvh *b, const struct rays *r, const double far[])
{
    wide apart = wide_of(0);
    int i = 0;

    s->n = r->n;
    for (; i + WIDE <= r->n; i += WIDE)
        apart = wide_max(aim_some(s, i, b, r->x + i, r->y + i, r->z + i, r->dx + i, r->dy + i,
                                  r->dz + i, far + i), apart);
    if (i < r->n)
        apart = wide_max(aim_rest(s, b, r, far, i), apart);
    double most = bvh_float_error + highest_of(apart);
    s->apart = (float)(most + bvh_float_error);         /* the second: of turn, and of boxes made larger */
    s->ball_apart = (float)(most + bvh_ball_error);
}

/* --- going down ------------------------------------------------------------ */

/* The rays of a list: their numbers, and what each may meet, a byte each. */
struct list {
    int n;
    uint64_t ray[STREAM / 8], bits[STREAM / 8];
};

#define EACH_BYTE 0x0101010101010101u

/* Those of the list that bit c names. */
INLINE void pile_add(struct stream_pile *p, const struct list *l, int c, uint32_t child, uint32_t count)
{
    int first = p->used, at = first;

    for (int w = 0; 8 * w < l->n; w++) {
        uint64_t one = l->bits[w] >> c & EACH_BYTE;
#ifdef __BMI2__
        uint64_t some = _pext_u64(l->ray[w], one * 0xff);
        memcpy(p->ray + at, &some, sizeof some);
        at += __builtin_popcountll(one);
#else
        for (int k = 0; k < 8; k++) {
            p->ray[at] = (uint8_t)(l->ray[w] >> 8 * k);
            at += one >> 8 * k & 1;
        }
#endif
    }
    p->used = at;
    p->entry[p->n++] = (struct stream_waiting) { child, count, first, at - first };
}

INLINE struct stream_waiting pile_take(struct stream_pile *p, struct list *l)
{
    struct stream_waiting top = p->entry[--p->n];

    l->n = top.n;
    memcpy(l->ray, p->ray + top.first, sizeof l->ray);
    p->used = top.first;
    return top;
}

struct sides { lanes low[3], high[3]; };

INLINE struct sides sides_of(const struct bvh_node *n, float apart)
{
    struct sides s;

    for (int axis = 0; axis < 3; axis++) {
        s.low[axis] = lanes_sub(lanes_load(n->side[0][axis]), lanes_of(apart));
        s.high[axis] = lanes_add(lanes_load(n->side[1][axis]), lanes_of(apart));
    }
    return s;
}

/* Which boxes lie on a ray's way; nearest: where the first ray enters each. */
INLINE unsigned try_sides(const struct sides *b, const struct stream *s, unsigned i, lanes *nearest)
{
    lanes begin = lanes_of(0), end = lanes_of(s->limit[i]);

    for (int axis = 0; axis < 3; axis++) {
        lanes inverse = lanes_of(s->inverse[axis][i]), turn = lanes_of(s->turn[axis][i]);
        lanes in = lanes_mul_sub(b->low[axis], inverse, turn);
        lanes out = lanes_mul_sub(b->high[axis], inverse, turn);
        begin = lanes_max(lanes_min(in, out), begin);
        end = lanes_min(lanes_max(in, out), end);
    }
    end = lanes_mul(end, lanes_of(1 + 8 * FLT_EPSILON));
    *nearest = lanes_min(lanes_where_not_above(begin, end, begin, lanes_of(FLT_MAX)), *nearest);
    return lanes_not_above(begin, end);
}

INLINE unsigned list_byte(const uint64_t *of, int i) { return of[i / 8] >> 8 * (i % 8) & 0xff; }

/* Returns all bits of all rays. */
INLINE unsigned try_node(const struct bvh_node *n, const struct stream *s, struct list *l, float near[])
{
    struct sides sides = sides_of(n, s->apart);
    lanes nearest = lanes_of(FLT_MAX);
    uint64_t any = 0;

    for (int w = 0; 8 * w < l->n; w++) {
        int left = l->n - 8 * w < 8 ? l->n - 8 * w : 8;
        uint64_t bits = 0, ray = l->ray[w];
        for (int k = 0; k < left; k++, ray >>= 8)
            bits |= (uint64_t)try_sides(&sides, s, ray & 0xff, &nearest) << 8 * k;
        l->bits[w] = bits;
        any |= bits;
    }
    lanes_store(near, nearest);
    any |= any >> 32;
    any |= any >> 16;
    return (any | any >> 8) & 0xff;
}

/* Slots of the bits, the farthest first. */
INLINE int sort_slots(unsigned bits, const float near[], int slot[])
{
    int n = 0;

    for (; bits; bits &= bits - 1) {
        int i = __builtin_ctz(bits), at = n++;
        for (; at > 0 && near[slot[at - 1]] < near[i]; at--)
            slot[at] = slot[at - 1];
        slot[at] = i;
    }
    return n;
}

INLINE int list_slots(unsigned bits, int slot[])
{
    int n = 0;

    for (; bits; bits &= bits - 1)
        slot[n++] = __builtin_ctz(bits);
    return n;
}

struct balls { lanes x, y, z, radius; };

/* As bvh_test_balls. */
INLINE unsigned try_balls(const struct balls *b, const struct stream *s, unsigned i)
{
    lanes x = lanes_sub(b->x, lanes_of(s->at[0][i])), dx = lanes_of(s->dir[0][i]);
    lanes y = lanes_sub(b->y, lanes_of(s->at[1][i])), dy = lanes_of(s->dir[1][i]);
    lanes z = lanes_sub(b->z, lanes_of(s->at[2][i])), dz = lanes_of(s->dir[2][i]);
    lanes t = lanes_add(lanes_add(lanes_mul(x, dx), lanes_mul(y, dy)), lanes_mul(z, dz));

    t = lanes_mul(t, lanes_of(s->over[i]));
    x = lanes_mul_sub(t, dx, x);
    y = lanes_mul_sub(t, dy, y);
    z = lanes_mul_sub(t, dz, z);
    lanes apart = lanes_add(lanes_add(lanes_mul(x, x), lanes_mul(y, y)), lanes_mul(z, z));
    return lanes_not_above(apart, lanes_mul(b->radius, b->radius))
           & lanes_not_above(lanes_sub(t, b->radius), lanes_of(s->limit[i]))
           & lanes_not_above(lanes_of(0), lanes_add(t, b->radius));
}

/* These leave of the list the rays that may meet something. */

static int sift_by_balls(const struct bvh *b, const struct stream *s, const struct stream_waiting *leaf,
                         const struct list *l, uint8_t ray[], uint8_t bits[])
{
    const struct balls balls = { lanes_load(b->ball[0] + leaf->child),
                                 lanes_load(b->ball[1] + leaf->child),
                                 lanes_load(b->ball[2] + leaf->child),
                                 lanes_add(lanes_load(b->ball[3] + leaf->child), lanes_of(s->ball_apart)) };
    unsigned all = (1u << leaf->count) - 1;
    int n = 0;

    for (int i = 0; i < l->n; i++) {
        unsigned k = list_byte(l->ray, i), may = try_balls(&balls, s, k) & all;
        ray[n] = (uint8_t)k;
        bits[n] = (uint8_t)may;
        n += may != 0;
    }
    return n;
}

INLINE unsigned try_bricks(const struct brick_lanes *b, const struct stream *s, unsigned i)
{
    const lanes at[] = { lanes_of(s->at[0][i]), lanes_of(s->at[1][i]), lanes_of(s->at[2][i]) };
    const lanes dir[] = { lanes_of(s->dir[0][i]), lanes_of(s->dir[1][i]), lanes_of(s->dir[2][i]) };

    return brick_test(b, at, dir, lanes_of(s->limit[i]));
}

static int sift_by_bricks(const struct bvh *b, const struct stream *s, const struct stream_waiting *leaf,
                          const struct list *l, uint8_t ray[], uint8_t bits[])
{
    struct brick_lanes bricks;
    int n = 0;

    brick_fetch(b, leaf->child, leaf->count, s->ball_apart, &bricks);
    for (int i = 0; i < l->n; i++) {
        unsigned k = list_byte(l->ray, i);
        unsigned may = brick_bits(try_bricks(&bricks, s, k), leaf->child, leaf->count);
        ray[n] = (uint8_t)k;
        bits[n] = (uint8_t)may;
        n += may != 0;
    }
    return n;
}

static int sift(const struct bvh *b, const struct stream *s, const struct stream_waiting *leaf,
                const struct list *l, uint8_t ray[], uint8_t bits[])
{
    if (b->ball[0])
        return sift_by_balls(b, s, leaf, l, ray, bits);
    if (b->brick)
        return sift_by_bricks(b, s, leaf, l, ray, bits);
    for (int i = 0; i < l->n; i++) {
        ray[i] = (uint8_t)list_byte(l->ray, i);
        bits[i] = (uint8_t)((1u << leaf->count) - 1);
    }
    return l->n;
}

/* All rays that go anywhere wait for the root. */
static void pile_begin(struct stream *s)
{
    struct stream_pile *p = &s->pile;
    int n = 0;

    for (int i = 0; i < s->n; i++) {
        p->ray[n] = (uint8_t)i;
        n += s->limit[i] >= 0;
    }
    p->n = n > 0;
    p->used = n;
    p->entry[0] = (struct stream_waiting) { 0, 0, 0, n };
}

void stream_walk(struct stream *s, const struct bvh *b, bool in_order, stream_visit *visit, void *arg,
                 unsigned long long *box_tests)
{
    struct list list;

    if (b->n_node == 0)
        return;
    pile_begin(s);
    while (s->pile.n) {
        struct stream_waiting at = pile_take(&s->pile, &list);
        if (at.count) {
            uint8_t ray[STREAM], bits[STREAM];
            int n = sift(b, s, &at, &list, ray, bits);
            if (n)
                visit(arg, at.child, ray, bits, n);
            continue;
        }
        const struct bvh_node *node = &b->node[at.child];
        float near[LANES];
        int slot[LANES];
        unsigned any = try_node(node, s, &list, near);
        int n = in_order ? sort_slots(any, near, slot) : list_slots(any, slot);
        *box_tests += (unsigned)list.n * LANES;
        for (int k = 0; k < n; k++)
            pile_add(&s->pile, &list, slot[k], node->child[slot[k]], node->count[slot[k]]);
    }
}
