/* csg.h: solids combined: intersections, differences, merges, clipped and
 * inverted things.
 *
 * All parts of a root are cut by the ray's whole line at once, the crossings
 * are sorted, and one sweep along the line counts at each node how many of
 * its children contain the point.  A crossing is seen when the nodes above
 * it let it through.  Faces that coincide are passed together, so that what
 * stands on both sides of them decides, and not the rounding. */
#ifndef RTC_CSG_H
#define RTC_CSG_H

#include "tree/bvh.h"
#include "trace/plan.h"

/* Inversion has been carried down to the parts (De Morgan), a difference is
 * an intersection. */
enum csg_kind { CSG_UNION, CSG_MERGE, CSG_INTERSECTION };

struct csg_node {
    uint32_t parent;                    /* NO_LEAF: the root, which is node 0 */
    uint32_t n_child;
    enum csg_kind kind;
};

struct csg_part {
    uint32_t leaf;                      /* of plan->leaf */
    uint32_t parent;
    bool is_silent;                     /* clips: its own surface is not seen */
    bool alternates;                    /* its crossings go in and out */
    bool is_asked;                      /* whether a point is inside is asked point by point */
    bool is_infinite;                   /* the line may begin inside */
};

struct csg {
    const struct leaf *leaf;            /* plan->leaf */
    struct bounds bounds;               /* of what can be seen */
    struct csg_node *node;
    size_t n_node;
    struct csg_part *part;              /* in the order of their listing */
    size_t n_part;
    uint32_t *at_rest;                  /* children of each node that contain a point far off, */
                                        /* infinite and asked ones not counted */
    uint32_t *infinite, *asked;         /* parts */
    size_t n_infinite, n_asked;
    struct part_boxes *boxes;           /* of the finite parts, if they are few; else NULL, and */
    struct bvh tree;                    /* over them */
    uint32_t required;                  /* bits of boxes: nothing is seen on lines that miss one */
    const struct convex *convex;        /* NULL: more than convex solids cut with one another */
    size_t most_events;
    uint32_t surface_leaf;              /* whose surface stands for the whole */
    uint8_t mask;
};

struct csg_event {
    struct hit hit;
    uint32_t part;
    bool enters;                        /* the part, inverse taken into account */
};

/* Crossings are sorted by these; of equal t, as they were found, since one
 * part's come sorted. */
struct csg_key { double t; uint32_t event; };

struct csg_scratch {
    struct csg_event *event;
    struct csg_key *key;
    size_t n_event, room;
    uint32_t *count, *before;           /* children inside, a node: now, and before the group */
    bool *asked_inside;
    struct hit *hits;                   /* of a mesh */
    int hits_room;
    unsigned long long *box_tests;
};

/* Crossings that lie further apart than this share of their distance from
 * the origin never coincide: far above any rounding. */
#define CSG_WORTH_A_LOOK 0x1p-20

/* Nothing is seen but where the part and all else contain the point. */
bool csg_is_cut_only(const struct csg *c, const struct csg_part *part);

/* Completes a csg whose nodes and parts are there; n_child and at_rest too. */
void csg_finish(struct csg *c, struct arena *mem);
void csg_count(const struct csg_node node[], uint32_t count[], uint32_t at, int by);

void csg_scratch_init(struct csg_scratch *s, const struct csg c[], size_t n, struct arena *mem);

/* Calls visit for what can be seen with 0 < t < far, nearest first, until it
 * returns true; returns what it returned last. */
bool csg_sweep(const struct csg *c, struct csg_scratch *s, struct ray ray, double far,
               bool (*visit)(void *arg, const struct csg_event *e), void *arg);

bool csg_inside(const struct csg *c, struct csg_scratch *s, vec3 p);

#endif
