/* sky.h: what is seen where nothing is, and the haze before everything. */
#ifndef RTC_SKY_H
#define RTC_SKY_H

#include "trace/worker.h"

/* The scene's atmosphere ready for use; of the shader. */
struct sky {
    const struct paint **paint;         /* of the sky_sphere, the lowest first */
    int n_paint;
    rgb emission;
    bool is_old;                        /* before 3.7 layers mixed otherwise */
    rgb background;                     /* times what of it is opaque */
    float transmit;
};

const struct sky *sky_new(struct arena *mem, const struct scene *s);

/* For the rays of the wave now: dims them by the fog on their way, then adds
 * the sky to those that met nothing. */
void sky_fog(struct worker *w);
void sky_show(struct worker *w);

#endif
