/* code.c: running compiled functions. */
#include "lang/code.h"

#include <math.h>
#include <string.h>

enum { LANES = 32, ROUNDS_OF_CALL = 8 };

static const double most_rounds = 1e9;  /* of one call while a picture is made */

/* Threads share functions, so that only the reader of the scene may let them remember. */
struct run {
    bool remember;
    double left;                /* rounds of sums and calls of functions; then the result is NaN */
};

/* What runs: arrays of n values, stride apart. */
struct machine {
    double *reg;
    int stride, n;
    struct run *run;
};

static void run(const struct machine *m, const struct code *code, size_t n_code);
static double grey(colour c)
{
    return (double)((0.297f * c.r + 0.589f * c.g) + 0.114f * c.b);
}

static void run_one(const struct function *f, const double *arguments, double *out, struct run *now);

#define EACH(expression) \
    for (int i = 0; i < n; i++) \
        r[i] = (expression); \
    break

/* As POV-Ray's machine has it where one of them is no number. */
static double least(double a, double b) { return a <= b ? a : b; }
static double most(double a, double b) { return b > a ? b : a; }
static double sign_of(double x, double a, double b, double c) { return x < 0 ? a : x == 0 ? b : c; }

static void call(const struct machine *m, const struct code *c, double *r)
{
    double argument[MOST_PARAMETERS] = { 0 }, out[MOST_COMPONENTS];

    for (int i = 0; i < m->n; i++) {
        if ((m->run->left -= ROUNDS_OF_CALL) < 0) {
            r[i] = NAN;
            continue;
        }
        for (int k = 0; k < c->function->n_parameter; k++)
            argument[k] = r[k * m->stride + i];
        run_one(c->function, argument, out, m->run);
        r[i] = out[c->from];
    }
}

/* The counter takes the register behind the two bounds. */
static void repeat(const struct machine *m, const struct code *c)
{
    int stride = m->stride;
    double *r = m->reg + (size_t)c->to * (size_t)stride;

    for (int i = 0; i < m->n; i++) {
        struct machine one = { m->reg + i, stride, 1, m->run };
        double end = r[stride + i], total = c->op == CODE_SUM ? 0 : 1;
        for (double k = r[i]; k <= end; k++) {
            r[2 * stride + i] = k;
            run(&one, c + 1, c->count);
            total = c->op == CODE_SUM ? total + r[3 * stride + i] : total * r[3 * stride + i];
            if (k + 1 == k || --m->run->left < 0)
                break;
        }
        r[i] = m->run->left < 0 ? NAN : total;
    }
}

static void run(const struct machine *m, const struct code *code, size_t n_code)
{
    double *reg = m->reg;
    int stride = m->stride, n = m->n;

    for (const struct code *c = code; c < code + n_code; c++) {
        double *r = reg + (size_t)c->to * (size_t)stride, *s = r + stride;
        const double *from = reg + (size_t)c->from * (size_t)stride;
        switch (c->op) {
        case CODE_NUMBER: EACH(c->number);
        case CODE_MOVE: EACH(from[i]);
        case CODE_ADD: EACH(r[i] + s[i]);
        case CODE_SUB: EACH(r[i] - s[i]);
        case CODE_MUL: EACH(r[i] * s[i]);
        case CODE_DIV: EACH(r[i] / s[i]);
        case CODE_LT: EACH(r[i] < s[i]);
        case CODE_LE: EACH(r[i] <= s[i]);
        case CODE_EQ: EACH(r[i] == s[i]);
        case CODE_NE: EACH(r[i] != s[i]);
        case CODE_GE: EACH(!(r[i] < s[i]));
        case CODE_GT: EACH(!(r[i] <= s[i]));
        case CODE_AND: EACH(r[i] != 0 && s[i] != 0);
        case CODE_OR: EACH(r[i] != 0 || s[i] != 0);
        case CODE_MIN: EACH(least(r[i], s[i]));
        case CODE_MAX: EACH(most(r[i], s[i]));
        case CODE_NEG: EACH(-r[i]);
        case CODE_ONE: EACH(c->one(r[i]));
        case CODE_TWO: EACH(c->two(r[i], s[i]));
        case CODE_SELECT3: EACH(r[i] < 0 ? s[i] : s[stride + i]);
        case CODE_SELECT4: EACH(sign_of(r[i], s[i], s[stride + i], s[2 * stride + i]));
        case CODE_CALL: call(m, c, r); break;
        default:
            repeat(m, c);
            c += c->count;
        }
    }
}

