/* cylinder.c: cylinder { BASE, CAP, RADIUS [open] } */
#include "shape/frustum.h"
#include "shape/shapes.h"

struct cylinder {
    struct frustum frustum;             /* first: FRUSTUM_OPS */
    vec3 base, cap;
    double radius;
    bool is_open;
};

static const struct cylinder defaults = { .cap = { 0, 1, 0 }, .radius = 1 };

static const struct field args[] = {
    { "", FIELD_POINT, offsetof(struct cylinder, base), ANY, "centre of the base", NULL },
    { "", FIELD_POINT, offsetof(struct cylinder, cap), ANY, "centre of the cap", NULL },
    { "", FIELD_NUM, offsetof(struct cylinder, radius), ANY, "radius", NULL },
    FIELD_END
};

static const struct field words[] = {
    { "open", FIELD_FLAG, offsetof(struct cylinder, is_open), ANY, "without its two discs", NULL },
    FIELD_END
};

static const char *prepare(void *self, struct arena *mem)
{
    struct cylinder *s = self;
    double r = fabs(s->radius);

    (void)mem;
    return frustum_prepare(&s->frustum, s->base, r, s->cap, r, s->is_open);
}

const struct shape_ops shape_cylinder = {
    .name = "cylinder", .help = "a tube between two points",
    .size = sizeof(struct cylinder), .defaults = &defaults, .args = args, .n_required = 3,
    .words = words, .prepare = prepare, FRUSTUM_OPS,
};
