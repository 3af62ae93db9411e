/* patterns.c: the table of all patterns. */
#include "pattern/patterns.h"

#include <string.h>

#define PATTERN_ROW(name) &pattern_##name,
const struct pattern_ops *const patterns[] = { PATTERNS(PATTERN_ROW) NULL };

const struct pattern_block pattern_block_default = PATTERN_BLOCK;

const struct field pattern_noise_words[] = {
    { "noise_generator", FIELD_INT, offsetof(struct pattern_block, noise_generator), 0, 3,
      "which noise: 1, 2 or 3; 0: the scene's", NULL },
    FIELD_END
};

const struct pattern_ops *pattern_find(const char *name)
{
    for (const struct pattern_ops *const *p = patterns; *p; p++)
        if (strcmp((*p)->name, name) == 0)
            return *p;
    return NULL;
}
