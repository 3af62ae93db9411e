/* torus_first.c: where lines enter a torus first, a register of lines at a time.
 *
 * Along a line the torus is a quartic x^4 + c2 x^2 + c1 x + c0 (x counts from
 * the point nearest to the centre), which is convex, then concave between
 * -turn and turn, then convex again, where turn^2 = -c2 / 6.  On a convex
 * piece Newton's steps from outside come to the first root without passing
 * it, or step beyond the lowest point, which says that there is none; the
 * concave piece has an entry where its ends differ in sign.  What lies within
 * SURE of a tangent is left to torus_cross.c, and so is a ray that starts
 * inside.  The last steps are made on the distance from the tube, as there. */
#include "shape/torus.h"

#define SURE 0x1p-40                    /* of the quartic, whose rounding is below 2^-44 */
#define STEEP 0x1p-16                   /* its slope at a root that is no tangent */

struct lines {
    const struct torus *s;
    struct wide3 p, e;
    wide low, high, turn;
    wide c0, c1, c2, c3;
    wide mid, length;
};

struct entry { wide at; wide_mask is_there, unsure; };

static const struct entry no_entry;

INLINE wide quartic_at(const struct lines *c, wide x)
{
    return (((x + c->c3) * x + c->c2) * x + c->c1) * x + c->c0;
}

INLINE wide slope_at(const struct lines *c, wide x)
{
    return ((4 * x + 3 * c->c3) * x + 2 * c->c2) * x + c->c1;
}

/* ---- the last steps ---- */

struct distance { wide f, slope; };

/* As of torus_cross.c, without an inner sheet. */
INLINE struct distance distance_at(const struct lines *c, wide at)
{
    struct wide3 q = wide3_fma(c->p, at, c->e);
    wide rho = wide_sqrt(q.x * q.x + q.z * q.z), across = rho - c->s->ring;
    wide rho_slope = (q.x * c->e.x + q.z * c->e.z) / rho;

    return (struct distance) {
        wide_fma(across, across, (q.y - c->s->tube) * (q.y + c->s->tube)),
        2 * wide_fma(across, rho_slope, q.y * c->e.y) };
}

/* The root that at is near to; lanes that do not come there are unsure. */
static struct entry polished(const struct lines *c, struct entry from)
{
    wide_mask run = from.is_there;
    struct entry out = from;

    for (int i = 0; i < 8 && wide_bits(run); i++) {
        struct distance y = distance_at(c, out.at);
        wide next = out.at - y.f / y.slope, step = next - out.at;
        out.at = wide_pick(run, next, out.at);
        run &= wide_not(wide_at_most(step * step, 0x1p-58 * wide_abs(y.slope)));
    }
    wide_mask is_far = wide_not(wide_below(wide_abs(out.at - from.at), wide_of(STEEP)));
    out.unsure |= run | (from.is_there & is_far);
    out.is_there &= wide_not(out.unsure);
    return out;
}

/* ---- the pieces ---- */

/* Between a, where the quartic falls, and b, where it rises, on a convex piece:
 * lanes where it stays above 0 without doubt are taken out. */
static wide_mask may_touch(const struct lines *c, wide a, wide b, wide_mask run)
{
    wide_mask unsure = wide_mask_of(0);

    for (int i = 0; i < 8 && wide_bits(run); i++) {
        wide ya = quartic_at(c, a), sa = slope_at(c, a), yb = quartic_at(c, b), sb = slope_at(c, b);
        wide x = (yb - ya + sa * a - sb * b) / (sa - sb);   /* where the tangents meet, below the curve */
        run &= wide_not(wide_below(wide_of(SURE), ya + sa * (x - a)));
        wide_mask is_low = run & wide_not(wide_below(wide_of(SURE), quartic_at(c, x)));
        unsure |= is_low;
        run &= wide_not(is_low);
        wide_mask falls = wide_below(slope_at(c, x), wide_of(0));
        a = wide_pick(falls, x, a);
        b = wide_pick(falls, b, x);
    }
    return unsure | run;
}

