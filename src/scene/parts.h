/* parts.h: which parts of an object a ray or a point may meet.
 *
 * trace() and inside() ask one object, so there is no plan for them; but an
 * object of many children or faces gets a tree when it is asked first. */
#ifndef RTC_PARTS_H
#define RTC_PARTS_H

#include "scene/object.h"
#include "tree/bvh.h"

/* Of one object, in its inner space.  Every part with a surface is in the tree
 * or is loose; those whose inside reaches beyond their surfaces' box (inverse
 * things, discs, open meshes) are told again, for questions about insides. */
struct parts {
    struct bvh tree;                    /* its item i is part[i] */
    uint32_t *part;
    uint32_t *loose;                    /* what has no finite box */
    size_t n_loose;
    uint32_t *beyond;
    size_t n_beyond;
};

/* NULL: the object has few parts, and all are to be asked. */
const struct parts *object_parts(struct object_trees *t, const struct object *o);

/* Holds its surface, in its inner space; perhaps not tightly. */
struct bounds object_inner_box(const struct object *o);

/* Where a line crosses a face: t of either sign, the weights of its second and
 * third corner, and its normal. */
struct crossing { double t, u, v; vec3 flat; };
bool face_crosses(const struct mesh *m, size_t face, struct ray r, struct crossing *out);

#endif
