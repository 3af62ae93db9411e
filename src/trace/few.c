/* few.c: the boxes of small scenes, tried for arrays of rays. */
#include "trace/few.h"

#include <string.h>

#include "math/kernel.h"

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

/* Vectors go between inlined functions only: there is no ABI to break. */
#pragma GCC diagnostic ignored "-Wpsabi"

/* As many rays as a register holds, kept there while all boxes pass by. */
#if defined(__AVX512F__)
enum { SIDE_BY_SIDE = 8 };
#elif defined(__AVX__)
enum { SIDE_BY_SIDE = 4 };
#else
enum { SIDE_BY_SIDE = 2 };
#endif
typedef double many __attribute__((vector_size(SIDE_BY_SIDE * sizeof(double))));
typedef int64_t many_bits __attribute__((vector_size(SIDE_BY_SIDE * sizeof(int64_t))));

struct bundle { many o[3], inverse[3]; many_bits back[3]; };

INLINE many load(const double *p)
{
    many v;

    memcpy(&v, p, sizeof v);
    return v;
}

INLINE many either(many_bits which, many a, many b)
{
    return (many)(((many_bits)a & which) | ((many_bits)b & ~which));
}

INLINE struct bundle bundle_of(const struct rays *r, int i)
{
    struct bundle q = { .o = { load(r->x + i), load(r->y + i), load(r->z + i) } };

    q.inverse[0] = 1 / load(r->dx + i);
    q.inverse[1] = 1 / load(r->dy + i);
    q.inverse[2] = 1 / load(r->dz + i);
    for (int axis = 0; axis < 3; axis++)
        q.back[axis] = q.inverse[axis] < 0;
    return q;
}

/* A ray in a face's plane gives 0 * infinity: the comparison is then false
 * and keeps what was known before (facts numerics.md 1.6). */
INLINE many_bits meets_box(const struct bundle *q, const struct few *f, int k, many end)
{
    many begin = { 0 };

    for (int axis = 0; axis < 3; axis++) {
        many low = f->side[0][axis][k] - q->o[axis], high = f->side[1][axis][k] - q->o[axis];
        many near = either(q->back[axis], high, low) * q->inverse[axis];
        many far = either(q->back[axis], low, high) * q->inverse[axis];
        begin = either(near > begin, near, begin);
        end = either(far < end, far, end);
    }
    return begin <= end * (1 + rounding);
}

static bool is_everywhere(const struct few *f, int k)
{
    for (int axis = 0; axis < 3; axis++)
        if (!isinf(f->side[0][axis][k]) || !isinf(f->side[1][axis][k]))
            return false;
    return true;
}

/* ---- which boxes can be met at all by rays that lie close together ---- */

/* All origins and directions lie between these. */
struct beam { double o[2][3], d[2][3], far; };

/* The compiler does not dare to: the order matters for NaN. */
static void span_of(int n, const double *v, double out[2])
{
    many low = (many) { 0 } + v[0], high = low;
    int i = 0;

    for (; i + SIDE_BY_SIDE <= n; i += SIDE_BY_SIDE) {
        many a = load(v + i);
        low = either(a < low, a, low);
        high = either(a > high, a, high);
    }
    out[0] = low[0];
    out[1] = high[0];
    for (int k = 1; k < SIDE_BY_SIDE; k++) {
        out[0] = smaller(out[0], low[k]);
        out[1] = larger(out[1], high[k]);
    }
    for (; i < n; i++) {
        out[0] = smaller(out[0], v[i]);
        out[1] = larger(out[1], v[i]);
    }
}

static struct beam beam_of(const struct rays *r, const double *far)
{
    const double *o[] = { r->x, r->y, r->z }, *d[] = { r->dx, r->dy, r->dz };
    struct beam b = { .far = INFINITY };
    double span[2];

