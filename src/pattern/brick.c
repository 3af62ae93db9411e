/* brick.c: bricks in courses, and the mortar between (facts patterns.md 3.7). */
#include "pattern/patterns.h"

struct brick {
    vec3 size;
    double mortar;
};

static const struct brick defaults = { .size = { 8, 3, 4.5 }, .mortar = 0.5 };

static const struct field words[] = {
    { "brick_size", FIELD_POINT, offsetof(struct brick, size), ANY,
      "width, height and depth of a brick with its mortar", NULL },
    { "mortar", FIELD_NUM, offsetof(struct brick, mortar), ANY, "thickness of the mortar", NULL },
    FIELD_END
};

static double part_of(double v)
{
    double part = v - trunc(v);
    return part < 0 ? part + 1 : part;
}

/* POV-Ray keeps the thickness, narrowed by twice its guard, in single
 * precision. */
static double at(const void *self, vec3 p)
{
    const struct brick *b = self;
    double mortar = (double)(float)((double)(float)b->mortar - 2 * BORDER);
    double x = (p.x + BORDER + mortar) / b->size.x, y = (p.y + BORDER + mortar) / b->size.y,
           z = (p.z + BORDER + mortar) / b->size.z;
    bool odd = part_of(y * 0.5) <= 0.5;

    if (part_of(y) <= mortar / b->size.y)
        return 0;
    if (part_of(odd ? x : x + 0.5) <= mortar / b->size.x)
        return 0;
    return part_of(odd ? z + 0.5 : z) <= mortar / b->size.z ? 0 : 1;
}

POINTWISE(values, at)

const struct pattern_ops pattern_brick = {
    .name = "brick", .help = "bricks and the mortar between", .size = sizeof(struct brick),
    .defaults = &defaults, .words = words, .n_list = 2, .values = values,
};
