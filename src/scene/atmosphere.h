/* atmosphere.h: what fills space and surrounds it.  Read and kept; not
 * rendered yet. */
#ifndef RTC_ATMOSPHERE_H
#define RTC_ATMOSPHERE_H

#include <stdbool.h>

#include "base/field.h"
#include "math/mat.h"
#include "scene/pigment.h"

struct media {
    int intervals, samples_min, samples_max, method, aa_level;
    double jitter, aa_threshold, confidence, variance, ratio;
    rgb absorption, emission, scattering;
    int scattering_type;
    double eccentricity, extinction;
    bool collect;
    const struct pigment **density;     /* they multiply */
    size_t n_density;
    struct transform place;
    const struct media *more;           /* several in one interior add up */
};

struct fog {
    colour colour;
    double distance, offset, alt, turb_depth, omega, lambda;
    int type, octaves;
    vec3 up, turbulence;
    struct transform place;
};

struct rainbow {
    double angle, width, distance, arc_angle, falloff_angle, jitter;
    vec3 direction, up;
    const struct map_entry *entry;
    size_t n_entry;
};

struct sky_sphere {
    const struct pigment **pigment;     /* the first is the lowest */
    size_t n_pigment;
    rgb emission;
    struct transform place;
};

extern const struct media media_default;
extern const struct fog fog_default;
extern const struct rainbow rainbow_default;
extern const struct sky_sphere sky_sphere_default;
extern const struct field media_fields[], scattering_fields[], fog_fields[], rainbow_fields[],
    sky_sphere_fields[];

#endif
