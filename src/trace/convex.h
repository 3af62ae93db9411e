/* convex.h: CSG of convex solids that are only cut with one another, for
 * arrays of rays.
 *
 * Where all parts are convex and every node is an intersection (differences
 * are), a ray is inside of each part along one span.  What is seen first
 * follows from comparing the ends of the spans, without events or sorting.
 * Where ends lie so close together that they may coincide, and wherever else
 * something is special, the answer is left to csg_sweep, which knows how. */
#ifndef RTC_CONVEX_H
#define RTC_CONVEX_H

#include "trace/csg.h"
#include "trace/many.h"

enum { CONVEX_RAYS = 64, CONVEX_PARTS = 16 };

struct convex {
    uint32_t n_required, n_part;
    uint32_t part[CONVEX_PARTS];        /* of the root: those that the whole lies in, then the rest */
};

/* The first thing that a ray sees. */
enum { CONVEX_NOTHING = UINT32_MAX, CONVEX_UNKNOWN = UINT32_MAX - 1 };

typedef double convex_row[CONVEX_RAYS + 8];     /* 8: a register may be filled up */

struct convex_work {
    int n;
    int number[CONVEX_RAYS + 1];        /* of the rays, where they came from */
    convex_row ray[6], far;
    /* what is seen first, with 0 < t < far */
    convex_row t;
    uint32_t part[CONVEX_RAYS];         /* of the root, or CONVEX_NOTHING or CONVEX_UNKNOWN */
    /* under way */
    convex_row placed[6], begin, end, first, doubt;
    convex_row near[CONVEX_PARTS], away[CONVEX_PARTS];      /* the spans, by part */
};

/* NULL: this root is not one of them. */
struct convex *convex_new(const struct csg *c, struct arena *mem);

/* Takes the next of the asked rays, from *at on. */
bool convex_gather(struct convex_work *w, const struct packet *p, const struct lanes_asked *asked,
                   int *at);

/* Finds t and part; w->far is the caller's to fill. */
void convex_cast(const struct csg *c, struct convex_work *w);

#endif
