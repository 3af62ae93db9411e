/* picture.h: colours from an image (facts patterns.md 6.1, 6.2). */
#ifndef RTC_PICTURE_H
#define RTC_PICTURE_H

#include "scene/pigment.h"

/* At a point of the image's space; clear (transmit 1) outside of a `once` image. */
colour picture_colour(const struct image_use *use, vec3 p);

#endif
