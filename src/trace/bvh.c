/* bvh.c: building a tree of boxes, and aiming rays at it.
 *
 * Binned surface area heuristic.  A node takes its (up to) eight children by
 * splitting the largest of them again and again. */
#include "trace/bvh.h"

#include <string.h>

#include "base/jobs.h"

/* A box in tree units, and what it is of. */
struct ref {
    float low[3], high[3];
    uint32_t item;
};

struct range {
    float low[3], high[3];
    uint32_t first, count;
};

enum {
    BINS = 16,
    SPLIT_BY_COUNT = 32,        /* levels after which ranges are halved, so that depth is bounded: */
    MOST_DEPTH = 32 + 11,       /* 2^32 items halved three times a level; 7 * this < BVH_STACK */
    CHUNK = 4096,               /* items that make a job of their own */
    MOST_CHUNKS = 256,
};

struct pending { uint32_t node, slot; struct range range; int depth; };

struct builder {
    struct arena *mem;
    struct ref *ref;
    unsigned leaf_size;
    struct bvh_node *node;
    size_t n_node, room;
    struct pending *pending;    /* left for other threads */
    size_t n_pending, pending_room;
    size_t chunk;               /* 0: nothing is left to others */
};

static void range_clear(struct range *r)
{
    for (int i = 0; i < 3; i++) {
        r->low[i] = FLT_MAX;
        r->high[i] = -FLT_MAX;
    }
    r->count = 0;
}

static void range_join(struct range *r, const float low[3], const float high[3], uint32_t count)
{
    for (int i = 0; i < 3; i++) {
        r->low[i] = low[i] < r->low[i] ? low[i] : r->low[i];
        r->high[i] = high[i] > r->high[i] ? high[i] : r->high[i];
    }
    r->count += count;
}

static float area(const struct range *r)
{
    float x = r->high[0] - r->low[0], y = r->high[1] - r->low[1], z = r->high[2] - r->low[2];

    return r->count ? x * y + y * z + z * x : 0;
}

/* Twice the middle of a box. */
static float centre(const struct ref *r, int axis) { return r->low[axis] + r->high[axis]; }

struct bins {
    float from[3], times[3];            /* bin = (centre - from) * times */
    struct range bin[3][BINS];
};

static int bin_of(const struct bins *b, const struct ref *r, int axis)
{
    int i = (int)((centre(r, axis) - b->from[axis]) * b->times[axis]);

    return i < 0 ? 0 : i < BINS ? i : BINS - 1;
}

static void bins_fill(struct bins *b, const struct ref *ref, uint32_t n)
{
    float high[3];

    for (int axis = 0; axis < 3; axis++) {
        b->from[axis] = high[axis] = centre(ref, axis);
        for (uint32_t i = 1; i < n; i++) {
            float c = centre(&ref[i], axis);
            b->from[axis] = c < b->from[axis] ? c : b->from[axis];
            high[axis] = c > high[axis] ? c : high[axis];
        }
        float width = high[axis] - b->from[axis];
        b->times[axis] = width > FLT_MIN * BINS ? BINS / width : 0;
        for (int i = 0; i < BINS; i++)
            range_clear(&b->bin[axis][i]);
    }
    for (uint32_t i = 0; i < n; i++)
        for (int axis = 0; axis < 3; axis++)
            range_join(&b->bin[axis][bin_of(b, &ref[i], axis)], ref[i].low, ref[i].high, 1);
}

struct cut { int axis, bin; float cost; };      /* bins up to and with this one go left */

static void bins_cut(const struct bins *b, int axis, struct cut *best)
{
    float right[BINS];
    struct range r;

    range_clear(&r);
    for (int i = BINS - 1; i > 0; i--) {
        range_join(&r, b->bin[axis][i].low, b->bin[axis][i].high, b->bin[axis][i].count);
        right[i] = area(&r) * r.count;
    }
    range_clear(&r);
    for (int i = 0; i < BINS - 1; i++) {
        range_join(&r, b->bin[axis][i].low, b->bin[axis][i].high, b->bin[axis][i].count);
        float cost = area(&r) * r.count + right[i + 1];
        if (cost < best->cost)
            *best = (struct cut) { axis, i, cost };
    }
}

static uint32_t partition(const struct bins *b, struct cut cut, struct ref *ref, uint32_t n)
{
    uint32_t left = 0;

    for (uint32_t i = 0; i < n; i++)
        if (bin_of(b, &ref[i], cut.axis) <= cut.bin) {
            struct ref swap = ref[left];
            ref[left++] = ref[i];
            ref[i] = swap;
        }
    return left;
}

static struct range range_of(const struct ref *ref, uint32_t first, uint32_t count)
{
    struct range r;

    range_clear(&r);
    for (uint32_t i = first; i < first + count; i++)
        range_join(&r, ref[i].low, ref[i].high, 1);
    r.first = first;
    return r;
}

