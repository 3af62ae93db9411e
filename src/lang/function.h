/* function.h: function { } and spline { }. */
#ifndef RTC_FUNCTION_H
#define RTC_FUNCTION_H

#include "lang/state.h"

bool function_make(struct lang *l, const struct ast *node, struct value *out);
void function_call(struct lang *l, const struct ast *node, const struct function *f,
                   struct value *out);

/* How many parameters internal(number) has; 0: there is none. */
int internal_parameters(int number);

struct spline;
bool spline_make(struct lang *l, const struct ast *node, struct value *out);
void spline_call(struct lang *l, const struct ast *node, const struct spline *s,
                 struct value *out);

#endif
