/* coat.h: one layer of a texture on a batch of points. */
#ifndef RTC_COAT_H
#define RTC_COAT_H

#include "trace/shade.h"

/* A batch in single precision, for everything that is colour. */
struct view {
    float nx[BATCH], ny[BATCH], nz[BATCH];
    float dx[BATCH], dy[BATCH], dz[BATCH];
};
void view_of(const struct batch *b, struct view *v);

/* What a layer's pigment and finish meet at a batch of points. */
struct coat {
    const struct gloss *gloss;
    struct colours colour;
    float opaque[BATCH];
    float r[BATCH], g[BATCH], b[BATCH]; /* the light that leaves it */
};

/* alive: 0 where nobody sees it. */
void coat_light(struct worker *w, const struct batch *b, const struct view *v, const float *alive,
                int layer, struct coat *c);

/* How much it reflects, below layers that let trans through. */
void coat_mirror(const struct worker *w, const struct batch *b, const struct view *v,
                 const struct coat *c, const float *trans, const float *alive,
                 struct mirror_layer *out);

#endif
