/* light.h: light sources. */
#ifndef RTC_LIGHT_H
#define RTC_LIGHT_H

#include <stdbool.h>

#include "base/field.h"
#include "math/mat.h"
#include "math/vec.h"

enum light_kind { LIGHT_POINT, LIGHT_SPOT, LIGHT_CYLINDER };

struct light {
    enum light_kind kind;
    vec3 centre;
    rgb colour;                         /* negative components take light away */
    vec3 point_at;                      /* <0,0,1> */
    double radius, falloff;             /* degrees for a spotlight, units for a cylinder */
    double tightness;
    bool parallel;                      /* rays parallel to centre -> point_at */
    bool shadowless;
    double fade_distance, fade_power;   /* 0: no fading */
    bool is_area;
    vec3 axis1, axis2;
    int samples1, samples2, adaptive;
    bool jitter, circular, orient, area_illumination;
    bool media_interaction, media_attenuation;
    const struct object *looks_like;    /* already moved to the light; NULL: invisible */
    const struct object *projected_through;
};

extern const struct light light_default;
extern const struct field light_fields[];           /* words of light_source { } */
struct light light_moved(const struct light *l, const struct transform *t);

#endif
