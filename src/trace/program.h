/* program.h: textures as short programs: layers of paint and gloss. */
#ifndef RTC_PROGRAM_H
#define RTC_PROGRAM_H

#include <stdint.h>

#include "scene/scene.h"
#include "trace/pigment.h"

/* A finish ready for use. */
struct gloss {
    rgb ambient;                        /* times the scene's ambient_light */
    rgb emission;
    float diffuse, diffuse_back, brilliance;
    float phong, phong_size;
    float specular, shininess;          /* 1 / roughness */
    float metallic, crand;
    float irid, irid_thickness;
    struct {
        rgb low, high;
        float falloff, metallic;
        float power;                    /* of what is seen in it; 1 mostly */
        bool fresnel;
    } mirror;
    bool has_mirror, has_highlight, conserve_energy;
};

struct layer {
    const struct paint *paint;
    const struct gloss *gloss;
    bool can_transmit;
};

enum program_kind { PROGRAM_LAYERS, PROGRAM_MAP, PROGRAM_AVERAGE };

struct program {
    enum program_kind kind;
    /* Points whose programs have the same group are shaded together: one
     * program, or all those that differ in nothing but a plain colour. */
    uint32_t group;
    bool is_plain;                      /* one layer of one colour: */
    colour colour;
    bool can_transmit, has_mirror, wants_uv;
    int n_layer;
    const struct layer *layer;          /* the top one, declared last, first */
    const struct gauge *gauge;          /* of a map */
    const struct program **entry;
    const float *weight;                /* of an average; they add up to 1 */
    const struct program **face;        /* of a mesh: by the numbers of its faces' textures */
    uint32_t lone;                      /* 1 + the surface that is no more than this program; 0: not made */
};

const struct gloss *gloss_new(struct arena *mem, const struct settings *settings,
                              const struct finish *f);
struct program *program_new(struct arena *mem, const struct settings *settings,
                            const struct texture *texture, const struct transform *outer);
/* One layer of one colour, with a gloss that is there already. */
struct program *program_plain(struct arena *mem, const struct pigment *p, const struct gloss *gloss);

/* How much light comes through, as shadows see it: the product over the layers
 * of colour * filter + transmit. */
void program_filter(const struct program *p, const struct spots *s, rgb out[]);

#endif
