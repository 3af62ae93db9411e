/* render.c: tiles of the picture, shared out to threads. */
#include "trace/render.h"

#include <pthread.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "math/kernel.h"
#include "trace/worker.h"

enum {
    TILE_WIDTH = 32, TILE_HEIGHT = 16,
    WAVE_RAYS = 1024,                   /* of one pass over a tile, about */
    TILES_BY_ROW = 2,                   /* a thread: the last ones */
    GRACE = 2,                          /* seconds for the rows under way once a stop is wanted */
    STACK_BYTES = 64 << 20,             /* pigments nest as deeply as a scene's blocks may */
};

/* The rows of a row of tiles, on their way to the receiver. */
struct band {
    float *pixels;
    unsigned rows_left;                 /* of its tiles, each tile's counted */
};

/* What the threads share.  Bands are finished in any order and handed over in
 * theirs; only `window` of them exist at a time, so that memory does not grow
 * with the picture. */
struct gang {
    const struct plan *plan;
    const struct render_options *o;
    unsigned across, down;              /* tiles */
    unsigned long next, total;          /* tiles, row by row */
    unsigned next_row;                  /* of the next tile: the last ones are shared out by the row */
    unsigned long whole;                /* tiles that are not */
    unsigned window, delivered;         /* bands */
    struct band *band;                  /* a ring of window */
    pthread_mutex_t lock;
    pthread_cond_t moved;               /* a band was delivered, or the end was decided */
    bool ended, delivering;
    unsigned rows_done;
    double area_done;                   /* pixels */
    double rays, last_progress;
    _Atomic double stopped;             /* when the stop was seen; 0: it was not */
    struct render_stats *stats;
};

static double now(void)
{
    struct timespec t;

    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + (double)t.tv_nsec * 1e-9;
}

static unsigned least(unsigned a, unsigned b) { return a < b ? a : b; }

/* ---- a tile ---- */

/* All or some rows of one; pixels of the part that is rendered. */
struct tile { unsigned x, y, width, height; };

static struct tile tile_at(const struct gang *g, unsigned long number)
{
    unsigned x = (unsigned)(number % g->across) * TILE_WIDTH;
    unsigned y = (unsigned)(number / g->across) * TILE_HEIGHT;

    return (struct tile) { x, y, least(TILE_WIDTH, g->o->crop_width - x),
                           least(TILE_HEIGHT, g->o->crop_height - y) };
}

/* Samples first to end of the pixels of a tile, and how they lie in its rows. */
struct aims {
    const struct render_options *o;
    const struct tile *tile;
    unsigned first, end;
    int n;                              /* rays a row */
    double u[WAVE_RAYS], v[WAVE_RAYS];  /* v: of the row that is looked at */
    double down[WAVE_RAYS];             /* within the pixel, 0 to 1 */
    uint32_t pixel[WAVE_RAYS];          /* within the row */
};

KERNEL static void place(int n, double pixel, const double *restrict part, double size,
                         double *restrict out)
{
    for (int i = 0; i < n; i++)
        out[i] = (pixel + part[i]) / size;
}

static void plan_rows(struct aims *a)
{
    const struct render_options *o = a->o;
    double across[WAVE_RAYS], side = o->samples_side;
    int n = 0;

    for (unsigned k = a->first; k < a->end; k++) {
        across[k - a->first] = (k % o->samples_side + 0.5) / side;
        a->down[k - a->first] = (k / o->samples_side + 0.5) / side;
    }
    for (unsigned x = 0; x < a->tile->width; x++) {
        int count = (int)(a->end - a->first);
        place(count, o->crop_x + a->tile->x + x, across, o->width, a->u + n);
        for (int k = 0; k < count; k++, n++) {
            a->pixel[n] = x;
            a->down[n] = a->down[k];
        }
    }
    a->n = n;
}

/* What all rays that come from the camera have in common. */
static void load_wave(struct wave *w, int from, uint32_t inside)
{
    for (int i = from; i < w->n; i++)
        w->red[i] = w->green[i] = w->blue[i] = w->alpha[i] = w->adc[i] = 1;
    for (int i = from; i < w->n; i++) {
        w->inside[i] = inside;
        w->depth[i] = 0;
        w->mask[i] = RAY_PRIMARY;
    }
}

static void shoot_fan(struct worker *w, const struct aims *a, uint32_t pixel)
{
    struct wave *now = &w->now;
    int from = now->n;

    now->n += a->n;
    lens_fan(&w->lens, a->n, a->u, a->v, now->dx + from, now->dy + from, now->dz + from);
    for (int i = 0; i < a->n; i++) {
        now->x[from + i] = w->lens.location.x;
        now->y[from + i] = w->lens.location.y;
        now->z[from + i] = w->lens.location.z;
        now->pixel[from + i] = pixel + a->pixel[i];
    }
    load_wave(now, from, w->camera_inside);
}

