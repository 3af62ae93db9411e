/* object.h: shapes placed in the world, and their combinations. */
#ifndef RTC_OBJECT_H
#define RTC_OBJECT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/intern.h"
#include "base/source.h"
#include "math/mat.h"
#include "scene/texture.h"
#include "shape/shape.h"

enum object_kind {
    OBJECT_SHAPE,                       /* ops and shape */
    OBJECT_MESH,
    OBJECT_UNION,                       /* all surfaces of the children */
    OBJECT_MERGE,                       /* a union without inner surfaces */
    OBJECT_INTERSECTION,
    OBJECT_DIFFERENCE,                  /* the first child less the others */
    OBJECT_LIGHT,                       /* a light among a union's children */
};

enum object_flag {
    OBJECT_INVERSE            = 1 << 0,     /* inside and outside change places */
    OBJECT_NO_SHADOW          = 1 << 1,
    OBJECT_NO_IMAGE           = 1 << 2,
    OBJECT_NO_REFLECTION      = 1 << 3,
    OBJECT_HOLLOW             = 1 << 4,
    OBJECT_DOUBLE_ILLUMINATE  = 1 << 5,
    OBJECT_CUTAWAY_TEXTURES   = 1 << 6,
    OBJECT_NO_RADIOSITY       = 1 << 7,
    OBJECT_UV_MAPPING         = 1 << 8,
};

struct three { uint32_t of[3]; };

/* Triangles that share vertices.  Single precision, as the meshes of
 * POV-Ray, would lose far from the origin: rtc keeps doubles. */
struct mesh {
    const vec3 *vertex;
    size_t n_vertex;
    const vec3 *normal;                 /* of unit length; NULL: all flat */
    size_t n_normal;
    const vec2 *uv;                     /* NULL: none */
    size_t n_uv;
    /* Of each face's corners; NULL: no face has any. */
    struct three *face;                 /* of vertex */
    struct three *face_normal;          /* MESH_NONE: a flat face */
    struct three *face_uv;              /* MESH_NONE: this one has none */
    struct three *face_texture;         /* MESH_NONE: the object's; often three times the same */
    size_t n_face;
    const struct texture **texture;
    size_t n_texture;
    vec3 inside_vector;                 /* 0: the mesh has no inside */
    struct bounds box;                  /* of all faces */
};
#define MESH_NONE UINT32_MAX

/* What few nodes have; in the node's outer space but for box and reach. */
struct object_more {
    const struct texture *interior_texture;
    const struct interior *interior;    /* NULL: the parent's */
    const struct object **clip;         /* clipped_by */
    size_t n_clip;
    const struct object **bound;        /* bounded_by */
    size_t n_bound;
    const char *unsupported;            /* a shape that cannot be rendered yet: an empty union, named */
    struct bounds reach;                /* of such a shape, in inner space */
    struct bounds box;                  /* holds all children, in inner space; perhaps not tightly */
    bool has_box;
    unsigned depth;                     /* of the children in each other: 0 of a shape */
    double parts;                       /* shapes in it, each as often as it is there; 0 of a shape */
};

/* A node of what the user wrote; there may be millions.  Everything in it is in
 * the node's outer space (its parent's) except the shape and the children, which
 * are in its inner one: transforms given after a texture move the texture too, by
 * composing with its place; those before do not. */
struct object {
    uint8_t kind;                       /* enum object_kind */
    bool own_place, own_more;           /* place, more belong to this node alone */
    bool keep_whole;                    /* split_union off */
    uint16_t flags;                     /* enum object_flag */
    uint16_t flags_given;               /* said by this node itself; the others come from the parent */
    struct loc at;                      /* for messages and dumps */
    uint32_t n_child;                   /* 0: of what has no children, too */
    const struct shape_ops *ops;
    union {
        const void *shape;              /* OBJECT_SHAPE */
        const struct mesh *mesh;        /* OBJECT_MESH */
        const struct light *light;      /* OBJECT_LIGHT */
        const struct object **child;    /* of the others */
    };
    const struct transform *place;      /* outer from inner; never NULL */
    const struct texture *texture;      /* bottom layer; NULL: the parent's */
    const struct object_more *more;     /* never NULL */
    const char *name;                   /* it was declared under, or NULL */
};

extern const struct object_more object_no_more;

struct object *object_new(struct arena *mem, enum object_kind kind);
void object_renew(struct object *o, enum object_kind kind);     /* what it was is forgotten */

/* Two shapes of which everything else is the same, and shared. */
bool object_is_like(const struct object *a, const struct object *b);

/* What few nodes have, to be written to. */
struct object_more *object_more(struct arena *mem, struct object *o);

/* A node that may be changed freely, sharing all that it points to. */
struct object *object_copy(struct arena *mem, const struct object *o);

/* Moves a node, its textures, clips and bounds by t (outer from outer). */
void object_move(struct arena *mem, struct object *o, const struct transform *t);
const struct texture *texture_move(struct arena *mem, const struct texture *layers,
                                   const struct transform *t);

/* In the node's outer space. */
struct bounds object_bounds(const struct object *o);
struct bounds object_extent(const struct object *o);    /* POV-Ray's, which is looser: extent.c */
struct bounds object_inner_bounds(const struct object *o);      /* of its shape or children, in inner space */
struct bounds bounds_move(const struct bounds *b, const struct transform *t);
bool object_has_inside(const struct object *o);           /* all of it has an inside */

/* --- one question about one object: the language's inside() and trace() ------------- */

/* Trees over the parts of what was asked about, made when first needed (parts.h).
 * Where there is NULL instead, each part is looked at. */
struct object_trees {
    struct arena *mem;
    struct intern known;                /* by the address of children or faces, which copies share */
};

bool object_inside(const struct object *o, vec3 p, struct object_trees *t);     /* p in outer space */

/* Of the children, p in inner space: in any from a number on, or in all, one left out. */
#define NO_CHILD SIZE_MAX
bool object_inside_any(const struct object *o, vec3 p, size_t from, size_t skip, struct object_trees *t);
bool object_inside_all(const struct object *o, vec3 p, size_t skip, struct object_trees *t);

/* The nearest surface along a ray in outer space, CSG and clips respected;
 * the normal is outward and of unit length. */
bool object_trace(const struct object *o, vec3 origin, vec3 dir, struct object_trees *t, vec3 *point,
                  vec3 *normal);

#endif
