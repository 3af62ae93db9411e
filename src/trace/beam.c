/* beam.c: rays that lie close together go down a tree as one.
 *
 * Where the rays enter the tree, or begin, and where they leave it, or end,
 * are two boxes.  All of the rays lie in the hull of both, which is the first
 * box moving over to the second and becoming it; a node's box is on the way
 * if there is a moment s, 0 to 1, at which the moving box overlaps it. */
#include "trace/beam.h"

#include <string.h>

#include "math/wide.h"

enum { MOST_NODES = 48 };               /* of a walk that is worth it */

static const double step_error = 0x1p-45;       /* see bvh.c */
static const double float_error = 0x1p-20;      /* of the walk, in tree units */

/* --- the two boxes --------------------------------------------------------- */

struct extent { wide low, high; };

struct ends { struct extent at[2][3]; wide far_off; };      /* far_off: the largest coordinate */

struct line { wide o, d, inverse; };

INLINE struct line line_of(const double *from, const double *dir, double middle, double scale)
{
    wide d = wide_load(dir) * scale;

    return (struct line) { (wide_load(from) - middle) * scale, d, 1 / d };
}

INLINE void line_clip(const struct line *l, wide reach, wide *begin, wide *end)
{
    wide a = (-reach - l->o) * l->inverse, b = (reach - l->o) * l->inverse;

    *begin = wide_max(wide_min(a, b), *begin);
    *end = wide_min(wide_max(a, b), *end);
}

/* Rays that miss the tree change nothing. */
INLINE void extent_join(struct extent *e, wide at, wide_mask misses)
{
    e->low = wide_min(wide_pick(misses, wide_of(INFINITY), at), e->low);
    e->high = wide_max(wide_pick(misses, wide_of(-INFINITY), at), e->high);
}

INLINE wide size_of(wide a) { return wide_max(a, -a); }

static const double longest = 1e290;    /* a t that is nearly infinite */

static void ends_join(struct ends *e, const struct bvh *b, const struct rays *r, const double *far,
                      int i)
{
    const struct line x = line_of(r->x + i, r->dx + i, b->middle.x, b->scale);
    const struct line y = line_of(r->y + i, r->dy + i, b->middle.y, b->scale);
    const struct line z = line_of(r->z + i, r->dz + i, b->middle.z, b->scale);
    wide off = wide_max(size_of(x.o), wide_max(size_of(y.o), size_of(z.o)));
    wide error = (off + 1) * step_error;
    wide begin = wide_of(0), end = wide_of(longest);

    if (far)
        end = wide_min(wide_load(far + i), end);
    line_clip(&x, b->half.x + error, &begin, &end);
    line_clip(&y, b->half.y + error, &begin, &end);
    line_clip(&z, b->half.z + error, &begin, &end);
    wide_mask misses = wide_below(end, begin);
    e->far_off = wide_max(wide_pick(misses, wide_of(0), off), e->far_off);
    const struct line *line[] = { &x, &y, &z };
    for (int axis = 0; axis < 3; axis++) {
        extent_join(&e->at[0][axis], line[axis]->o + begin * line[axis]->d, misses);
        extent_join(&e->at[1][axis], line[axis]->o + end * line[axis]->d, misses);
    }
}

/* One side of the moving box: at moment s it is at from + s / inverse. */
struct side { lanes from, inverse; bool falls; };

struct beam { struct side low[3], high[3]; };

static struct side side_of(double from, double to)
{
    double way = to - from;
    float inverse = fabs(way) > 1e-30 ? (float)(1 / way) : copysignf(1e30f, (float)way);

    return (struct side) { lanes_of((float)from), lanes_of(inverse), inverse < 0 };
}

static double lowest_of(wide a)
{
    double low = a[0];

    for (int i = 1; i < WIDE; i++)
        low = a[i] < low ? a[i] : low;
    return low;
}

static double highest_of(wide a) { return -lowest_of(-a); }

enum reach { REACH_NOTHING, REACH_SOME, REACH_UNKNOWN };

static enum reach beam_of(const struct bvh *b, const struct rays *r, const double *far,
                          struct beam *out)
{
    const struct extent none = { wide_of(INFINITY), wide_of(-INFINITY) };
    struct ends e = { { { none, none, none }, { none, none, none } }, wide_of(0) };

