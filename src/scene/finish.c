/* finish.c: the words of finish { } and what they start from. */
#include "scene/finish.h"

const struct finish finish_default = {
    .ambient = { 0.1f, 0.1f, 0.1f },
    .diffuse = 0.6, .brilliance = 1,
    .phong_size = 40,
    .roughness = 0.05,
    .reflection = { .falloff = 1, .exponent = 1 },
    .ior = -1, .caustics = -1, .refraction = 1,
};

#define MEMBER(m) offsetof(struct finish, m)

const struct field finish_fields[] = {
    { "ambient", FIELD_RGB, MEMBER(ambient), ANY, "light the surface gets from everywhere" },
    { "emission", FIELD_RGB, MEMBER(emission), ANY, "light the surface gives by itself" },
    { "diffuse", FIELD_CUSTOM, MEMBER(diffuse), ANY, "share of light scattered: [albedo] front [, back]" },
    { "brilliance", FIELD_NUM, MEMBER(brilliance), ANY, "how fast diffuse light falls with the angle" },
    { "phong", FIELD_CUSTOM, MEMBER(phong), ANY, "strength of the phong highlight: [albedo] number" },
    { "phong_size", FIELD_NUM, MEMBER(phong_size), ANY, "tightness of the phong highlight" },
    { "specular", FIELD_CUSTOM, MEMBER(specular), ANY, "strength of the specular highlight: [albedo] number" },
    { "roughness", FIELD_NUM, MEMBER(roughness), ANY, "width of the specular highlight" },
    { "metallic", FIELD_NUM_OR_1, MEMBER(metallic), ANY, "how far highlights take the surface's colour" },
    { "crand", FIELD_NUM, MEMBER(crand), ANY, "random darkening of diffuse light" },
    { "conserve_energy", FIELD_FLAG, MEMBER(conserve_energy), ANY, "what is reflected is not let through" },
    { "reflection", FIELD_CUSTOM, MEMBER(reflection), ANY, "mirror colour, or { lowest, highest and words }" },
    { "reflection_exponent", FIELD_NUM, MEMBER(reflection.exponent), ANY, "bends the brightness of reflections" },
    { "irid", FIELD_CUSTOM, MEMBER(irid), ANY, "thin film colours: { amount and words }" },
    { "subsurface", FIELD_CUSTOM, 0, ANY, "light below the surface", "subsurface" },
    { "ior", FIELD_NUM, MEMBER(ior), ANY, "old place of the interior's ior" },
    { "caustics", FIELD_NUM, MEMBER(caustics), ANY, "old place of the interior's caustics" },
    { "refraction", FIELD_NUM, MEMBER(refraction), ANY, "old word: scales the light let through" },
    FIELD_END,
};

#undef MEMBER
#define MEMBER(m) offsetof(struct reflection, m)

const struct field reflection_fields[] = {
    { "fresnel", FIELD_FLAG, MEMBER(fresnel), ANY, "by Fresnel's law from the interior's ior" },
    { "falloff", FIELD_NUM, MEMBER(falloff), ANY, "how the share grows towards grazing angles" },
    { "exponent", FIELD_NUM, MEMBER(exponent), ANY, "bends the brightness of reflections" },
    { "metallic", FIELD_NUM_OR_1, MEMBER(metallic), ANY, "how far reflections take the surface's colour" },
    FIELD_END,
};
