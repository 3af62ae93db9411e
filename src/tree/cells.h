/* cells.h: groups of things that lie together, found by counting, before
 * anything is compared: what makes building the trees of many quick. */
#ifndef RTC_CELLS_H
#define RTC_CELLS_H

#include <stdint.h>

#include "base/arena.h"
#include "math/vec.h"

struct cell { uint32_t first, n; };     /* item[first] to item[first + n - 1] */

struct cells {
    struct cell *cell;
    size_t n, room;
    struct arena *mem;                  /* where cell stands */
};

/* Orders item[0] to item[n - 1] and appends cells of at most most of them;
 * more only where very many lie in one place.  middle says where, somewhere
 * in -1..1. */
void cells_make(struct cells *c, uint32_t item[], uint32_t n, uint32_t most,
                vec3 (*middle)(const void *of, uint32_t item), const void *of);

#endif
