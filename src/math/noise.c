/* noise.c: POV-Ray's noise.  The tables follow from the rules of facts
 * patterns.md 1.1 and 1.3 and are worked out when noise is first asked for. */
#include "math/noise.h"

#include <stdatomic.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "math/kernel.h"
#include "math/random.h"

enum { N_HASH = NOISE_HASHES, N_LATTICE = 267, N_GRADIENT = 2048 };

struct tables {
    uint16_t hash[2 * N_HASH];          /* a permutation, twice */
    double lattice[N_LATTICE];
    vec3 gradient[N_GRADIENT];
    uint16_t permutation[N_GRADIENT];
};

/* ---- tables ---- */

static uint32_t draw(uint32_t *state) { return (*state = random_step(*state)) >> 16 & 32767; }

static void fill_hash(uint16_t hash[])
{
    uint32_t state = 0;

    for (int i = 0; i < N_HASH; i++)
        hash[i] = (uint16_t)i;
    for (int i = N_HASH - 1; i >= 0; i--) {
        uint32_t j = draw(&state) % N_HASH;
        uint16_t swap = hash[i];
        hash[i] = hash[j];
        hash[j] = swap;
    }
    memcpy(hash + N_HASH, hash, N_HASH * sizeof *hash);
}

/* CRC-16/ARC of a number's big-endian bytes, three times over. */
static uint32_t checksum(double number)
{
    uint64_t bits;
    uint32_t crc = 0;

    memcpy(&bits, &number, sizeof bits);
    for (int i = 0; i < 24; i++) {
        crc ^= (uint32_t)(bits >> (56 - 8 * (i % 8))) & 255;
        for (int k = 0; k < 8; k++)
            crc = crc >> 1 ^ (crc & 1 ? 0xa001 : 0);
    }
    return crc;
}

/* The nearest number of six significant decimal digits; |x| <= 1. */
static double six_digits(double x)
{
    double unit = 1e6;

    if (x == 0)
        return 0;
    while (fabs(x) * unit < 1e5)
        unit *= 10;
    if (fabs(x) >= 1)
        unit = 1e5;
    return rint(x * unit) / unit;
}

static void fill_lattice(double lattice[])
{
    for (int k = 0; k < N_LATTICE; k++)
        lattice[k] = six_digits(2.0 * checksum(k * 0.12345) / 65535.0 - 1);
}

static void fill_gradients(vec3 gradient[], uint16_t permutation[])
{
    uint32_t state = 1;
    uint16_t p[N_GRADIENT + 1];

    for (int i = 0; i < N_GRADIENT; i++) {
        double v[3], rr;
        do {
            for (int k = 0; k < 3; k++)
                v[k] = ((double)(draw(&state) % 4096) - 2048) / 2048;
            rr = v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
        } while (rr < 1e-5 || rr > 1);
        double r = sqrt(rr);
        gradient[i] = vec(v[0] / r, v[1] / r, v[2] / r);
    }
    for (int i = 0; i <= N_GRADIENT; i++)
        p[i] = (uint16_t)(i < N_GRADIENT ? i : 0);
    for (int i = N_GRADIENT; i > 0; i -= 2) {
        uint16_t keep = p[i];
        uint32_t j = draw(&state) % N_GRADIENT;
        p[i] = p[j];
        p[j] = keep;
    }
    memcpy(permutation, p, N_GRADIENT * sizeof *p);
}

static void *new_table(size_t size)
{
    void *t = malloc(size);

    if (!t)
        abort();
    return t;
}

static struct tables *tables_new(void)
{
    struct tables *t = new_table(sizeof *t);

    fill_hash(t->hash);
    fill_lattice(t->lattice);
    fill_gradients(t->gradient, t->permutation);
    return t;
}

static double *random_new(void)
{
    uint32_t *out = new_table(NOISE_RANDOMS * sizeof *out);
    double *random = new_table(NOISE_RANDOMS * sizeof *random);

    random_twister(out, NOISE_RANDOMS);
    for (int i = 0; i < NOISE_RANDOMS; i++)
        random[i] = out[i] / 4294967296.0;
    free(out);
    return random;
}

