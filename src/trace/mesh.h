/* mesh.h: a mesh's own tree.  Placed often, it is stored once. */
#ifndef RTC_MESH_H
#define RTC_MESH_H

#include "scene/object.h"
#include "shape/packet.h"
#include "tree/bvh.h"
#include "trace/sieve.h"
#include "trace/stream.h"

struct mesh_tree {
    const struct mesh *mesh;
    struct bvh tree;                    /* its items are faces */
    struct sieve sieve;
    bool is_closed;                     /* every line crosses it an even number of times */
    struct bounds bounds;
};

INLINE const vec3 *mesh_corner(const struct mesh *m, uint32_t face, int i)
{
    return &m->vertex[m->face[face].of[i]];
}

/* NULL: no face is finite. */
const struct mesh_tree *mesh_tree_new(const struct mesh *m, unsigned threads, struct arena *mem);

/* The nearest crossing with near < t < far; part: the face; u, v: weights of
 * its second and third vertex.  Of equal t, the first face's. */
bool mesh_nearest(const struct mesh_tree *t, struct ray ray, double near, double far,
                  struct hit *out, unsigned long long *box_tests);

/* So few faces are sooner tried one after the other than by their tree.  Then
 * the nearest crossing with t > 0 of many rays, to the bit what mesh_nearest
 * says (packet.h): t[0] and what belongs to it. */
bool mesh_is_tiny(const struct mesh_tree *t);
void mesh_nearest_many(const struct mesh_tree *t, const struct packet *p, const uint8_t may[],
                       struct crossings *out);

/* Of larger meshes, the nearest crossing of each ray with 0 < t < far; far
 * below 0: the ray is not asked.  is_any: one of them, whichever. */
void mesh_nearest_stream(const struct mesh_tree *t, struct stream *s, const struct packet *p,
                         const double far[], bool is_any, struct crossings *out,
                         unsigned long long *box_tests);

/* All crossings of near < t < far, in increasing t; no more than room. */
int mesh_hits(const struct mesh_tree *t, struct ray ray, double near, double far,
              struct hit out[], int room, unsigned long long *box_tests);

bool mesh_has_inside(const struct mesh_tree *t);
bool mesh_inside(const struct mesh_tree *t, vec3 p);
vec3 mesh_normal(const struct mesh_tree *t, const struct hit *h);   /* any length */
bool mesh_is_flat(const struct mesh_tree *t, uint32_t face);    /* one normal for all of it */
vec2 mesh_uv(const struct mesh_tree *t, const struct hit *h, vec2 otherwise);

#endif