static double internal_value(const struct function *f, const double *a, bool remember)
{
    struct octave_weights *w = f->weights;
    struct internal_setting setting = { *f->noise_generator,
                                        w && (remember || w->known) ? w : NULL };

    return f->internal->at(a[0], a[1], a[2], a + 3, &setting);
}

static void run_one(const struct function *f, const double *arguments, double *out, struct run *now)
{
    vec3 p = vec(arguments[0], arguments[1], arguments[2]);   /* there is room for three at least */

    switch (f->kind) {
    case FUNCTION_CODE: {
        double reg[f->n_register];
        memcpy(reg, arguments, (size_t)f->n_parameter * sizeof *reg);
        run(&(struct machine) { reg, 1, 1, now }, f->code, f->n_code);
        out[0] = reg[f->n_parameter];
        return;
    }
    case FUNCTION_TRANSFORM: {
        vec3 to = mat_point(&f->transform->to, p);
        memcpy(out, (double[]) { to.x, to.y, to.z }, 3 * sizeof *out);
        return;
    }
    case FUNCTION_PIGMENT: {
        colour c = pigment_at(f->pigment, p);
        memcpy(out, (double[]) { c.r, c.g, c.b, c.f, c.t }, 5 * sizeof *out);
        return;
    }
    case FUNCTION_SPLINE: spline_at(f->spline, arguments[0], -1, out); return;
    case FUNCTION_INTERNAL: out[0] = internal_value(f, arguments, now->remember); return;
    case FUNCTION_GREY: out[0] = grey(pigment_at(f->pigment, p)); return;
    case FUNCTION_PATTERN: out[0] = pattern_at(f->pattern, f->transform, p); return;
    }
}

void function_run(const struct function *f, const double *arguments, double *out, double *left)
{
    double padded[MOST_PARAMETERS] = { 0 };
    struct run now = { true, left ? *left : most_rounds };

    memcpy(padded, arguments, (size_t)f->n_parameter * sizeof *padded);
    run_one(f, padded, out, &now);
    if (left)
        *left = now.left;
}

void function_many(const struct function *f, int n, const double *const *arguments, double *out,
                   double *left)
{
    struct run now = { false, left ? *left : most_rounds };

    if (f->kind != FUNCTION_CODE) {
        double argument[MOST_PARAMETERS] = { 0 }, component[MOST_COMPONENTS];
        for (int i = 0; i < n; i++) {
            for (int k = 0; k < f->n_parameter; k++)
                argument[k] = arguments[k][i];
            run_one(f, argument, component, &now);
            out[i] = component[0];
        }
        if (left)
            *left = now.left;
        return;
    }
    double reg[(size_t)f->n_register * LANES];
    for (int first = 0; first < n; first += LANES) {
        int lanes = n - first < LANES ? n - first : LANES;
        for (int k = 0; k < f->n_parameter; k++)
            memcpy(reg + k * LANES, arguments[k] + first, (size_t)lanes * sizeof *reg);
        run(&(struct machine) { reg, LANES, lanes, &now }, f->code, f->n_code);
        memcpy(out + first, reg + f->n_parameter * LANES, (size_t)lanes * sizeof *reg);
    }
    if (left)
        *left = now.left;
}

void function_values(const void *self, int n, const double *x, const double *y, const double *z,
                     double *value)
{
    function_many(self, n, (const double *[]) { x, y, z }, value, NULL);
}

double function_at(const struct function *f, const double *arguments)
{
    double out[MOST_COMPONENTS];

    function_run(f, arguments, out, NULL);
    return out[0];
}

int function_parameters(const struct function *f) { return f->n_parameter; }
int function_components(const struct function *f) { return f->n_component; }
