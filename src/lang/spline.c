/* spline.c: spline { }: values between given ones. */
#include <string.h>

#include "lang/code.h"
#include "lang/eval.h"
#include "lang/frame.h"
#include "lang/function.h"

enum spline_type { SPLINE_LINEAR, SPLINE_QUADRATIC, SPLINE_CUBIC, SPLINE_NATURAL };

struct knot { double t, v[5]; double bend[5]; };    /* bend: second derivative, natural splines */

struct spline {
    enum spline_type type;
    int n_component;
    size_t n;
    struct knot *knot;
};

static const char *const type_words[] = { "linear_spline", "quadratic_spline", "cubic_spline",
                                          "natural_spline" };

int spline_components(const struct spline *s)
{
    return s->n_component;
}

/* --- evaluation --------------------------------------------------------------- */

static size_t segment(const struct spline *s, double t)
{
    size_t low = 0, high = s->n - 1;

    while (high - low > 1) {
        size_t middle = (low + high) / 2;
        if (s->knot[middle].t <= t)
            low = middle;
        else
            high = middle;
    }
    return low;
}

static double linear(const struct knot *k, double t, int c)
{
    double u = (t - k[0].t) / (k[1].t - k[0].t);

    return k[0].v[c] + u * (k[1].v[c] - k[0].v[c]);
}

/* The parabola through three points (Lagrange). */
static double quadratic(const struct spline *s, size_t i, double t, int c)
{
    if (s->n == 2)
        return linear(s->knot, t, c);
    const struct knot *k = &s->knot[i ? i - 1 : 0];
    double a = k[0].t, b = k[1].t, d = k[2].t;
    return k[0].v[c] * (t - b) * (t - d) / ((a - b) * (a - d))
        + k[1].v[c] * (t - a) * (t - d) / ((b - a) * (b - d))
        + k[2].v[c] * (t - a) * (t - b) / ((d - a) * (d - b));
}

static double natural(const struct knot *k, double t, int c)
{
    double h = k[1].t - k[0].t, a = (k[1].t - t) / h, b = (t - k[0].t) / h;

    return a * k[0].v[c] + b * k[1].v[c]
        + ((a * a * a - a) * k[0].bend[c] + (b * b * b - b) * k[1].bend[c]) * h * h / 6;
}

static double slope(const struct knot *k, int c)
{
    return (k[1].v[c] - k[0].v[c]) / (k[1].t - k[0].t);
}

/* Between the second and the last but one point; the tangent at a point is
 * the mean of the slopes beside it. */
static double cubic(const struct spline *s, size_t i, double t, int c)
{
    const struct knot *k = &s->knot[i];
    double h = k[1].t - k[0].t, u = (t - k[0].t) / h;
    double m0 = (slope(k - 1, c) + slope(k, c)) / 2 * h;
    double m1 = (slope(k, c) + slope(k + 1, c)) / 2 * h;
    double u2 = u * u, u3 = u2 * u;

    return (2 * u3 - 3 * u2 + 1) * k[0].v[c] + (u3 - 2 * u2 + u) * m0
        + (3 * u2 - 2 * u3) * k[1].v[c] + (u3 - u2) * m1;
}

static void cubic_at(const struct spline *s, double t, double *out)
{
    const struct knot *k = s->knot;

    for (int c = 0; c < s->n_component; c++) {
        if (s->n == 1)
            out[c] = k[0].v[c];
        else if (s->n == 2)
            out[c] = (k[0].v[c] + k[1].v[c]) / 2;
        else if (t <= k[1].t)
            out[c] = k[1].v[c];
        else if (t >= k[s->n - 2].t)
            out[c] = k[s->n - 2].v[c];
        else
            out[c] = cubic(s, segment(s, t), t, c);
    }
}

void spline_at(const struct spline *s, double t, int type, double *out)
{
    const struct knot *last = &s->knot[s->n - 1];

    type = type < 0 ? (int)s->type : type;
    if (type == SPLINE_CUBIC && s->n > 1 && t > s->knot[0].t && t < last->t) {
        cubic_at(s, t, out);
        return;
    }
    if (t <= s->knot[0].t || t >= last->t) {
        if (type == SPLINE_CUBIC && s->n > 1)
            cubic_at(s, t, out);
        else
            memcpy(out, t <= s->knot[0].t ? s->knot[0].v : last->v,
                   (size_t)s->n_component * sizeof *out);
        return;
    }
    size_t i = segment(s, t);
    for (int c = 0; c < s->n_component; c++)
        out[c] = type == SPLINE_LINEAR ? linear(&s->knot[i], t, c)
            : type == SPLINE_QUADRATIC ? quadratic(s, i, t, c) : natural(&s->knot[i], t, c);
}

/* --- making one ------------------------------------------------------------------ */