/* Down a convex piece. */
static struct entry descend(const struct lines *c, wide left, wide right, wide_mask run)
{
    struct entry out = no_entry;
    wide x = left, before = left;
    wide_mask risen = wide_mask_of(0), first = run;

    for (int i = 0; i < 24 && wide_bits(run); i++) {
        wide s = slope_at(c, x);
        wide_mask rises = run & wide_not(wide_below(s, wide_of(0)));
        risen |= rises & wide_not(first);
        run &= wide_not(rises);
        wide next = x - quartic_at(c, x) / s;
        run &= wide_below(next, right);
        wide_mask is_done = run & wide_below(next - x, wide_of(0x1p-24));
        wide_mask is_steep = wide_below(s, wide_of(-STEEP));
        out.is_there |= is_done & is_steep;
        out.unsure |= is_done & wide_not(is_steep);
        out.at = wide_pick(is_done, next, out.at);
        run &= wide_not(is_done);
        before = wide_pick(run, x, before);
        x = wide_pick(run, next, x);
        first = wide_mask_of(0);
    }
    out.unsure |= run;
    if (wide_bits(risen))
        out.unsure |= may_touch(c, before, x, risen);
    return out;
}

/* Between left, where the quartic is above 0, and right, where it is below. */
static struct entry fall(const struct lines *c, wide left, wide right, wide_mask run)
{
    struct entry out = { .at = left + (right - left) / 2, .is_there = run, .unsure = wide_mask_of(0) };

    for (int i = 0; i < 20 && wide_bits(run); i++) {
        wide x = out.at, y = quartic_at(c, x);
        wide_mask is_above = wide_below(wide_of(0), y);
        left = wide_pick(is_above, x, left);
        right = wide_pick(is_above, right, x);
        wide next = x - y / slope_at(c, x);
        wide_mask is_within = wide_below(left, next) & wide_below(next, right);
        next = wide_pick(is_within, next, left + (right - left) / 2);
        out.at = wide_pick(run, next, x);
        run &= wide_not(wide_below(wide_abs(next - x), wide_of(0x1p-20)));
    }
    return out;
}

INLINE wide_mask is_high(wide y) { return wide_below(wide_of(SURE), y); }
INLINE wide_mask is_low(wide y) { return wide_below(y, wide_of(-SURE)); }

/* The entry of those lanes in a convex piece: the first is from low to -turn, the other from turn to high. */
static struct entry entry_of_convex(const struct lines *c, wide left, wide right, wide_mask run)
{
    run &= wide_below(left, right);
    if (!wide_bits(run))
        return no_entry;
    wide y = quartic_at(c, left);
    struct entry out = descend(c, left, right, run & is_high(y));
    out.unsure |= run & wide_not(is_high(y) | is_low(y));
    return out;
}

static struct entry entry_of_concave(const struct lines *c, wide_mask run)
{
    wide left = wide_max(-c->turn, c->low), right = wide_min(c->turn, c->high);

    run &= wide_below(left, right);
    if (!wide_bits(run))
        return no_entry;
    wide a = quartic_at(c, left), b = quartic_at(c, right);
    struct entry out = fall(c, left, right, run & is_high(a) & is_low(b));
    out.unsure |= run & wide_not((is_high(a) & (is_high(b) | is_low(b))) | (is_low(a) & is_high(b)));
    return out;
}

static struct entry entry_of_first(const struct lines *c, wide_mask run)
{
    return polished(c, entry_of_convex(c, c->low, wide_min(-c->turn, c->high), run));
}

static struct entry entry_of_second(const struct lines *c, wide_mask run)
{
    return polished(c, entry_of_concave(c, run));
}

static struct entry entry_of_last(const struct lines *c, wide_mask run)
{
    return polished(c, entry_of_convex(c, wide_max(c->turn, c->low), c->high, run));
}

