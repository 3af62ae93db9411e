/* frames.h: which frames an animation has, and their clocks. */
#ifndef RTC_FRAMES_H
#define RTC_FRAMES_H

#include "cli/options.h"

struct frames { int first, last, step; };

struct frames frames_of(const struct animation *a);
double frames_clock_delta(const struct animation *a);
double frames_clock(const struct animation *a, int frame);

#endif
