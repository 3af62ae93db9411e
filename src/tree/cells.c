/* cells.c: groups of things that lie together.
 *
 * Space is halved along its then longest side again and again, and each of
 * the cells has a number whose bits say which halves it lies in.  Counting
 * what each cell holds orders everything by that number; then neighbours are
 * taken together while they are few, and cells that hold too much are cut
 * into cells of their own. */
#include "tree/cells.h"

#include <math.h>
#include <string.h>

enum { MOST_BITS = 18, AXIS_BITS = 11, MOST_AGAIN = 8 };
static const double one_place = 1e-200; /* what lies together so closely need not be told apart */

/* How a place becomes a number. */
struct grid {
    vec3 low;
    double times[3];                    /* steps a unit */
    int last[3];                        /* the last step of each axis */
    int bits;
    uint32_t spread[3][1 << AXIS_BITS]; /* the bits that a step stands for */
};

struct sorter {
    struct cells *cells;
    uint32_t most;
    vec3 (*middle)(const void *of, uint32_t item);
    const void *of;
    uint32_t *begin;                    /* of the level at hand: where each cell's items begin, and where the last end */
    int again;                          /* how often cells were cut */
};

static void sort(const struct sorter *outer, uint32_t all[], uint32_t first, uint32_t n, vec3 low,
                 vec3 high);

/* A bit for each cell to hold four items: those that are left together must
 * be few, or they would be cut where there is no reason to. */
static int bits_for(uint32_t n)
{
    int bits = 3;

    while (bits < MOST_BITS && n >> bits > 4)
        bits++;
    return bits;
}

static int longest(const double side[3])
{
    int axis = side[1] > side[0];

    return side[2] > side[axis] ? 2 : axis;
}

/* Bit by bit, the highest first, to the axis along which cells are longest. */
static void share_bits(struct grid *g, const double across[3], int axis_of[])
{
    double side[3] = { across[0], across[1], across[2] };
    int n[3] = { 0, 0, 0 };

    for (int bit = 0; bit < g->bits; bit++) {
        int axis = longest(side);
        axis_of[bit] = axis;
        side[axis] = ++n[axis] < AXIS_BITS ? side[axis] / 2 : -1;
    }
    for (int axis = 0; axis < 3; axis++) {
        g->last[axis] = (1 << n[axis]) - 1;
        g->times[axis] = across[axis] > one_place ? (1 << n[axis]) / across[axis] : 0;
    }
}

static void grid_init(struct grid *g, vec3 low, vec3 high, int bits)
{
    double across[3] = { high.x - low.x, high.y - low.y, high.z - low.z };
    int axis_of[MOST_BITS], left[3];

    g->low = low;
    g->bits = bits;
    share_bits(g, across, axis_of);
    for (int axis = 0; axis < 3; axis++)
        for (int step = 0; step <= g->last[axis]; step++) {
            uint32_t number = 0;
            left[axis] = g->last[axis] + 1;
            for (int bit = 0; bit < bits; bit++)
                if (axis_of[bit] == axis && (step & (left[axis] /= 2)))
                    number |= 1u << (bits - 1 - bit);
            g->spread[axis][step] = number;
        }
}

static int step_of(const struct grid *g, int axis, double x)
{
    int step = (int)x;

    return step < g->last[axis] ? step : g->last[axis];
}

static uint32_t cell_of(const struct grid *g, vec3 p)
{
    return g->spread[0][step_of(g, 0, (p.x - g->low.x) * g->times[0])]
           | g->spread[1][step_of(g, 1, (p.y - g->low.y) * g->times[1])]
           | g->spread[2][step_of(g, 2, (p.z - g->low.z) * g->times[2])];
}

static void append(struct cells *c, uint32_t first, uint32_t n)
{
    c->cell = arena_grow(c->mem, c->cell, c->n, &c->room, sizeof *c->cell);
    c->cell[c->n++] = (struct cell) { first, n };
}

static vec3 least(vec3 a, vec3 b)
{
    return vec(smaller(a.x, b.x), smaller(a.y, b.y), smaller(a.z, b.z));
}

static vec3 most(vec3 a, vec3 b)
{
    return vec(larger(a.x, b.x), larger(a.y, b.y), larger(a.z, b.z));
}

/* What a single cell holds, by cells of its own. */
static void sort_again(const struct sorter *s, uint32_t item[], uint32_t first, uint32_t n)
{
    vec3 low = vec(1, 1, 1), high = vec(-1, -1, -1);

    for (uint32_t i = first; i < first + n; i++) {
        vec3 p = s->middle(s->of, item[i]);
        low = least(low, p);
        high = most(high, p);
    }
    if (s->again == MOST_AGAIN || !(vec_largest(vec_sub(high, low)) > one_place))
        append(s->cells, first, n);
    else
        sort(s, item, first, n, low, high);
}

/* The items of the 2^bits cells from number on, which are all that begin
 * with the same bits. */
static void gather(const struct sorter *s, uint32_t item[], uint32_t number, int bits)
{
    uint32_t first = s->begin[number], n = s->begin[number + (1u << bits)] - first;

    if (n == 0)
        return;
    if (n <= s->most) {
        append(s->cells, first, n);
    } else if (bits == 0) {
        sort_again(s, item, first, n);
    } else {
        gather(s, item, number, bits - 1);
        gather(s, item, number + (1u << (bits - 1)), bits - 1);
    }
}

/* Orders item and fills s->begin, which is all 0. */
static void count(const struct sorter *s, const struct grid *g, uint32_t item[], uint32_t first,
                  uint32_t n, uint32_t key[], uint32_t sorted[])
{
    uint32_t *begin = s->begin, cells = 1u << g->bits, at = 0;

    for (uint32_t i = 0; i < n; i++)
        begin[key[i] = cell_of(g, s->middle(s->of, item[i]))]++;
    for (uint32_t i = 0; i < cells; i++) {
        uint32_t here = begin[i];
        begin[i] = at;
        at += here;
    }
    for (uint32_t i = 0; i < n; i++)
        sorted[begin[key[i]]++] = item[i];
    for (uint32_t i = cells; i > 0; i--)
        begin[i] = begin[i - 1] + first;
    begin[0] = first;
    memcpy(item, sorted, n * sizeof *item);
}

static void sort(const struct sorter *outer, uint32_t all[], uint32_t first, uint32_t n, vec3 low,
                 vec3 high)
{
    struct sorter s = *outer;
    struct arena mem;

    s.again++;
    arena_init(&mem, s.cells->mem->budget);
    struct grid *g = arena_alloc(&mem, sizeof *g);
    grid_init(g, low, high, bits_for(n));
    s.begin = arena_array(&mem, (1u << g->bits) + 1, sizeof *s.begin);
    uint32_t *key = arena_array(&mem, 2 * (size_t)n, sizeof *key);
    count(&s, g, all + first, first, n, key, key + n);
    gather(&s, all, 0, g->bits);
    arena_free(&mem);
}

void cells_make(struct cells *c, uint32_t item[], uint32_t n, uint32_t most,
                vec3 (*middle)(const void *of, uint32_t item), const void *of)
{
    struct sorter s = { .cells = c, .most = most, .middle = middle, .of = of };

    if (n <= most)
        append(c, 0, n);
    else
        sort(&s, item, 0, n, vec(-1, -1, -1), vec(1, 1, 1));
}
