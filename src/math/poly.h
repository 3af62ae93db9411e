/* poly.h: real roots of polynomials. */
#ifndef RTC_POLY_H
#define RTC_POLY_H

enum { POLY_MOST = 35 };                /* largest degree */

/* c[0] + c[1] x + ... + c[degree] x^degree. */
double poly_at(int degree, const double c[], double x);

/* Where it changes sign in low < x < high, in increasing order; returns how
 * many.  A root that it only touches is not one.  Between neighbouring roots
 * of the derivative there is at most one, found by bisection made quick by
 * Newton's steps: always found, and as exact as the polynomial's own
 * evaluation allows. */
int poly_roots(int degree, const double c[], double low, double high, double root[]);

#endif