static void shoot_one(struct worker *w, uint32_t pixel, double u, double v)
{
    struct wave *now = &w->now;
    struct ray ray;
    int i = now->n;

    if (!lens_ray(&w->lens, u, v, &ray)) {
        w->film.sum[pixel][3] += 1;
        return;
    }
    now->x[i] = ray.origin.x;
    now->y[i] = ray.origin.y;
    now->z[i] = ray.origin.z;
    now->dx[i] = ray.dir.x;
    now->dy[i] = ray.dir.y;
    now->dz[i] = ray.dir.z;
    now->pixel[i] = pixel;
    now->n++;
    load_wave(now, i, w->lens.fixed_origin ? w->camera_inside : worker_insides_at(w, ray.origin));
}

static void shoot_row(struct worker *w, struct aims *a, unsigned y)
{
    uint32_t pixel = y * a->tile->width;

    place(a->n, a->o->crop_y + a->tile->y + y, a->down, a->o->height, a->v);
    if (w->lens.kind == CAMERA_PERSPECTIVE)
        shoot_fan(w, a, pixel);
    else
        for (int i = 0; i < a->n; i++)
            shoot_one(w, pixel + a->pixel[i], a->u[i], a->v[i]);
}

/* Samples from first up to end, of all pixels of the tile. */
static void aim(struct worker *w, const struct render_options *o, const struct tile *t,
                unsigned first, unsigned end)
{
    struct aims a;

    a.o = o;
    a.tile = t;
    a.first = first;
    a.end = end;
    plan_rows(&a);
    wave_reserve(&w->now, a.n * (int)t->height);
    for (unsigned y = 0; y < t->height; y++)
        shoot_row(w, &a, y);
    w->counts.primary += w->now.n;
}

/* False: it was given up. */
static bool trace_tile(struct worker *w, const struct render_options *o, const struct tile *t)
{
    unsigned n_pixel = t->width * t->height, n_sample = o->samples_side * o->samples_side;
    unsigned at_once = WAVE_RAYS > n_pixel ? WAVE_RAYS / n_pixel : 1;

    film_start(&w->film, n_pixel);
    for (unsigned s = 0; s < n_sample; s += at_once) {
        aim(w, o, t, s, least(s + at_once, n_sample));
        if (!worker_trace(w))
            return false;
    }
    return true;
}

KERNEL static void average(int n, const double *restrict sum, double count, float *restrict out)
{
    for (int i = 0; i < n; i++)
        out[i] = (float)(sum[i] / count);
}

/* Into the tile's place in its band. */
static void develop(const struct worker *w, const struct render_options *o, const struct tile *t,
                    float *band)
{
    double n = (double)o->samples_side * o->samples_side;

    for (unsigned y = 0; y < t->height; y++)
        average(4 * (int)t->width, *w->film.sum + 4 * (size_t)y * t->width, n,
                band + 4 * ((size_t)(t->y % TILE_HEIGHT + y) * o->crop_width + t->x));
}

/* ---- sharing out ---- */

static bool is_stopped(const struct gang *g) { return g->o->stop && *g->o->stop; }

/* A pixel may take for ever: rows that are not done soon after a stop are
 * given up. */
static bool is_late(void *gang)
{
    struct gang *g = gang;

    if (!is_stopped(g))
        return false;
    if (g->stopped == 0)
        g->stopped = now();
    return now() - g->stopped > GRACE;
}

static struct band *band_of(const struct gang *g, const struct tile *t)
{
    return &g->band[t->y / TILE_HEIGHT % g->window];
}

/* The next tile, or at the end, when others would have to wait for a slow
 * one, its next row. */
static struct tile next_part(struct gang *g)
{
    struct tile t = tile_at(g, g->next);

    if (g->next < g->whole) {
        g->next++;
        return t;
    }
    unsigned height = t.height;
    t.y += g->next_row++;
    t.height = 1;
    if (g->next_row == height) {
        g->next_row = 0;
        g->next++;
    }
    return t;
}

/* What to do next, or false at the end.  A stopped render finishes the bands
 * that are begun. */
static bool take(struct gang *g, struct tile *part)
{
    pthread_mutex_lock(&g->lock);
    while (!g->ended && g->next < g->total
           && g->next / g->across >= (unsigned long)g->delivered + g->window)
        pthread_cond_wait(&g->moved, &g->lock);
    if (g->next % g->across == 0 && g->next_row == 0 && is_stopped(g))
        g->total = g->next;
    bool more = !g->ended && g->next < g->total;
    if (more)
        *part = next_part(g);
    pthread_mutex_unlock(&g->lock);
    return more;
}

static void tell_progress(struct gang *g)
{
    double t = now();

    if (!g->o->progress || t - g->last_progress < 0.05)
        return;
    g->last_progress = t;
    g->o->progress(g->o->arg, g->area_done / ((double)g->o->crop_width * g->o->crop_height), g->rays);
}

/* 0 beyond the end. */
static unsigned rows_of_band(const struct gang *g, unsigned number)
{
    if (number >= g->down)
        return 0;
    return g->across * least(TILE_HEIGHT, g->o->crop_height - number * TILE_HEIGHT);
}

/* Hands over all bands that are whole and next, with the lock held but for
 * the call itself; one thread at a time. */
