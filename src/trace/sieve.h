/* sieve.h: which triangles of a leaf a ray may meet, eight at a time.
 *
 * The edge functions of triangle.h in floats, with a bound of their error:
 * what fails here surely fails there, and the few that are left are asked
 * exactly.  Corners stand in the order of the leaves, in tree units. */
#ifndef RTC_SIEVE_H
#define RTC_SIEVE_H

#include "tree/bvh.h"

struct sieve {
    /* Of the leaf that begins at item i and has n: from 9 i on, n times the
     * first corners' x, then y and z, then the second's and the third's. */
    float *corner;
};

struct sieve_ray {
    lanes origin[3];                    /* along the ray's lesser axes and its largest */
    lanes shear[2];
    lanes apart;                        /* how far off a corner may be, sideways and along */
    lanes sign;
    int axis[3];
};

/* corner says where the i-th corner of an item is, in the world. */
void sieve_init(struct sieve *s, const struct bvh *b,
                const vec3 *(*corner)(const void *of, uint32_t item, int i), const void *of,
                struct arena *mem);

/* The same, a word each: for rays that are kept. */
struct sieve_line {
    float origin[3], shear[2], sign;
    int axis[3];
};

INLINE void sieve_line(struct sieve_line *l, const float at[3], const float dir[3])
{
    float ax = fabsf(dir[0]), ay = fabsf(dir[1]), az = fabsf(dir[2]);
    int z = ax >= ay && ax >= az ? 0 : ay >= az ? 1 : 2;

    l->axis[2] = z;
    l->axis[0] = z == 2 ? 0 : z + 1;
    l->axis[1] = l->axis[0] == 2 ? 0 : l->axis[0] + 1;
    for (int i = 0; i < 3; i++)
        l->origin[i] = at[l->axis[i]];
    l->shear[0] = dir[l->axis[0]] / dir[z];
    l->shear[1] = dir[l->axis[1]] / dir[z];
    l->sign = dir[z] > 0 ? 1 : -1;
}

INLINE void sieve_spread(struct sieve_ray *s, const struct sieve_line *l, float apart)
{
    for (int i = 0; i < 3; i++) {
        s->axis[i] = l->axis[i];
        s->origin[i] = lanes_of(l->origin[i]);
    }
    s->shear[0] = lanes_of(l->shear[0]);
    s->shear[1] = lanes_of(l->shear[1]);
    s->sign = lanes_of(l->sign);
    s->apart = lanes_of(apart);
}

INLINE void sieve_aim(struct sieve_ray *s, const struct bvh_ray *r)
{
    struct sieve_line l;

    sieve_line(&l, r->at, r->dir);
    sieve_spread(s, &l, r->apart);
}

struct sieve_corner { lanes x, y, z; };

/* Where a corner lies when the ray runs along z from the origin. */
INLINE struct sieve_corner sieve_corner(const struct sieve_ray *s, const float *at, uint32_t n)
{
    lanes x = lanes_sub(lanes_load(at + (uint32_t)s->axis[0] * n), s->origin[0]);
    lanes y = lanes_sub(lanes_load(at + (uint32_t)s->axis[1] * n), s->origin[1]);
    lanes z = lanes_sub(lanes_load(at + (uint32_t)s->axis[2] * n), s->origin[2]);

    return (struct sieve_corner) { lanes_sub(x, lanes_mul(s->shear[0], z)),
                                   lanes_sub(y, lanes_mul(s->shear[1], z)),
                                   lanes_mul(z, s->sign) };
}

INLINE lanes sieve_edge(const struct sieve_corner *p, const struct sieve_corner *q)
{
    return lanes_sub(lanes_mul(p->x, q->y), lanes_mul(p->y, q->x));
}

INLINE lanes sieve_least(lanes a, lanes b, lanes c) { return lanes_min(a, lanes_min(b, c)); }
INLINE lanes sieve_most(lanes a, lanes b, lanes c) { return lanes_max(a, lanes_max(b, c)); }

/* With sheared coordinates of at most m, each off by e at most, an edge
 * function is off by 4 e m + 2 e e; its own rounding, 2^-22 m m, is less than
 * 2 e m, as m is 4 at most and e at least 2^-19. */
INLINE lanes sieve_error(const struct sieve_ray *s, const struct sieve_corner *p,
                         const struct sieve_corner *q, const struct sieve_corner *t)
{
    lanes most = lanes_max(sieve_most(p->x, q->x, t->x), sieve_most(p->y, q->y, t->y));
    lanes least = lanes_min(sieve_least(p->x, q->x, t->x), sieve_least(p->y, q->y, t->y));
    lanes m = lanes_max(most, lanes_sub(lanes_of(0), least));

    return lanes_mul(lanes_mul(lanes_of(8), s->apart), lanes_add(m, s->apart));
}

/* Of the n items from first on, those that the ray may meet between 0 and
 * far. */
INLINE unsigned sieve_test(const struct sieve *all, const struct sieve_ray *s, uint32_t first,
                           uint32_t n, float far)
{
    const float *at = all->corner + 9 * (size_t)first;
    struct sieve_corner p = sieve_corner(s, at, n), q = sieve_corner(s, at + 3 * n, n),
                        t = sieve_corner(s, at + 6 * n, n);
    lanes u = sieve_edge(&t, &p), v = sieve_edge(&p, &q), w = sieve_edge(&q, &t);
    lanes error = sieve_error(s, &p, &q, &t);
    unsigned inside = lanes_not_above(lanes_sub(lanes_of(0), error), sieve_least(u, v, w))
                      | lanes_not_above(sieve_most(u, v, w), error);

    return inside & lanes_not_above(lanes_sub(sieve_least(p.z, q.z, t.z), s->apart), lanes_of(far))
           & lanes_not_above(lanes_sub(lanes_of(0), s->apart), sieve_most(p.z, q.z, t.z));
}

#endif
