/* parked.c: rays of a wave that must wait, so that waves stay small. */
#include "trace/parked.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Items keep their waves, and so the memory of these, when they are popped. */
static struct parking *next_item(struct parked *p)
{
    if (p->n == p->room) {
        int room = p->room ? 2 * p->room : 8;
        p->item = realloc(p->item, (size_t)room * sizeof *p->item);
        if (!p->item) {
            fputs("rtc: out of memory\n", stderr);
            exit(4);
        }
        memset(p->item + p->room, 0, (size_t)(room - p->room) * sizeof *p->item);
        p->room = room;
    }
    return &p->item[p->n++];
}

/* The pixel up to which rays may go on; the last one's: all may. */
static uint32_t middle_pixel(const struct wave *w, const struct film *f, uint32_t *last)
{
    uint32_t first = *last = film_root(f, w->pixel[0]);

    for (int i = 1; i < w->n; i++) {
        uint32_t pixel = film_root(f, w->pixel[i]);
        first = pixel < first ? pixel : first;
        *last = pixel > *last ? pixel : *last;
    }
    return first + (*last - first) / 2;
}

void parked_push(struct parked *p, struct wave *w, int most, const struct insides *in,
                 const struct film *f)
{
    struct parking *to = next_item(p);
    uint32_t last, middle = middle_pixel(w, f, &last);
    int n = w->n;

    to->n_inside = in->n;
    to->n_film = f->n;
    to->wave.n = w->n = 0;
    wave_reserve(&to->wave, n);
    for (int i = 0; i < n; i++) {
        bool waits = middle == last ? i >= most : film_root(f, w->pixel[i]) > middle;
        wave_move(waits ? &to->wave : w, w, i);
    }
}

bool parked_pop(struct parked *p, struct wave *w, struct insides *in, struct film *f)
{
    if (p->n == 0)
        return false;
    struct parking *from = &p->item[--p->n];
    struct wave empty = *w;
    *w = from->wave;
    from->wave = empty;
    film_settle(f, from->n_film);
    in->n = from->n_inside;
    return true;
}

void parked_clear(struct parked *p)
{
    p->n = 0;
}

void parked_release(struct parked *p)
{
    for (int i = 0; i < p->room; i++)
        wave_release(&p->item[i].wave);
    free(p->item);
    *p = (struct parked) { 0 };
}
