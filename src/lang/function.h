/* function.h: function { } and spline { }. */
#ifndef RTC_FUNCTION_H
#define RTC_FUNCTION_H

#include "lang/state.h"
#include "scene/pigment.h"

bool function_make(struct lang *l, const struct ast *node, struct value *out);
void function_call(struct lang *l, const struct ast *node, const struct function *f,
                   struct value *out);

/* While the scene is read: what it takes counts for --max-iterations; false: that was
 * reached, which was reported. */
bool function_run_counted(struct lang *l, struct loc at, const struct function *f,
                          const double *arguments, double *out);

/* The function as the number of a pattern, into its struct; false: it is not one of
 * x, y, z, which was reported.  *unsupported: what it needs and cannot have. */
struct function_pattern;
bool function_as_pattern(struct lang *l, struct loc at, const struct function *f,
                         struct function_pattern *out, const char **unsupported);

/* How bright a pigment is where: what pigment_pattern means. */
const struct function *function_of_grey(struct lang *l, const struct pigment *p, struct loc at);

struct spline;
bool spline_make(struct lang *l, const struct ast *node, struct value *out);
void spline_call(struct lang *l, const struct ast *node, const struct spline *s,
                 struct value *out);

#endif
