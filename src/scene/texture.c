/* texture.c: textures, pigments and interiors to start from, and how a
 * texture moves with its object. */
#include "scene/texture.h"

#include <math.h>

#include "scene/object.h"

static const struct pattern_use no_pattern = {
    .frequency = 1, .exponent = 1, .turbulence = { .lambda = 2, .omega = 0.5, .octaves = 6 },
};
static const struct image_use no_image;

const struct pigment pigment_default = {
    .kind = PIGMENT_COLOUR, .pattern = &no_pattern, .image = &no_image, .place = &transform_identity,
};

const struct texture texture_default = {
    .kind = TEXTURE_PLAIN, .pigment = &pigment_default, .finish = &finish_default,
    .pattern = &no_pattern, .place = &transform_identity,
};

const struct interior interior_default = { .dispersion = 1, .dispersion_samples = 7 };

#define MEMBER(m) offsetof(struct interior, m)

const struct field interior_fields[] = {
    { "ior", FIELD_NUM, MEMBER(ior), ANY, "index of refraction" },
    { "dispersion", FIELD_NUM, MEMBER(dispersion), ANY, "ratio of violet's ior to red's" },
    { "dispersion_samples", FIELD_INT, MEMBER(dispersion_samples), 2, INFINITY, "colours that dispersion splits light into" },
    { "caustics", FIELD_NUM, MEMBER(caustics), ANY, "brightens the middle of shadows" },
    { "fade_distance", FIELD_NUM, MEMBER(fade_distance), ANY, "where light has faded by half" },
    { "fade_power", FIELD_NUM, MEMBER(fade_power), ANY, "how sharply light fades; 1000 and more: exponentially" },
    { "fade_color", FIELD_RGB, MEMBER(fade_colour), ANY, "what faded light turns to" },
    { "fade_colour", FIELD_RGB, MEMBER(fade_colour), ANY, "what faded light turns to" },
    { "media", FIELD_CUSTOM, MEMBER(media), ANY, "smoke, fog, glow inside", "media" },
    { "refraction", FIELD_IGNORED, 0, ANY, "old switch; light that is let through is always bent" },
    FIELD_END,
};

const struct transform *transform_moved(struct arena *mem, const struct transform *t,
                                        const struct transform *place)
{
    struct transform both = transform_compose(t, place);

    return arena_copy(mem, &both, sizeof both);
}

/* The lowest layer is copied first, so layers keep their order.  One that lives
 * in (u, v) is not moved from outside of its block. */
const struct texture *texture_move(struct arena *mem, const struct texture *layers,
                                   const struct transform *t)
{
    const struct texture *bottom = NULL, **link = &bottom;

    if (t->is_identity)
        return layers;
    for (const struct texture *from = layers; from; from = from->above) {
        struct texture *copy = arena_copy(mem, from, sizeof *from);
        if (!from->uv_mapping)
            copy->place = transform_moved(mem, t, from->place);
        *link = copy;
        link = &copy->above;
    }
    return bottom;
}
