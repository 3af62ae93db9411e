/* brick.h: slanted boxes that hold a tree's items, eight tried at once.
 *
 * Long things that lie askew fill little of their bounds; a box along their
 * own edges passes over most of them before anything of theirs is read. */
#ifndef RTC_BRICK_H
#define RTC_BRICK_H

#include "tree/bvh.h"

struct brick { vec3 centre, edge[3]; };         /* from the centre to three of its faces */

/* Where bricks come from: false for an item that has none. */
struct brick_source {
    bool (*brick)(const void *of, uint32_t item, struct brick *out);
    bvh_fetch *fetch;
    const void *of;
};

/* Gives the items bricks, in their order in the tree. */
void bvh_add_bricks(struct bvh *b, const struct brick_source *s, struct arena *mem);

/* In the tree's unit, floats in rows of eight; an item's lane is its number
 * modulo eight, so that those of a leaf never meet in one.  q = row (p - centre)
 * is within -1..1 inside; the last row is the largest sum of a row's numbers,
 * by which errors of p grow. */
enum { BRICK_CENTRE, BRICK_ROW = 3, BRICK_SUM = 12, BRICK_FLOATS };

struct brick_lanes { lanes v[BRICK_FLOATS], reach; };

INLINE void brick_fetch(const struct bvh *b, uint32_t first, uint32_t count, float apart,
                        struct brick_lanes *out)
{
    static const float number[] = { 0, 1, 2, 3, 4, 5, 6, 7 };
    const float (*row)[LANES] = b->brick + first / LANES * BRICK_FLOATS;
    uint32_t lane = first % LANES;
    lanes at = lanes_load(number), from = lanes_of((float)lane);

    for (int i = 0; i < BRICK_FLOATS; i++)
        out->v[i] = lanes_load(row[i]);
    if (lane + count > LANES)
        for (int i = 0; i < BRICK_FLOATS; i++)
            out->v[i] = lanes_where_not_above(from, at, out->v[i], lanes_load(row[BRICK_FLOATS + i]));
    out->reach = lanes_mul_add(out->v[BRICK_SUM], lanes_of(apart), lanes_of(1));
}

/* Bit k: item first + k may be met. */
INLINE unsigned brick_bits(unsigned lane_bits, uint32_t first, uint32_t count)
{
    unsigned turn = first % LANES;

    return (lane_bits >> turn | lane_bits << (LANES - turn)) & ((1u << count) - 1);
}

/* Lanes that a ray may meet: where it is, where it goes, and how far. */
INLINE unsigned brick_test(const struct brick_lanes *b, const lanes at[3], const lanes dir[3], lanes far)
{
    lanes begin = lanes_of(0), end = far;
    lanes x = lanes_sub(at[0], b->v[0]), y = lanes_sub(at[1], b->v[1]), z = lanes_sub(at[2], b->v[2]);

    for (int i = 0; i < 3; i++) {
        const lanes *row = &b->v[BRICK_ROW + 3 * i];
        lanes o = lanes_mul_add(row[0], x, lanes_mul_add(row[1], y, lanes_mul(row[2], z)));
        lanes d = lanes_mul_add(row[0], dir[0], lanes_mul_add(row[1], dir[1], lanes_mul(row[2], dir[2])));
        lanes inverse = lanes_div(lanes_of(1), d);
        lanes in = lanes_mul(lanes_sub(lanes_sub(lanes_of(0), b->reach), o), inverse);
        lanes out = lanes_mul(lanes_sub(b->reach, o), inverse);
        begin = lanes_max(lanes_min(in, out), begin);
        end = lanes_min(lanes_max(in, out), end);
    }
    return lanes_not_above(begin, end);
}

#endif
