/* kernel.h: marks for hot loops over arrays.
 *
 * The folders math, shape, pattern and trace are compiled once for each
 * instruction set (Makefile.am: engine variants) and one is picked when the
 * program starts, so fma() and vectors are inlined everywhere and not only in
 * marked loops.  KERNEL before a function says that its loop over restrict
 * arrays is meant to become vector code; tests/check-vectors looks whether it
 * did, and -fopt-info-vec-missed says why not. */
#ifndef RTC_KERNEL_H
#define RTC_KERNEL_H

#define KERNEL __attribute__((noinline))
#define INLINE static inline __attribute__((always_inline))
#define UNLIKELY(x) __builtin_expect(!!(x), 0)
#define LIKELY(x) __builtin_expect(!!(x), 1)

/* Arrays of BATCH are worked on up to whole(n): a number that every register
 * divides leaves no rest for a second, scalar loop.  What stands behind n is
 * a copy of what stands before it. */
enum { BATCH = 128, STRIDE = 16 };

INLINE int whole(int n) { return (n + STRIDE - 1) & -STRIDE; }

#endif
