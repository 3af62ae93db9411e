/* leopard.c: round spots (facts patterns.md 3.20). */
#include "pattern/patterns.h"

static double at(const void *self, vec3 p)
{
    double v = (sin(p.x) + sin(p.y) + sin(p.z)) / 3;

    (void)self;
    return v * v;
}

POINTWISE(values, at)

const struct pattern_ops pattern_leopard = {
    .name = "leopard", .help = "round spots in a grid", .values = values,
};
