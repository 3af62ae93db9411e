/* film.c: where light arrives. */
#include "trace/film.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void reserve(struct film *f, uint32_t room)
{
    if (room <= f->room)
        return;
    f->room = room > 2 * f->room ? room : 2 * f->room;
    f->sum = realloc(f->sum, f->room * sizeof *f->sum);
    f->branch = realloc(f->branch, f->room * sizeof *f->branch);
    if (!f->sum || !f->branch) {
        fputs("rtc: out of memory\n", stderr);
        exit(4);
    }
}

void film_start(struct film *f, uint32_t n_pixel)
{
    reserve(f, n_pixel);
    f->n = f->n_pixel = n_pixel;
    memset(f->sum, 0, n_pixel * sizeof *f->sum);
}

uint32_t film_branch(struct film *f, uint32_t parent, rgb weight, float power)
{
    reserve(f, f->n + 1);
    memset(f->sum[f->n], 0, sizeof *f->sum);
    f->branch[f->n] = (struct film_branch) { parent, weight, power };
    return f->n++;
}

/* From the last: what a hidden pixel sees stands behind it. */
void film_settle(struct film *f, uint32_t first)
{
    while (f->n > first) {
        const struct film_branch *b = &f->branch[--f->n];
        const float weight[] = { b->weight.r, b->weight.g, b->weight.b };
        for (int k = 0; k < 3; k++)
            f->sum[b->parent][k] += weight[k] * pow(fmax(f->sum[f->n][k], 0), b->power);
    }
}

void film_release(struct film *f)
{
    free(f->sum);
    free(f->branch);
    *f = (struct film) { 0 };
}
