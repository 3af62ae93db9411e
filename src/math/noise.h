/* noise.h: POV-Ray's noise (facts patterns.md 1).
 *
 * A generator is 1 (original), 2 (range corrected, the default since 3.5) or
 * 3 (gradient noise); 0 counts as 2.  The vector noise is the same for all. */
#ifndef RTC_NOISE_H
#define RTC_NOISE_H

#include "math/vec.h"

enum { NOISE_DEFAULT = 2, NOISE_MOST_OCTAVES = 10 };

double noise_at(int generator, vec3 p);             /* 0..1 */
vec3 noise_vector(vec3 p);                          /* DNoise: about -1..1 each */

/* Octaves are limited to 1..10. */
double noise_turbulence(int generator, vec3 p, int octaves, double omega, double lambda);
vec3 noise_vector_turbulence(vec3 p, int octaves, double omega, double lambda);

/* A random number for each cell of space, and the table behind it. */
enum { NOISE_HASHES = 4096, NOISE_RANDOMS = 32768 };
int noise_hash(vec3 cell);                          /* whole coordinates: 0..4095 */
enum { NOISE_MOST_SIDE = 5 };
void noise_hash_cube(vec3 corner, int side, int out[]);  /* of side^3 cells from a corner on, z first */
double noise_random(int i);                         /* 0 <= i < NOISE_RANDOMS: 0 <= result < 1 */

#endif