    for (int axis = 0; axis < 3; axis++) {
        span_of(r->n, o[axis], span);
        b.o[0][axis] = span[0];
        b.o[1][axis] = span[1];
        span_of(r->n, d[axis], span);
        b.d[0][axis] = span[0];
        b.d[1][axis] = span[1];
    }
    if (far) {
        span_of(r->n, far, span);
        b.far = span[1];
    }
    return b;
}

/* t * speed <= way, or >= it: what that leaves of begin..end. */
static void keep_below(double way, double speed, double *begin, double *end)
{
    if (speed > 0)
        *end = smaller(*end, way / speed);
    else if (speed < 0)
        *begin = larger(*begin, way / speed);
    else if (way < 0)
        *end = -1;
}

/* Is there a time at which, on each axis, the slowest ray has not passed the
 * box and the fastest has reached it? */
static bool beam_meets(const struct beam *b, const struct few *f, int k)
{
    const double loose = 1e-9;          /* far above rounding: this only saves work */
    double begin = 0, end = b->far;

    for (int axis = 0; axis < 3; axis++) {
        keep_below(f->side[1][axis][k] - b->o[0][axis], b->d[0][axis], &begin, &end);
        keep_below(b->o[1][axis] - f->side[0][axis][k], -b->d[1][axis], &begin, &end);
    }
    return !(begin > end + loose * (fabs(begin) + fabs(end)));
}

/* ---- which boxes each ray meets ---- */

struct choice { int n, box[FEW]; uint64_t always; };

static struct choice choose(const struct few *f, const struct rays *r, const double *far)
{
    enum { WORTH_IT = 16 };             /* rays */
    struct beam beam = { .far = INFINITY };
    struct choice c = { .n = 0 };

    if (r->n >= WORTH_IT)
        beam = beam_of(r, far);
    for (int k = 0; k < f->n; k++)
        if (is_everywhere(f, k))
            c.always |= (uint64_t)1 << k;
        else if (r->n < WORTH_IT || beam_meets(&beam, f, k))
            c.box[c.n++] = k;
    return c;
}

INLINE void aim_bundle(const struct few *f, const struct choice *c, const struct rays *r,
                       const double *far, int i, uint64_t *may)
{
    struct bundle q = bundle_of(r, i);
    many end = far ? load(far + i) : (many) { 0 } + INFINITY;
    many_bits bits = (many_bits) { 0 } + (int64_t)c->always;

    for (int k = 0; k < c->n; k++)
        bits |= meets_box(&q, f, c->box[k], end) & ((many_bits) { 0 } + ((int64_t)1 << c->box[k]));
    memcpy(may + i, &bits, sizeof bits);
}

/* The last rays, too few for a register, are copied to where one can be read. */
static void aim_rest(const struct few *f, const struct choice *c, const struct rays *r,
                     const double *far, int i, uint64_t *may)
{
    double copy[7][SIDE_BY_SIDE] = { { 0 } };
    uint64_t bits[SIDE_BY_SIDE];
    const struct rays rest = { SIDE_BY_SIDE, copy[0], copy[1], copy[2], copy[3], copy[4], copy[5] };
    size_t size = (size_t)(r->n - i) * sizeof(double);
    const double *from[] = { r->x, r->y, r->z, r->dx, r->dy, r->dz };

    for (int k = 0; k < 6; k++)
        memcpy(copy[k], from[k] + i, size);
    if (far)
        memcpy(copy[6], far + i, size);
    aim_bundle(f, c, &rest, far ? copy[6] : NULL, 0, bits);
    memcpy(may + i, bits, size);
}

void few_aim(const struct few *f, const struct rays *r, const double *far, uint64_t *may)
{
    struct choice c = choose(f, r, far);
    int i = 0;

    for (; i + SIDE_BY_SIDE <= r->n; i += SIDE_BY_SIDE)
        aim_bundle(f, &c, r, far, i, may);
    if (i < r->n)
        aim_rest(f, &c, r, far, i, may);
}
