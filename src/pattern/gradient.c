/* gradient.c: gradient V: along a direction, again and again (facts
 * patterns.md 3.15). */
#include "pattern/patterns.h"

struct gradient { vec3 direction; };

static const struct gradient defaults = { { 1, 0, 0 } };

static const struct field args[] = {
    { "", FIELD_POINT, offsetof(struct gradient, direction), ANY, "direction", NULL },
    FIELD_END
};

/* Division, so that an axis stays exact. */
static const char *prepare(void *self, struct arena *mem)
{
    struct gradient *g = self;
    double length = vec_length(g->direction);

    (void)mem;
    if (!(length > 0) || isinf(length))
        return "zero direction";
    g->direction = vec(g->direction.x / length, g->direction.y / length, g->direction.z / length);
    return NULL;
}

/* A whole number stays 1 only at 1 itself, as in POV-Ray. */
KERNEL static void values(const void *self, int n, const double *restrict x,
                          const double *restrict y, const double *restrict z,
                          double *restrict value)
{
    const vec3 d = ((const struct gradient *)self)->direction;

    for (int i = 0; i < n; i++) {
        double v = x[i] * d.x + y[i] * d.y + z[i] * d.z;
        value[i] = v > 1 ? v - floor(v) : v;
    }
}

const struct pattern_ops pattern_gradient = {
    .name = "gradient", .help = "from 0 to 1 along a direction, again and again",
    .size = sizeof(struct gradient), .defaults = &defaults, .args = args,
    .prepare = prepare, .values = values,
};
