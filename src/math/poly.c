/* poly.c: real roots of polynomials. */
#include "math/poly.h"

#include <math.h>
#include <stdbool.h>

#include "math/kernel.h"

/* Inlined, so that the degrees which are asked for most are loops without end
 * tests: a torus asks for cubics. */
INLINE double value_at(int degree, const double c[], double x)
{
    double y = c[degree];

    for (int i = degree - 1; i >= 0; i--)
        y = fma(y, x, c[i]);
    return y;
}

double poly_at(int degree, const double c[], double x) { return value_at(degree, c, x); }

INLINE double slope_at(int degree, const double c[], double x)
{
    double y = degree * c[degree];

    for (int i = degree - 1; i >= 1; i--)
        y = fma(y, x, i * c[i]);
    return y;
}

/* The one root between a and b, whose values differ in sign. */
INLINE double root_between(int degree, const double c[], double a, double b, bool rising)
{
    double x = a + (b - a) / 2;

    for (int i = 0; i < 200; i++) {
        double y = value_at(degree, c, x);
        if (y == 0)
            return x;
        if ((y > 0) == rising)
            b = x;
        else
            a = x;
        double next = x - y / slope_at(degree, c, x);
        bool is_newton = next > a && next < b;
        if (!is_newton)
            next = a + (b - a) / 2;
        if (next <= a || next >= b)
            return next;
        /* Newton's steps square the error: half the digits now are all next. */
        if (fabs(next - x) <= (is_newton ? 0x1p-30 : 0x1p-52) * fabs(next))
            return next;
        x = next;
    }
    return x;
}

static int roots_of_line(const double c[], double low, double high, double root[])
{
    if (c[1] == 0)
        return 0;
    root[0] = -c[0] / c[1];
    return root[0] > low && root[0] < high;
}

static int roots_of_parabola(const double c[], double low, double high, double root[])
{
    double a = c[2], b = c[1] / 2, cc = a * c[0];
    double left = fma(b, b, -cc) + fma(-a, c[0], cc);
    int n = 0;

    if (a == 0)
        return roots_of_line(c, low, high, root);
    if (!(left > 0))
        return 0;
    double q = -(b + copysign(sqrt(left), b));
    double x = q / a, y = c[0] / q, first = fmin(x, y), second = fmax(x, y);
    if (first > low && first < high)
        root[n++] = first;
    if (second > low && second < high)
        root[n++] = second;
    return n;
}

/* Between the places where the polynomial turns, and the ends; turn has room
 * for one more. */
INLINE int roots_between(int degree, const double c[], double low, double high, double turn[],
                         int n_turn, double root[])
{
    double from = low, before = value_at(degree, c, low);
    int n = 0;

    turn[n_turn++] = high;
    for (int i = 0; i < n_turn; i++) {
        double after = value_at(degree, c, turn[i]);
        if ((before < 0 && after > 0) || (before > 0 && after < 0))
            root[n++] = root_between(degree, c, from, turn[i], after > 0);
        if (after != 0) {               /* a zero belongs to the next change of sign */
            before = after;
            from = turn[i];
        }
    }
    return n;
}

static int roots_of_cubic(const double c[], double low, double high, double root[])
{
    const double slope[] = { c[1], 2 * c[2], 3 * c[3] };
    double turn[3];
    int n = roots_of_parabola(slope, low, high, turn);

    return roots_between(3, c, low, high, turn, n, root);
}

int poly_roots(int degree, const double c[], double low, double high, double root[])
{
    double slope[POLY_MOST], turn[POLY_MOST + 1];

    while (degree > 0 && c[degree] == 0)
        degree--;
    if (degree <= 0 || degree > POLY_MOST)
        return 0;
    if (degree == 1)
        return roots_of_line(c, low, high, root);
    if (degree == 2)
        return roots_of_parabola(c, low, high, root);
    if (degree == 3)
        return roots_of_cubic(c, low, high, root);

    for (int i = 1; i <= degree; i++)
        slope[i - 1] = i * c[i];
    int n_turn = poly_roots(degree - 1, slope, low, high, turn);
    return roots_between(degree, c, low, high, turn, n_turn, root);
}
