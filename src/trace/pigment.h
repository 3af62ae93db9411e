/* pigment.h: pigments ready for use, evaluated for arrays of points. */
#ifndef RTC_TRACE_PIGMENT_H
#define RTC_TRACE_PIGMENT_H

#include "math/kernel.h"
#include "scene/tune.h"

/* Points as textures see them. */
struct spots {
    int n;                              /* <= BATCH */
    const double *x, *y, *z;
    const double *u, *v;                /* of the surface, for uv_mapping */
};

struct colours { float r[BATCH], g[BATCH], b[BATCH], f[BATCH], t[BATCH]; };

/* How a point comes to a pattern: from the surface's space, or from uv. */
struct chain {
    mat34 from;                         /* pattern's space from the outer one */
    bool is_identity, from_uv;
    struct turbulence turbulence;
    bool has_turbulence;
};

/* A pattern with the keys of its map. */
struct gauge {
    struct chain chain;
    struct pattern_use use;
    const float *key;                   /* single precision, as POV-Ray keeps them */
    int n_key;
};

struct paint {
    enum pigment_kind kind;
    bool can_transmit, wants_uv;
    colour colour;
    const struct gauge *gauge;          /* all but a plain colour have one */
    const colour *entry_colour;
    const struct paint **entry;
    const float *weight;                /* of an average; they add up to 1 */
    const struct image_use *image;
};

/* outer: the surface's space from the pigment's surroundings. */
const struct paint *paint_new(struct arena *mem, const struct pigment *p,
                              const struct transform *outer);
void paint_colours(const struct paint *p, const struct spots *s, struct colours *out);

/* For texture maps, which look up the same way. */
struct chain chain_of(const struct transform *outer, const struct transform *own, bool from_uv,
                      const struct turbulence *turbulence);
const struct gauge *gauge_new(struct arena *mem, const struct chain *chain,
                              const struct pattern_use *use, const struct map_entry *entry,
                              size_t n_entry);
void chain_walk(const struct chain *c, const struct spots *s, double *x, double *y, double *z);
/* where[i]: between which entries point i lies; x, y, z: the points as the entries see them. */
void gauge_read(const struct gauge *g, const struct spots *s, double *x, double *y, double *z,
                struct map_place *where);

#endif
