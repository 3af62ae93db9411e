/* intern.h: equal bytes, equal value. */
#ifndef RTC_INTERN_H
#define RTC_INTERN_H

#include <stdint.h>

#include "base/arena.h"

struct intern {
    struct intern_slot { uint64_t hash; const void *key, *value; } *slot;
    size_t n, room;                     /* room is a power of two */
    size_t most;                        /* 0: no limit; or what is kept, and ... */
    unsigned char *keys;                /* ... where: when full, it starts anew, empty */
};

/* Where the value of these bytes is kept; NULL is there when they are new.  All
 * keys of a table have one size; their padding counts. */
const void **intern_at(struct intern *t, struct arena *mem, const void *key, size_t size);
/* The one copy of these bytes; of a table without a limit. */
const void *intern_copy(struct intern *t, struct arena *mem, const void *key, size_t size);

#endif
