/* insides.c: which interiors a ray travels in. */
#include "trace/insides.h"

#include <stdio.h>
#include <stdlib.h>

void insides_init(struct insides *s)
{
    *s = (struct insides) { .n = 1, .room = 64 };
    s->item = calloc(s->room, sizeof *s->item);
    if (!s->item)
        exit(4);
}

void insides_release(struct insides *s)
{
    free(s->item);
    *s = (struct insides) { 0 };
}

static uint32_t add(struct insides *s, struct inside item)
{
    if (s->n == s->room) {
        s->room *= 2;
        s->item = realloc(s->item, s->room * sizeof *s->item);
        if (!s->item) {
            fputs("rtc: out of memory\n", stderr);
            exit(4);
        }
    }
    s->item[s->n] = item;
    return s->n++;
}

uint32_t insides_enter(struct insides *s, uint32_t list, const struct surface *in, uint32_t instance)
{
    return add(s, (struct inside) { list, instance, in->solid ? in->solid : in, in });
}

/* Those entered later stay, in their order. */
uint32_t insides_leave(struct insides *s, uint32_t list, const struct surface *out, uint32_t instance)
{
    if (!list)
        return 0;
    struct inside last = s->item[list];
    if (inside_is(&last, out, instance))
        return last.before;
    last.before = insides_leave(s, last.before, out, instance);
    return add(s, last);
}

bool insides_holds(const struct insides *s, uint32_t list, const struct surface *in,
                   uint32_t instance)
{
    for (; list; list = s->item[list].before)
        if (inside_is(&s->item[list], in, instance))
            return true;
    return false;
}
