/* worker.h: what one thread works with. */
#ifndef RTC_WORKER_H
#define RTC_WORKER_H

#include "trace/camera_rays.h"
#include "trace/film.h"
#include "trace/geometry.h"
#include "trace/insides.h"
#include "trace/parked.h"
#include "trace/shader.h"
#include "trace/wave.h"

/* What arrives of each lamp at the points of a batch, once it is known: for
 * textures of which several parts are lit alike. */
struct shadows { bool is_kept, *known; rgb *through; };     /* [lamp * BATCH + slot] */

/* From the points of a batch to one lamp. */
struct shadow_rays {
    double x[BATCH], y[BATCH], z[BATCH], dx[BATCH], dy[BATCH], dz[BATCH], far[BATCH];
    uint64_t barrier[BATCH];
};

/* What area lights work with: area.c. */
struct area_room {
    struct area_spot *spot;             /* of each sample of a lamp */
    struct area_wanted { uint64_t by[BATCH / 64]; } *wanted;   /* of each: by which points */
    uint8_t *state;                     /* [point * samples + sample] */
    rgb *colour;
};

void area_room_init(struct area_room *r, int n_sample, struct arena *mem);

/* The number of a ray that met something, and of what is shaded together with it. */
struct wave_hit { uint32_t ray, group; };

struct render_counts { double primary, reflected, refracted; };

struct worker {
    const struct plan *plan;
    const struct shader *shader;
    struct arena mem;
    struct scratch *scratch;
    struct lens lens;
    struct wave now, next;
    struct parked parked;
    bool (*give_up)(void *arg);         /* NULL: never */
    void *give_up_arg;
    struct film film;
    struct insides insides;
    uint32_t camera_inside, n_camera_inside;    /* the list at a fixed camera; items to keep */
    struct meeting *meeting;            /* of the rays of the wave now; leaf NO_LEAF: none */
    struct wave_hit *hit, *order;       /* rays that met something; by group */
    uint32_t *start;                    /* of each group among them */
    int room_hits;
    struct shadows shadows;
    struct shadow_rays shadow_rays;
    struct area_room area;
    struct mirror_layer *mirror;        /* of the layers of a program */
    int room_mirror;
    struct render_counts counts;
};

void worker_init(struct worker *w, const struct plan *p);
void worker_release(struct worker *w);

/* The interiors around a camera or the origin of a ray. */
uint32_t worker_insides_at(struct worker *w, vec3 point);

/* Follows the wave `now` and all that comes of it until nothing is left.
 * False: give_up said so, and the film is not whole. */
bool worker_trace(struct worker *w);

#endif