/* Constants that are worked out instead of written down: the same whoever
 * makes them, so two threads may race and one result is thrown away. */
static __attribute__((noinline, cold)) const void *keep_first(_Atomic(void *) *made, void *mine)
{
    void *others = NULL;

    if (atomic_compare_exchange_strong(made, &others, mine))
        return mine;
    free(mine);
    return others;
}

INLINE const struct tables *tables(void)
{
    static _Atomic(void *) made;
    const void *t = atomic_load_explicit(&made, memory_order_acquire);

    return LIKELY(t != NULL) ? t : keep_first(&made, tables_new());
}

/* ---- generators 1 and 2, and the vector ---- */

INLINE double smooth(double t) { return t * t * (3 - 2 * t); }
INLINE double clamp(double v) { return v < 0 ? 0 : v > 1 ? 1 : v; }

/* A coordinate's place in the lattice. */
struct place { int index; double part; };

/* A negative coordinate less than 1e-10 below a whole one belongs to the
 * cell above, as in POV-Ray; its part is then a little negative. */
INLINE struct place place_of(double c)
{
    double whole = trunc(c - (c >= 0 ? 0 : 1 - 1e-10));
    double wrapped = LIKELY(fabs(whole) < 0x1p31) ? whole
                     : isfinite(whole) ? fmod(whole, N_HASH) : 0;

    return (struct place) { (int)((int64_t)wrapped + 10000) & (N_HASH - 1), c - whole };
}

/* What a corner adds is the product of four numbers of the table and of four
 * that are the same whichever part of the table is looked at: a half and the
 * way from the corner, weighted.  So four are worked on at once, and added to
 * each other when those of all corners are. */
typedef double quad __attribute__((vector_size(4 * sizeof(double))));

INLINE double quad_sum(quad q) { return (q[0] + q[1]) + (q[2] + q[3]); }

/* Of n parts of the table, 1 or 3. */
INLINE void lattice_sums(const struct tables *t, vec3 p, int n, double sum[])
{
    struct place x = place_of(p.x), y = place_of(p.y), z = place_of(p.z);
    const double sx = smooth(x.part), sy = smooth(y.part), sz = smooth(z.part);
    const double wx[2] = { 1 - sx, sx }, wy[2] = { 1 - sy, sy }, wz[2] = { 1 - sz, sz };
    quad all[3] = { { 0 } }, way = { 0.5, x.part, y.part, z.part };

    for (int i = 0; i < 8; i++) {
        int dx = i >> 2, dy = i >> 1 & 1, dz = i & 1;
        int column = t->hash[t->hash[x.index + dx] ^ (y.index + dy)];
        const double *row = t->lattice + (t->hash[column ^ (z.index + dz)] & 255);
        quad factor = (way - (quad) { 0, dx, dy, dz }) * (wx[dx] * wy[dy] * wz[dz]), four;
        for (int k = 0; k < n; k++) {
            memcpy(&four, row + 4 * k, sizeof four);
            all[k] += four * factor;
        }
    }
    for (int k = 0; k < n; k++)
        sum[k] = quad_sum(all[k]);
}

vec3 noise_vector(vec3 p)
{
    double sum[3];

    lattice_sums(tables(), p, 3, sum);
    return vec(sum[0], sum[1], sum[2]);
}

/* ---- generator 3 ---- */

INLINE struct place gradient_place(double c)
{
    double moved = c + 10000000.023157213, whole = floor(moved);
    double wrapped = LIKELY(fabs(whole) < 0x1p52) ? whole
                     : isfinite(whole) ? fmod(whole, N_GRADIENT) : 0;

    return (struct place) { (int)((int64_t)wrapped & (N_GRADIENT - 1)), moved - whole };
}

INLINE double mix(double a, double b, double t) { return a + t * (b - a); }