static void split(struct builder *b, const struct range *r, int depth, struct range out[2])
{
    struct ref *ref = b->ref + r->first;
    struct cut cut = { 0, 0, FLT_MAX };
    struct bins bins;
    uint32_t left = 0;

    if (depth < SPLIT_BY_COUNT && r->count > 2) {
        bins_fill(&bins, ref, r->count);
        for (int axis = 0; axis < 3; axis++)
            if (bins.times[axis] > 0)
                bins_cut(&bins, axis, &cut);
        if (cut.cost < FLT_MAX)
            left = partition(&bins, cut, ref, r->count);
    }
    if (left == 0 || left == r->count)
        left = r->count / 2;
    out[0] = range_of(b->ref, r->first, left);
    out[1] = range_of(b->ref, r->first + left, r->count - left);
}

/* The largest of the ranges that are more than a leaf; when there are none,
 * of those that may still be divided, as slots would be empty otherwise. */
static int worth_splitting(const struct range r[], int n, unsigned leaf_size)
{
    int best = -1;

    for (int i = 0; i < n; i++) {
        if (r[i].count < 2)
            continue;
        bool big = r[i].count > leaf_size;
        bool best_big = best >= 0 && r[best].count > leaf_size;
        if (best < 0 || big > best_big || (big == best_big && area(&r[i]) > area(&r[best])))
            best = i;
    }
    return best;
}

static int children(struct builder *b, const struct range *whole, int depth, struct range r[LANES])
{
    int n = 1;

    r[0] = *whole;
    while (n < LANES) {
        struct range half[2];
        int i = worth_splitting(r, n, b->leaf_size);
        if (i < 0)
            break;
        split(b, &r[i], depth, half);
        r[i] = half[0];
        memmove(r + i + 2, r + i + 1, (size_t)(n - i - 1) * sizeof *r);
        r[i + 1] = half[1];
        n++;
    }
    return n;
}

static void slot_box(struct bvh_node *n, int slot, const float low[3], const float high[3])
{
    for (int axis = 0; axis < 3; axis++) {
        n->side[0][axis][slot] = low[axis];
        n->side[1][axis][slot] = high[axis];
    }
}

/* No ray meets an inside-out box. */
static void clear(struct bvh_node *n)
{
    static const float above[3] = { 4, 4, 4 }, below[3] = { -4, -4, -4 };

    *n = (struct bvh_node) { .count = { 0 } };
    for (int slot = 0; slot < LANES; slot++)
        slot_box(n, slot, above, below);
}

static uint32_t build_node(struct builder *b, const struct range *whole, int depth)
{
    struct range r[LANES];
    int n = children(b, whole, depth, r);

    b->node = arena_grow(b->mem, b->node, b->n_node, &b->room, sizeof *b->node);
    uint32_t self = (uint32_t)b->n_node++;
    clear(&b->node[self]);
    for (int i = 0; i < n; i++) {
        slot_box(&b->node[self], i, r[i].low, r[i].high);
        b->node[self].child[i] = r[i].first;
        if (r[i].count <= b->leaf_size) {
            b->node[self].count[i] = r[i].count;
        } else if (r[i].count <= b->chunk) {
            b->pending = arena_grow(b->mem, b->pending, b->n_pending, &b->pending_room,
                                    sizeof *b->pending);
            b->pending[b->n_pending++] = (struct pending) { self, (uint32_t)i, r[i], depth + 1 };
        } else {
            uint32_t child = build_node(b, &r[i], depth + 1);
            b->node[self].child[i] = child;
        }
    }
    return self;
}

/* Parts are built in any order and put together in the order in which they
 * were found, so the tree does not depend on the number of threads. */
struct part {
    struct builder builder;
    struct arena mem;
};

struct parts {
    const struct builder *top;
    struct part *part;
};

static void build_part(void *arg, size_t i, unsigned worker)
{
    struct parts *p = arg;
    struct builder *b = &p->part[i].builder;
    const struct pending *from = &p->top->pending[i];

    (void)worker;
    arena_init(&p->part[i].mem, p->top->mem->budget);
    *b = (struct builder) { .mem = &p->part[i].mem, .ref = p->top->ref,
                            .leaf_size = p->top->leaf_size };
    build_node(b, &from->range, from->depth);
}

static void place_part(struct bvh_node *to, const struct bvh_node *from, size_t n, uint32_t offset)
{
    for (size_t i = 0; i < n; i++) {
        to[i] = from[i];
        for (int slot = 0; slot < LANES; slot++)
            if (to[i].count[slot] == 0)
                to[i].child[slot] += offset;
    }
}

static void assemble(struct bvh *tree, struct builder *top, struct part *part, struct arena *mem)
{
    size_t n = top->n_node;

    for (size_t i = 0; i < top->n_pending; i++)
        n += part[i].builder.n_node;
    tree->node = arena_alloc_aligned(mem, n * sizeof *tree->node, 32);
    tree->n_node = top->n_node;
    memcpy(tree->node, top->node, top->n_node * sizeof *tree->node);
    for (size_t i = 0; i < top->n_pending; i++) {
        const struct builder *b = &part[i].builder;
        uint32_t at = (uint32_t)tree->n_node;
        place_part(tree->node + at, b->node, b->n_node, at);
        tree->node[top->pending[i].node].child[top->pending[i].slot] = at;
        tree->n_node += b->n_node;
        arena_free(&part[i].mem);
    }
}

