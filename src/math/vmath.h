/* vmath.h: powers of whole arrays: the one place to swap in another library. */
#ifndef RTC_VMATH_H
#define RTC_VMATH_H

/* out[i] = x[i] ^ y for x >= 0 and y > 0; 0 for x <= 0.  Right to the last
 * bit of a float but for rare ties, and the same bits on every machine. */
void vmath_pow(int n, const float *restrict x, float y, float *restrict out);

#endif
