/* function.h: the pattern of a function's values. */
#ifndef RTC_FUNCTION_PATTERN_H
#define RTC_FUNCTION_PATTERN_H

#include "pattern/pattern.h"

/* A number at each point, worked out by somebody who knows this folder (the
 * language's functions). */
struct callable {
    void (*many)(const void *self, int n, const double *x, const double *y, const double *z,
                 double *value);
    const void *self;
};

struct function_pattern { struct callable function; };     /* self of the row "function" */

#endif
