/* crackle.c: crackle and cells: random points and numbers in unit cubes
 * (facts patterns.md 3.8, 3.10). */
#include "pattern/patterns.h"

struct crackle {
    struct pattern_block block;
    vec3 form;
    vec3 metric;                        /* only its first component is used */
    double offset;
    bool is_solid;
};

static const struct crackle defaults = { PATTERN_BLOCK, { -1, 1, 0 }, { 2, 2, 2 }, 0, false };

static const struct field words[] = {
    { "noise_generator", FIELD_INT, offsetof(struct crackle, block.noise_generator), 0, 3,
      "which noise: 1, 2 or 3; 0: the scene's", NULL },
    { "form", FIELD_POINT, offsetof(struct crackle, form), ANY,
      "weights of the distances to the three nearest points", NULL },
    { "metric", FIELD_POINT, offsetof(struct crackle, metric), ANY,
      "power of the distance: 2 is as the crow flies", NULL },
    { "offset", FIELD_NUM, offsetof(struct crackle, offset), ANY,
      "distance from space as seen from a fourth dimension", NULL },
    { "solid", FIELD_FLAG, offsetof(struct crackle, is_solid), ANY,
      "one value for each cell", NULL },
    FIELD_END
};

/* The points of a cell and of those around, without the corners of the outer
 * layer.  Neighbouring points ask for the same cell again and again; few ask
 * for the outer layer. */
enum { N_INNER = 27, N_POINTS = 81 };

struct crowd {
    vec3 cell;
    int n;                              /* points so far: N_INNER or all */
    vec3 point[N_POINTS];
};

static void add_point(struct crowd *c, int seed, int i, int j, int k)
{
    vec3 in = vec(noise_random(seed), noise_random(seed + 1), noise_random(seed + 2));

    c->point[c->n++] = vec_add(vec_add(c->cell, vec(i, j, k)), in);
}

static void gather_inner(struct crowd *c, vec3 cell)
{
    int seed[3 * 3 * 3], *next = seed;

    c->cell = cell;
    c->n = 0;
    noise_hash_cube(vec_sub(cell, vec(1, 1, 1)), 3, seed);
    for (int i = -1; i <= 1; i++)
        for (int j = -1; j <= 1; j++)
            for (int k = -1; k <= 1; k++)
                add_point(c, *next++, i, j, k);
}

static void gather_outer(struct crowd *c)
{
    int seed[5 * 5 * 5], *next = seed;

    noise_hash_cube(vec_sub(c->cell, vec(2, 2, 2)), 5, seed);
    for (int i = -2; i <= 2; i++)
        for (int j = -2; j <= 2; j++)
            for (int k = -2; k <= 2; k++, next++)
                if ((i * i == 4) + (j * j == 4) + (k * k == 4) == 1)
                    add_point(c, *next, i, j, k);
}

struct three { double d[3]; vec3 nearest; };    /* sums of powers, in increasing order */

INLINE void meet(struct three *t, double d, vec3 q)
{
    if (d >= t->d[2])
        return;
    if (d < t->d[0])
        t->nearest = q;
    t->d[2] = d < t->d[1] ? t->d[1] : d;
    t->d[1] = d < t->d[0] ? t->d[0] : d < t->d[1] ? d : t->d[1];
    t->d[0] = d < t->d[0] ? d : t->d[0];
}

static void meet_all(struct three *t, const struct crowd *c, int from, vec3 p, double metric)
{
    for (int i = from; i < c->n; i++) {
        vec3 d = vec_sub(p, c->point[i]);
        if (metric == 2)
            meet(t, vec_dot(d, d), c->point[i]);
        else if (metric == 1)
            meet(t, fabs(d.x) + fabs(d.y) + fabs(d.z), c->point[i]);
        else
            meet(t, pow(fabs(d.x), metric) + pow(fabs(d.y), metric) + pow(fabs(d.z), metric),
                 c->point[i]);
    }
}

/* How far the outer layer is at least: from 1 on, but for what BORDER and
 * rounding take away. */
static double outer_distance(vec3 p, vec3 cell)
{
    vec3 in = vec_sub(p, cell);
    double low = fmin(in.x, fmin(in.y, in.z)), high = fmax(in.x, fmax(in.y, in.z));

    return fmin(1 + low, 2 - high) - 1e-6;
}

static struct three nearest_three(struct crowd *c, vec3 p, double metric)
{
    struct three t = { { INFINITY, INFINITY, INFINITY }, p };
    double outer = outer_distance(p, c->cell);

    meet_all(&t, c, 0, p, metric);
    if (c->n == N_INNER && !(metric > 0 && t.d[2] <= (metric == 2 ? outer * outer : pow(outer, metric)))) {
        gather_outer(c);
        meet_all(&t, c, N_INNER, p, metric);
    }
    return t;
}

static double root(double sum, double metric)
{
    return metric == 2 ? sqrt(sum) : metric == 1 ? sum : pow(sum, 1 / metric);
}

static double at(const struct crackle *s, struct crowd *c, vec3 p)
{
    vec3 cell = vec(floor(p.x - BORDER), floor(p.y - BORDER), floor(p.z - BORDER));
    double m = s->metric.x;

    if (cell.x != c->cell.x || cell.y != c->cell.y || cell.z != c->cell.z)
        gather_inner(c, cell);
    struct three t = nearest_three(c, p, m);
    if (s->is_solid)
        return noise_at(generator_of(&s->block), t.nearest);
    double more = s->offset != 0 ? pow(s->offset, m) : 0;
    double v = s->form.x * root(t.d[0] + more, m);
    if (s->form.y != 0)
        v += s->form.y * root(t.d[1] + more, m);
    if (s->form.z != 0)
        v += s->form.z * root(t.d[2] + more, m);
    return unit_clamp(v);
}

static void values(const void *self, int n, const double *x, const double *y, const double *z,
                   double *value)
{
    struct crowd crowd = { .cell = { NAN, NAN, NAN } };

    for (int i = 0; i < n; i++)
        value[i] = at(self, &crowd, vec(x[i], y[i], z[i]));
}

const struct pattern_ops pattern_crackle = {
    .name = "crackle", .help = "cracks between random points", .size = sizeof(struct crackle),
    .defaults = &defaults, .words = words, .takes_block = true, .values = values,
};

static double cell_at(const void *self, vec3 p)
{
    (void)self;
    return noise_random(noise_hash(vec(floor(p.x + BORDER), floor(p.y + BORDER),
                                       floor(p.z + BORDER))));
}

POINTWISE(cell_values, cell_at)

const struct pattern_ops pattern_cells = {
    .name = "cells", .help = "a random value for each unit cube", .values = cell_values,
};
