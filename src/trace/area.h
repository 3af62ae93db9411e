/* area.h: shadows of area lights. */
#ifndef RTC_AREA_H
#define RTC_AREA_H

#include "trace/shadow.h"

/* As shadow_through, of a lamp that is a grid of lights. */
void area_through(struct worker *w, const struct batch *b, const struct beams *beam, uint32_t lamp, int n,
                  const uint16_t at[], struct lit *out);

#endif
