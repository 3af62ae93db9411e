/* scope.h: which value a name has where (facts sdl.md 4.1). */
#ifndef RTC_SCOPE_H
#define RTC_SCOPE_H

#include "lang/state.h"

/* Scopes are numbered from 1; 0 is the global one. */
unsigned scope_open(struct lang *l);
void scope_close(struct lang *l);       /* the innermost */

static inline struct binding *scope_find(const struct name *name)
{
    return name->slot;
}

/* The binding that #declare (local: #local) of a name writes to. */
struct binding *scope_declare(struct lang *l, struct name *name, bool local, struct loc at);
/* What was said to be wrong or missing is known from now on, as a harmless number: one
 * mistake, one message. */
void scope_declare_broken(struct lang *l, struct name *name, struct loc at);
struct binding *scope_declare_global(struct lang *l, struct name *name, struct loc at);
/* A macro's parameter, in the innermost scope; refers: to the caller's value. */
struct binding *scope_parameter(struct lang *l, struct name *name, struct value *refers,
                                struct loc at);
void scope_undef(struct lang *l, struct name *name);
bool scope_is_outer(const struct lang *l, const struct binding *b, unsigned scope);

#endif
