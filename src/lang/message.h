/* message.h: what a scene says: #debug, #warning, #error. */
#ifndef RTC_MESSAGE_H
#define RTC_MESSAGE_H

#include "lang/state.h"

void message_say(struct lang *l, const struct ast *node);
void message_end(struct lang *l);

#endif
