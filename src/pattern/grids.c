/* grids.c: square, triangular, cubic: lists of four and six (facts
 * patterns.md 3.11, 3.32, 3.33). */
#include "pattern/patterns.h"

static bool is_odd(double whole) { return whole / 2 != floor(whole / 2); }

static double square(const void *self, vec3 p)
{
    bool a = is_odd(floor(p.x)), b = is_odd(floor(p.z));

    (void)self;
    return a ? (b ? 2 : 3) : b ? 1 : 0;
}

/* A strip as high as two rows of triangles repeats; the upper row mirrors
 * the lower one. */
static double triangular(const void *self, vec3 p)
{
    const double root = sqrt(3), half = root / 2;
    double x = p.x - 3 * floor(p.x / 3), z = p.z - root * floor(p.z / root);
    bool upper = z >= half;

    (void)self;
    if (!(x < 3 && z < root))           /* too far away to have a place */
        return 0;
    int a = (int)floor(x), kind;
    x -= a;
    if (upper)
        z = root - z;
    if (z < root * x && z < root * (1 - x))
        kind = (6 - 2 * a) % 6;
    else
        kind = ((x == 0 || z >= root * x ? 1 : 3) + 2 * a) % 6;
    return upper ? 5 - kind : kind;
}

/* Which of the six faces of a cube is seen from the origin. */
static double cubic(const void *self, vec3 p)
{
    double x = fabs(p.x), y = fabs(p.y), z = fabs(p.z);

    (void)self;
    if (p.x >= 0 && x >= y && x >= z)
        return 0;
    if (p.y >= 0 && y >= x && y >= z)
        return 1;
    if (p.z >= 0 && z >= x && z >= y)
        return 2;
    if (p.x < 0 && x >= y && x >= z)
        return 3;
    return p.y < 0 && y >= x && y >= z ? 4 : 5;
}

POINTWISE(square_values, square)
POINTWISE(triangular_values, triangular)
POINTWISE(cubic_values, cubic)

const struct pattern_ops pattern_square = {
    .name = "square", .help = "squares of four kinds", .n_list = 4, .values = square_values,
};
const struct pattern_ops pattern_triangular = {
    .name = "triangular", .help = "triangles of six kinds", .n_list = 6,
    .values = triangular_values,
};
const struct pattern_ops pattern_cubic = {
    .name = "cubic", .help = "the six sides around the origin", .n_list = 6,
    .values = cubic_values,
};