static void deliver(struct gang *g)
{
    if (g->delivering)
        return;
    g->delivering = true;
    while (!g->ended && g->delivered < g->down) {
        struct band *b = &g->band[g->delivered % g->window];
        unsigned first = g->delivered * TILE_HEIGHT;
        unsigned count = least(TILE_HEIGHT, g->o->crop_height - first);
        if (b->rows_left)
            break;
        pthread_mutex_unlock(&g->lock);
        bool go_on = g->o->rows(g->o->arg, first, count, b->pixels);
        pthread_mutex_lock(&g->lock);
        if (!go_on) {
            g->ended = true;
        } else {
            g->rows_done = first + count;
            g->delivered++;
            b->rows_left = rows_of_band(g, g->delivered - 1 + g->window);
        }
        pthread_cond_broadcast(&g->moved);
    }
    g->delivering = false;
}

static void give_up(struct gang *g)
{
    pthread_mutex_lock(&g->lock);
    g->ended = true;
    pthread_cond_broadcast(&g->moved);
    pthread_mutex_unlock(&g->lock);
}

static void finish_part(struct gang *g, const struct tile *t, double rays)
{
    struct band *b = band_of(g, t);

    pthread_mutex_lock(&g->lock);
    g->area_done += (double)t->width * t->height;
    g->rays += rays;
    tell_progress(g);
    b->rows_left -= t->height;
    if (b->rows_left == 0)
        deliver(g);
    pthread_mutex_unlock(&g->lock);
}

static void add_counts(struct gang *g, const struct worker *w)
{
    struct geometry_counts c = scratch_counts(w->scratch);

    pthread_mutex_lock(&g->lock);
    g->stats->rays += (double)c.rays;
    g->stats->shadow_rays += (double)c.shadow_rays;
    g->stats->primary_rays += w->counts.primary;
    g->stats->reflected_rays += w->counts.reflected;
    g->stats->refracted_rays += w->counts.refracted;
    pthread_mutex_unlock(&g->lock);
}

static double rays_of(const struct worker *w)
{
    struct geometry_counts c = scratch_counts(w->scratch);

    return (double)(c.rays + c.shadow_rays);
}

static void *work(void *arg)
{
    struct gang *g = arg;
    struct worker w;
    struct tile t;

    worker_init(&w, g->plan);
    w.give_up = is_late;
    w.give_up_arg = g;
    while (take(g, &t)) {
        double before = rays_of(&w);
        if (!trace_tile(&w, g->o, &t)) {
            give_up(g);
            break;
        }
        develop(&w, g->o, &t, band_of(g, &t)->pixels);
        finish_part(g, &t, rays_of(&w) - before);
    }
    add_counts(g, &w);
    worker_release(&w);
    return NULL;
}

/* ---- the whole ---- */

static void run_threads(struct gang *g, unsigned n)
{
    pthread_t *thread = calloc(n, sizeof *thread);
    pthread_attr_t attr;
    unsigned started = 0;

    pthread_attr_init(&attr);
    pthread_attr_setstacksize(&attr, STACK_BYTES);
    for (unsigned i = 0; thread && i < n; i++)
        if (pthread_create(&thread[started], &attr, work, g) == 0)
            started++;
    if (started == 0)
        work(g);
    for (unsigned i = 0; i < started; i++)
        pthread_join(thread[i], NULL);
    pthread_attr_destroy(&attr);
    free(thread);
}

static void make_bands(struct gang *g, struct arena *mem)
{
    size_t floats = (size_t)g->o->crop_width * TILE_HEIGHT * 4;

    g->band = arena_array(mem, g->window, sizeof *g->band);
    for (unsigned i = 0; i < g->window; i++) {
        g->band[i].pixels = arena_array(mem, floats, sizeof(float));
        g->band[i].rows_left = rows_of_band(g, i);
    }
}

bool render(const struct plan *p, const struct render_options *o, struct render_stats *stats)
{
    struct gang g = {
        .plan = p, .o = o, .stats = stats,
        .across = (o->crop_width + TILE_WIDTH - 1) / TILE_WIDTH,
        .down = (o->crop_height + TILE_HEIGHT - 1) / TILE_HEIGHT,
    };
    unsigned threads = o->threads ? o->threads : 1;
    double start = now();
    struct arena mem;

    *stats = (struct render_stats) { 0 };
    arena_init(&mem, p->mem->budget);
    g.total = (unsigned long)g.across * g.down;
    g.whole = threads > 1 ? g.total - least((unsigned)g.total, TILES_BY_ROW * threads) : g.total;
    g.window = least(threads + 2, g.down);
    make_bands(&g, &mem);
    pthread_mutex_init(&g.lock, NULL);
    pthread_cond_init(&g.moved, NULL);
    run_threads(&g, threads);
    pthread_cond_destroy(&g.moved);
    pthread_mutex_destroy(&g.lock);
    arena_free(&mem);
    stats->rows_done = g.rows_done;
    stats->seconds = now() - start;
    return g.rows_done == o->crop_height;
}
