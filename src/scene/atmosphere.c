/* atmosphere.c: words and defaults of media, fog, rainbow and sky_sphere. */
#include "scene/atmosphere.h"

#include <math.h>
#include <stddef.h>

#define IDENTITY { { { { 1, 0, 0, 0 }, { 0, 1, 0, 0 }, { 0, 0, 1, 0 } } }, \
                   { { { 1, 0, 0, 0 }, { 0, 1, 0, 0 }, { 0, 0, 1, 0 } } }, true }

const struct media media_default = {
    .intervals = 1, .samples_min = 10, .samples_max = 10, .method = 3, .aa_level = 3,
    .aa_threshold = 0.1, .confidence = 0.9, .variance = 1.0 / 128, .ratio = 0.9,
    .extinction = 1, .collect = true, .place = IDENTITY,
};

#define MEMBER(m) offsetof(struct media, m)

const struct field media_fields[] = {
    { "intervals", FIELD_INT, MEMBER(intervals), 1, INFINITY, "pieces a ray is cut into" },
    { "samples", FIELD_CUSTOM, MEMBER(samples_min), ANY, "least [, most] samples in an interval" },
    { "method", FIELD_INT, MEMBER(method), 1, 3, "how samples are placed" },
    { "jitter", FIELD_NUM, MEMBER(jitter), ANY, "randomness of samples" },
    { "aa_threshold", FIELD_NUM, MEMBER(aa_threshold), ANY, "method 3: when to sample more" },
    { "aa_level", FIELD_INT, MEMBER(aa_level), ANY, "method 3: how often to sample more" },
    { "absorption", FIELD_RGB, MEMBER(absorption), ANY, "light taken away" },
    { "emission", FIELD_RGB, MEMBER(emission), ANY, "light given" },
    { "scattering", FIELD_CUSTOM, MEMBER(scattering), ANY, "light scattered: { type, colour }" },
    { "confidence", FIELD_NUM, MEMBER(confidence), ANY, "how sure samples must be" },
    { "variance", FIELD_NUM, MEMBER(variance), ANY, "how exact samples must be" },
    { "ratio", FIELD_NUM, MEMBER(ratio), ANY, "share of samples in lit intervals" },
    { "collect", FIELD_FLAG, MEMBER(collect), ANY, "photons are kept in it" },
    { "density", FIELD_CUSTOM, MEMBER(density), ANY, "how thick it is where" },
    FIELD_END,
};

const struct field scattering_fields[] = {
    { "eccentricity", FIELD_NUM, MEMBER(eccentricity), ANY, "how far type 5 scatters forwards" },
    { "extinction", FIELD_NUM, MEMBER(extinction), ANY, "how much of what is scattered is lost" },
    FIELD_END,
};

const struct fog fog_default = {
    .type = 1, .up = { 0, 1, 0 }, .turb_depth = 0.5, .omega = 0.5, .lambda = 2, .octaves = 6,
    .place = IDENTITY,
};

#undef MEMBER
#define MEMBER(m) offsetof(struct fog, m)

const struct field fog_fields[] = {
    { "distance", FIELD_NUM, MEMBER(distance), ANY, "where little is seen" },
    { "fog_type", FIELD_INT, MEMBER(type), 1, 2, "1: everywhere, 2: on the ground" },
    { "fog_offset", FIELD_NUM, MEMBER(offset), ANY, "height below which it is full" },
    { "fog_alt", FIELD_NUM, MEMBER(alt), ANY, "how fast it thins above" },
    { "up", FIELD_POINT, MEMBER(up), ANY, "the way it thins" },
    { "turbulence", FIELD_POINT, MEMBER(turbulence), ANY, "how uneven it is" },
    { "turb_depth", FIELD_NUM, MEMBER(turb_depth), ANY, "how far uneven" },
    { "octaves", FIELD_INT, MEMBER(octaves), ANY, "of the turbulence" },
    { "omega", FIELD_NUM, MEMBER(omega), ANY, "of the turbulence" },
    { "lambda", FIELD_NUM, MEMBER(lambda), ANY, "of the turbulence" },
    FIELD_END,
};

const struct rainbow rainbow_default = {
    .distance = 1e7, .up = { 0, 1, 0 }, .arc_angle = 180, .falloff_angle = 180,
};

#undef MEMBER
#define MEMBER(m) offsetof(struct rainbow, m)

const struct field rainbow_fields[] = {
    { "angle", FIELD_NUM, MEMBER(angle), ANY, "degrees from the direction" },
    { "width", FIELD_NUM, MEMBER(width), ANY, "degrees" },
    { "distance", FIELD_NUM, MEMBER(distance), ANY, "where it hides half of what is behind" },
    { "direction", FIELD_POINT, MEMBER(direction), ANY, "of the light" },
    { "up", FIELD_POINT, MEMBER(up), ANY, "the middle of its arc" },
    { "arc_angle", FIELD_NUM, MEMBER(arc_angle), ANY, "degrees of the arc" },
    { "falloff_angle", FIELD_NUM, MEMBER(falloff_angle), ANY, "degrees where the arc begins to fade" },
    { "jitter", FIELD_NUM, MEMBER(jitter), ANY, "randomness" },
    { "color_map", FIELD_CUSTOM, MEMBER(entry), ANY, "its colours" },
    { "colour_map", FIELD_CUSTOM, MEMBER(entry), ANY, "its colours" },
    FIELD_END,
};

const struct sky_sphere sky_sphere_default = { .emission = { 1, 1, 1 }, .place = IDENTITY };

#undef MEMBER
#define MEMBER(m) offsetof(struct sky_sphere, m)

const struct field sky_sphere_fields[] = {
    { "pigment", FIELD_CUSTOM, MEMBER(pigment), ANY, "a layer, the last on top" },
    { "emission", FIELD_RGB, MEMBER(emission), ANY, "how bright it is" },
    FIELD_END,
};
