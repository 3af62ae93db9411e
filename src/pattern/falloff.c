/* falloff.c: boxed, cylindrical, planar, spherical: 1 at the middle, 0 from
 * a distance of 1 on (facts patterns.md 3.5). */
#include "pattern/patterns.h"

INLINE double left_of(double distance) { return distance > 1 ? 0 : 1 - distance; }

static double boxed(const void *self, vec3 p)
{
    (void)self;
    return left_of(vec_largest(p));
}

static double cylindrical(const void *self, vec3 p)
{
    (void)self;
    return left_of(sqrt(p.x * p.x + p.z * p.z));
}

static double planar(const void *self, vec3 p)
{
    (void)self;
    return left_of(fabs(p.y));
}

static double spherical(const void *self, vec3 p)
{
    (void)self;
    return left_of(vec_length(p));
}

POINTWISE(boxed_values, boxed)
POINTWISE(cylindrical_values, cylindrical)
POINTWISE(planar_values, planar)
POINTWISE(spherical_values, spherical)

const struct pattern_ops pattern_boxed = {
    .name = "boxed", .help = "from 1 at the origin to 0 on a cube", .values = boxed_values,
};
const struct pattern_ops pattern_cylindrical = {
    .name = "cylindrical", .help = "from 1 on the y axis to 0 on a tube",
    .values = cylindrical_values,
};
const struct pattern_ops pattern_planar = {
    .name = "planar", .help = "from 1 at y = 0 to 0 above and below", .values = planar_values,
};
const struct pattern_ops pattern_spherical = {
    .name = "spherical", .help = "from 1 at the origin to 0 on a sphere",
    .values = spherical_values,
};
