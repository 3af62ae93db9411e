/* spiral.c: spiral1 N, spiral2 N: N arms around the z axis (facts
 * patterns.md 3.29). */
#include "pattern/patterns.h"

struct spiral {
    struct pattern_block block;
    int arms;
};

static const struct spiral defaults = { PATTERN_BLOCK, 1 };

static const struct field args[] = {
    { "", FIELD_INT, offsetof(struct spiral, arms), ANY, "number of arms", NULL },
    FIELD_END
};

/* From -y, about z. */
static double angle(double x, double y, double r)
{
    if (r == 0)
        return 0;
    return x < 0 ? 3 * M_PI / 2 - asin(y / r) : M_PI / 2 + asin(y / r);
}

static double arms_at(const struct spiral *s, vec3 p, double r)
{
    double v = p.z + r + s->arms * angle(p.x, p.y, r) / (2 * M_PI), t = s->block.turbulence.x;
    return t == 0 ? v : v + t * block_turbulence(&s->block, p);
}

static double one(const void *self, vec3 p)
{
    return arms_at(self, p, sqrt(p.x * p.x + p.y * p.y));
}

static double two(const void *self, vec3 p)
{
    double r = sqrt(p.x * p.x + p.y * p.y);
    return triangle(r) + triangle(arms_at(self, p, r));
}

POINTWISE(one_values, one)
POINTWISE(two_values, two)

const struct pattern_ops pattern_spiral1 = {
    .name = "spiral1", .help = "arms around the z axis", .size = sizeof(struct spiral),
    .defaults = &defaults, .args = args, .words = pattern_noise_words, .takes_block = true,
    .values = one_values,
};
const struct pattern_ops pattern_spiral2 = {
    .name = "spiral2", .help = "arms both ways around the z axis", .size = sizeof(struct spiral),
    .defaults = &defaults, .args = args, .words = pattern_noise_words, .takes_block = true,
    .values = two_values,
};
