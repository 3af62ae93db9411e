/* onion.c: shells around the origin (facts patterns.md 3.23). */
#include "pattern/patterns.h"

static double at(const void *self, vec3 p)
{
    (void)self;
    return fmod(vec_length(p), 1);
}

POINTWISE(values, at)

const struct pattern_ops pattern_onion = {
    .name = "onion", .help = "shells around the origin", .values = values,
};
