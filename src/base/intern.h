/* intern.h: equal bytes, equal value. */
#ifndef RTC_INTERN_H
#define RTC_INTERN_H

#include "base/arena.h"

struct intern {
    struct intern_slot { const void *key; const void *value; } *slot;
    size_t n, room;                     /* room is a power of two */
};

/* The one copy of these bytes, and where their value is kept; NULL is there when
 * they are new.  All keys of a table have one size; their padding counts. */
struct intern_slot *intern_slot(struct intern *t, struct arena *mem, const void *key, size_t size);
const void **intern_at(struct intern *t, struct arena *mem, const void *key, size_t size);
/* The one copy of these bytes. */
const void *intern_copy(struct intern *t, struct arena *mem, const void *key, size_t size);

#endif
