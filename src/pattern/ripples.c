/* ripples.c: ripples and waves from random sources (facts patterns.md 3.27). */
#include "math/random.h"
#include "pattern/patterns.h"

struct sources {
    struct pattern_block block;
    const struct source { vec3 at; double frequency; } *source;
};

static const struct sources defaults = { PATTERN_BLOCK, NULL };

static const char *prepare(void *self, struct arena *mem)
{
    struct sources *s = self;
    uint32_t state = (uint32_t)-560851967;

    if (s->block.number_of_waves < 1)
        s->block.number_of_waves = 1;
    struct source *source = arena_array(mem, (size_t)s->block.number_of_waves, sizeof *source);
    for (int i = 0; i < s->block.number_of_waves; i++) {
        state = random_step(state);
        source[i].at = vec_unit(noise_vector(vec(i, 0, 0)));
        source[i].frequency = (state >> 16 & 32767) * 0.000030518509476 + 0.01;
    }
    s->source = source;
    return NULL;
}

static double distance(const struct source *s, vec3 p)
{
    double d = vec_length(vec_sub(p, s->at));
    return d == 0 ? 1 : d;
}

static double ripples(const void *self, vec3 p)
{
    const struct sources *s = self;
    const struct pattern_block *b = &s->block;
    double sum = 0;

    for (int i = 0; i < b->number_of_waves; i++)
        sum += cycle(distance(&s->source[i], p) * b->frequency + b->phase);
    return 0.5 * (1 + sum / b->number_of_waves);
}

static double waves(const void *self, vec3 p)
{
    const struct sources *s = self;
    const struct pattern_block *b = &s->block;
    double sum = 0;

    for (int i = 0; i < b->number_of_waves; i++) {
        double f = s->source[i].frequency;
        sum += cycle(distance(&s->source[i], p) * b->frequency * f + b->phase) / f;
    }
    return 0.2 * (2.5 + sum / b->number_of_waves);
}

POINTWISE(ripples_values, ripples)
POINTWISE(waves_values, waves)

const struct pattern_ops pattern_ripples = {
    .name = "ripples", .help = "ripples from random places, all of one length",
    .size = sizeof(struct sources), .defaults = &defaults, .takes_block = true,
    .prepare = prepare, .values = ripples_values,
};
const struct pattern_ops pattern_waves = {
    .name = "waves", .help = "ripples from random places, of different lengths",
    .size = sizeof(struct sources), .defaults = &defaults, .takes_block = true,
    .prepare = prepare, .values = waves_values,
};
