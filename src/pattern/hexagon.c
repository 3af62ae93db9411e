/* hexagon.c: hexagons of three kinds, upright along y (facts patterns.md 3.17). */
#include "pattern/patterns.h"

static double floored_mod(double a, double b) { return a - b * floor(a / b); }

/* The plane is cut into strips along x, of which every third is slanted. */
static double at(const void *self, vec3 p)
{
    static const int straight[2][6] = { { 0, 1, 1, 2, 2, 0 }, { 2, 2, 0, 0, 1, 1 } };
    static const int slanted[2][6] = { { 0, 2, 1, 0, 2, 1 }, { 2, 1, 0, 2, 1, 0 } };
    double x = floored_mod(2 * fabs(p.x), 6);
    double z = floored_mod((p.z < 0 ? 5.196152424 - fabs(p.z) : p.z) / 0.866025404, 6);

    (void)self;
    if (!(x < 6 && z < 6))              /* too far away to have a place */
        return 0;
    int a = (int)floor(x), b = (int)floor(z);
    if (a == 0 || a == 5)
        return straight[0][b];
    if (a == 2 || a == 3)
        return straight[1][b];
    double across = x - a, along = z - b;
    if ((a + b) % 2)
        across = 1 - across;
    if (across == 0)
        across = 0.0001;
    return slanted[along / across < 1 ? 0 : 1][b];
}

POINTWISE(values, at)

const struct pattern_ops pattern_hexagon = {
    .name = "hexagon", .help = "hexagons of three kinds", .n_list = 3, .values = values,
};
