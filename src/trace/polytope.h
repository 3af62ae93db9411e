/* polytope.h: what half-spaces have in common. */
#ifndef RTC_POLYTOPE_H
#define RTC_POLYTOPE_H

#include "shape/shape.h"

enum { POLYTOPE_FACES = 32 };

/* The part of bounds (which may be infinite) that lies inside of n half-spaces,
 * whose normals are of unit length; rounded outwards.  Where the part reaches
 * without end, or where this is uncertain, bounds as they were. */
struct bounds polytope_bounds(int n, const struct half_space face[], struct bounds within);

#endif
