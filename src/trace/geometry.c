/* geometry.c: arrays of rays against everything, and points within. */
#include "trace/geometry.h"

#include <string.h>

#include "trace/beam.h"
#include "trace/flock.h"
#include "trace/volley.h"

struct scratch *scratch_new(const struct plan *p, struct arena *mem)
{
    struct scratch *s = arena_alloc_aligned(mem, sizeof *s, _Alignof(struct scratch));

    s->plan = p;
    csg_scratch_init(&s->csg, p->geometry->csg, p->geometry->n_csg, mem);
    s->convex = arena_alloc_aligned(mem, p->geometry->n_csg ? sizeof *s->convex : 1, 64);
    s->csg.box_tests = &s->counts.box_tests;
    s->n_blocker = p->n_light;
    s->blocker = arena_array(mem, p->n_light + 1, sizeof *s->blocker);
    s->blocked = arena_array(mem, p->n_light + 1, sizeof *s->blocked);
    s->stream = arena_alloc(mem, sizeof *s->stream);
    s->inner = arena_alloc(mem, sizeof *s->inner);
    s->volley = s->volleys;
    s->post = arena_alloc(mem, p->n_instance ? sizeof *s->post : 1);
    return s;
}

struct geometry_counts scratch_counts(const struct scratch *s) { return s->counts; }

/* ---- beams ---- */

/* In small scenes all boxes are tried.  In others, rays that lie together go
 * down the tree as a beam, and what it finds is tried so: one thing after the
 * other, against all of the rays. */

/* Of its surface, where that has bounds on some axis. */
static struct bounds unbounded_box(const struct plan *p, uint32_t item)
{
    return item_kind(item) == ITEM_LEAF ? leaf_crust(&p->leaf[item_number(item)]) : BOUNDS_ALL;
}

/* What may be met, in c; false: too much.  n: how much it is. */
static bool beam(const struct space *space, struct scratch *s, const struct rays *r,
                 const double *far, struct choice *c)
{
    uint32_t place[FEW];
    int n = space->n_unbounded > FEW ? BEAM_TOO_MUCH
            : beam_walk(&space->tree, r, far, place, FEW - (int)space->n_unbounded,
                        &s->counts.box_tests);

    if (n < 0)
        return false;
    s->beam.n = 0;
    *c = (struct choice) { .few = &s->beam };
    for (int i = 0; i < n; i++) {
        const struct candidate *one = &space->candidate[place[i]];
        c->opaque |= (uint64_t)one->is_opaque << i;
        c->clear |= (uint64_t)one->is_clear << i;
        few_add(&s->beam, space->tree.item[place[i]], &one->bounds);
    }
    for (size_t i = 0; i < space->n_unbounded; i++) {
        struct bounds box = unbounded_box(s->plan, space->unbounded[i]);
        c->opaque |= (uint64_t)1 << s->beam.n;
        c->clear |= (uint64_t)1 << s->beam.n;
        few_add(&s->beam, space->unbounded[i], &box);
    }
    return true;
}

/* Rays of the next group, which is a beam or not. */
static int next_group(struct pace *p, int left, bool *is_beam)
{
    enum { FIRST = 64 };
    int most = p->size ? p->size : FIRST;

    if (p->rest > 0 || left < BEAM_LEAST) {
        int n = p->rest > 0 && p->rest < left ? p->rest : left;
        p->rest -= n < p->rest ? n : p->rest;
        *is_beam = false;
        return n;
    }
    *is_beam = true;
    return left < most + BEAM_LEAST && left <= PACKET ? left : most;
}

/* After a beam of n rays: larger or smaller ones, or none for a while. */
static void beam_went_well(struct pace *p, int n, int found)
{
    enum { ROOM_FOR_MORE = 10 };
    int more = 2 * n < PACKET ? 2 * n : PACKET;

    p->wait = 0;
    p->size = found <= ROOM_FOR_MORE ? more : n < BEAM_LEAST ? BEAM_LEAST : n;
}

static void beam_went_badly(struct pace *p, int n)
{
    enum { SMALLEST = 16, FIRST_WAIT = 128, LONGEST_WAIT = 8192 };

    p->size = n / 2;
    if (p->size >= SMALLEST)
        return;
    p->size = SMALLEST;
    p->wait = p->wait == 0 ? FIRST_WAIT : p->wait < LONGEST_WAIT ? 2 * p->wait : p->wait;
    p->rest = p->wait;
}

/* ---- the nearest ---- */

static void nearest_of_few(const struct plan *p, struct scratch *s, const struct rays *rays,
                           const uint8_t *mask, struct meeting *out)
{
    const struct choice all = { .few = p->geometry->space[0].few };

    s->counts.rays += (unsigned)rays->n;
    for (int at = 0; at < rays->n; at += PACKET) {
        struct rays some = rays_from(rays, at, PACKET);
        nearest_of_choice(p, s, &all, &some, NULL, mask + at, out + at);
    }
}

