/* light.c: lamps ready for use, and how their light arrives (facts shading.md 4). */
#include "trace/light.h"

#include <math.h>

#include "math/kernel.h"

struct lamp lamp_of(const struct light *l)
{
    const double degree = M_PI / 180;

    return (struct lamp) {
        .kind = l->kind, .centre = l->centre,
        .target = l->point_at, .axis = vec_unit(vec_sub(l->point_at, l->centre)), .colour = l->colour,
        .cos_radius = (float)cos(l->radius * degree),
        .cos_falloff = (float)cos(l->falloff * degree),
        .tightness = (float)l->tightness, .radius = l->radius, .falloff = l->falloff,
        .parallel = l->parallel || l->kind == LIGHT_CYLINDER,
        .shadowless = l->shadowless, .is_area = l->is_area,
        .fade_distance = l->fade_distance,
        .fade_power = fabs(l->fade_distance) > 0 ? l->fade_power : 0,
        .area = { l->axis1, l->axis2, l->samples1, l->samples2, l->adaptive,
                  l->circular || l->orient, l->orient, l->jitter },
    };
}

KERNEL static void aim_at_point(vec3 c, int n, const double *restrict x, const double *restrict y,
                                const double *restrict z, double *restrict dx,
                                double *restrict dy, double *restrict dz, double *restrict far)
{
    for (int i = 0; i < whole(n); i++) {
        double ax = c.x - x[i], ay = c.y - y[i], az = c.z - z[i];
        double length = sqrt(ax * ax + ay * ay + az * az);
        double k = length > 0 ? 1 / length : 0;
        dx[i] = ax * k;
        dy[i] = ay * k;
        dz[i] = az * k;
        far[i] = length;
    }
}

/* All from one side: as far as the plane through the light. */
KERNEL static void aim_at_plane(vec3 c, vec3 axis, int n, const double *restrict x,
                                const double *restrict y, const double *restrict z,
                                double *restrict dx, double *restrict dy, double *restrict dz,
                                double *restrict far)
{
    for (int i = 0; i < whole(n); i++) {
        dx[i] = -axis.x;
        dy[i] = -axis.y;
        dz[i] = -axis.z;
        far[i] = (x[i] - c.x) * axis.x + (y[i] - c.y) * axis.y + (z[i] - c.z) * axis.z;
    }
}

/* 0 below low, 1 from high on, a cubic between. */
static float smooth_step(float low, float high, float x)
{
    if (x < low)
        return 0;
    if (x >= high)
        return 1;
    float t = (x - low) / (high - low);
    return (3 - 2 * t) * t * t;
}

static float spot_share(const struct lamp *l, vec3 to_light)
{
    float c = (float)-vec_dot(to_light, l->axis);

    if (c <= 0)
        return 0;
    float share = l->tightness != 0 ? powf(c, l->tightness) : 1;
    if (l->cos_radius > 0 && c < l->cos_radius)
        share *= smooth_step(l->cos_falloff, l->cos_radius, c);
    return share;
}

static float cylinder_share(const struct lamp *l, vec3 p)
{
    vec3 v = vec_sub(p, l->centre);
    double k = vec_dot(v, l->axis);
    double off = vec_length(vec_sub(v, vec_scale(l->axis, k)));

    if (k <= 0 || off >= l->falloff)
        return 0;
    float x = (float)(1 - off / l->falloff);
    float share = l->tightness != 0 ? powf(x, l->tightness) : 1;
    if (l->radius > 0 && off > l->radius)
        share *= smooth_step(0, (float)(1 - l->radius / l->falloff), x);
    return share;
}

static float fade(const struct lamp *l, double distance)
{
    return (float)(2 / (1 + pow(fabs(distance / l->fade_distance), l->fade_power)));
}

static void shares(const struct lamp *l, int n, const double *x, const double *y, const double *z,
                   struct beams *b)
{
    for (int i = 0; i < n; i++) {
        float share = 1;
        if (l->kind == LIGHT_SPOT)
            share = spot_share(l, vec_unit(vec(l->centre.x - x[i], l->centre.y - y[i],
                                               l->centre.z - z[i])));
        else if (l->kind == LIGHT_CYLINDER)
            share = cylinder_share(l, vec(x[i], y[i], z[i]));
        if (l->fade_power > 0 && share != 0)
            share *= fade(l, b->far[i]);
        b->share[i] = share;
    }
    for (int i = n; i < whole(n); i++)
        b->share[i] = 0;
}

void lamp_beams(const struct lamp *l, int n, const double *x, const double *y, const double *z,
                struct beams *b)
{
    if (l->parallel)
        aim_at_plane(l->centre, l->axis, n, x, y, z, b->dx, b->dy, b->dz, b->far);
    else
        aim_at_point(l->centre, n, x, y, z, b->dx, b->dy, b->dz, b->far);
    if (l->kind != LIGHT_POINT || l->fade_power > 0)
        shares(l, n, x, y, z, b);
    else
        for (int i = 0; i < whole(n); i++)
            b->share[i] = 1;
}

void lamp_area_axes(const struct lamp *l, vec3 to_light, vec3 axis[2])
{
    axis[0] = l->area.axis1;
    axis[1] = l->area.axis2;
    if (!l->area.orient)
        return;
    double length = vec_length(l->area.axis1);
    vec3 side = fabs(fabs(to_light.z) - 1) < 0.01 ? vec(0, 1, 0) : vec(0, 0, 1);
    axis[0] = vec_unit(vec_cross(to_light, side));
    axis[1] = vec_scale(vec_unit(vec_cross(to_light, axis[0])), length);
    axis[0] = vec_scale(axis[0], length);
}

void lamp_area_spot(const struct lamp *l, double i, double j, double *u, double *v)
{
    *u = l->area.n1 > 1 ? i / (l->area.n1 - 1) - 0.5 : 0;
    *v = l->area.n2 > 1 ? j / (l->area.n2 - 1) - 0.5 : 0;
    if (!l->area.circular || l->area.n1 <= 1 || l->area.n2 <= 1)
        return;
    *u += 0.001;
    *v += 0.001;
    double k = fmax(fabs(*u), fabs(*v)) / sqrt(*u * *u + *v * *v);
    *u *= k;
    *v *= k;
}
