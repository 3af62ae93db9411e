/* dd.h: numbers of twice the precision, for decisions that doubles cannot
 * make.  A number is the unevaluated sum hi + lo, |lo| at most half an ulp of
 * hi.  Needs -ffp-contract=off. */
#ifndef RTC_DD_H
#define RTC_DD_H

#include <math.h>

typedef struct { double hi, lo; } dd;

static inline dd dd_of(double a) { return (dd) { a, 0 }; }

/* |a| >= |b|. */
static inline dd dd_quick_sum(double a, double b)
{
    double s = a + b;
    return (dd) { s, b - (s - a) };
}

/* Exactly a + b (Knuth). */
static inline dd dd_sum(double a, double b)
{
    double s = a + b, v = s - a;
    return (dd) { s, (a - (s - v)) + (b - v) };
}

/* Exactly a * b, if it does not underflow. */
static inline dd dd_product(double a, double b)
{
    double p = a * b;
    return (dd) { p, fma(a, b, -p) };
}

static inline dd dd_add(dd a, dd b)
{
    dd s = dd_sum(a.hi, b.hi), t = dd_sum(a.lo, b.lo);

    s = dd_quick_sum(s.hi, s.lo + t.hi);
    return dd_quick_sum(s.hi, s.lo + t.lo);
}

static inline dd dd_neg(dd a) { return (dd) { -a.hi, -a.lo }; }
static inline dd dd_sub(dd a, dd b) { return dd_add(a, dd_neg(b)); }

static inline dd dd_mul(dd a, dd b)
{
    dd p = dd_product(a.hi, b.hi);
    return dd_quick_sum(p.hi, p.lo + (a.hi * b.lo + a.lo * b.hi));
}

/* a * s for a power of two s: exact. */
static inline dd dd_scale(dd a, double s) { return (dd) { a.hi * s, a.lo * s }; }

static inline dd dd_sqrt(dd a)
{
    if (!(a.hi > 0))
        return dd_of(0);
    double r = sqrt(a.hi);
    return dd_quick_sum(r, dd_sub(a, dd_product(r, r)).hi / (2 * r));
}

/* a * b - c * d with at most 1.5 ulp of error, so also with the right sign
 * (Kahan; Jeannerod, Louvet and Muller 2013). */
static inline double difference_of_products(double a, double b, double c, double d)
{
    double cd = c * d;
    return fma(a, b, -cd) + fma(-c, d, cd);
}

#endif
