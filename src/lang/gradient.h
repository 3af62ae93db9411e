/* gradient.h: how steep a function is. */
#ifndef RTC_GRADIENT_H
#define RTC_GRADIENT_H

#include "lang/state.h"
#include "math/vec.h"

/* The greatest slope found of a function of x, y, z in a box, and where. */
double gradient_steepest(const struct function *f, vec3 low, vec3 high, vec3 *where);

#endif
