/* split.c: dividing boxes in two. */
#include "tree/split.h"

#include <float.h>
#include <string.h>

enum { BINS = 16 };

/* A bin = (middle - from) * times, where a middle is twice that of a box. */
struct bins {
    quad from, times, last;
    int n;
    bool is_flat[3];                    /* all middles are one along this axis */
    struct box box[3][BINS];
    uint32_t weight[3][BINS];
};

INLINE quad middle(const struct box *b)
{
    return quad_sub(quad_load(b->side), quad_load(b->side + 4));
}

/* Most ranges are small, and many bins would cost more than they gain. */
static int bins_for(uint32_t n) { return n <= 8 ? 4 : n <= 64 ? 8 : 12; }

static void bins_aim(struct bins *b, const struct ref ref[], uint32_t n)
{
    quad low = middle(&ref[0].box), high = low;
    float width[4], times[4] = { 0 };

    for (uint32_t i = 1; i < n; i++) {
        quad m = middle(&ref[i].box);
        low = quad_min(m, low);
        high = quad_max(m, high);
    }
    quad_store(width, quad_sub(high, low));
    for (int axis = 0; axis < 3; axis++) {
        b->is_flat[axis] = !(width[axis] > FLT_MIN * BINS);
        times[axis] = b->is_flat[axis] ? 0 : (float)b->n / width[axis];
    }
    b->from = low;
    b->times = quad_load(times);
    b->last = quad_of((float)(b->n - 1));
}

INLINE void bins_of(const struct bins *b, const struct box *box, int32_t bin[4])
{
    quad at = quad_mul(quad_sub(middle(box), b->from), b->times);

    quad_whole(bin, quad_min(quad_max(at, quad_of(0)), b->last));
}

static void bins_fill(struct bins *b, const struct ref ref[], uint32_t n)
{
    b->n = bins_for(n);
    bins_aim(b, ref, n);
    for (int axis = 0; axis < 3; axis++)
        for (int i = 0; i < b->n; i++) {
            b->box[axis][i] = box_empty;
            b->weight[axis][i] = 0;
        }
    for (uint32_t i = 0; i < n; i++) {
        int32_t bin[4];
        bins_of(b, &ref[i].box, bin);
        for (int axis = 0; axis < 3; axis++) {
            box_join(&b->box[axis][bin[axis]], &ref[i].box);
            b->weight[axis][bin[axis]] += ref[i].weight;
        }
    }
}

struct cut { int axis, bin; float cost; };      /* bins up to and with this one go left */

static void bins_cut(const struct bins *b, int axis, struct cut *best)
{
    const struct box *box = b->box[axis];
    const uint32_t *weight = b->weight[axis];
    float right[BINS + 1];
    struct box all = box_empty;
    uint32_t n = 0;

    for (int i = b->n - 1; i > 0; i--) {
        box_join(&all, &box[i]);
        n += weight[i];
        right[i] = n ? box_area(&all) * (float)(int32_t)n : FLT_MAX;
    }
    all = box_empty;
    n = 0;
    for (int i = 0; i < b->n - 1; i++) {
        box_join(&all, &box[i]);
        n += weight[i];
        float cost = n ? box_area(&all) * (float)(int32_t)n + right[i + 1] : FLT_MAX;
        if (cost < best->cost)
            *best = (struct cut) { axis, i, cost };
    }
}

/* Those of the left side first; each side keeps its order.  Every ref is
 * written to both sides, as no processor could guess which is right. */
static uint32_t partition(const struct bins *b, struct cut cut, struct ref ref[],
                          struct ref spare[], uint32_t n)
{
    uint32_t left = 0, right = 0;

    for (uint32_t i = 0; i < n; i++) {
        int32_t bin[4];
        bins_of(b, &ref[i].box, bin);
        bool is_left = bin[cut.axis] <= cut.bin;
        spare[right] = ref[i];
        ref[left] = ref[i];
        left += is_left;
        right += !is_left;
    }
    memcpy(ref + left, spare, right * sizeof *spare);
    return left;
}

void range_measure(struct range *r, const struct ref ref[])
{
    r->box = box_empty;
    r->weight = 0;
    for (uint32_t i = r->first; i < r->first + r->n; i++) {
        box_join(&r->box, &ref[i].box);
        r->weight += ref[i].weight;
    }
}

/* The sides that the bins know already. */
static void range_of_bins(const struct bins *b, int axis, int from, int to, struct range *r)
{
    r->box = box_empty;
    r->weight = 0;
    for (int i = from; i < to; i++) {
        box_join(&r->box, &b->box[axis][i]);
        r->weight += b->weight[axis][i];
    }
}

static void halve(const struct range *r, const struct ref ref[], struct range out[2])
{
    uint32_t left = r->n / 2;

    out[0] = (struct range) { .first = r->first, .n = left };
    out[1] = (struct range) { .first = r->first + left, .n = r->n - left };
    range_measure(&out[0], ref);
    range_measure(&out[1], ref);
}

void range_split(const struct range *r, struct ref ref[], struct ref spare[], bool evenly,
                 struct range out[2])
{
    struct cut cut = { 0, 0, FLT_MAX };
    struct bins b;

    if (evenly || r->n == 2) {
        halve(r, ref, out);
        return;
    }
    bins_fill(&b, ref + r->first, r->n);
    for (int axis = 0; axis < 3; axis++)
        if (!b.is_flat[axis])
            bins_cut(&b, axis, &cut);
    if (cut.cost == FLT_MAX) {
        halve(r, ref, out);
        return;
    }
    uint32_t left = partition(&b, cut, ref + r->first, spare, r->n);
    range_of_bins(&b, cut.axis, 0, cut.bin + 1, &out[0]);
    range_of_bins(&b, cut.axis, cut.bin + 1, b.n, &out[1]);
    out[0].first = r->first, out[0].n = left;
    out[1].first = r->first + left, out[1].n = r->n - left;
}