static float rounded_down(double a)
{
    float f = (float)a;

    return (double)f > a ? nextafterf(f, -INFINITY) : f;
}

/* The unit in which everything lies in -1..1. */
static void measure(struct bvh *b, struct bounds all)
{
    int exponent;

    b->middle = vec_add(vec_scale(all.low, 0.5), vec_scale(all.high, 0.5));
    vec3 high = vec_sub(all.high, b->middle), low = vec_sub(b->middle, all.low);
    vec3 half = vec(fmax(high.x, low.x), fmax(high.y, low.y), fmax(high.z, low.z));
    double largest = vec_largest(half);
    frexp(largest, &exponent);
    b->scale = largest > 0 ? ldexp(1, exponent < -1000 ? 1000 : -exponent) : 1;
    b->half = vec_scale(half, b->scale);
}

static void make_refs(struct bvh *b, struct bounds (*box)(const void *of, size_t i),
                      const void *of, struct ref *ref)
{
    struct bounds all = BOUNDS_EMPTY;

    for (size_t i = 0; i < b->n_item; i++)
        all = bounds_join(all, box(of, i));
    measure(b, all);
    for (size_t i = 0; i < b->n_item; i++) {
        struct bounds one = box(of, i);
        for (int axis = 0; axis < 3; axis++) {
            double m = vec_get(b->middle, axis);
            ref[i].low[axis] = rounded_down((vec_get(one.low, axis) - m) * b->scale);
            ref[i].high[axis] = -rounded_down((m - vec_get(one.high, axis)) * b->scale);
        }
        ref[i].item = (uint32_t)i;
    }
}

void bvh_build(struct bvh *tree, size_t n, struct bounds (*box)(const void *of, size_t i),
               const void *of, unsigned leaf_size, unsigned threads, struct arena *mem)
{
    struct arena scrap;
    size_t chunk = n / MOST_CHUNKS > CHUNK ? n / MOST_CHUNKS : CHUNK;

    *tree = (struct bvh) { .n_item = n };
    if (n == 0)
        return;
    arena_init(&scrap, mem->budget);
    struct builder top = { .mem = &scrap, .leaf_size = leaf_size, .chunk = n > 2 * chunk ? chunk : 0 };
    top.ref = arena_array(&scrap, n, sizeof *top.ref);
    make_refs(tree, box, of, top.ref);
    struct range whole = range_of(top.ref, 0, (uint32_t)n);
    build_node(&top, &whole, 0);
    struct part *part = arena_array(&scrap, top.n_pending + 1, sizeof *part);
    jobs_run(threads, top.n_pending, build_part, &(struct parts) { &top, part });
    assemble(tree, &top, part, mem);
    tree->item = arena_array(mem, n, sizeof *tree->item);
    for (size_t i = 0; i < n; i++)
        tree->item[i] = top.ref[i].item;
    arena_free(&scrap);
}

/* Rounding up in the last step pays for the roundings before it. */
void bvh_add_balls(struct bvh *b, bool (*ball)(const void *of, uint32_t item, vec3 *centre, double *radius),
                   const void *of, struct arena *mem)
{
    for (int i = 0; i < 4; i++)         /* eight are read at once, also at the end */
        b->ball[i] = arena_array(mem, b->n_item + LANES, sizeof *b->ball[i]);
    for (size_t i = 0; i < b->n_item; i++) {
        vec3 centre = b->middle;
        double radius = INFINITY;
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
 * is left, of this step and of the origin, moves the origin apart. */
static const double step_error = 0x1p-45, float_error = 0x1p-23;
static const double ball_error = 0x1p-19;       /* of a centre's distance from the line */
static const double flat = 1e-30;       /* in tree units a ray does not move at all along such an axis */

struct aim { double o, dir, inverse; };

INLINE struct aim aim_axis(double origin, double dir, double middle, double scale, double shorten)
{
    double d = dir * shorten;

    return (struct aim) { (origin - middle) * scale, d,
                          fabs(d) > flat ? 1 / d : copysign(1 / flat, d) };
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

INLINE void aim_finish(struct bvh_ray *r, int axis, struct aim a, double begin, double apart)
{
    double at = a.o + begin * a.dir, shift = copysign(apart, a.dir);

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
    double error = (largest(x.o, y.o, z.o) + 1) * step_error;
    double begin = near * unit, end = far * unit;

    aim_clip(x, b->half.x + error, &begin, &end);
    aim_clip(y, b->half.y + error, &begin, &end);
    aim_clip(z, b->half.z + error, &begin, &end);
    if (!(begin <= end))
        return false;
    begin -= fabs(begin) * 1e-12;
    out->start = begin;
    out->unit = unit;
    out->slop = fabs(begin) * step_error;
    double apart = float_error + error + 4 * out->slop;
    aim_finish(out, 0, x, begin, apart);
    aim_finish(out, 1, y, begin, apart);
    aim_finish(out, 2, z, begin, apart);
    out->apart = (float)(apart + ball_error);
    return true;
}
