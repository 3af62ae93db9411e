/* oracle.h: the primitives once more, in 113 bits and without haste. */
#ifndef RTC_ORACLE_H
#define RTC_ORACLE_H

#include "shape/shape.h"

typedef __float128 quad;
typedef struct { quad x, y, z; } quad3;

quad quad_sqrt(quad a);
static inline quad quad_abs(quad a) { return a < 0 ? -a : a; }
static inline quad3 quad_of(vec3 a) { return (quad3) { a.x, a.y, a.z }; }
static inline quad quad_dot(quad3 a, quad3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
static inline quad3 quad_sub(quad3 a, quad3 b)
{
    return (quad3) { a.x - b.x, a.y - b.y, a.z - b.z };
}
static inline quad3 quad_along(quad3 o, quad t, quad3 d)
{
    return (quad3) { o.x + t * d.x, o.y + t * d.y, o.z + t * d.z };
}

/* Sign changes of a polynomial over all reals. */
int oracle_roots(int degree, const quad c[], quad root[]);

/* Where the whole line crosses: t in increasing order; returns how many. */
int oracle_sphere(vec3 centre, double r, struct ray ray, quad t[2]);
int oracle_torus(double major, double minor, struct ray ray, quad t[4]);
/* Along y, from 0 to height. */
int oracle_cone(double base_radius, double cap_radius, double height, struct ray ray, quad t[2]);

/* Distance of a point from the surface. */
double oracle_sphere_distance(vec3 centre, double r, vec3 p);
double oracle_torus_distance(double major, double minor, vec3 p);
double oracle_box_distance(vec3 low, vec3 high, vec3 p);
double oracle_cone_distance(vec3 base, double base_radius, vec3 cap, double cap_radius,
                            bool is_open, vec3 p);
double oracle_plane_distance(vec3 normal, double distance, vec3 p);
double oracle_disc_distance(vec3 centre, vec3 normal, double r, double hole, vec3 p);
double oracle_triangle_distance(vec3 a, vec3 b, vec3 c, vec3 p);

#endif
