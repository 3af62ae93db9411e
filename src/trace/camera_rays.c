/* camera_rays.c: where each point of the picture looks (facts shading.md 1.2, 1.4). */
#include "trace/camera_rays.h"

#include <math.h>

#include "math/kernel.h"

static bool wants_unit_vectors(enum camera_kind kind)
{
    return kind != CAMERA_PERSPECTIVE && kind != CAMERA_ORTHOGRAPHIC
           && kind != CAMERA_PANORAMIC && kind != CAMERA_SPHERICAL;
}

struct lens lens_of(const struct camera *c)
{
    struct lens l = {
        .kind = c->kind, .location = c->location, .direction = c->direction,
        .right = c->right, .up = c->up,
        .width = vec_length(c->right), .height = vec_length(c->up),
        .angle = c->angle, .h_angle = c->h_angle, .v_angle = c->v_angle,
        .fixed_origin = c->kind != CAMERA_ORTHOGRAPHIC && c->kind != CAMERA_CYLINDER3
                        && c->kind != CAMERA_CYLINDER4,
    };

    /* Only directions count, and squares of extreme lengths would not be finite. */
    double big = fmax(vec_largest(l.direction), fmax(vec_largest(l.right), vec_largest(l.up)));
    if (c->kind == CAMERA_PERSPECTIVE && big > 0 && (big < 1e-100 || big > 1e100)) {
        l.direction = vec_scale(l.direction, 1 / big);
        l.right = vec_scale(l.right, 1 / big);
        l.up = vec_scale(l.up, 1 / big);
    }
    if (wants_unit_vectors(c->kind)) {
        l.direction = vec_unit(l.direction);
        l.right = vec_unit(l.right);
        l.up = vec_unit(l.up);
    }
    return l;
}

/* a right + b up + c direction */
static vec3 mix(const struct lens *l, double a, double b, double c)
{
    return vec_fma(vec_fma(vec_scale(l->direction, c), a, l->right), b, l->up);
}

static vec3 perspective(const struct lens *l, double x, double y)
{
    return mix(l, x, y, 1);
}

/* phi around the axis from the right, theta away from it. */
static vec3 around(const struct lens *l, double phi, double theta)
{
    return mix(l, cos(phi) * sin(theta), sin(phi) * sin(theta), cos(theta));
}

static bool fisheye(const struct lens *l, double x, double y, vec3 *d)
{
    x *= 2 * l->width;
    y *= 2 * l->height;
    double rho = sqrt(x * x + y * y);
    if (rho > 1)
        return false;
    *d = around(l, atan2(y, x), rho * l->angle / 2);
    return true;
}

/* A dome's projector: its aspect and lens polynomial are POV-Ray's. */
static bool omnimax(const struct lens *l, double x, double y, vec3 *d)
{
    const double aspect = 1.283458, below_horizon = 135 * (M_PI / 180);
    double q = l->width / l->height;

    x *= 2;
    y *= 2;
    if (q > aspect) {
        x *= q / aspect;
        y = (y - 1) / aspect + 1;
    } else {
        y = q > 1 ? (y - 1) / q + 1 : y / q;
    }
    double rho = sqrt(x * x + y * y);
    if (rho > 1)
        return false;
    double phi = atan2(y, x);
    double theta = 1.411269 * rho - 0.09439 * pow(rho, 3) + 0.25674 * pow(rho, 5);
    if (sin(phi) * sin(theta) < tan(below_horizon) * cos(theta))
        return false;
    *d = around(l, phi, theta);
    return true;
}

static vec3 panoramic(const struct lens *l, double x, double y)
{
    double a = (0.5 - x) * M_PI, b = y * M_PI;
    double rise = fabs(M_PI / 2 - fabs(b)) < 1e-10 ? copysign(2e10, b) : tan(b);

    return mix(l, cos(a), rise, sin(a));
}

/* Tilts about right, then turns about up; right and up need not be square. */
static vec3 spherical(const struct lens *l, double x, double y)
{
    struct transform tilt = transform_axis_rotate(l->right, -y * l->v_angle * (180 / M_PI));
    struct transform turn = transform_axis_rotate(l->up, x * l->h_angle * (180 / M_PI));

    return mat_direction(&turn.to, mat_direction(&tilt.to, l->direction));
}

bool lens_ray(const struct lens *l, double u, double v, struct ray *ray)
{
    double x = u - 0.5, y = 0.5 - v;
    double a = x * l->angle, b = y * l->angle;
    vec3 d = l->direction;

    ray->origin = l->location;
    switch (l->kind) {
    case CAMERA_PERSPECTIVE:
        d = perspective(l, x, y);
        break;
    case CAMERA_ORTHOGRAPHIC:
        ray->origin = vec_fma(vec_fma(l->location, x, l->right), y, l->up);
        break;
    case CAMERA_FISHEYE:
        if (!fisheye(l, x, y, &d))
            return false;
        break;
    case CAMERA_ULTRA_WIDE:
        b *= l->height / l->width;
        d = mix(l, sin(a), sin(b), cos(a) * cos(b));
        break;
    case CAMERA_OMNIMAX:
        if (!omnimax(l, x, y, &d))
            return false;
        break;
    case CAMERA_PANORAMIC:
        d = panoramic(l, x, y);
        break;
    case CAMERA_CYLINDER1:
        d = mix(l, sin(a), y * l->height, cos(a));
        break;
    case CAMERA_CYLINDER2:
        d = mix(l, x * l->width, sin(b), cos(b));
        break;
    case CAMERA_CYLINDER3:
        ray->origin = vec_fma(l->location, y * l->height, l->up);
        d = mix(l, sin(a), 0, cos(a));
        break;
    case CAMERA_CYLINDER4:
        ray->origin = vec_fma(l->location, x * l->width, l->right);
        d = mix(l, 0, sin(b), cos(b));
        break;
    case CAMERA_SPHERICAL:
        d = spherical(l, x, y);
        break;
    }
    ray->dir = vec_unit(d);
    return true;
}

KERNEL void lens_fan(const struct lens *l, int n, const double *restrict u,
                     const double *restrict v, double *restrict dx, double *restrict dy,
                     double *restrict dz)
{
    const vec3 d = l->direction, right = l->right, up = l->up;

    for (int i = 0; i < n; i++) {
        double x = u[i] - 0.5, y = 0.5 - v[i];
        double ax = fma(y, up.x, fma(x, right.x, d.x));
        double ay = fma(y, up.y, fma(x, right.y, d.y));
        double az = fma(y, up.z, fma(x, right.z, d.z));
        double k = 1 / sqrt(ax * ax + ay * ay + az * az);
        dx[i] = ax * k;
        dy[i] = ay * k;
        dz[i] = az * k;
    }
}
