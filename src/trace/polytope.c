/* polytope.c: what half-spaces have in common: its corners, found as points
 * where three of the planes meet and which no half-space leaves out. */
#include "trace/polytope.h"

#include "math/kernel.h"

struct polytope {
    int n;
    struct half_space face[POLYTOPE_FACES];
    struct bounds corners;
    bool is_uncertain;                  /* planes meet at so small an angle that a corner may be anywhere */
};

static const double parallel = 1e-14, certain = 1e-7;   /* volumes that unit normals span */
static const double loose = 1e-9;       /* of lengths; of directions */

static void add(struct polytope *p, vec3 normal, double distance)
{
    if (fabs(distance) < INFINITY && p->n < POLYTOPE_FACES)
        p->face[p->n++] = (struct half_space) { normal, distance };
}

static void add_box(struct polytope *p, const struct bounds *b)
{
    add(p, vec(1, 0, 0), b->high.x);
    add(p, vec(0, 1, 0), b->high.y);
    add(p, vec(0, 0, 1), b->high.z);
    add(p, vec(-1, 0, 0), -b->low.x);
    add(p, vec(0, -1, 0), -b->low.y);
    add(p, vec(0, 0, -1), -b->low.z);
}

/* Whether all half-spaces go on without end that way. */
static bool goes_on(const struct polytope *p, vec3 way)
{
    for (int i = 0; i < p->n; i++)
        if (vec_dot(p->face[i].normal, way) > loose)
            return false;
    return true;
}

/* If there is no end, then along the line where two planes meet, too. */
static bool is_endless(const struct polytope *p)
{
    for (int i = 0; i < p->n; i++)
        for (int k = 0; k < i; k++) {
            vec3 way = vec_unit(vec_cross(p->face[i].normal, p->face[k].normal));
            if (vec_largest(way) > 0 && (goes_on(p, way) || goes_on(p, vec_neg(way))))
                return true;
        }
    return false;
}

static bool holds(const struct polytope *p, vec3 at)
{
    double size = vec_largest(at);

    for (int i = 0; i < p->n; i++)
        if (vec_dot(p->face[i].normal, at) - p->face[i].distance
            > loose * (size + fabs(p->face[i].distance)))
            return false;
    return true;
}

/* Cramer's rule. */
static void meet(struct polytope *p, const struct half_space *a, const struct half_space *b,
                 const struct half_space *c)
{
    vec3 bc = vec_cross(b->normal, c->normal), ca = vec_cross(c->normal, a->normal);
    vec3 ab = vec_cross(a->normal, b->normal);
    double volume = vec_dot(a->normal, bc);

    if (fabs(volume) < parallel)
        return;
    p->is_uncertain |= fabs(volume) < certain;
    vec3 at = vec_scale(vec_add(vec_add(vec_scale(bc, a->distance), vec_scale(ca, b->distance)),
                                vec_scale(ab, c->distance)), 1 / volume);
    if (holds(p, at))
        p->corners = bounds_join(p->corners, (struct bounds) { at, at });
}

static void find_corners(struct polytope *p)
{
    for (int i = 0; i < p->n; i++)
        for (int j = 0; j < i; j++)
            for (int k = 0; k < j; k++)
                meet(p, &p->face[i], &p->face[j], &p->face[k]);
}

struct bounds polytope_bounds(int n, const struct half_space face[], struct bounds within)
{
    struct polytope p = { .corners = BOUNDS_EMPTY };

    add_box(&p, &within);
    for (int i = 0; i < n; i++)         /* those that are too many would only leave less */
        add(&p, face[i].normal, face[i].distance);
    if (is_endless(&p))
        return within;
    find_corners(&p);
    if (p.is_uncertain || !(p.corners.low.x <= p.corners.high.x))
        return within;
    double pad = 8 * loose * larger(vec_largest(p.corners.low), vec_largest(p.corners.high));
    p.corners.low = vec_sub(p.corners.low, vec(pad, pad, pad));
    p.corners.high = vec_add(p.corners.high, vec(pad, pad, pad));
    return bounds_meet(within, p.corners);
}