static void nearest_of_beams(const struct plan *p, struct scratch *s, const struct rays *rays,
                             const uint8_t *mask, struct meeting *out)
{
    struct choice c;
    bool is_beam;

    for (int at = 0, n; at < rays->n; at += n) {
        struct rays some = rays_from(rays, at, next_group(&s->nearest, rays->n - at, &is_beam));
        n = some.n;
        if (!is_beam) {
            nearest_of_streams(p, s, &some, mask + at, out + at);
        } else if (beam(&p->geometry->space[0], s, &some, NULL, &c)) {
            beam_went_well(&s->nearest, n, c.few->n);
            s->counts.rays += (unsigned)n;
            nearest_of_choice(p, s, &c, &some, NULL, mask + at, out + at);
        } else {
            beam_went_badly(&s->nearest, n);
            n = 0;
        }
    }
}

void geometry_nearest_many(const struct plan *p, struct scratch *s, const struct rays *rays,
                           const uint8_t *mask, struct meeting *out)
{
    const struct space *world = &p->geometry->space[0];

    (world->few ? nearest_of_few : world->candidate ? nearest_of_beams : nearest_of_streams)
        (p, s, rays, mask, out);
}

/* ---- what blocks light ---- */

static void blocked_by_few(const struct plan *p, struct scratch *s, const struct rays *rays,
                           const double *far, uint64_t *barrier)
{
    const struct space *world = &p->geometry->space[0];
    const struct choice all = { world->few, world->opaque, world->clear, 0 };

    s->counts.shadow_rays += (unsigned)rays->n;
    for (int at = 0; at < rays->n; at += PACKET) {
        struct rays some = rays_from(rays, at, PACKET);
        blocked_by_choice(p, s, &all, &some, far + at, barrier + at);
    }
}

/* Keeps what the beam may cross, and says where in the upper half. */
static uint64_t keep_list(struct scratch *s, const struct few *few)
{
    if (s->n_list == MOST_LISTS)
        return BARRIER_CLEAR;
    memcpy(s->list[s->n_list], few->item, (size_t)few->n * sizeof few->item[0]);
    return (uint64_t)++s->n_list << FEW;
}

static void blocked_by_beams(const struct plan *p, struct scratch *s, const struct rays *rays,
                             const double *far, uint32_t light, struct blocker *last,
                             uint64_t *barrier)
{
    struct pace *pace = &s->blocked[light < s->n_blocker ? light : s->n_blocker];
    struct choice c;
    bool is_beam;

    s->n_list = 0;
    for (int at = 0, n; at < rays->n; at += n) {
        struct rays some = rays_from(rays, at, next_group(pace, rays->n - at, &is_beam));
        n = some.n;
        if (!is_beam) {
            blocked_by_streams(p, s, &some, far + at, last, barrier + at);
        } else if (beam(&p->geometry->space[0], s, &some, far + at, &c)) {
            beam_went_well(pace, n, c.few->n);
            s->counts.shadow_rays += (unsigned)n;
            c.list = p->has_transparency && c.clear ? keep_list(s, c.few) : 0;
            blocked_by_choice(p, s, &c, &some, far + at, barrier + at);
        } else {
            beam_went_badly(pace, n);
            n = 0;
        }
    }
}

void geometry_blocked_many(const struct plan *p, struct scratch *s, const struct rays *rays,
                           const double *far, uint32_t light, uint64_t *barrier)
{
    const struct space *world = &p->geometry->space[0];
    struct blocker none, *last = last_blocker(s, light, &none);

    s->n_kept = s->n_tallied = 0;
    if (world->few)
        blocked_by_few(p, s, rays, far, barrier);
    else if (world->candidate)
        blocked_by_beams(p, s, rays, far, light, last, barrier);
    else
        blocked_by_streams(p, s, rays, far, last, barrier);
}

/* ---- within ---- */

struct insides {
    const struct plan *plan;
    struct scratch *scratch;
    uint32_t *surface;
    size_t n, room;
};

/* own: the surface that items without one take from the copy, or NO_LEAF. */
static void look_inside(struct insides *in, const struct space *space, vec3 point, uint32_t own);

static void look_inside_copy(struct insides *in, const struct instance *i, vec3 point)
{
    look_inside(in, &in->plan->geometry->space[i->root], mat_point(&i->place.from, point), i->surface);
}

static void look_inside_item(struct insides *in, uint32_t item, vec3 point, uint32_t own)
{
    const struct plan *p = in->plan;
    const struct csg *csg = item_kind(item) == ITEM_CSG ? &p->geometry->csg[item_number(item)] : NULL;
    const struct leaf *l = &p->leaf[csg ? csg->surface_leaf : item_number(item)];
    uint32_t surface = l->surface == NO_LEAF ? own : l->surface;

    if (surface != NO_LEAF && p->surface[surface].interior
        && (csg ? csg_inside(csg, &in->scratch->csg, point) : leaf_inside(l, point)))
        in->surface[in->n++] = surface;
}

static void look_inside(struct insides *in, const struct space *space, vec3 point, uint32_t own)
{
    for (size_t i = 0; i < space->n_filled && in->n < in->room; i++) {
        uint32_t item = space->filled[i];
        if (item_kind(item) == ITEM_INSTANCE)
            look_inside_copy(in, &in->plan->instance[item_number(item)], point);
        else
            look_inside_item(in, item, point, own);
    }
}

size_t geometry_inside(const struct plan *p, struct scratch *s, vec3 point, uint32_t surface[],
                       size_t room)
{
    struct insides in = { p, s, surface, 0, room };

    look_inside(&in, &p->geometry->space[0], point, NO_LEAF);
    return in.n;
}
