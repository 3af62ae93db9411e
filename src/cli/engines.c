/* engines.c: the same engine for several instruction sets; all give the same
 * bits (tests/check-engines). */
#include "cli/engines.h"

#include <config.h>
#include <string.h>

static bool always(void)
{
    return true;
}

#ifdef ENGINE_VARIANTS
/* The levels of the x86-64 psABI, feature by feature: gcc 12 knows them by
 * name, clang 14 does not. */
static bool has_v3(void)
{
    return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") &&
           __builtin_cpu_supports("bmi") && __builtin_cpu_supports("bmi2") &&
           __builtin_cpu_supports("popcnt");
}

static bool has_v4(void)
{
    return has_v3() && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") &&
           __builtin_cpu_supports("avx512cd") && __builtin_cpu_supports("avx512dq") &&
           __builtin_cpu_supports("avx512vl");
}
#endif

const struct engine_row engine_rows[] = {
#ifdef ENGINE_VARIANTS
    { "v4", has_v4, &engine_v4 },
    { "v3", has_v3, &engine_v3 },
#endif
    { "baseline", always, &engine_baseline },
    { NULL, NULL, NULL },
};

const struct engine *engine_find(const char *name)
{
    for (const struct engine_row *row = engine_rows; row->name; row++)
        if ((!name || strcmp(name, row->name) == 0) && row->is_there())
            return row->engine;
    return NULL;
}
