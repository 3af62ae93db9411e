/* places.h: where files are: the library, the picture. */
#ifndef RTC_PLACES_H
#define RTC_PLACES_H

#include "cli/options.h"

/* The n-th folder of include files that is installed here; NULL: no more. */
const char *places_installed(unsigned n);

/* The folders given, then rtc's own and POV-Ray's installed ones. */
void places_library(struct options *o);

/* The picture's path; frame < 0: no animation, else its number is put
 * before the extension, as wide as the last one. */
const char *places_output(const struct options *o, int frame);

/* Of /a/b/scene.rt: /a/b ("." when there is none). */
const char *places_folder(struct arena *mem, const char *path);

#endif
