/* engines.h: the same engine for several instruction sets. */
#ifndef RTC_ENGINES_H
#define RTC_ENGINES_H

#include <stdbool.h>

#include "trace/engine.h"

struct engine_row {
    const char *name;                   /* as of --isa */
    bool (*is_there)(void);             /* can this machine run it? */
    const struct engine *engine;
};
extern const struct engine_row engine_rows[];       /* from the best; NULL name ends */

/* The named one, or the best for NULL; NULL: not on this machine, not built. */
const struct engine *engine_find(const char *name);

#endif
