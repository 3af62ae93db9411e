/* render.h: from plan to pixels. */
#ifndef RTC_RENDER_H
#define RTC_RENDER_H

#include <signal.h>
#include <stdbool.h>

#include "trace/plan.h"

struct render_options {
    unsigned width, height;             /* of the whole picture */
    unsigned crop_x, crop_y, crop_width, crop_height;   /* the part that is rendered */
    unsigned samples_side;              /* N rays a pixel on a regular grid: its side, sqrt N */
    unsigned threads;
    const volatile sig_atomic_t *stop;  /* not 0: end after the rows under way, if they end soon */
    /* Rows arrive once each, top to bottom in bands; linear working-space
     * floats, 4 a pixel (red, green, blue, transmit).  false ends the render. */
    bool (*rows)(void *arg, unsigned first, unsigned count, const float *pixels);
    void (*progress)(void *arg, double share, double rays);     /* NULL; called now and then */
    void *arg;
};

struct render_stats {
    double rays, shadow_rays, primary_rays, reflected_rays, refracted_rays;
    double seconds;                     /* wall */
    unsigned rows_done;
};

/* False: stopped or rows() said so; the rows before are complete. */
bool render(const struct plan *p, const struct render_options *o, struct render_stats *stats);

#endif
