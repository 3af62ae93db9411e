/* insides.h: which interiors a ray travels in: shared lists, a handle each. */
#ifndef RTC_INSIDES_H
#define RTC_INSIDES_H

#include <stdint.h>

#include "trace/plan.h"

/* Lists share their beginnings and never change; handle 0 is the open air. */
struct insides {
    struct inside {
        uint32_t before;                /* the list that this one adds to */
        uint32_t instance;
        const void *solid;
        const struct surface *surface;
    } *item;
    uint32_t n, room;
};

void insides_init(struct insides *s);
void insides_release(struct insides *s);
uint32_t insides_enter(struct insides *s, uint32_t list, const struct surface *in, uint32_t instance);
uint32_t insides_leave(struct insides *s, uint32_t list, const struct surface *out, uint32_t instance);
bool insides_holds(const struct insides *s, uint32_t list, const struct surface *in,
                   uint32_t instance);

static inline bool inside_is(const struct inside *i, const struct surface *s, uint32_t instance)
{
    return i->solid == (s->solid ? s->solid : s) && i->instance == instance;
}

#endif
