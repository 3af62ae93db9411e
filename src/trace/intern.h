/* intern.h: equal bytes, equal value. */
#ifndef RTC_INTERN_H
#define RTC_INTERN_H

#include "base/arena.h"

struct intern {
    struct intern_slot { const void *key; const void *value; } *slot;
    size_t n, room;                     /* room is a power of two */
};

/* Where the value of these bytes is kept; NULL is there when they are new.
 * All keys of a table have one size; their padding counts. */
const void **intern_at(struct intern *t, struct arena *mem, const void *key, size_t size);

#endif