double torus_entry(const struct torus *s, const struct torus_chord *c, double a, double b)
{
    struct lines lines = {
        .s = s, .p = { wide_of(c->p.x), wide_of(c->p.y), wide_of(c->p.z) },
        .e = { wide_of(c->e.x), wide_of(c->e.y), wide_of(c->e.z) },
        .low = wide_of(c->low), .high = wide_of(c->high),
        .turn = wide_sqrt(wide_max(wide_of(-c->quartic[2] / 6), wide_of(0))),
        .c0 = wide_of(c->quartic[0]), .c1 = wide_of(c->quartic[1]), .c2 = wide_of(c->quartic[2]),
        .c3 = wide_of(c->quartic[3]) };
    static struct entry (*const of[])(const struct lines *c, wide_mask run) = {
        entry_of_first, entry_of_second, entry_of_last };

    for (int i = 0; i < 3 && !s->has_inner; i++) {
        struct entry e = of[i](&lines, wide_mask_of(1));
        if (wide_bits(e.is_there) & 1 && e.at[0] > a && e.at[0] < b)
            return e.at[0];
    }
    return NAN;
}

/* ---- rays ---- */

/* Lanes that come near to the tube; as torus_cross.c has it. */
static wide_mask clip(struct lines *c)
{
    const wide margin = wide_of(TORUS_MARGIN);
    double tube = c->s->tube, out = c->s->ring + tube;
    wide left = out * out - wide_dot(c->p, c->p);
    wide_mask is_near = wide_not(wide_below(left, -margin));
    wide_mask is_flat = wide_below(wide_abs(c->e.y), margin);
    wide a = (-tube - c->p.y) / c->e.y, b = (tube - c->p.y) / c->e.y;

    c->high = wide_sqrt(wide_max(left, wide_of(0))) + margin;
    c->low = -c->high;
    c->low = wide_pick(is_flat, c->low, wide_max(c->low, wide_min(a, b) - margin));
    c->high = wide_pick(is_flat, c->high, wide_min(c->high, wide_max(a, b) + margin));
    wide_mask is_level = wide_at_most(wide_abs(c->p.y), tube + 2 * margin);
    return is_near & wide_below(c->low, c->high) & (wide_not(is_flat) | is_level);
}

static void expand(struct lines *c)
{
    const double rr = c->s->ring * c->s->ring, apart = (c->s->ring - c->s->tube) * (c->s->ring + c->s->tube);
    wide k = wide_dot(c->p, c->p) + apart, b = wide_dot(c->p, c->e);
    wide ee = c->e.x * c->e.x + c->e.z * c->e.z, pe = c->p.x * c->e.x + c->p.z * c->e.z;
    wide pp = c->p.x * c->p.x + c->p.z * c->p.z;

    c->c0 = k * k - 4 * rr * pp;
    c->c1 = 4 * b * k - 8 * rr * pe;
    c->c2 = 4 * b * b + 2 * k - 4 * rr * ee;
    c->c3 = 4 * b;
    c->turn = wide_sqrt(wide_max(-c->c2 / 6, wide_of(0)));
}

/* Those of the asked that come near. */
static wide_mask lines_of(const struct torus *s, const struct wide_ray *r, wide_mask asked, struct lines *c)
{
    double out = s->ring + s->tube + 0x1p-20;
    struct wide3 from = wide3_scale(r->o, s->unit);
    wide square = wide_dot(r->d, r->d);

    c->s = s;
    c->mid = -wide_dot(from, r->d) / square;
    c->p = wide3_fma(from, c->mid, r->d);
    asked &= wide_below(wide_dot(c->p, c->p), wide_of(out * out));
    if (!wide_bits(asked))
        return asked;
    c->length = wide_sqrt(square);
    wide inverse = 1 / c->length;
    c->e = (struct wide3) { r->d.x * inverse, r->d.y * inverse, r->d.z * inverse };
    asked &= clip(c);
    if (wide_bits(asked))
        expand(c);
    return asked;
}

/* What is known of a ray's start, where that lies within the chord. */
struct start { wide at; wide_mask is_within, rises, unsure; };

