/* texture.c: textures, pigments and interiors to start from, and how a
 * texture moves with its object. */
#include "scene/texture.h"

#include "scene/object.h"

#define IDENTITY { { { { 1, 0, 0, 0 }, { 0, 1, 0, 0 }, { 0, 0, 1, 0 } } }, \
                   { { { 1, 0, 0, 0 }, { 0, 1, 0, 0 }, { 0, 0, 1, 0 } } }, true }
#define PATTERN_USE { .frequency = 1, .exponent = 1, \
                      .turbulence = { .lambda = 2, .omega = 0.5, .octaves = 6 } }

const struct pigment pigment_default = {
    .kind = PIGMENT_COLOUR, .pattern = PATTERN_USE, .place = IDENTITY,
};

const struct texture texture_default = {
    .kind = TEXTURE_PLAIN, .pigment = &pigment_default, .finish = &finish_default,
    .pattern = PATTERN_USE, .place = IDENTITY,
};

const struct interior interior_default = { .dispersion = 1, .dispersion_samples = 7 };

#define MEMBER(m) offsetof(struct interior, m)

const struct field interior_fields[] = {
    { "ior", FIELD_NUM, MEMBER(ior), ANY, "index of refraction" },
    { "dispersion", FIELD_NUM, MEMBER(dispersion), ANY, "ratio of violet's ior to red's" },
    { "dispersion_samples", FIELD_INT, MEMBER(dispersion_samples), ANY, "colours that dispersion splits light into" },
    { "caustics", FIELD_NUM, MEMBER(caustics), ANY, "brightens the middle of shadows" },
    { "fade_distance", FIELD_NUM, MEMBER(fade_distance), ANY, "where light has faded by half" },
    { "fade_power", FIELD_NUM, MEMBER(fade_power), ANY, "how sharply light fades; 1000 and more: exponentially" },
    { "fade_color", FIELD_RGB, MEMBER(fade_colour), ANY, "what faded light turns to" },
    { "fade_colour", FIELD_RGB, MEMBER(fade_colour), ANY, "what faded light turns to" },
    { "media", FIELD_CUSTOM, MEMBER(media), ANY, "smoke, fog, glow inside", "media" },
    { "refraction", FIELD_IGNORED, 0, ANY, "old switch; light that is let through is always bent" },
    FIELD_END,
};

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
            copy->place = transform_compose(t, &from->place);
        *link = copy;
        link = &copy->above;
    }
    return bottom;
}
