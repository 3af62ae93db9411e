/* camera.h: from where and how the scene is seen. */
#ifndef RTC_CAMERA_H
#define RTC_CAMERA_H

#include <stdbool.h>

#include "base/field.h"
#include "math/mat.h"
#include "math/vec.h"

enum camera_kind {
    CAMERA_PERSPECTIVE, CAMERA_ORTHOGRAPHIC, CAMERA_FISHEYE, CAMERA_ULTRA_WIDE, CAMERA_OMNIMAX,
    CAMERA_PANORAMIC, CAMERA_CYLINDER1, CAMERA_CYLINDER2, CAMERA_CYLINDER3, CAMERA_CYLINDER4,
    CAMERA_SPHERICAL,
};

/* What the block says, word by word ... */
struct camera_words {
    enum camera_kind kind;
    vec3 location, direction, right, up, sky, look_at, focal_point;
    double angle;                       /* degrees; 0: not given */
    double h_angle, v_angle;            /* spherical */
    double aperture, confidence, variance;
    int blur_samples, blur_samples_min;
    bool has_look_at, has_focal_point, has_up, has_right, has_angle;
    struct transform place;             /* of the transforms in the block, composed */
};

/* ... and what it means: facts shading.md 1.3, all six steps taken. */
struct camera {
    enum camera_kind kind;
    vec3 location, direction, right, up;    /* lengths count */
    double angle;                       /* radians, for the kinds that need one */
    double h_angle, v_angle;            /* radians */
    double aperture, focal_distance, confidence, variance;
    int blur_samples, blur_samples_min;
};

extern const struct camera_words camera_default;
extern const struct field camera_fields[];

/* NULL, or what is wrong ("location and look_at are the same point"). */
const char *camera_solve(const struct camera_words *words, struct camera *camera);
void camera_move(struct camera *camera, const struct transform *t);

#endif