    for (int i = 0; i + WIDE < r->n; i += WIDE)
        ends_join(&e, b, r, far, i);
    ends_join(&e, b, r, far, r->n - WIDE);      /* the last: again or not, it changes nothing */
    if (highest_of(e.at[0][0].high) == -INFINITY)
        return REACH_NOTHING;
    double pad = float_error + (highest_of(e.far_off) + 1) * step_error;
    for (int axis = 0; axis < 3; axis++) {
        double low[2], high[2];
        for (int k = 0; k < 2; k++) {
            low[k] = lowest_of(e.at[k][axis].low) - pad;
            high[k] = highest_of(e.at[k][axis].high) + pad;
            if (!(low[k] > -4 && high[k] < 4))
                return REACH_UNKNOWN;
        }
        out->low[axis] = side_of(low[0], low[1]);
        out->high[axis] = side_of(high[0], high[1]);
    }
    return REACH_SOME;
}

/* --- the walk -------------------------------------------------------------- */

/* The moments at which the moving box's low side is below the other's high
 * one, and its high side above the other's low one. */
INLINE void beam_clip(const struct bvh_node *n, const struct beam *b, int axis, lanes *begin,
                      lanes *end)
{
    const struct side *low = &b->low[axis], *high = &b->high[axis];
    lanes under = lanes_mul(lanes_sub(lanes_load(n->side[1][axis]), low->from), low->inverse);
    lanes over = lanes_mul(lanes_sub(lanes_load(n->side[0][axis]), high->from), high->inverse);

    if (low->falls)
        *begin = lanes_max(under, *begin);
    else
        *end = lanes_min(under, *end);
    if (high->falls)
        *end = lanes_min(over, *end);
    else
        *begin = lanes_max(over, *begin);
}

INLINE unsigned beam_test(const struct bvh_node *n, const struct beam *b, float near[])
{
    lanes begin = lanes_of(0), end = lanes_of(1);

    for (int axis = 0; axis < 3; axis++)
        beam_clip(n, b, axis, &begin, &end);
    lanes_store(near, begin);
    return lanes_not_above(begin, end);
}

struct finds {
    uint32_t *place;
    float near[FEW];
    int n, room;
};

static bool find(struct finds *f, const struct bvh_node *node, int slot, float near)
{
    if (f->n + (int)node->count[slot] > f->room)
        return false;
    for (uint32_t i = 0; i < node->count[slot]; i++) {
        int at = f->n++;
        for (; at > 0 && f->near[at - 1] > near; at--) {
            f->near[at] = f->near[at - 1];
            f->place[at] = f->place[at - 1];
        }
        f->near[at] = near;
        f->place[at] = node->child[slot] + i;
    }
    return true;
}

static bool walk(const struct bvh *b, const struct beam *beam, struct finds *f,
                 unsigned long long *box_tests)
{
    uint32_t stack[MOST_NODES + LANES] = { 0 };
    int top = 1;

    for (int visited = 0; top > 0; visited++) {
        const struct bvh_node *node = &b->node[stack[--top]];
        float near[LANES];
        if (visited == MOST_NODES)
            return false;
        *box_tests += LANES;
        for (unsigned bits = beam_test(node, beam, near); bits; bits &= bits - 1) {
            int slot = __builtin_ctz(bits);
            if (node->count[slot] == 0 && top < MOST_NODES)
                stack[top++] = node->child[slot];
            else if (node->count[slot] == 0 || !find(f, node, slot, near[slot]))
                return false;
        }
    }
    return true;
}

int beam_walk(const struct bvh *b, const struct rays *r, const double *far, uint32_t place[],
              int room, unsigned long long *box_tests)
{
    struct finds f = { .place = place, .room = room };
    struct beam beam;

    if (b->n_node == 0)
        return 0;
    switch (beam_of(b, r, far, &beam)) {
    case REACH_NOTHING: return 0;
    case REACH_UNKNOWN: return BEAM_TOO_MUCH;
    case REACH_SOME:    break;
    }
    return walk(b, &beam, &f, box_tests) ? f.n : BEAM_TOO_MUCH;
}
