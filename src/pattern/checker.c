/* checker.c: unit cubes of two kinds in turn (facts patterns.md 3.9). */
#include "pattern/patterns.h"

KERNEL static void values(const void *self, int n, const double *restrict x,
                          const double *restrict y, const double *restrict z,
                          double *restrict value)
{
    (void)self;
    for (int i = 0; i < n; i++) {
        double half = (floor(x[i] + BORDER) + floor(y[i] + BORDER) + floor(z[i] + BORDER)) / 2;
        value[i] = half == floor(half) ? 0 : 1;
    }
}

const struct pattern_ops pattern_checker = {
    .name = "checker", .help = "cubes of two kinds in turn", .n_list = 2, .values = values,
};
