/* finish.h: how a surface answers light. */
#ifndef RTC_FINISH_H
#define RTC_FINISH_H

#include <stdbool.h>

#include "base/field.h"
#include "math/vec.h"

struct reflection {
    rgb low, high;                      /* facing the viewer, and grazing */
    double falloff, exponent, metallic;
    bool fresnel;
};

struct finish {
    rgb ambient, emission;
    double diffuse, diffuse_back, brilliance;
    double phong, phong_size;
    double specular, roughness;
    double metallic;
    double crand;
    double irid, irid_thickness, irid_turbulence;
    struct reflection reflection;
    bool conserve_energy;
    bool albedo_diffuse, albedo_phong, albedo_specular;
    double ior, caustics, refraction;   /* the old places for them; ior < 0, caustics < 0: not given */
};

extern const struct finish finish_default;          /* facts shading.md 2.1 */
extern const struct field finish_fields[];          /* words of finish { } */
extern const struct field reflection_fields[];      /* words of reflection { }, after its colours */

#endif
