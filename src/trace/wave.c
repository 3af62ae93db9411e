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

void wave_push(struct wave *w, const struct wave_ray *r)
{
    int i = w->n++;

    wave_reserve(w, w->n);
    w->x[i] = r->ray.origin.x;
    w->y[i] = r->ray.origin.y;
    w->z[i] = r->ray.origin.z;
    w->dx[i] = r->ray.dir.x;
    w->dy[i] = r->ray.dir.y;
    w->dz[i] = r->ray.dir.z;
    w->red[i] = r->weight.r;
    w->green[i] = r->weight.g;
    w->blue[i] = r->weight.b;
    w->alpha[i] = r->alpha;
    w->adc[i] = r->adc;
    w->pixel[i] = r->pixel;
    w->inside[i] = r->inside;
    w->depth[i] = r->depth;
    w->mask[i] = r->mask;
}

void wave_release(struct wave *w)
{
#define C(type, name) free(w->name);
    WAVE_COLUMNS(C)
#undef C
    *w = (struct wave) { 0 };
}