/* Second derivatives of the natural cubic: a tridiagonal system, 0 at the ends. */
static void solve_bends(const struct lang *l, const struct spline *s)
{
    size_t n = s->n;
    struct knot *k = s->knot;

    if (n < 3)
        return;
    double *factor = arena_array(l->mem, n, sizeof *factor);
    for (int c = 0; c < s->n_component; c++) {
        for (size_t i = 1; i + 1 < n; i++) {
            double h0 = k[i].t - k[i - 1].t, h1 = k[i + 1].t - k[i].t;
            double right = 6 * (slope(&k[i], c) - slope(&k[i - 1], c));
            double diagonal = 2 * (h0 + h1) - h0 * (i > 1 ? factor[i - 1] : 0);
            factor[i] = h1 / diagonal;
            k[i].bend[c] = (right - (i > 1 ? h0 * k[i - 1].bend[c] : 0)) / diagonal;
        }
        for (size_t i = n - 2; i-- > 1;)
            k[i].bend[c] -= factor[i] * k[i + 1].bend[c];
    }
}

/* Sorted; the same parameter again replaces, but not at the end of several: there
 * the new value is lost, as in POV-Ray. */
static void insert(struct spline *s, struct knot new)
{
    size_t i = s->n;

    if (s->n > 1 && new.t == s->knot[s->n - 1].t)
        return;
    while (i && s->knot[i - 1].t > new.t)
        i--;
    if (i && s->knot[i - 1].t == new.t) {
        s->knot[i - 1] = new;
        return;
    }
    memmove(s->knot + i + 1, s->knot + i, (s->n - i) * sizeof *s->knot);
    s->knot[i] = new;
    s->n++;
}

static int type_of(const struct item *i)
{
    for (int k = 0; i->kind == ITEM_WORD && k < 4; k++)
        if (word_is(i->word, type_words[k]))
            return k;
    return -1;
}

static bool read_knot(struct reader *r, struct spline *s)
{
    struct knot k = { .t = reader_number(r, false, "a number, the parameter of a point") };

    reader_skip_comma(r);
    const struct item *i = reader_peek(r);
    if (r->failed)
        return false;
    if (i->kind != ITEM_VALUE || !value_is_number(&i->value)) {
        diag_error(r->lang->diag, reader_at(r), "expected the value of the spline's point, found %s",
                   item_describe(r->lang, i));
        return false;
    }
    int n = i->value.n < 2 ? 2 : i->value.n;
    for (int c = 0; c < n || (i->value.rest == REST_KEPT && c < MOST_COMPONENTS); c++)
        k.v[c] = c == 1 && i->value.n == 1 ? i->value.v[0] : value_component(&i->value, c);
    s->n_component = n > s->n_component ? n : s->n_component;
    reader_next(r);
    insert(s, k);
    reader_skip_comma(r);
    return true;
}

static void copy_spline(struct lang *l, struct spline *s, const struct spline *from)
{
    *s = *from;
    s->knot = arena_copy(l->scene_mem, from->knot, from->n * sizeof *from->knot);
}

bool spline_make(struct lang *l, const struct ast *node, struct value *out)
{
    struct spline *s = arena_alloc(l->scene_mem, sizeof *s);
    size_t room = 0;
    struct reader r;
    bool fine = true;

    s->n_component = 2;
    *out = value_thing(VALUE_SPLINE, s);
    reader_open(&r, l, node->body);
    if (reader_peek(&r)->kind == ITEM_VALUE && reader_peek(&r)->value.type == VALUE_SPLINE) {
        copy_spline(l, s, reader_next(&r).value.thing);
        room = s->n;
        reader_skip_comma(&r);
    }
    for (int type; (type = type_of(reader_peek(&r))) >= 0; reader_skip_comma(&r)) {
        s->type = (enum spline_type)type;
        reader_next(&r);
    }
    while (fine && !l->stopped && reader_peek(&r)->kind != ITEM_END) {
        s->knot = arena_grow(l->scene_mem, s->knot, s->n, &room, sizeof *s->knot);
        fine = read_knot(&r, s);
    }
    if (fine && s->n == 0 && !r.failed)
        diag_error(l->diag, node->at, "a spline without points");
    fine = fine && s->n;
    reader_close(&r);
    if (!s->n) {
        s->knot = arena_alloc(l->scene_mem, sizeof *s->knot);
        s->n = 1;
    }
    solve_bends(l, s);
    return fine;
}

/* S(t) or S(t, linear_spline) */
void spline_call(struct lang *l, const struct ast *node, const struct spline *s,
                 struct value *out)
{
    struct reader r;
    double t, v[5];
    int type = -1;

    reader_open(&r, l, node->args);
    t = reader_number(&r, false, "a number");
    if (!r.failed && reader_peek(&r)->kind == ITEM_COMMA) {
        reader_next(&r);
        type = type_of(reader_peek(&r));
        if (type < 0)
            diag_error(l->diag, reader_at(&r), "expected the type of a spline");
        else
            reader_next(&r);
    }
    if (!r.failed && reader_peek(&r)->kind != ITEM_END)
        diag_error(l->diag, reader_at(&r), "a spline takes a number, perhaps a comma and a type");
    reader_close(&r);
    spline_at(s, t, type, v);
    *out = value_vector(s->n_component, v);
}
