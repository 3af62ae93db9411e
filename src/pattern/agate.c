/* agate.c: bands bent by turbulence (facts patterns.md 3.2). */
#include "pattern/patterns.h"

struct agate {
    struct pattern_block block;
    double amount;
};

static const struct agate defaults = { PATTERN_BLOCK, 1 };

static const struct field words[] = {
    { "noise_generator", FIELD_INT, offsetof(struct agate, block.noise_generator), 0, 3,
      "which noise: 1, 2 or 3; 0: the scene's", NULL },
    { "agate_turb", FIELD_NUM, offsetof(struct agate, amount), ANY, "how much turbulence", NULL },
    FIELD_END
};

static double at(const void *self, vec3 p)
{
    const struct agate *a = self;
    double bend = (double)(float)a->amount * block_turbulence(&a->block, p);
    double v = (cycle(1.3 * bend + 1.1 * p.z) + 1) / 2;

    return v > 0 ? pow(v, 0.77) : 0;
}

POINTWISE(values, at)

const struct pattern_ops pattern_agate = {
    .name = "agate", .help = "bands, like the stone", .size = sizeof(struct agate),
    .defaults = &defaults, .words = words, .takes_block = true, .values = values,
};
