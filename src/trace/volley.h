/* volley.h: packets of rays against a choice of things, one thing after the
 * other. */
#ifndef RTC_VOLLEY_H
#define RTC_VOLLEY_H

#include "trace/search.h"

/* What rays that lie together may meet: all of a small scene, or what a beam
 * found.  Bits of few: may block light, may filter it. */
struct choice { const struct few *few; uint64_t opaque, clear, list; };

/* far: how far each ray goes, filled up to a register as a packet is; NULL: any t. */
void nearest_of_choice(const struct plan *p, struct scratch *s, const struct choice *c,
                       const struct rays *r, const double *far, const uint8_t *mask,
                       struct meeting *out);
void blocked_by_choice(const struct plan *p, struct scratch *s, const struct choice *c,
                       const struct rays *r, const double *far, uint64_t *barrier);

/* ---- what both are made of; the rays are those of s->volley ---- */

/* far NULL: any t. */
void volley_start(struct scratch *s, const struct choice *c, const struct rays *r,
                  const double *far);

/* Leaves in asked the rays that may meet the box of item k. */
bool volley_meets(struct volley *v, const struct few *few, int k, const double *far,
                  struct lanes_asked *asked);

/* Asks a leaf about those of the asked rays that meet its box.  False: none. */
bool volley_leaf(struct scratch *s, const struct leaf *l, const struct few *few, int k,
                 const double *far, struct lanes_asked *asked);

/* The same for a mesh with a tree of its own.  is_any: no matter which of the
 * crossings before far. */
bool volley_mesh(struct scratch *s, const struct leaf *l, const struct few *few, int k,
                 const double *far, bool is_any, struct lanes_asked *asked);

/* Which of some of the choice's things each of the asked rays may meet. */
void volley_aim(struct scratch *s, const struct few *few, uint32_t things, const double *far,
                const struct lanes_asked *asked, uint64_t may[]);

/* The asked rays to a copy. */
void volley_errands(const struct volley *v, const struct instance *to, uint32_t number,
                    const struct lanes_asked *asked, struct errands *e);

/* ---- what an item is; NULL: not that ---- */

const struct leaf *hot_leaf(const struct plan *p, uint32_t item);   /* can be asked about many rays */
const struct leaf *mesh_leaf(const struct plan *p, uint32_t item);  /* a mesh, but no tiny one */
const struct csg *convex_of(const struct plan *p, uint32_t item);   /* CSG of convex solids */
const struct instance *copy_of(const struct plan *p, uint32_t item);

/* ---- what both look for the nearest with ---- */

/* The rays that may see a leaf: seldom not all. */
struct lanes_asked lanes_that_see(const struct packet *p, const uint8_t *mask, uint8_t by);

/* What search knows of ray i; its hits go to out[i]. */
void search_for(struct search *s, const struct rays *r, int i, const uint8_t *mask,
                struct meeting *out);

void found_meetings(const struct plan *p, const struct found *f, int n, struct meeting *out);

#endif
