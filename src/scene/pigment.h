/* pigment.h: colours over space: plain, by a pattern, or from an image. */
#ifndef RTC_PIGMENT_H
#define RTC_PIGMENT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/field.h"
#include "math/mat.h"
#include "math/vec.h"
#include "pattern/pattern.h"

/* Pixels ready for use: in the scene's working space, alpha as transmit. */
struct image {
    unsigned width, height;
    colour *pixel;                      /* top row first; or instead, for small files in memory: */
    const uint8_t *index;               /* ... each pixel's place in the palette */
    const colour *palette;
    const uint8_t *bytes;               /* ... red, green, blue, and what a byte stands for */
    const float *level;
    bool has_transparency;              /* some pixel's filter or transmit is not 0 */
};

static inline colour image_pixel(const struct image *m, size_t i)
{
    if (m->pixel)
        return m->pixel[i];
    if (m->index)
        return m->palette[m->index[i]];
    const uint8_t *p = m->bytes + 3 * i;
    return (colour) { m->level[p[0]], m->level[p[1]], m->level[p[2]], 0, 0 };
}

/* Where pixel i begins. */
static inline const void *image_address(const struct image *m, size_t i)
{
    return m->pixel ? (const void *)(m->pixel + i) : m->index ? m->index + i : m->bytes + 3 * i;
}

enum wave_type { WAVE_RAMP, WAVE_TRIANGLE, WAVE_SINE, WAVE_SCALLOP, WAVE_CUBIC, WAVE_POLY };

struct turbulence {
    vec3 amount;                        /* 0: none */
    double lambda, omega;
    int octaves;
};

/* How much is in each other: pigments and textures in maps, functions that others call.  A
 * declared one counts wherever it is named, so forty lines may ask for 2^40. */
struct nest { unsigned levels; double parts; };

static inline void nest_add(struct nest *around, struct nest in)
{
    if (around->levels < in.levels + 1)
        around->levels = in.levels + 1;
    around->parts += 1 + in.parts;
}

/* What stands between a point and the pattern's number, and between that
 * number and the map. */
struct pattern_use {
    const struct pattern_ops *ops;
    const void *self;
    double frequency, phase, exponent;  /* exponent: of poly_wave */
    enum wave_type wave;
    struct turbulence turbulence;
    const struct warp *warps;           /* none yet */
};

/* Value v maps to what the entries at both sides say, mixed linearly; beyond
 * the ends the end entry holds (facts patterns.md). */
struct map_entry {
    double value;
    colour colour;                      /* in a colour map */
    const struct pigment *pigment;      /* in a pigment map or list */
    const struct texture *texture;      /* in a texture map or list */
    const struct normal *normal;        /* in a normal map */
};

enum pigment_kind {
    PIGMENT_COLOUR,                     /* one colour */
    PIGMENT_COLOUR_MAP,                 /* pattern, and a map of colours or a list of them */
    PIGMENT_PIGMENT_MAP,                /* pattern, and a map or list of pigments */
    PIGMENT_IMAGE,
    PIGMENT_AVERAGE,                    /* pigments with weights in value */
};

enum { MAP_PLANAR = 0, MAP_SPHERICAL = 1, MAP_CYLINDRICAL = 2, MAP_TOROIDAL = 5 };
enum { INTERPOLATE_NONE = 0, INTERPOLATE_BILINEAR = 2, INTERPOLATE_BICUBIC = 3,
       INTERPOLATE_DISTANCE = 4 };

struct image_use {
    const struct image *image;
    int map_type, interpolate;
    bool once;
    double filter_all, transmit_all;    /* added to every pixel's */
};

/* A scene may have one for each of its objects. */
struct pigment {
    enum pigment_kind kind;
    colour colour;
    colour quick_colour;
    bool has_quick_colour;
    bool uv_mapping;
    const struct pattern_use *pattern;  /* never NULL, like image and place: most share them */
    struct map_entry *entry;            /* of the map or list; NULL with n 0: the pattern's default */
    size_t n_entry;
    const struct image_use *image;
    const struct transform *place;      /* texture's space from the pigment's */
    struct nest nest;
    const char *unsupported;            /* not NULL: what cannot be shown yet; a plain colour stands for it */
    const void *said;                   /* the language's: how it was written */
};

/* Perturbed normals; which kinds there are comes with a later issue. */
struct normal {
    struct pattern_use pattern;
    double amount, accuracy;
    struct transform place;
    bool no_bump_scale;
    const char *word;                   /* of its pattern */
    const void *said;                   /* the language's: how it was written */
};

extern const struct pigment pigment_default;        /* black, opaque */

/* At one point of the space that the pigment is used in: for the language's
 * functions.  What cannot be shown is refused before: pigment_unsupported. */
colour pigment_at(const struct pigment *p, vec3 at);
const char *pigment_unsupported(const struct pigment *p);   /* in it or in its maps; NULL: nothing */

/* A pattern's number at a point, behind frequency, phase and wave. */
double pattern_at(const struct pattern_use *use, const struct transform *place, vec3 p);

#endif
