/* quilted.c: cushions (facts patterns.md 3.25). */
#include "pattern/patterns.h"

struct quilted { double control0, control1; };

static const struct quilted defaults = { 1, 1 };

static const struct field words[] = {
    { "control0", FIELD_NUM, offsetof(struct quilted, control0), ANY,
      "slope of the cushions at their middle", NULL },
    { "control1", FIELD_NUM, offsetof(struct quilted, control1), ANY,
      "slope of the cushions at their seams", NULL },
    FIELD_END
};

/* From the cell's middle; POV-Ray takes exact negative numbers one lower. */
static double from_middle(double c)
{
    return c - (c >= 0 ? floor(c) : -floor(-c) - 1) - 0.5;
}

static double at(const void *self, vec3 p)
{
    const struct quilted *q = self;
    double c0 = (double)(float)q->control0, c1 = (double)(float)q->control1;
    vec3 u = vec(from_middle(p.x), from_middle(p.y), from_middle(p.z));
    double t = vec_length(u), s = 1 - t;
    double bulge = 1.154700538 * (t * t * t + 3 * t * s * s * c0 + 3 * t * t * s * c1);

    return bulge * (fabs(u.x) + fabs(u.y) + fabs(u.z)) / 3;
}

POINTWISE(values, at)

const struct pattern_ops pattern_quilted = {
    .name = "quilted", .help = "cushions", .size = sizeof(struct quilted),
    .defaults = &defaults, .words = words, .values = values,
};
