/* sieve.c: the corners of the triangles in a tree's leaves, as floats. */
#include "trace/sieve.h"

struct filling {
    struct sieve *sieve;
    const struct bvh *tree;
    const vec3 *(*corner)(const void *of, uint32_t item, int i);
    const void *of;
};

static void fill_leaf(const struct filling *f, uint32_t first, uint32_t n)
{
    const struct bvh *b = f->tree;
    float *at = f->sieve->corner + 9 * (size_t)first;

    for (uint32_t k = 0; k < n; k++)
        for (int i = 0; i < 3; i++) {
            vec3 p = vec_sub(*f->corner(f->of, b->item[first + k], i), b->middle);
            p = vec_scale(p, b->scale);
            at[(3 * (uint32_t)i + 0) * n + k] = (float)p.x;
            at[(3 * (uint32_t)i + 1) * n + k] = (float)p.y;
            at[(3 * (uint32_t)i + 2) * n + k] = (float)p.z;
        }
}

void sieve_init(struct sieve *s, const struct bvh *b,
                const vec3 *(*corner)(const void *of, uint32_t item, int i), const void *of,
                struct arena *mem)
{
    struct filling f = { s, b, corner, of };

    s->corner = arena_array(mem, 9 * b->n_item + LANES, sizeof *s->corner);   /* eight are read at once, also at the end */
    for (size_t i = 0; i < b->n_node; i++)
        for (int slot = 0; slot < LANES; slot++)
            if (b->node[i].count[slot])
                fill_leaf(&f, b->node[i].child[slot], b->node[i].count[slot]);
}
