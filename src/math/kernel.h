/* kernel.h: marks for hot loops over arrays.
 *
 * The folders math, shape, pattern and trace are compiled once for each
 * instruction set (Makefile.am: engine variants) and one is picked when the
 * program starts, so fma() and vectors are inlined everywhere and not only in
 * marked loops.  KERNEL before a function says that its loop over restrict
 * arrays is meant to become vector code; -fopt-info-vec tells whether it did. */
#ifndef RTC_KERNEL_H
#define RTC_KERNEL_H

#define KERNEL __attribute__((noinline))
#define INLINE static inline __attribute__((always_inline))
#define UNLIKELY(x) __builtin_expect(!!(x), 0)
#define LIKELY(x) __builtin_expect(!!(x), 1)

#endif
