/* function.c: a function's value (facts patterns.md 3.14). */
#include "pattern/function.h"

#include "pattern/patterns.h"

static void values(const void *self, int n, const double *restrict x, const double *restrict y,
                   const double *restrict z, double *restrict value)
{
    const struct callable *f = &((const struct function_pattern *)self)->function;

    f->many(f->self, n, x, y, z, value);
    for (int i = 0; i < n; i++)
        if (value[i] > 1)
            value[i] = fmod(value[i], 1);
}

static void none(const void *self, int n, const double *x, const double *y, const double *z,
                 double *value)
{
    (void)self, (void)x, (void)y, (void)z;
    for (int i = 0; i < n; i++)
        value[i] = 0;
}

static const struct function_pattern defaults = { { none, NULL } };

const struct pattern_ops pattern_function = {
    .name = "function", .help = "a function's value, its fraction above 1",
    .size = sizeof defaults, .defaults = &defaults, .values = values,
};
