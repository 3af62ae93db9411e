/* scratch.h: what a thread keeps while it looks for what rays meet. */
#ifndef RTC_SCRATCH_H
#define RTC_SCRATCH_H

#include "trace/convex.h"
#include "trace/errand.h"
#include "trace/many.h"
#include "trace/stream.h"
#include "trace/world.h"

enum { MOST_CROSSINGS = SHAPE_MOST_HITS };   /* kept at a time; more are found by looking again */

/* What stood in a light's way last time, to be asked first. */
struct blocker {
    uint32_t item, instance;
    bool is_known;
};

/* How many rays make a beam, and how many go by themselves first because
 * beams did not pay. */
struct pace { int size, rest, wait; };

enum { MOST_LISTS = 16 };

/* Crossings of light that were found ahead: those of each ray in order. */
enum { MOST_KEPT = 512, KEPT_END, KEPT_TOO_MANY };
struct kept { struct meeting m; uint32_t next; };

/* A barrier that is a list of them: its first's number below. */
#define BARRIER_KEPT ((uint64_t)1 << 61)

/* How often each of some rays crosses each of the plan's tallies. */
enum { MOST_TALLIED = BATCH };

/* A barrier that is such a row: its number below. */
#define BARRIER_TALLIED ((uint64_t)1 << 60)

/* A packet of rays on its way through the choice. */
struct volley {
    struct packet rays;
    struct found found;
    struct leaf_view view;
    double far[PACKET];
    uint32_t on_the_way;                /* of the choice */
};

struct scratch {
    const struct plan *plan;
    struct csg_scratch csg;
    struct convex_work *convex;
    struct geometry_counts counts;
    struct blocker *blocker;            /* a light */
    size_t n_blocker;
    struct pace nearest, *blocked;      /* blocked: a light */
    struct few beam;                    /* the last beam's */
    struct stream *stream, *inner;      /* inner: of one mesh, while the other goes on */
    struct post *post;
    uint32_t list[MOST_LISTS][FEW];     /* what beams of shadow rays found, for their crossings */
    int n_list;
    struct kept kept[MOST_KEPT];
    uint32_t n_kept;
    unsigned tallied[MOST_TALLIED][PLAN_TALLIES];
    uint32_t n_tallied;
    struct volley *volley, volleys[2];  /* the first, or, within a copy, the second */
    struct meeting crossing[MOST_CROSSINGS];
};

/* Rows for n rays, all 0: the first one's number, or NO_TALLY: there is no room. */
#define NO_TALLY UINT32_MAX
uint32_t scratch_tally(struct scratch *s, int n);

/* The barriers of the rays of these rows, unless they are blocked. */
void scratch_tallied(const struct scratch *s, uint32_t first, int n, uint64_t *barrier);

/* What stood in the light's way last time; none: for a light that has no place
 * of its own. */
INLINE struct blocker *last_blocker(struct scratch *s, uint32_t light, struct blocker *none)
{
    *none = (struct blocker) { .is_known = false };
    return light < s->n_blocker ? &s->blocker[light] : none;
}

#endif
