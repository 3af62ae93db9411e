/* shadow.h: how much of a lamp's light comes through. */
#ifndef RTC_SHADOW_H
#define RTC_SHADOW_H

#include "trace/shade.h"

/* What gets through of a lamp's light to the points at[0..n) of a batch; 1:
 * all of it.  0 at other points. */
struct lit { float r[BATCH], g[BATCH], b[BATCH]; };

INLINE void lit_put(struct lit *out, int i, rgb c)
{
    out->r[i] = c.r;
    out->g[i] = c.g;
    out->b[i] = c.b;
}

void shadow_through(struct worker *w, const struct batch *b, const struct beams *beam,
                    uint32_t lamp, int n, const uint16_t at[], struct lit *out);

/* A lamp that stands exactly on a surface is not shadowed by it: of the way to it. */
static const double shadow_nearly = 1 - 1e-9;

/* The same along the worker's n shadow_rays, the k-th from the point at[k]; out: of ray k. */
void shadow_rays_pass(struct worker *w, const struct batch *b, uint32_t lamp, int n, const uint16_t at[],
                      struct lit *out);

/* Before a batch of n points that will be lit more than once. */
void shadow_forget(struct worker *w, int n);

/* What is left of light after a way through an interior (facts shading.md 3.4). */
rgb interior_fade(const struct interior *in, double distance);

/* The points as the textures of this surface want them. */
void spot_of(const struct surface *s, const struct surface_point *p, double spot[5]);

#endif
