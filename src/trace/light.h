/* light.h: lamps ready for use, and how their light arrives. */
#ifndef RTC_TRACE_LIGHT_H
#define RTC_TRACE_LIGHT_H

#include <stdint.h>

#include "scene/light.h"
#include "trace/pigment.h"

struct lamp {
    enum light_kind kind;
    vec3 centre;
    vec3 target;                        /* point_at */
    vec3 axis;                          /* unit, from the light to there */
    rgb colour;
    float cos_radius, cos_falloff;      /* of a spotlight */
    float tightness;
    double radius, falloff;             /* of a cylinder */
    bool parallel, shadowless, is_area;
    double fade_distance, fade_power;   /* 0: no fading */
    struct { vec3 axis1, axis2; int n1, n2, adaptive; bool circular, orient, jitter; } area;
};

struct lamp lamp_of(const struct light *l);

/* How a lamp is seen from an array of points, worked out up to whole(n). */
struct beams {
    double dx[BATCH], dy[BATCH], dz[BATCH];     /* unit, to the light */
    double far[BATCH];                  /* how far shadows must be looked for */
    float share[BATCH];                 /* of its colour that arrives; 0 outside of its cone */
};
void lamp_beams(const struct lamp *l, int n, const double *x, const double *y, const double *z,
                struct beams *out);

/* Of an area light (4.3): its axes as they are for a point (to_light: unit, from
 * there to the centre), and where sample i, j lies along them
 * (between samples, too: what is moved by jitter). */
void lamp_area_axes(const struct lamp *l, vec3 to_light, vec3 axis[2]);
void lamp_area_spot(const struct lamp *l, double i, double j, double *u, double *v);

#endif
