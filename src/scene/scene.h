/* scene.h: all that the user described; no rays, no syntax. */
#ifndef RTC_SCENE_H
#define RTC_SCENE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

#include "base/arena.h"
#include "base/field.h"
#include "scene/atmosphere.h"
#include "scene/camera.h"
#include "scene/light.h"
#include "scene/object.h"
#include "scene/texture.h"

/* Facts shading.md 5.2: what the scene's numbers mean. */
enum working_space {
    SPACE_RAW,                          /* no gamma handling: files before 3.7 without assumed_gamma */
    SPACE_LINEAR,
    SPACE_POWER,                        /* linear = value ^ gamma */
    SPACE_SRGB,
};

struct settings {
    int version;                        /* number * 100 */
    int effective_version;              /* 362 when nothing was said: facts shading.md 0 */
    enum working_space space;
    double gamma;                       /* of SPACE_POWER */
    int max_trace_level;                /* 5 */
    double adc_bailout;                 /* 1/255 */
    rgb ambient_light;                  /* 1 */
    rgb irid_wavelength;
    int noise_generator;                /* 2 */
    int number_of_waves;                /* 10 */
    int max_intersections;              /* read, not needed */
    bool has_assumed_gamma;
};

/* An object of the world.  Of shapes that differ in nothing else one stands for
 * all, and only their shapes are kept: there may be millions. */
struct listed {
    const struct object *like;
    const void *shape;                  /* instead of like's */
};

enum { SCENE_KINDS = 64 };

struct scene {
    struct arena *mem;
    struct settings settings;
    struct camera camera;
    colour background;
    bool has_background;
    struct listed *listed;              /* in the world; lights among them are in light[] too */
    size_t n_object, room_object;
    const struct object *kind[SCENE_KINDS];     /* some of those that others may be like */
    struct light *light;                /* in the world, also those that stood in unions */
    size_t n_light, room_light;
    const struct sky_sphere *sky_sphere;    /* the last one; NULL: none */
    const struct fog **fog;
    size_t n_fog, room_fog;
};

extern const struct settings settings_default;
extern const struct field settings_fields[];        /* words of global_settings { } */

void scene_init(struct scene *s, struct arena *mem);
/* Adds a top-level object; the lights inside it come into light[].  True: it is
 * like another, so that o itself is free to become something else. */
bool scene_add(struct scene *s, struct object *o);
const struct object *scene_object(const struct scene *s, size_t i, struct object *room);  /* perhaps in room */
void scene_forget_objects(struct scene *s);     /* the list of them; what they point to stays */
void scene_add_light(struct scene *s, const struct light *l);

/* A readable listing (--dump=scene). */
void scene_dump(const struct scene *s, FILE *out);

#endif
