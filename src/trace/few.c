/* few.c: the boxes of small scenes, tried for arrays of rays. */
#include "trace/few.h"

#include "math/kernel.h"

enum { AT_ONCE = 256 };                 /* rays: what the arrays on the stack hold */

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

KERNEL static void invert(int n, const double *restrict d, double *restrict inverse)
{
    for (int i = 0; i < n; i++)
        inverse[i] = 1 / d[i];
}

struct slab { double low, high; const double *restrict o, *restrict inverse; };

/* A ray in a face's plane gives 0 * infinity: the comparison is then false
 * and keeps what was known before (facts numerics.md 1.6). */
INLINE void clip(const struct slab *s, int i, double *begin, double *end)
{
    double r = s->inverse[i];
    double near = ((r < 0 ? s->high : s->low) - s->o[i]) * r;
    double far = ((r < 0 ? s->low : s->high) - s->o[i]) * r;

    *begin = near > *begin ? near : *begin;
    *end = far < *end ? far : *end;
}

KERNEL static void try_box(int n, struct slab x, struct slab y, struct slab z,
                           const double *restrict far, uint64_t bit, uint64_t *restrict may)
{
    for (int i = 0; i < n; i++) {
        double begin = 0, end = far[i];
        clip(&x, i, &begin, &end);
        clip(&y, i, &begin, &end);
        clip(&z, i, &begin, &end);
        may[i] |= begin <= end * (1 + rounding) ? bit : 0;
    }
}

static struct slab slab_of(const struct few *f, int k, int axis, const double *o,
                           const double *inverse)
{
    return (struct slab) { f->side[0][axis][k], f->side[1][axis][k], o, inverse };
}

static bool is_everywhere(const struct few *f, int k)
{
    for (int axis = 0; axis < 3; axis++)
        if (!isinf(f->side[0][axis][k]) || !isinf(f->side[1][axis][k]))
            return false;
    return true;
}

static void aim_some(const struct few *f, const struct rays *r, const double *far, uint64_t *may)
{
    double ix[AT_ONCE], iy[AT_ONCE], iz[AT_ONCE];
    uint64_t always = 0;

    invert(r->n, r->dx, ix);
    invert(r->n, r->dy, iy);
    invert(r->n, r->dz, iz);
    for (int k = 0; k < f->n; k++)
        always |= (uint64_t)is_everywhere(f, k) << k;
    for (int i = 0; i < r->n; i++)
        may[i] = always;
    for (int k = 0; k < f->n; k++)
        if (!(always >> k & 1))
            try_box(r->n, slab_of(f, k, 0, r->x, ix), slab_of(f, k, 1, r->y, iy),
                    slab_of(f, k, 2, r->z, iz), far, (uint64_t)1 << k, may);
}

void few_aim(const struct few *f, const struct rays *r, const double *far, uint64_t *may)
{
    double endless[AT_ONCE];

    for (int i = 0; !far && i < AT_ONCE; i++)
        endless[i] = INFINITY;
    for (int at = 0; at < r->n; at += AT_ONCE) {
        int n = r->n - at < AT_ONCE ? r->n - at : AT_ONCE;
        struct rays some = { n, r->x + at, r->y + at, r->z + at,
                             r->dx + at, r->dy + at, r->dz + at };
        aim_some(f, &some, far ? far + at : endless, may + at);
    }
}
