/* texture.h: what a surface looks like: pigment, normal and finish, in layers. */
#ifndef RTC_TEXTURE_H
#define RTC_TEXTURE_H

#include "scene/finish.h"
#include "scene/pigment.h"

enum texture_kind {
    TEXTURE_PLAIN,
    TEXTURE_MAP,                        /* pattern, and a map or list of textures */
    TEXTURE_AVERAGE,
};

/* One layer.  Layers are listed from the bottom (the first declared) up. */
struct texture {
    enum texture_kind kind;
    const struct pigment *pigment;      /* of a plain texture; never NULL there */
    const struct normal *normal;        /* may be NULL */
    const struct finish *finish;        /* never NULL in a plain texture */
    const struct pattern_use *pattern;  /* of the other kinds */
    struct map_entry *entry;
    size_t n_entry;
    const struct transform *place;      /* the owner object's outer space from the texture's */
    const struct texture *above;        /* the next layer, or NULL */
    struct nest nest;                   /* of one that is not plain */
    bool uv_mapping;
    const char *unsupported;            /* not NULL: what cannot be shown yet */
};

/* What fills a solid. */
struct interior {
    double ior;                         /* 0: not given, as the surroundings */
    double caustics;
    double dispersion;                  /* 1 */
    int dispersion_samples;             /* 7 */
    double fade_distance, fade_power;
    rgb fade_colour;
    const struct media *media;          /* none yet */
};

extern const struct interior interior_default;
extern const struct field interior_fields[];
extern const struct texture texture_default;

/* place, moved by t. */
const struct transform *transform_moved(struct arena *mem, const struct transform *t,
                                        const struct transform *place);

#endif
