/* plan.h: how to render a scene: only what this scene needs, all of it const
 * once plan_new is done, shared by all threads without locks. */
#ifndef RTC_PLAN_H
#define RTC_PLAN_H

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

#include "scene/scene.h"

#define NO_LEAF UINT32_MAX
#define NO_INSTANCE UINT32_MAX

/* Which rays may see a leaf. */
enum ray_mask {
    RAY_PRIMARY = 1 << 0,               /* from the camera, and its refracted continuations */
    RAY_REFLECTED = 1 << 1,             /* reflected, and what follows of it */
    RAY_SHADOW = 1 << 2,
};

/* Where shapes stand: shared by all that stand alike, which are most. */
struct placement {
    struct transform place;             /* world (or instance's space) from the shape's */
    double stretch;                     /* the shape's slack in world units */
    double fuzz;                        /* rounding of the way there and back: of the coordinates' size */
};

/* One shape placed in the world, or in an instance's space.  There may be
 * millions: 32 bytes each. */
struct leaf {
    const struct shape_ops *ops;        /* this build's own table's; NULL: a mesh */
    union {
        const void *shape;              /* prepared */
        const struct mesh_tree *mesh;   /* all of one mesh: mesh.h */
    };
    const struct placement *placement;  /* NULL: where the shape says */
    uint32_t surface;                   /* of plan->surface; NO_LEAF: the instance's */
    uint8_t mask;                       /* enum ray_mask */
    bool inverse;                       /* its normal and its inside are turned */
};

/* How a surface looks; many leaves may share one.  surface.h has the rest. */
struct surface {
    const struct texture *texture, *interior_texture;   /* bottom layers; the first never NULL */
    const struct interior *interior;    /* NULL: none given */
    const void *solid;                  /* identifies the object whose interior it is */
    bool is_opaque;                     /* no pigment in it can let light through */
    bool double_illuminate, hollow, uv_mapping;
    bool wants_uv;                      /* some texture looks at u and v */
    bool is_mixed;                      /* which program shades a point depends on the point */
    bool is_even;                       /* light that comes through is the same all over */
    uint8_t tally;                      /* of the plan's tallies */
    uint32_t group;                     /* what is shaded together: that of its program */
    const struct program *program, *interior_program;   /* textures as short programs: surface.h */
};

struct instance {                       /* one stored tree, placed once more */
    struct transform place;             /* world from the instance's space */
    double stretch, fuzz;               /* as of struct placement */
    uint32_t root;                      /* which tree */
    uint32_t surface;                   /* replaces inherited surfaces; NO_LEAF: keeps them */
    uint8_t mask;
};

enum { PLAN_TALLIES = 16 };

struct plan {
    struct arena *mem;
    const struct scene *scene;
    struct leaf *leaf;
    size_t n_leaf;
    struct surface *surface;
    size_t n_surface;
    struct instance *instance;
    size_t n_instance;
    const struct light *light;
    size_t n_light;
    struct camera camera;
    const struct geometry *geometry;    /* trees, CSG roots, infinite leaves: geometry.h */
    const struct shader *shader;        /* lights prepared, what stages run: surface.h */
    bool has_transparency;              /* some caster lets light through */
    /* Where all that lets light through is even and never fades it, a shadow
     * depends on no more than how often it crosses each program: these. */
    const struct program *tally[PLAN_TALLIES];
    int n_tally;                        /* 0: there is more to it */
    bool has_reflection, has_refraction, has_shadows;
    char *note[64];                     /* what was left out and why, a line each (--explain) */
    size_t n_note;
};

/* The scene's objects become the plan's: its list of them is given up.
 * threads: for building the trees. */
struct plan *plan_new(struct scene *s, struct arena *mem, unsigned threads);
void plan_note(struct plan *p, const char *format, ...) __attribute__((format(printf, 2, 3)));
void plan_explain(const struct plan *p, FILE *out);     /* --explain */
void plan_dump(const struct plan *p, FILE *out);        /* --dump=plan */

#endif
