/* shapes.h: the list of all primitives. */
#ifndef RTC_SHAPES_H
#define RTC_SHAPES_H

#include "shape/shape.h"

/* Adding a primitive is adding a row: shape_NAME is defined in its file. */
#define SHAPES(S) \
    S(box) \
    S(cone) \
    S(cylinder) \
    S(disc) \
    S(plane) \
    S(quadric) \
    S(smooth_triangle) \
    S(sphere) \
    S(superellipsoid) \
    S(torus) \
    S(triangle)

#define SHAPE_DECLARE(name) extern const struct shape_ops shape_##name;
SHAPES(SHAPE_DECLARE)
#undef SHAPE_DECLARE

#endif
