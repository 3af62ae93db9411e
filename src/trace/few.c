/* few.c: the boxes of small scenes. */
#include "trace/few.h"

/* Wider than all rounding of the slabs' three operations. */
static const double rounding = 0x1p-49;

void few_add(struct few *f, uint32_t item, const struct bounds *box)
{
    const vec3 low = box->low, high = box->high;
    int k = f->n++;

    f->item[k] = item;
    for (int axis = 0; axis < 3; axis++) {
        double a = vec_get(low, axis), b = vec_get(high, axis);
        double pad = isinf(a) || isinf(b) ? 0 : rounding * larger(fabs(a), fabs(b));
        f->side[0][axis][k] = a - pad;
        f->side[1][axis][k] = b + pad;
    }
}

/* ---- which boxes a ray meets, or which rays a box ---- */

/* The part of a ray inside of one slab after another.  A ray in a face's
 * plane gives 0 * infinity: the comparison is then false and keeps what was
 * known before (facts numerics.md 1.6). */
struct slab_walk { wide begin, end; };

INLINE void walk_slab(struct slab_walk *w, wide near, wide far)
{
    w->begin = wide_max(near, w->begin);
    w->end = wide_min(far, w->end);
}

INLINE uint32_t is_inside(const struct slab_walk *w)
{
    return wide_not_above(w->begin, w->end * (1 + rounding));
}

uint32_t few_aim(const struct few *f, const struct ray *ray, double far)
{
    const double from[] = { ray->origin.x, ray->origin.y, ray->origin.z };
    const double inverse[] = { 1 / ray->dir.x, 1 / ray->dir.y, 1 / ray->dir.z };
    uint32_t may = 0;

    for (int k = 0; k < f->n; k += WIDE) {
        struct slab_walk w = { wide_of(0), wide_of(far) };
        for (int axis = 0; axis < 3; axis++) {
            bool back = inverse[axis] < 0;
            walk_slab(&w, (wide_load(&f->side[back][axis][k]) - from[axis]) * inverse[axis],
                      (wide_load(&f->side[!back][axis][k]) - from[axis]) * inverse[axis]);
        }
        may |= is_inside(&w) << k;
    }
    return f->n < FEW ? may & ((1u << f->n) - 1) : may;
}

bool few_meet(const struct few *f, int k, const struct packet *p, const double *far, uint8_t may[])
{
    unsigned any = 0;

    for (int at = 0, r = 0; at < p->n; at += WIDE, r++) {
        if (!may[r])
            continue;
        struct slab_walk w = { wide_of(0), wide_load(far + at) };
        for (int axis = 0; axis < 3; axis++) {
            wide by = wide_load(&p->inverse[axis][at]), from = wide_load(&p->o[axis][at]);
            wide low = (f->side[0][axis][k] - from) * by, high = (f->side[1][axis][k] - from) * by;
            wide_mask back = wide_signs(by);
            walk_slab(&w, wide_pick(back, high, low), wide_pick(back, low, high));
        }
        any |= may[r] &= (uint8_t)is_inside(&w);
    }
    return any;
}

/* ---- which boxes can be met at all by rays that lie close together ---- */

/* All origins, directions and ways up to far lie between these. */
struct beam { double o[2][3], d[2][3], far, way[2][3]; };

static void range_of_two(wide low, wide high, double out[2])
{
    out[0] = low[0];
    out[1] = high[0];
    for (int k = 1; k < WIDE; k++) {
        out[0] = smaller(low[k], out[0]);
        out[1] = larger(high[k], out[1]);
    }
}

/* v is filled up to a whole register with copies. */
static void range_of(int n, const double *v, double out[2])
{
    wide low = wide_load(v), high = low;

    for (int i = WIDE; i < n; i += WIDE) {
        low = wide_min(wide_load(v + i), low);
        high = wide_max(wide_load(v + i), high);
    }
    range_of_two(low, high, out);
}

/* Where rays begin or end along an axis, and a little beyond. */
static void find_way(const struct packet *p, const double *far, int axis, struct beam *b)
{
    const double loose = 1e-9;
    wide low = wide_of(b->o[0][axis]), high = wide_of(b->o[1][axis]);
    double end[2] = { -INFINITY, INFINITY };

    for (int i = 0; b->far < INFINITY && i < p->n; i += WIDE) {
        wide at = wide_load(p->o[axis] + i) + wide_load(far + i) * wide_load(p->d[axis] + i);
        low = wide_min(at, low);
        high = wide_max(at, high);
    }
    if (b->far < INFINITY)
        range_of_two(low, high, end);
    double size = loose * larger(fabs(end[0]), fabs(end[1]));
    b->way[0][axis] = end[0] - size;
    b->way[1][axis] = end[1] + size;
}

static struct beam beam_of(const struct packet *p, const double *far)
{
    struct beam b = { .far = INFINITY };
    double range[2];

    for (int axis = 0; axis < 3; axis++) {
        range_of(p->n, p->o[axis], range);
        b.o[0][axis] = range[0];
        b.o[1][axis] = range[1];
        range_of(p->n, p->d[axis], range);
        b.d[0][axis] = range[0];
        b.d[1][axis] = range[1];
    }
    if (far) {
        range_of(p->n, far, range);
        b.far = range[1];
    }
    for (int axis = 0; axis < 3; axis++)
        find_way(p, far, axis, &b);
    return b;
}

/* t * speed <= way: what that leaves of begin..end. */
INLINE void keep_below(struct slab_walk *w, wide way, double speed)
{
    if (speed > 0)
        w->end = wide_min(way / speed, w->end);
    else if (speed < 0)
        w->begin = wide_max(way / speed, w->begin);
    else
        w->end = wide_pick(wide_below(way, wide_of(0)), wide_of(-1), w->end);
}

/* Does the way lead there, and is there a time at which, on each axis, the
 * slowest ray has not passed the box and the fastest has reached it?  Of boxes k and those that follow. */
static uint32_t beam_meets(const struct beam *b, const struct few *f, int k)
{
    const double loose = 1e-9;          /* far above rounding: this only saves work */
    struct slab_walk w = { wide_of(0), wide_of(b->far) };
    wide_mask beside = wide_mask_of(0);

    for (int axis = 0; axis < 3; axis++) {
        wide low = wide_load(&f->side[0][axis][k]), high = wide_load(&f->side[1][axis][k]);
        keep_below(&w, high - b->o[0][axis], b->d[0][axis]);
        keep_below(&w, b->o[1][axis] - low, -b->d[1][axis]);
        beside |= wide_below(high, wide_of(b->way[0][axis])) | wide_below(wide_of(b->way[1][axis]), low);
    }
    wide late = w.end + loose * (wide_abs(w.begin) + wide_abs(w.end));
    return ~wide_bits(wide_below(late, w.begin) | beside) & ((1u << WIDE) - 1);
}

uint32_t few_on_the_way(const struct few *f, const struct packet *p, const double *far)
{
    enum { WORTH_IT = 16 };             /* rays */
    const uint32_t all = f->n < FEW ? (1u << f->n) - 1 : UINT32_MAX;
    uint32_t may = 0;

    if (p->n < WORTH_IT)
        return all;
    struct beam beam = beam_of(p, far);
    for (int k = 0; k < f->n; k += WIDE)
        may |= beam_meets(&beam, f, k) << k;
    return may & all;
}
