/* gradient.c: how steep a function is, looked up on a grid.
 *
 * An isosurface is found with steps that max_gradient makes safe; where the
 * function is steeper, it has holes.  POV-Ray tells after the picture is made. */
#include "lang/gradient.h"

#include <math.h>

#include "lang/code.h"

enum { SIDE = 12, FOUR = 4 };           /* cells along an axis; samples at each */

static const double most_rounds = 1e6;  /* of sums and calls: only a warning comes of it */
static const double step = 1e-6;        /* of the box's side: far above rounding, far below detail */

struct samples { double x[SIDE * FOUR], y[SIDE * FOUR], z[SIDE * FOUR], value[SIDE * FOUR]; };

/* One row of cells along x: each cell's centre and a step along each axis. */
static void place(struct samples *s, vec3 low, vec3 side, int j, int k)
{
    for (int i = 0; i < SIDE * FOUR; i++) {
        int axis = i % FOUR;
        s->x[i] = low.x + side.x * ((i / FOUR + 0.5) / SIDE + (axis == 1 ? step : 0));
        s->y[i] = low.y + side.y * ((j + 0.5) / SIDE + (axis == 2 ? step : 0));
        s->z[i] = low.z + side.z * ((k + 0.5) / SIDE + (axis == 3 ? step : 0));
    }
}

static double slope(const double *value, vec3 side)
{
    double x = (value[1] - value[0]) / (side.x * step);
    double y = (value[2] - value[0]) / (side.y * step);
    double z = (value[3] - value[0]) / (side.z * step);

    return sqrt(x * x + y * y + z * z);
}

double gradient_steepest(const struct function *f, vec3 low, vec3 high, vec3 *where)
{
    vec3 side = vec_sub(high, low);
    double most = 0, left = most_rounds;

    for (int row = 0; row < SIDE * SIDE && left > 0; row++) {
        struct samples s;
        place(&s, low, side, row % SIDE, row / SIDE);
        function_many(f, SIDE * FOUR, (const double *[]) { s.x, s.y, s.z }, s.value, &left);
        for (int i = 0; i < SIDE * FOUR; i += FOUR) {
            double found = slope(s.value + i, side);
            if (isfinite(found) && found > most) {
                most = found;
                *where = vec(s.x[i], s.y[i], s.z[i]);
            }
        }
    }
    return most;
}
