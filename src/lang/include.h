/* include.h: other files as part of the scene. */
#ifndef RTC_INCLUDE_H
#define RTC_INCLUDE_H

#include "lang/state.h"

void include(struct lang *l, const struct ast *node);

#endif
