/* radial.c: around the y axis (facts patterns.md 3.26). */
#include "pattern/patterns.h"

static double at(const void *self, vec3 p)
{
    (void)self;
    if (fabs(p.x) < 0.001 && fabs(p.z) < 0.001)
        return 0.25;
    return 0.25 + (atan2(p.x, p.z) + M_PI) / (2 * M_PI);
}

POINTWISE(values, at)

const struct pattern_ops pattern_radial = {
    .name = "radial", .help = "around the y axis, like a fan", .values = values,
};
