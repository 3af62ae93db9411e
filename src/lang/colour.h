/* colour.h: colour specifications, facts sdl.md section 3. */
#ifndef RTC_COLOUR_H
#define RTC_COLOUR_H

#include "lang/reader.h"
#include "lang/value.h"
#include "math/vec.h"
#include "scene/scene.h"

/* Does a specification stand next that says it is one: rgb, color, red, or a
 * declared colour? */
bool colour_is_next(struct reader *r);
bool item_is_colour(const struct item *i);

/* One specification with its red, green ... behind it.  False: nothing that
 * could be a colour (reported). */
bool colour_read(struct reader *r, struct value *out);

/* The same as floats.  Plain numbers and vectors are taken too. */
colour colour_take(struct reader *r, bool comma, const char *what);
rgb colour_take_rgb(struct reader *r, bool comma, const char *what);    /* warns of filter, transmit */

/* The sRGB curve's other way, and a linear value in the scene's working space. */
double srgb_decode(double x);
double working_encode(const struct settings *s, double linear);

extern const char *const colour_words[];    /* all that may stand in one; NULL ends */

#endif
