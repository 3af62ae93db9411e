/* camera.c: what the words of camera { } mean together. */
#include "scene/camera.h"

#include <stddef.h>

#define PI 3.14159265358979323846

static const double near_zero = 1e-10;      /* POV-Ray's: facts shading.md, notation */

const struct camera_words camera_default = {
    .kind = CAMERA_PERSPECTIVE,
    .direction = { 0, 0, 1 }, .right = { 1.33, 0, 0 }, .up = { 0, 1, 0 }, .sky = { 0, 1, 0 },
    .look_at = { 0, 0, 1 },
    .h_angle = 360, .v_angle = 180,
    .confidence = 0.9, .variance = 1.0 / 10000,
    .place = { { { { 1, 0, 0, 0 }, { 0, 1, 0, 0 }, { 0, 0, 1, 0 } } },
               { { { 1, 0, 0, 0 }, { 0, 1, 0, 0 }, { 0, 0, 1, 0 } } }, true },
};

#define MEMBER(m) offsetof(struct camera_words, m)

const struct field camera_fields[] = {
    { "location", FIELD_POINT, MEMBER(location), ANY, "where the camera stands" },
    { "look_at", FIELD_POINT, MEMBER(look_at), ANY, "the point in the middle of the picture" },
    { "direction", FIELD_POINT, MEMBER(direction), ANY, "the way it looks; its length is the zoom" },
    { "up", FIELD_POINT, MEMBER(up), ANY, "the picture's height" },
    { "right", FIELD_POINT, MEMBER(right), ANY, "the picture's width" },
    { "sky", FIELD_POINT, MEMBER(sky), ANY, "what is upright for look_at" },
    { "angle", FIELD_CUSTOM, MEMBER(angle), ANY, "degrees that the picture is wide" },
    { "aperture", FIELD_NUM, MEMBER(aperture), ANY, "size of the lens: blur out of focus" },
    { "focal_point", FIELD_POINT, MEMBER(focal_point), ANY, "a point in focus" },
    { "blur_samples", FIELD_CUSTOM, MEMBER(blur_samples), ANY, "rays a pixel for blur: [least,] most" },
    { "confidence", FIELD_NUM, MEMBER(confidence), ANY, "how sure blur must be" },
    { "variance", FIELD_NUM, MEMBER(variance), ANY, "how exact blur must be" },
    { "normal", FIELD_CUSTOM, 0, ANY, "bends the rays", "normal (in camera)" },
    { "bokeh", FIELD_CUSTOM, 0, ANY, "shape of the lens", "bokeh" },
    FIELD_END,
};

static double radians(double degrees) { return degrees * PI / 180; }

/* Step 2: the angle sets how long direction is. */
static const char *zoom(const struct camera_words *w, struct camera *c)
{
    bool flat = c->kind == CAMERA_PERSPECTIVE || c->kind == CAMERA_ORTHOGRAPHIC;

    c->angle = radians(w->has_angle ? w->angle : 90);
    if (!w->has_angle || !flat || w->angle <= 0)
        return NULL;
    if (w->angle >= 180)
        return "a perspective camera's angle must be less than 180 degrees";
    c->direction = vec_scale(vec_unit(c->direction),
                             vec_length(c->right) / (2 * tan(c->angle / 2)));
    return NULL;
}

/* Step 3: lengths and handedness stay, directions come from look_at. */
static const char *aim(const struct camera_words *w, struct camera *c)
{
    vec3 view = vec_sub(w->look_at, c->location);
    bool right_handed = vec_dot(vec_cross(c->up, c->direction), c->right) > 0;

    if (!w->has_look_at)
        return NULL;
    if (vec_largest(view) == 0)
        return "location and look_at are the same point";
    vec3 d = vec_unit(vec_scale(view, 1 / vec_largest(view)));  /* no square of it is too small */
    vec3 side = vec_cross(w->sky, d);
    vec3 r = vec_largest(side) < near_zero ? vec_unit(c->right) : vec_unit(side);
    vec3 u = vec_cross(d, r);
    double width = vec_length(c->right);
    c->direction = vec_scale(d, vec_length(c->direction));
    c->up = vec_scale(u, vec_length(c->up));
    c->right = vec_scale(r, right_handed ? width : -width);
    return NULL;
}

/* Step 4: an orthographic picture is as wide as a perspective one at the
 * distance of look_at. */
static void widen(const struct camera_words *w, struct camera *c)
{
    double distance = vec_length(vec_sub(w->look_at, c->location));
    double length = vec_length(c->direction);

    if (c->kind != CAMERA_ORTHOGRAPHIC || ((w->has_up || w->has_right) && !w->has_angle))
        return;
    if (!(distance > 0) || !(length > 0))
        return;
    c->right = vec_scale(c->right, distance / length);
    c->up = vec_scale(c->up, distance / length);
}

const char *camera_solve(const struct camera_words *w, struct camera *c)
{
    *c = (struct camera) {
        .kind = w->kind, .location = w->location, .direction = w->direction, .right = w->right,
        .up = w->up, .h_angle = radians(w->h_angle), .v_angle = radians(w->v_angle),
        .aperture = w->aperture, .confidence = w->confidence, .variance = w->variance,
        .blur_samples = w->blur_samples, .blur_samples_min = w->blur_samples_min,
    };
    const char *wrong = zoom(w, c);
    if (!wrong)
        wrong = aim(w, c);
    if (wrong)
        return wrong;
    widen(w, c);
    c->focal_distance = w->has_focal_point
        ? vec_length(vec_sub(w->focal_point, c->location)) : vec_length(c->direction);
    if (!(c->focal_distance > 0))
        c->focal_distance = 1;
    camera_move(c, &w->place);
    return NULL;
}

void camera_move(struct camera *c, const struct transform *t)
{
    if (t->is_identity)
        return;
    c->location = mat_point(&t->to, c->location);
    c->direction = mat_direction(&t->to, c->direction);
    c->up = mat_direction(&t->to, c->up);
    c->right = mat_direction(&t->to, c->right);
}
