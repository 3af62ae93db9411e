/* shadow.h: how much of a lamp's light comes through. */
#ifndef RTC_SHADOW_H
#define RTC_SHADOW_H

#include "trace/worker.h"

/* From a point with this viewer-facing normal, of a ray inside these interiors;
 * direction and far: to the lamp, as lamp_beams says. */
struct shadow_query {
    vec3 point, normal, direction;
    double slack, far;
    uint32_t lamp, inside;
};

/* What gets through to n <= BATCH points of one lamp's light; 1: all of it. */
void shadow_through(struct worker *w, int n, const struct shadow_query *q, rgb *through);

/* What is left of light after a way through an interior (facts shading.md 3.4). */
rgb interior_fade(const struct interior *in, double distance);

/* The points as the textures of this surface want them. */
void spot_of(const struct surface *s, const struct surface_point *p, double spot[5]);

#endif
