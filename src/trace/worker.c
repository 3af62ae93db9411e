/* worker.c: waves of rays, followed until nothing is left. */
#include "trace/worker.h"

#include <stdlib.h>
#include <string.h>

#include "trace/shade.h"
#include "trace/sky.h"

enum {
    MOST_SURROUNDING = 64,              /* solids around a camera that are noticed */
    MOST_RAYS = 8192,                   /* of a wave */
};

static int largest_grid(const struct shader *s)
{
    int most = 0;

    for (size_t i = 0; i < s->n_lamp; i++) {
        int n = s->lamp[i].is_area ? s->lamp[i].area.n1 * s->lamp[i].area.n2 : 0;
        most = n > most ? n : most;
    }
    return most;
}

void worker_init(struct worker *w, const struct plan *p)
{
    size_t n_shadow = p->shader->n_lamp * BATCH;

    memset(w, 0, sizeof *w);
    w->plan = p;
    w->shader = p->shader;
    arena_init(&w->mem, p->mem->budget);
    w->scratch = scratch_new(p, &w->mem);
    w->lens = lens_of(&p->camera);
    insides_init(&w->insides);
    w->shadows.known = arena_array(&w->mem, n_shadow, sizeof *w->shadows.known);
    w->shadows.through = arena_array(&w->mem, n_shadow, sizeof *w->shadows.through);
    area_room_init(&w->area, largest_grid(p->shader), &w->mem);
    w->start = arena_array(&w->mem, (size_t)p->shader->n_group + 1, sizeof *w->start);
    w->camera_inside = w->lens.fixed_origin ? worker_insides_at(w, w->lens.location) : 0;
    w->n_camera_inside = w->insides.n;
}

void worker_release(struct worker *w)
{
    wave_release(&w->now);
    wave_release(&w->next);
    parked_release(&w->parked);
    film_release(&w->film);
    insides_release(&w->insides);
    free(w->meeting);
    free(w->hit);
    free(w->order);
    arena_free(&w->mem);
}

uint32_t worker_insides_at(struct worker *w, vec3 point)
{
    uint32_t around[MOST_SURROUNDING], list = 0;

    if (!w->plan->has_refraction && !w->shader->has_interior && !w->plan->scene->n_fog)
        return 0;
    size_t n = geometry_inside(w->plan, w->scratch, point, around, MOST_SURROUNDING);
    for (size_t i = 0; i < n && i < MOST_SURROUNDING; i++)
        list = insides_enter(&w->insides, list, &w->plan->surface[around[i]], NO_INSTANCE);
    return list;
}

static void *grown(void *old, int n, size_t size)
{
    void *more = realloc(old, (size_t)n * size);

    if (!more) {
        fputs("rtc: out of memory\n", stderr);
        exit(4);
    }
    return more;
}

static void reserve_hits(struct worker *w, int n)
{
    if (n <= w->room_hits)
        return;
    w->room_hits = n > 2 * w->room_hits ? n : 2 * w->room_hits;
    w->meeting = grown(w->meeting, w->room_hits, sizeof *w->meeting);
    w->hit = grown(w->hit, w->room_hits, sizeof *w->hit);
    w->order = grown(w->order, w->room_hits, sizeof *w->order);
}

/* ---- hits ---- */

static void meet(struct worker *w)
{
    const struct wave *r = &w->now;
    const struct rays rays = { r->n, r->x, r->y, r->z, r->dx, r->dy, r->dz };

    geometry_nearest_many(w->plan, w->scratch, &rays, r->mask, w->meeting);
}

/* ---- groups of what is shaded together ---- */

static int list_hits(struct worker *w)
{
    int n = 0;

    for (int i = 0; i < w->now.n; i++) {
        const struct meeting *m = &w->meeting[i];
        if (m->leaf != NO_LEAF)
            w->hit[n++] = (struct wave_hit) { (uint32_t)i, surface_met(w->plan, m)->group };
    }
    return n;
}

/* Neighbours mostly belong together. */
static int run_end(const struct wave_hit *hit, int n, int i)
{
    int end = i + 1;

    while (end < n && hit[end].group == hit[i].group)
        end++;
    return end;
}

/* Stable: a pixel's rays keep their order within a group. */
static void sort_by_counting(struct worker *w, int n)
{
    uint32_t n_group = w->shader->n_group;

    memset(w->start, 0, (n_group + 1) * sizeof *w->start);
    for (int i = 0, end; i < n; i = end) {
        end = run_end(w->hit, n, i);
        w->start[w->hit[i].group + 1] += (uint32_t)(end - i);
    }
    for (uint32_t g = 0; g < n_group; g++)
        w->start[g + 1] += w->start[g];
    for (int i = 0, end; i < n; i = end) {
        end = run_end(w->hit, n, i);
        memcpy(w->order + w->start[w->hit[i].group], w->hit + i,
               (size_t)(end - i) * sizeof *w->hit);
        w->start[w->hit[i].group] += (uint32_t)(end - i);
    }
}

static int by_group(const void *a, const void *b)
{
    const struct wave_hit *s = a, *t = b;

    if (s->group != t->group)
        return s->group < t->group ? -1 : 1;
    return (s->ray > t->ray) - (s->ray < t->ray);
}

static void sort_hits(struct worker *w, int n)
{
    if (w->shader->n_group <= 1024u || w->shader->n_group <= (uint32_t)n) {
        sort_by_counting(w, n);
        return;
    }
    memcpy(w->order, w->hit, (size_t)n * sizeof *w->hit);
    qsort(w->order, (size_t)n, sizeof *w->order, by_group);
}

static void shade_all(struct worker *w, int n)
{
    for (int i = 0, end; i < n; i = end) {
        end = run_end(w->order, n < i + BATCH ? n : i + BATCH, i);
        shade_hits(w, end - i, w->order + i);
    }
}

static void trade_waves(struct worker *w)
{
    struct wave done = w->now;

    w->now = w->next;
    w->next = done;
    w->next.n = 0;
}

static void follow(struct worker *w)
{
    reserve_hits(w, w->now.n);
    meet(w);
    sky_fog(w);
    sky_show(w);
    int n = list_hits(w);
    sort_hits(w, n);
    shade_all(w, n);
    trade_waves(w);
}

/* What comes of a wave may be twice its size and more, a hundred times over:
 * beyond MOST_RAYS the rest waits. */
static bool follow_all(struct worker *w)
{
    while (w->now.n) {
        if (w->give_up && w->give_up(w->give_up_arg))
            return false;
        while (w->now.n > MOST_RAYS)
            parked_push(&w->parked, &w->now, MOST_RAYS, &w->insides, &w->film);
        follow(w);
    }
    return true;
}

bool worker_trace(struct worker *w)
{
    bool is_whole;

    do
        is_whole = follow_all(w);
    while (is_whole && parked_pop(&w->parked, &w->now, &w->insides, &w->film));
    w->now.n = 0;
    parked_clear(&w->parked);
    film_settle(&w->film, w->film.n_pixel);
    w->insides.n = w->n_camera_inside;
    return is_whole;
}
