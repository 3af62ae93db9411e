/* picture.h: colours from an image (facts patterns.md 6.1, 6.2). */
#ifndef RTC_PICTURE_H
#define RTC_PICTURE_H

#include "scene/pigment.h"

/* At a point of the image's space; clear (transmit 1) outside of a `once` image. */
colour picture_colour(const struct image_use *use, vec3 p);

/* The same in two steps, for many points: memory is asked for pixels in the
 * first and need not be waited for in the second.  False: outside. */
struct picture_place { double x, y; };
bool picture_find(const struct image_use *use, vec3 p, struct picture_place *at);
colour picture_at(const struct image_use *use, const struct picture_place *at);
extern const colour picture_outside;

#endif
