/* picture.c: rows on their way from the renderer to the file. */
#include "cli/picture.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cli/stop.h"

/* The scene's working space as the file's writer names it (facts shading.md 5.2). */
static struct tone tone_of(const struct settings *s)
{
    switch (s->space) {
    case SPACE_LINEAR: return (struct tone) { .working = TONE_LINEAR };
    case SPACE_POWER:  return (struct tone) { .working = TONE_POWER, .gamma = s->gamma };
    case SPACE_SRGB:   return (struct tone) { .working = TONE_SRGB };
    default:           return (struct tone) { .working = TONE_RAW };
    }
}

/* +SC and its kin: pixels from 1, or shares of the side below 1. */
static unsigned edge(double said, unsigned side, double otherwise)
{
    if (said <= 0)
        return (unsigned)otherwise;
    return (unsigned)fmin(said < 1 ? floor(said * side + 0.5) : said, side);
}

static void choose_part(struct picture *p, const struct options *o, struct render_options *r)
{
    unsigned left = edge(o->part[0], o->width, 1), right = edge(o->part[1], o->width, o->width);
    unsigned top = edge(o->part[2], o->height, 1), bottom = edge(o->part[3], o->height, o->height);

    r->crop_x = left > 0 ? left - 1 : 0;
    r->crop_y = top > 0 ? top - 1 : 0;
    r->crop_width = right > r->crop_x ? right - r->crop_x : 1;
    r->crop_height = bottom > r->crop_y ? bottom - r->crop_y : 1;
    p->width = o->width, p->height = o->height;
    p->x = r->crop_x, p->y = r->crop_y;
    if (!o->has_crop)
        return;
    r->crop_x = o->crop.x, r->crop_y = o->crop.y;
    r->crop_width = p->width = o->crop.width;
    r->crop_height = p->height = o->crop.height;
    p->x = p->y = 0;
}

/* Rows that are not rendered are black. */
static bool black_rows(struct picture *p, unsigned count)
{
    memset(p->row, 0, (size_t)p->width * 4 * sizeof *p->row);
    for (unsigned i = 0; i < count; i++)
        if (!png_rows(p->png, 1, p->row, &p->error))
            return false;
    return true;
}

static bool narrow_rows(struct picture *p, unsigned count, const float *pixels)
{
    for (unsigned i = 0; i < count; i++, pixels += (size_t)p->part_width * 4) {
        memcpy(p->row + (size_t)p->x * 4, pixels, (size_t)p->part_width * 4 * sizeof *pixels);
        if (!png_rows(p->png, 1, p->row, &p->error))
            return false;
    }
    return true;
}

/* The writer's text is the thread's own, and this thread ends before the
 * message is printed. */
static void keep_error(struct picture *p)
{
    snprintf(p->message, sizeof p->message, "%s", p->error);
    p->error = p->message;
}

static bool on_rows(void *arg, unsigned first, unsigned count, const float *pixels)
{
    struct picture *p = arg;
    double start = progress_now();
    bool done = true;

    (void)first;
    if (p->png && p->row)
        done = narrow_rows(p, count, pixels);
    else if (p->png)
        done = png_rows(p->png, count, pixels, &p->error);
    if (!done)
        keep_error(p);
    p->write_seconds += progress_now() - start;
    return done;
}

static void on_progress(void *arg, double share, double rays)
{
    struct picture *p = arg;

    progress_show(&p->progress, share, rays);
}

static bool open_file(struct picture *p, const struct options *o, const struct settings *s,
                      const char *path, struct arena *mem)
{
    p->png = png_open(path, p->width, p->height, o->bits, o->alpha, tone_of(s), &p->error);
    if (!p->png)
        return false;
    stop_begin_rows(png_temporary(p->png));
    if (p->part_width == p->width && p->y == 0)
        return true;
    p->row = arena_array(mem, p->width, 4 * sizeof *p->row);
    return black_rows(p, p->y);
}

bool picture_open(struct picture *p, const struct options *o, const struct settings *s,
                  const char *path, struct arena *mem, struct render_options *r)
{
    *p = (struct picture) { .path = path };
    r->width = o->width, r->height = o->height;
    choose_part(p, o, r);
    p->part_width = r->crop_width;
    r->rows = on_rows, r->progress = on_progress, r->arg = p;
    stop_begin_rows(NULL);
    return o->no_file || open_file(p, o, s, path, mem);
}

bool picture_close(struct picture *p, bool keep)
{
    const char *error = NULL;
    bool done = !p->png || png_close(p->png, keep, &error);

    p->png = NULL;
    if (!p->error)
        p->error = error;
    stop_end_rows();
    return done;
}
