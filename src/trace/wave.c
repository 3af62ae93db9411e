/* wave.c: rays under way, an array a member. */
#include "trace/wave.h"

#include <stdio.h>
#include <stdlib.h>

/* Like an arena: running out of memory is a limit reached, never a NULL. */
static void *grow(void *old, size_t bytes)
{
    void *more = realloc(old, bytes);

    if (!more) {
        fputs("rtc: out of memory\n", stderr);
        exit(4);
    }
    return more;
}

void wave_reserve(struct wave *w, int room)
{
    if (room <= w->room)
        return;
    w->room = room > 2 * w->room ? room : 2 * w->room;
#define C(type, name) w->name = grow(w->name, (size_t)w->room * sizeof *w->name);
    WAVE_COLUMNS(C)
#undef C
}

void wave_release(struct wave *w)
{
#define C(type, name) free(w->name);
    WAVE_COLUMNS(C)
#undef C
    *w = (struct wave) { 0 };
}
