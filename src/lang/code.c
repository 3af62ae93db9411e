/* code.c: running compiled functions. */
#include "lang/code.h"

#include <math.h>
#include <string.h>

enum { LANES = 32 };

static void run(const struct function *f, const struct code *code, size_t n_code, double *reg,
                int stride, int n);

#define EACH(expression) \
    for (int i = 0; i < n; i++) \
        r[i] = (expression); \
    break

static double least(double a, double b) { return b < a ? b : a; }
static double most(double a, double b) { return b > a ? b : a; }
static double sign_of(double x, double a, double b, double c) { return x < 0 ? a : x == 0 ? b : c; }

static void call(const struct code *c, double *r, int stride, int n)
{
    double argument[MOST_PARAMETERS], out[MOST_COMPONENTS];

    for (int i = 0; i < n; i++) {
        for (int k = 0; k < c->function->n_parameter; k++)
            argument[k] = r[k * stride + i];
        function_run(c->function, argument, out);
        r[i] = out[c->from];
    }
}

/* The counter takes the register behind the two bounds. */
static void repeat(const struct function *f, const struct code *c, double *reg, int stride, int n)
{
    double *r = reg + (size_t)c->to * (size_t)stride;

    for (int i = 0; i < n; i++) {
        double end = r[stride + i], total = c->op == CODE_SUM ? 0 : 1;
        for (double k = r[i]; k <= end; k++) {
            r[2 * stride + i] = k;
            run(f, c + 1, c->count, reg + i, stride, 1);
            total = c->op == CODE_SUM ? total + r[3 * stride + i] : total * r[3 * stride + i];
            if (k + 1 == k)
                break;
        }
        r[i] = total;
    }
}

static void run(const struct function *f, const struct code *code, size_t n_code, double *reg,
                int stride, int n)
{
    for (const struct code *c = code; c < code + n_code; c++) {
        double *r = reg + (size_t)c->to * (size_t)stride, *s = r + stride;
        const double *from = reg + (size_t)c->from * (size_t)stride;
        switch (c->op) {
        case CODE_NUMBER: EACH(c->number);
        case CODE_MOVE: EACH(from[i]);
        case CODE_ADD: EACH(r[i] + s[i]);
        case CODE_SUB: EACH(r[i] - s[i]);
        case CODE_MUL: EACH(r[i] * s[i]);
        case CODE_DIV: EACH(s[i] == 0 ? HUGE_VAL : r[i] / s[i]);
        case CODE_LT: EACH(r[i] < s[i]);
        case CODE_LE: EACH(r[i] <= s[i]);
        case CODE_EQ: EACH(r[i] == s[i]);
        case CODE_NE: EACH(r[i] != s[i]);
        case CODE_GE: EACH(r[i] >= s[i]);
        case CODE_GT: EACH(r[i] > s[i]);
        case CODE_AND: EACH(r[i] != 0 && s[i] != 0);
        case CODE_OR: EACH(r[i] != 0 || s[i] != 0);
        case CODE_MIN: EACH(least(r[i], s[i]));
        case CODE_MAX: EACH(most(r[i], s[i]));
        case CODE_NEG: EACH(-r[i]);
        case CODE_ONE: EACH(c->one(r[i]));
        case CODE_TWO: EACH(c->two(r[i], s[i]));
        case CODE_SELECT3: EACH(r[i] < 0 ? s[i] : s[stride + i]);
        case CODE_SELECT4: EACH(sign_of(r[i], s[i], s[stride + i], s[2 * stride + i]));
        case CODE_CALL: call(c, r, stride, n); break;
        default:
            repeat(f, c, reg, stride, n);
            c += c->count;
        }
    }
}

void function_run(const struct function *f, const double *arguments, double *out)
{
    switch (f->kind) {
    case FUNCTION_CODE: {
        double reg[f->n_register];
        memcpy(reg, arguments, (size_t)f->n_parameter * sizeof *reg);
        run(f, f->code, f->n_code, reg, 1, 1);
        out[0] = reg[f->n_parameter];
        return;
    }
    case FUNCTION_TRANSFORM: {
        vec3 p = mat_point(&f->transform->to, vec(arguments[0], arguments[1], arguments[2]));
        out[0] = p.x;
        out[1] = p.y;
        out[2] = p.z;
        return;
    }
    case FUNCTION_SPLINE: spline_at(f->spline, arguments[0], -1, out); return;
    default: memset(out, 0, (size_t)f->n_component * sizeof *out);
    }
}

void function_many(const struct function *f, int n, const double *const *arguments, double *out)
{
    if (f->kind != FUNCTION_CODE) {
        double argument[MOST_PARAMETERS], component[MOST_COMPONENTS];
        for (int i = 0; i < n; i++) {
            for (int k = 0; k < f->n_parameter; k++)
                argument[k] = arguments[k][i];
            function_run(f, argument, component);
            out[i] = component[0];
        }
        return;
    }
    double reg[(size_t)f->n_register * LANES];
    for (int first = 0; first < n; first += LANES) {
        int lanes = n - first < LANES ? n - first : LANES;
        for (int k = 0; k < f->n_parameter; k++)
            memcpy(reg + k * LANES, arguments[k] + first, (size_t)lanes * sizeof *reg);
        run(f, f->code, f->n_code, reg, LANES, lanes);
        memcpy(out + first, reg + f->n_parameter * LANES, (size_t)lanes * sizeof *reg);
    }
}

double function_at(const struct function *f, const double *arguments)
{
    double out[MOST_COMPONENTS];

    function_run(f, arguments, out);
    return out[0];
}

int function_parameters(const struct function *f) { return f->n_parameter; }
int function_components(const struct function *f) { return f->n_component; }
