/* code.h: what function { } is compiled to.
 *
 * A small register code that runs over arrays of points: parameter i is
 * register i, operands wait in the registers behind. */
#ifndef RTC_CODE_H
#define RTC_CODE_H

#include "lang/state.h"
#include "math/internal.h"

enum operation {
    CODE_NUMBER, CODE_MOVE,                     /* to = number (count: no parentheses around it);
                                                   to = register from */
    CODE_ADD, CODE_SUB, CODE_MUL, CODE_DIV,     /* to = to op to + 1 */
    CODE_LT, CODE_LE, CODE_EQ, CODE_NE, CODE_GE, CODE_GT, CODE_AND, CODE_OR,
    CODE_MIN, CODE_MAX,
    CODE_NEG,                                   /* to = -to */
    CODE_ONE, CODE_TWO,                         /* functions of one and two numbers */
    CODE_SELECT3, CODE_SELECT4,
    CODE_CALL,                                  /* another function; from: which component */
    CODE_SUM, CODE_PROD,                        /* over to .. to + 1; the next count codes are the term */
};

struct code {
    uint16_t op;                                /* enum operation */
    uint16_t from;
    uint32_t to, count;
    union {
        double number;
        double (*one)(double);
        double (*two)(double, double);
        const struct function *function;
    };
};

enum function_kind { FUNCTION_CODE, FUNCTION_TRANSFORM, FUNCTION_SPLINE, FUNCTION_INTERNAL,
                     FUNCTION_PATTERN, FUNCTION_PIGMENT, FUNCTION_GREY };

struct function {
    enum function_kind kind;
    int n_parameter, n_component, n_register;
    bool is_recursive;                  /* it must not be called */
    struct code *code;
    size_t n_code;
    const struct transform *transform;  /* its own, or where the pattern is */
    const struct spline *spline;
    const struct pattern_use *pattern;
    const struct pigment *pigment;      /* PIGMENT, GREY: of its colour */
    const struct internal *internal;
    const int *noise_generator;         /* the scene's */
    struct octave_weights *weights;     /* what its first call leaves behind */
    struct nest nest;
    const char *unsupported;            /* not NULL: it cannot be called, for what it needs */
    struct loc at;
};

enum { MOST_PARAMETERS = 55 };

/* Components at one point, while the scene is read.  left: rounds of sums and calls that it
 * may take, below 0 if it took more; NULL: the usual number. */
void function_run(const struct function *f, const double *arguments, double *out, double *left);
/* A float function at n points: arguments[i] are the n values of parameter i.  Threads may share
 * f.  left: as above. */
void function_many(const struct function *f, int n, const double *const *arguments, double *out,
                   double *left);

/* A function of x, y, z for the rest of the program: self is the function. */
void function_values(const void *self, int n, const double *x, const double *y, const double *z,
                     double *value);

void spline_at(const struct spline *s, double t, int type, double *out);   /* type -1: its own */
int spline_components(const struct spline *s);

#endif
