/* shapes.c: the table of all primitives. */
#include "shape/shapes.h"

#include <string.h>

#define SHAPE_ROW(name) &shape_##name,
const struct shape_ops *const shapes[] = { SHAPES(SHAPE_ROW) NULL };

const struct shape_ops *shape_find(const char *name)
{
    for (const struct shape_ops *const *s = shapes; *s; s++)
        if (strcmp((*s)->name, name) == 0)
            return *s;
    return NULL;
}
