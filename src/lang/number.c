/* number.c: decimal numbers, in the C locale whatever the user's is. */
#include "lang/number.h"

#include <ctype.h>
#include <locale.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

enum { EXACT_POWERS = 22, LONGEST = 400 };

/* The powers of ten that doubles hold exactly. */
static const double powers[EXACT_POWERS + 1] = {
    1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16,
    1e17, 1e18, 1e19, 1e20, 1e21, 1e22,
};

/* The library knows how to round any number of digits, but wants the
 * locale's decimal point. */
static double slowly(const char *begin, const char *end)
{
    char copy[LONGEST + 1];
    size_t n = (size_t)(end - begin);

    if (n > LONGEST)
        n = LONGEST;
    memcpy(copy, begin, n);
    copy[n] = '\0';
    char *point = strchr(copy, '.');
    const char *wanted = localeconv()->decimal_point;
    if (point && wanted[0] != '.' && wanted[1] == '\0')
        *point = wanted[0];
    return strtod(copy, NULL);
}

/* Up to 19 digits without overflow; more are left to slowly(). */
static char *digits(char *p, uint64_t *value)
{
    for (unsigned digit; (digit = (unsigned)*p - '0') <= 9; p++)
        *value = *value * 10 + digit;
    return p;
}

static char *exponent(char *p, int *e)
{
    bool minus = false;
    int value = 0;

    if (*p != 'e' && *p != 'E')
        return p;
    p++;
    if (*p == '+' || *p == '-')
        minus = *p++ == '-';
    for (; *p >= '0' && *p <= '9'; p++)
        value = value < 10000 ? value * 10 + (*p - '0') : value;
    *e += minus ? -value : value;
    return p;
}

/* A mantissa below 2^53 times or over an exact power of ten is rounded once:
 * the result is the nearest double. */
char *number_scan(char *p, double *out)
{
    char *begin = p;
    uint64_t mantissa = 0;
    int e = 0;

    p = digits(p, &mantissa);
    if (*p == '.') {
        char *point = p++;
        p = digits(p, &mantissa);
        e = -(int)(p - point - 1);
    }
    ptrdiff_t n = p - begin;            /* and perhaps a point */
    p = exponent(p, &e);
    if (n > 19 || mantissa > (uint64_t)1 << 53 || e < -EXACT_POWERS || e > EXACT_POWERS)
        *out = slowly(begin, p);
    else
        *out = e < 0 ? (double)mantissa / powers[-e] : (double)mantissa * powers[e];
    return p;
}

double number_read(const char *begin, const char *end)
{
    double value;

    (void)end;
    number_scan((char *)begin, &value);
    return value;
}

double number_of_text(const char *text)
{
    size_t n = 0;

    while (isspace((unsigned char)*text))
        text++;
    while (text[n] && !isspace((unsigned char)text[n]))
        n++;
    return slowly(text, text + n);
}
