/* brick.c: slanted boxes that hold a tree's items. */
#include "tree/brick.h"

static const double thinnest = 0x1p-16;         /* in tree units: thinner ones would be all error */
static const double loose = 1 + 0x1p-20;        /* for what rounding does before floats come in */

/* The vectors whose products with the edges are 1 and 0.  False: there are
 * none. */
static bool dual_of(const vec3 edge[3], vec3 row[3])
{
    vec3 across = vec_cross(edge[0], edge[1]);
    double volume = vec_dot(across, edge[2]);

    row[0] = vec_scale(vec_cross(edge[1], edge[2]), 1 / volume);
    row[1] = vec_scale(vec_cross(edge[2], edge[0]), 1 / volume);
    row[2] = vec_scale(across, 1 / volume);
    return vec_is_finite(row[0]) && vec_is_finite(row[1]) && vec_is_finite(row[2]);
}

static double sum_of(vec3 a) { return fabs(a.x) + fabs(a.y) + fabs(a.z); }

static void put(float (*rows)[LANES], int from, unsigned lane, vec3 a)
{
    rows[from][lane] = (float)a.x;
    rows[from + 1][lane] = (float)a.y;
    rows[from + 2][lane] = (float)a.z;
}

/* Zeros, which all rays meet, stay where there is no brick. */
static void lay(const struct bvh *b, float (*rows)[LANES], unsigned lane, struct brick brick)
{
    double largest = 0;
    vec3 row[3];

    for (int i = 0; i < 3; i++)
        brick.edge[i] = vec_scale(brick.edge[i], b->scale * loose);
    if (!dual_of(brick.edge, row))
        return;
    for (int i = 0; i < 3; i++) {
        double sum = sum_of(row[i]);
        if (sum > 1 / thinnest)
            row[i] = vec_scale(row[i], 1 / (thinnest * sum));
        largest = larger(largest, smaller(sum, 1 / thinnest));
        put(rows, BRICK_ROW + 3 * i, lane, row[i]);
    }
    put(rows, BRICK_CENTRE, lane, vec_scale(vec_sub(brick.centre, b->middle), b->scale));
    rows[BRICK_SUM][lane] = (float)(largest * loose);
}

/* A chunk more than there are items: a leaf's may be read from two. */
void bvh_add_bricks(struct bvh *b, const struct brick_source *s, struct arena *mem)
{
    size_t chunks = b->n_item / LANES + 2;

    b->brick = arena_alloc_aligned(mem, chunks * BRICK_FLOATS * sizeof *b->brick, sizeof *b->brick);
    for (size_t i = 0; i < b->n_item; i++) {
        struct brick one;
        bvh_fetch_ahead(b, i, s->fetch, s->of);
        if (s->brick(s->of, b->item[i], &one))
            lay(b, b->brick + i / LANES * BRICK_FLOATS, i % LANES, one);
    }
}

unsigned bvh_test_bricks(const struct bvh *b, const struct bvh_ray *r, uint32_t first, uint32_t count,
                         float far)
{
    const lanes at[] = { lanes_of(r->at[0]), lanes_of(r->at[1]), lanes_of(r->at[2]) };
    const lanes dir[] = { lanes_of(r->dir[0]), lanes_of(r->dir[1]), lanes_of(r->dir[2]) };
    struct brick_lanes bricks;

    brick_fetch(b, first, count, r->apart, &bricks);
    return brick_bits(brick_test(&bricks, at, dir, lanes_of(far)), first, count);
}
