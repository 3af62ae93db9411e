/* marble.c: marble and wood: their turbulence is part of the formula and
 * does not move the point (facts patterns.md 3.21, 3.35). */
#include "pattern/patterns.h"

static double marble(const void *self, vec3 p)
{
    const struct pattern_block *b = self;
    return b->turbulence.x == 0 ? p.x : p.x + b->turbulence.x * block_turbulence(b, p);
}

/* Each axis has its own component of the amount: POV-Ray's values say so,
 * and not what facts patterns.md 3.35 says. */
static double wood(const void *self, vec3 p)
{
    const struct pattern_block *b = self;

    if (vec_largest(b->turbulence) == 0)
        return sqrt(p.x * p.x + p.y * p.y);
    vec3 w = block_vector_turbulence(b, p);
    double x = p.x + cycle((p.x + w.x) * b->turbulence.x);
    double y = p.y + cycle((p.y + w.y) * b->turbulence.y);
    return sqrt(x * x + y * y);
}

POINTWISE(marble_values, marble)
POINTWISE(wood_values, wood)

const struct pattern_ops pattern_marble = {
    .name = "marble", .help = "layers along x, bent by turbulence",
    .size = sizeof(struct pattern_block), .defaults = &pattern_block_default,
    .words = pattern_noise_words, .takes_block = true, .keeps_point = true,
    .values = marble_values,
};
const struct pattern_ops pattern_wood = {
    .name = "wood", .help = "rings around the z axis, bent by turbulence",
    .size = sizeof(struct pattern_block), .defaults = &pattern_block_default,
    .words = pattern_noise_words, .takes_block = true, .keeps_point = true,
    .values = wood_values,
};
