/* cone.c: cone { BASE, RADIUS, CAP, RADIUS [open] } */
#include "shape/frustum.h"
#include "shape/shapes.h"

struct cone {
    struct frustum frustum;             /* first: FRUSTUM_OPS */
    vec3 base, cap;
    double base_radius, cap_radius;
    bool is_open;
};

static const struct cone defaults = { .cap = { 0, 1, 0 }, .base_radius = 1 };

static const struct field args[] = {
    { "", FIELD_POINT, offsetof(struct cone, base), ANY, "centre of the base", NULL },
    { "", FIELD_NUM, offsetof(struct cone, base_radius), ANY, "radius of the base", NULL },
    { "", FIELD_POINT, offsetof(struct cone, cap), ANY, "centre of the cap", NULL },
    { "", FIELD_NUM, offsetof(struct cone, cap_radius), ANY, "radius of the cap", NULL },
    FIELD_END
};

static const struct field words[] = {
    { "open", FIELD_FLAG, offsetof(struct cone, is_open), ANY, "without its two discs", NULL },
    FIELD_END
};

static const char *prepare(void *self, struct arena *mem)
{
    struct cone *s = self;

    (void)mem;
    if (s->base_radius * s->cap_radius < 0)     /* POV-Ray: an hourglass */
        return "radii of opposite signs";
    return frustum_prepare(&s->frustum, s->base, fabs(s->base_radius), s->cap,
                           fabs(s->cap_radius), s->is_open);
}

const struct shape_ops shape_cone = {
    .name = "cone", .help = "a piece of a cone between two discs; a radius of 0 is a point",
    .size = sizeof(struct cone), .defaults = &defaults, .args = args, .n_required = 4,
    .words = words, .prepare = prepare, FRUSTUM_OPS,
};
