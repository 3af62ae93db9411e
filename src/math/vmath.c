/* vmath.c: powers of whole arrays, in plain C that becomes vector code. */
#include "math/vmath.h"

#include <stdint.h>
#include <string.h>

#include "math/kernel.h"

INLINE uint64_t bits_of(double x) { uint64_t b; memcpy(&b, &x, sizeof b); return b; }
INLINE double double_of(uint64_t b) { double x; memcpy(&x, &b, sizeof x); return x; }

/* log2 of a normal x > 0 to 1e-12, by the series of atanh around 1.
 * x = 2^e m with m between sqrt(1/2) and sqrt(2); the exponent becomes a
 * double by writing it into the mantissa of 2^52, since few machines convert
 * 64-bit integers in vectors. */
INLINE double log2_of(double x)
{
    const uint64_t root = 0x3fe6a09e667f3bcd;           /* sqrt(1/2) */
    const uint64_t bias = 1024;
    uint64_t k = (bits_of(x) - root + (bias << 52)) >> 52;
    double e = double_of(k | 0x4330000000000000) - (4503599627370496.0 + (double)bias);
    double m = double_of(bits_of(x) - ((k - bias) << 52));
    double s = (m - 1) / (m + 1), q = s * s;
    double series = 1 + q * (1 / 3. + q * (1 / 5. + q * (1 / 7. + q * (1 / 9. + q * (1 / 11.
                    + q * (1 / 13.))))));

    return e + 2.8853900817779268 * s * series;         /* 2 / ln 2 */
}

/* 2^x for |x| <= 1000 to 1e-13: Taylor on [-1/2, 1/2].  Adding 1.5 2^52
 * rounds to an integer and leaves it in the low bits. */
INLINE double exp2_of(double x)
{
    const double magic = 6755399441055744.0;
    double shifted = x + magic;
    double f = (x - (shifted - magic)) * 0.69314718055994531;
    double p = 1 + f * (1 + f * (1 / 2. + f * (1 / 6. + f * (1 / 24. + f * (1 / 120.
               + f * (1 / 720. + f * (1 / 5040. + f * (1 / 40320. + f * (1 / 362880.)))))))));

    return double_of(bits_of(p) + (bits_of(shifted) << 52));
}

/* In double inside: the product y log2 x of a sharp highlight is large, and a
 * float would lose its fraction. */
KERNEL void vmath_pow(int n, const float *restrict x, float y, float *restrict out)
{
    const double tiny = 1e-300;
    double exponent = y;

    for (int i = 0; i < n; i++) {
        double base = (double)x[i];
        double power = exponent * log2_of(base > tiny ? base : tiny);
        power = power > -1000 ? power : -1000;
        power = power < 1000 ? power : 1000;
        double value = exp2_of(power);
        out[i] = (float)(base > 0 ? value : 0);
    }
}
