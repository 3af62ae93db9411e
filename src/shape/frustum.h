/* frustum.h: a piece of a cone between two discs; cylinders too, whose
 * radius does not change.
 *
 * In its own space the axis is z, the base lies in z = 0 around the origin,
 * and the radius at height z is r + slope z. */
#ifndef RTC_FRUSTUM_H
#define RTC_FRUSTUM_H

#include "math/dd.h"
#include "shape/packet.h"

struct frustum {
    vec3 base;                          /* centre of the base disc */
    vec3 x, y, z;                       /* axes, orthonormal */
    double unit, size;                  /* a power of two and its reciprocal */
    double r, slope, height;            /* in units */
    double reach;                       /* largest coordinate, for slack */
    bool is_open;
};

enum frustum_part { FRUSTUM_WALL, FRUSTUM_BASE, FRUSTUM_CAP };

const char *frustum_prepare(struct frustum *s, vec3 base, double base_radius, vec3 cap,
                            double cap_radius, bool is_open);

/* What a shape that begins with its frustum does as any other. */
struct bounds frustum_bounds(const void *self);
void frustum_hold(const void *self, vec3 *centre, vec3 edge[3]);
bool frustum_inside(const void *self, vec3 p);
bool frustum_is_leaky(const void *self);
vec3 frustum_normal(const void *self, vec3 p, const struct hit *h);
int frustum_hits(const void *self, struct ray ray, struct hit out[]);
bool frustum_nearest(const void *self, const struct ray *along, double near, double far,
                     struct hit *out);
void frustum_spans(const void *self, const struct rays *rays, double near[], double far[]);
void frustum_hits_many(const void *self, const struct packet *p, const uint8_t may[],
                       struct crossings *out);

#define FRUSTUM_OPS \
    .is_solid = true, .most_hits = 2, .bounds = frustum_bounds, .hold = frustum_hold, \
    .hits = frustum_hits, .nearest = frustum_nearest, .spans = frustum_spans, \
    .hits_many = frustum_hits_many, .is_leaky = frustum_is_leaky, .inside = frustum_inside, \
    .normal = frustum_normal

#endif
