/* errand.c: rays of a stream on their way to things that are placed often. */
#include "trace/errand.h"

void errands_add(struct errands *e, const struct instance *to, uint32_t number, int i, const struct ray *ray)
{
    const struct ray inner = placed_ray(&to->place, *ray);
    int k = e->n++;

    e->root = to->root;
    e->ray[k] = (uint8_t)i;
    e->instance[k] = number;
    e->column[0][k] = inner.origin.x;
    e->column[1][k] = inner.origin.y;
    e->column[2][k] = inner.origin.z;
    e->column[3][k] = inner.dir.x;
    e->column[4][k] = inner.dir.y;
    e->column[5][k] = inner.dir.z;
}
