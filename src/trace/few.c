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

INLINE void aim_bundle(const struct few *f, const struct rays *r, const double *far, uint64_t always,
                      int i, uint64_t *may)
{
    struct bundle q = bundle_of(r, i);
    many end = far ? load(far + i) : (many) { 0 } + INFINITY;
    many_bits bits = (many_bits) { 0 } + (int64_t)always;

    for (int k = 0; k < f->n; k++)
        bits |= meets_box(&q, f, k, end) & ((many_bits) { 0 } + ((int64_t)1 << k));
    memcpy(may + i, &bits, sizeof bits);
}

static bool is_everywhere(const struct few *f, int k)
{
    for (int axis = 0; axis < 3; axis++)
        if (!isinf(f->side[0][axis][k]) || !isinf(f->side[1][axis][k]))
            return false;
    return true;
}

/* The last rays, too few for a register, are copied to where one can be read. */
static void aim_rest(const struct few *f, const struct rays *r, const double *far, uint64_t always,
                     int i, uint64_t *may)
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
    aim_bundle(f, &rest, far ? copy[6] : NULL, always, 0, bits);
    memcpy(may + i, bits, size);
}

void few_aim(const struct few *f, const struct rays *r, const double *far, uint64_t *may)
{
    uint64_t always = 0;
    int i = 0;

    for (int k = 0; k < f->n; k++)
        always |= (uint64_t)is_everywhere(f, k) << k;
    for (; i + SIDE_BY_SIDE <= r->n; i += SIDE_BY_SIDE)
        aim_bundle(f, r, far, always, i, may);
    if (i < r->n)
        aim_rest(f, r, far, always, i, may);
}
