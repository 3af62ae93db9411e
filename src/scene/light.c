/* light.c: light sources to start from, and how they move. */
#include "scene/light.h"

const struct light light_default = {
    .kind = LIGHT_POINT,
    .point_at = { 0, 0, 1 },
    .adaptive = 100,                    /* more than any grid needs: always divide fully */
    .samples1 = 1, .samples2 = 1,
    .media_interaction = true,
};

#define MEMBER(m) offsetof(struct light, m)

const struct field light_fields[] = {
    { "spotlight", FIELD_CUSTOM, MEMBER(kind), ANY, "a cone of light" },
    { "cylinder", FIELD_CUSTOM, MEMBER(kind), ANY, "a beam of light" },
    { "parallel", FIELD_FLAG, MEMBER(parallel), ANY, "all rays go the same way" },
    { "shadowless", FIELD_FLAG, MEMBER(shadowless), ANY, "light without shadows and highlights" },
    { "point_at", FIELD_POINT, MEMBER(point_at), ANY, "where the light looks" },
    { "radius", FIELD_NUM, MEMBER(radius), ANY, "degrees of the bright cone, or units of the beam" },
    { "falloff", FIELD_NUM, MEMBER(falloff), ANY, "where the cone or beam ends" },
    { "tightness", FIELD_NUM, MEMBER(tightness), ANY, "how light gathers in the middle" },
    { "fade_distance", FIELD_NUM, MEMBER(fade_distance), ANY, "where the light has its own strength" },
    { "fade_power", FIELD_NUM, MEMBER(fade_power), ANY, "how light fades with distance" },
    { "area_light", FIELD_CUSTOM, MEMBER(is_area), ANY, "a grid of lights: two axes, two counts" },
    { "adaptive", FIELD_INT, MEMBER(adaptive), ANY, "how finely an area light is always sampled" },
    { "jitter", FIELD_FLAG, MEMBER(jitter), ANY,
      "lights of the grid move at random" },
    { "circular", FIELD_FLAG, MEMBER(circular), ANY, "the grid is a disc" },
    { "orient", FIELD_FLAG, MEMBER(orient), ANY, "the grid turns to what it lights" },
    { "area_illumination", FIELD_FLAG, MEMBER(area_illumination), ANY,
      "the grid lights as well as shadows", "area_illumination" },
    { "media_interaction", FIELD_FLAG, MEMBER(media_interaction), ANY, "media scatter this light" },
    { "media_attenuation", FIELD_FLAG, MEMBER(media_attenuation), ANY,
      "media and fog dim this light", "media_attenuation" },
    { "looks_like", FIELD_CUSTOM, MEMBER(looks_like), ANY, "the object seen in the light's place" },
    { "projected_through", FIELD_CUSTOM, MEMBER(projected_through), ANY, "light passes this object only" },
    { "color_map", FIELD_CUSTOM, MEMBER(colour), ANY, "a spectrum, added up" },
    { "colour_map", FIELD_CUSTOM, MEMBER(colour), ANY, "a spectrum, added up" },
    { "photons", FIELD_CUSTOM, 0, ANY, "how photons treat the light", "photons" },
    FIELD_END,
};

/* Cone angles and beam radii keep their size (facts shading.md 4.1). */
struct light light_moved(const struct light *l, const struct transform *t)
{
    struct light moved = *l;

    if (t->is_identity)
        return moved;
    moved.centre = mat_point(&t->to, l->centre);
    moved.point_at = mat_point(&t->to, l->point_at);
    moved.axis1 = mat_direction(&t->to, l->axis1);
    moved.axis2 = mat_direction(&t->to, l->axis2);
    return moved;
}
