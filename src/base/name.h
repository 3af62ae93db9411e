/* name.h: interned words: equal text, equal pointer. */
#ifndef RTC_NAME_H
#define RTC_NAME_H

#include <stddef.h>
#include <stdint.h>

#include "base/arena.h"

struct name {
    const char *text;                   /* with a final NUL */
    uint32_t length;
    uint32_t hash;
    const void *word;                   /* what the language keeps with it; NULL: an ordinary name */
    void *slot;                         /* the language's: innermost binding, for quick look-up */
};

struct names {
    struct arena *mem;
    struct name **slot;
    size_t n, room;                     /* room is a power of two */
};

void names_init(struct names *t, struct arena *mem);
struct name *name_intern(struct names *t, const char *text, size_t length);
struct name *name_find(const struct names *t, const char *text, size_t length);  /* NULL: never seen */

/* Edits (insert, delete, change, swap of neighbours) between two words, case
 * counting half; a result above limit means "further".  For suggestions. */
unsigned name_distance(const char *a, const char *b, unsigned limit);

#endif