static struct start start_of(const struct lines *c, wide near, wide_mask asked)
{
    const wide least = wide_of(8 * ROUNDING * c->s->tube);
    struct start out = { .at = wide_max((near * c->s->unit - c->mid) * c->length, c->low) };

    out.is_within = asked & wide_below(c->low, out.at) & wide_below(out.at, c->high);
    out.rises = out.unsure = wide_mask_of(0);
    if (!wide_bits(out.is_within))
        return out;
    struct distance y = distance_at(c, out.at);
    wide s = slope_at(c, out.at);
    wide_mask is_out = wide_below(least, y.f), is_off = wide_below(wide_of(0x1p-20), y.f);
    out.rises = out.is_within & wide_below(wide_of(STEEP), s);
    wide_mask falls = wide_below(s, wide_of(-STEEP));
    out.unsure = out.is_within & wide_not(is_out & (out.rises | (falls & is_off)));
    return out;
}

static void take(struct entry *all, wide_mask *run, const struct entry *e)
{
    all->at = wide_pick(e->is_there, e->at, all->at);
    all->is_there |= e->is_there;
    all->unsure |= e->unsure;
    *run &= wide_not(e->is_there | e->unsure);
}

/* The first entry beyond near of rays that start outside. */
static struct entry first_entry(const struct lines *c, wide near, wide_mask asked)
{
    const struct start from = start_of(c, near, asked);
    struct entry all = no_entry, e;
    wide_mask run = asked & wide_not(from.unsure) & wide_below(from.at, c->high);

    all.unsure = from.unsure;
    e = entry_of_first(c, run & wide_below(from.at, -c->turn) & wide_not(from.rises));
    take(&all, &run, &e);
    e = entry_of_second(c, run & wide_below(from.at, c->turn));
    take(&all, &run, &e);
    e = entry_of_last(c, run & wide_not(from.rises & wide_below(c->turn, from.at)));
    take(&all, &run, &e);
    return all;
}

/* t of the first crossing with near < t. */
static struct entry first_crossing(const struct torus *s, const struct wide_ray *r, wide near, wide_mask asked)
{
    wide_mask wild = asked & wide_not(wide_is_tame(wide_dot(r->d, r->d)));
    struct lines c;

    if (s->has_inner)
        return (struct entry) { .at = near, .is_there = wide_mask_of(0), .unsure = asked };
    asked = lines_of(s, r, asked & wide_not(wild), &c);
    struct entry e = no_entry;
    e.unsure = wild;
    if (!wide_bits(asked))
        return e;
    e = first_entry(&c, near, asked);
    e.at = (c.mid + e.at / c.length) * s->size;
    wide_mask is_behind = e.is_there & wide_not(wide_below(near, e.at));
    e.is_there &= wide_not(is_behind);
    e.unsure |= is_behind | wild;
    return e;
}

enum torus_first torus_first(const struct torus *s, const struct ray *ray, double near, double far, double *t)
{
    const struct wide_ray r = {
        .o = { wide_of(ray->origin.x), wide_of(ray->origin.y), wide_of(ray->origin.z) },
        .d = { wide_of(ray->dir.x), wide_of(ray->dir.y), wide_of(ray->dir.z) } };
    struct entry e = first_crossing(s, &r, wide_of(near), wide_mask_of(1));

    *t = e.at[0];
    if (wide_bits(e.unsure) & 1)
        return TORUS_UNSURE;
    return wide_bits(e.is_there) & 1 && *t < far ? TORUS_MET : TORUS_MISSED;
}

INLINE wide_mask cross_many(const void *self, const struct wide_ray *r, wide_mask asked, wide *t,
                            wide_mask *unsure)
{
    struct entry e = first_crossing(self, r, wide_of(0), asked);

    *t = e.at;
    *unsure = e.unsure;
    return e.is_there;
}

void torus_first_many(const void *self, const struct packet *p, const uint8_t may[],
                      struct crossings *out)
{
    const struct torus *s = self;

    packet_crosses(cross_many, s, s->major + s->minor, p, may, out);
}
