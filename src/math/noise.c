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
    double random[NOISE_RANDOMS];
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

static void fill_random(double random[])
{
    uint32_t *out = malloc(NOISE_RANDOMS * sizeof *out);

    if (!out)
        abort();
    random_twister(out, NOISE_RANDOMS);
    for (int i = 0; i < NOISE_RANDOMS; i++)
        random[i] = out[i] / 4294967296.0;
    free(out);
}

static struct tables *tables_new(void)
{
    struct tables *t = malloc(sizeof *t);

    if (!t)
        abort();
    fill_hash(t->hash);
    fill_lattice(t->lattice);
    fill_gradients(t->gradient, t->permutation);
    fill_random(t->random);
    return t;
}

/* A constant that is worked out instead of written down: the same whoever
 * makes it, so two threads may race and one result is thrown away. */
static const struct tables *tables(void)
{
    static _Atomic(struct tables *) made;
    struct tables *t = atomic_load_explicit(&made, memory_order_acquire);

    if (LIKELY(t != NULL))
        return t;
    struct tables *mine = tables_new();
    if (atomic_compare_exchange_strong(&made, &t, mine))
        return mine;
    free(mine);
    return t;
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
    double whole = c >= 0 ? trunc(c) : trunc(c - (1 - 1e-10));
    double wrapped = LIKELY(fabs(whole) < 0x1p31) ? whole
                     : isfinite(whole) ? fmod(whole, N_HASH) : 0;

    return (struct place) { (int)((int64_t)wrapped + 10000) & (N_HASH - 1), c - whole };
}

struct corners {
    int key[8];                         /* into the lattice table */
    double weight[8];
    vec3 from[8];                       /* the point from the corner */
};

INLINE void corners_of(const struct tables *t, vec3 p, struct corners *c)
{
    struct place x = place_of(p.x), y = place_of(p.y), z = place_of(p.z);
    double wx[2], wy[2], wz[2];

    wx[1] = smooth(x.part), wx[0] = 1 - wx[1];
    wy[1] = smooth(y.part), wy[0] = 1 - wy[1];
    wz[1] = smooth(z.part), wz[0] = 1 - wz[1];
    for (int i = 0; i < 8; i++) {
        int dx = i & 1, dy = i >> 1 & 1, dz = i >> 2;
        int a = t->hash[t->hash[x.index + dx] ^ (y.index + dy)];
        c->key[i] = t->hash[a ^ (z.index + dz)] & 255;
        c->weight[i] = wx[dx] * wy[dy] * wz[dz];
        c->from[i] = vec(x.part - dx, y.part - dy, z.part - dz);
    }
}

INLINE double lattice_sum(const struct tables *t, const struct corners *c, int shift)
{
    double sum = 0;

    for (int i = 0; i < 8; i++) {
        const double *r = t->lattice + c->key[i] + shift;
        sum += c->weight[i] * (r[0] / 2 + r[1] * c->from[i].x + r[2] * c->from[i].y
                               + r[3] * c->from[i].z);
    }
    return sum;
}

vec3 noise_vector(vec3 p)
{
    const struct tables *t = tables();
    struct corners c;

    corners_of(t, p, &c);
    return vec(lattice_sum(t, &c, 0), lattice_sum(t, &c, 4), lattice_sum(t, &c, 8));
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
    struct corners c;

    if (generator == 3)
        return clamp(0.5 * (1.59 * gradient_noise(t, p) + 0.985));
    corners_of(t, p, &c);
    double sum = lattice_sum(t, &c, 0);
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

static int wrapped(double c)
{
    return (int)((int64_t)(isfinite(c) ? fmod(c, N_HASH) : 0) & (N_HASH - 1));
}

int noise_hash(vec3 cell)
{
    const uint16_t *h = tables()->hash;
    return h[h[h[wrapped(cell.x)] ^ wrapped(cell.y)] ^ wrapped(cell.z)];
}

double noise_random(int i) { return tables()->random[i]; }