static double gradient_noise(const struct tables *t, vec3 p)
{
    struct place x = gradient_place(p.x), y = gradient_place(p.y), z = gradient_place(p.z);
    double sx = smooth(x.part), sy = smooth(y.part), sz = smooth(z.part), value[8];
    enum { MASK = N_GRADIENT - 1 };

    for (int i = 0; i < 8; i++) {
        int dx = i & 1, dy = i >> 1 & 1, dz = i >> 2;
        int a = t->permutation[(x.index + dx) & MASK];
        int b = t->permutation[(a + ((y.index + dy) & MASK)) & MASK];
        vec3 g = t->gradient[(b + ((z.index + dz) & MASK)) & MASK];
        value[i] = g.x * (x.part - dx) + g.y * (y.part - dy) + g.z * (z.part - dz);
    }
    return mix(mix(mix(value[0], value[1], sx), mix(value[2], value[3], sx), sy),
               mix(mix(value[4], value[5], sx), mix(value[6], value[7], sx), sy), sz);
}

double noise_at(int generator, vec3 p)
{
    const struct tables *t = tables();
    double sum;

    if (generator == 3)
        return clamp(0.5 * (1.59 * gradient_noise(t, p) + 0.985));
    lattice_sums(t, p, 1, &sum);
    return generator == 1 ? clamp(sum + 0.5) : clamp((sum + 1.05242) * 0.48985582);
}

/* ---- turbulence ---- */

static int limited(int octaves)
{
    return octaves < 1 ? 1 : octaves > NOISE_MOST_OCTAVES ? NOISE_MOST_OCTAVES : octaves;
}

double noise_turbulence(int generator, vec3 p, int octaves, double omega, double lambda)
{
    double scale = 1, weight = 1, sum = 0;

    for (int i = 0; i < limited(octaves); i++) {
        double v = noise_at(generator, vec_scale(p, scale));
        if (generator != 1)             /* only the first term is clamped */
            v = i == 0 ? clamp(2 * v - 0.5) : 2 * v - 0.5;
        sum += weight * v;
        scale *= lambda;
        weight *= omega;
    }
    return sum;
}

vec3 noise_vector_turbulence(vec3 p, int octaves, double omega, double lambda)
{
    double scale = 1, weight = 1;
    vec3 sum = vec(0, 0, 0);

    for (int i = 0; i < limited(octaves); i++) {
        sum = vec_add(sum, vec_scale(noise_vector(vec_scale(p, scale)), weight));
        scale *= lambda;
        weight *= omega;
    }
    return sum;
}

/* ---- cells ---- */

INLINE int wrapped(double c)
{
    double small = LIKELY(fabs(c) < 0x1p31) ? c : isfinite(c) ? fmod(c, N_HASH) : 0;

    return (int)((int64_t)small & (N_HASH - 1));
}

int noise_hash(vec3 cell)
{
    const uint16_t *h = tables()->hash;
    return h[h[h[wrapped(cell.x)] ^ wrapped(cell.y)] ^ wrapped(cell.z)];
}

void noise_hash_cube(vec3 corner, int side, int out[])
{
    const uint16_t *h = tables()->hash;
    int x[NOISE_MOST_SIDE], y[NOISE_MOST_SIDE], z[NOISE_MOST_SIDE];

    for (int i = 0; i < side; i++) {
        x[i] = wrapped(corner.x + i);
        y[i] = wrapped(corner.y + i);
        z[i] = wrapped(corner.z + i);
    }
    for (int i = 0; i < side; i++)
        for (int j = 0; j < side; j++) {
            int row = h[h[x[i]] ^ y[j]];
            for (int k = 0; k < side; k++)
                *out++ = h[row ^ z[k]];
        }
}

double noise_random(int i)
{
    static _Atomic(void *) made;
    const double *t = atomic_load_explicit(&made, memory_order_acquire);

    return (LIKELY(t != NULL) ? t : (const double *)keep_first(&made, random_new()))[i];
}
