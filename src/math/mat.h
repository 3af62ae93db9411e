/* mat.h: affine transforms.  A matrix's name says both spaces: p_world =
 * mat_point(&world_from_object, p_object). */
#ifndef RTC_MAT_H
#define RTC_MAT_H

#include <stdbool.h>
#include <stdint.h>

#include "math/vec.h"

/* Rows: x' = m[0][0] x + m[0][1] y + m[0][2] z + m[0][3], and so on. */
typedef struct { double m[3][4]; } mat34;

enum transform_form { TRANSFORM_ANY, TRANSFORM_MOVE, TRANSFORM_STRETCH };

/* A transform and its inverse, composed together so that neither is ever
 * worked out from the other by elimination. */
struct transform {
    mat34 to;                           /* outer from inner: parent from object */
    mat34 from;                         /* inner from outer */
    bool is_identity;                   /* then nothing needs to be done */
    uint8_t form;                       /* enum transform_form: of which elements it has no others */
};

extern const mat34 mat_identity;
extern const struct transform transform_identity;

mat34 mat_compose(const mat34 *a, const mat34 *b);      /* a after b */
bool mat_invert(const mat34 *a, mat34 *inverse);        /* false: singular */
double mat_norm(const mat34 *a);                        /* largest stretch, an upper bound */

struct transform transform_compose(const struct transform *a, const struct transform *b);  /* a after b */
struct transform transform_inverse(const struct transform *a);

/* The language's transforms.  Degrees about x, then y, then z; the matrices
 * of facts shading.md section 0.  Scales must not be 0. */
struct transform transform_translate(vec3 by);
struct transform transform_rotate(vec3 degrees);
struct transform transform_axis_rotate(vec3 axis, double degrees);
struct transform transform_scale(vec3 by);
/* POV-Ray's order: v[0..2] is the image of x, and so on; v[9..11] is added.
 * False if it is singular. */
bool transform_matrix(const double v[12], struct transform *t);

static inline vec3 mat_point(const mat34 *a, vec3 p)
{
    return vec(a->m[0][0] * p.x + a->m[0][1] * p.y + a->m[0][2] * p.z + a->m[0][3],
               a->m[1][0] * p.x + a->m[1][1] * p.y + a->m[1][2] * p.z + a->m[1][3],
               a->m[2][0] * p.x + a->m[2][1] * p.y + a->m[2][2] * p.z + a->m[2][3]);
}

static inline vec3 mat_direction(const mat34 *a, vec3 d)
{
    return vec(a->m[0][0] * d.x + a->m[0][1] * d.y + a->m[0][2] * d.z,
               a->m[1][0] * d.x + a->m[1][1] * d.y + a->m[1][2] * d.z,
               a->m[2][0] * d.x + a->m[2][1] * d.y + a->m[2][2] * d.z);
}

/* A normal goes by the transpose of the other direction's matrix: the outer
 * normal of an inner n is mat_normal(&t->from, n); not of unit length. */
static inline vec3 mat_normal(const mat34 *inverse, vec3 n)
{
    return vec(inverse->m[0][0] * n.x + inverse->m[1][0] * n.y + inverse->m[2][0] * n.z,
               inverse->m[0][1] * n.x + inverse->m[1][1] * n.y + inverse->m[2][1] * n.z,
               inverse->m[0][2] * n.x + inverse->m[1][2] * n.y + inverse->m[2][2] * n.z);
}

#endif
