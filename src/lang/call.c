/* call.c: built-in functions and constants, a row each. */
#include "lang/call.h"

#include <math.h>
#include <string.h>
#include <time.h>

#include "lang/array.h"
#include "lang/eval.h"
#include "lang/file.h"
#include "lang/scope.h"
#include "math/mat.h"
#include "math/noise.h"

static const double near = 1e-10;       /* POV-Ray's tolerance in comparisons */

/* --- numbers ---------------------------------------------------------------- */

/* One factor, as POV-Ray has it: the last bits of angles depend on it. */
static double degrees(double x) { return x / (M_PI / 180); }
static double radians(double x) { return x * (M_PI / 180); }

/* POV-Ray goes through a 32-bit int, as x86 converts: what does not fit
 * becomes its smallest value. */
static double to_int(double x)
{
    return x >= -2147483648.0 && x < 2147483648.0 ? (double)(int32_t)x : -2147483648.0;
}

/* fmod, by way of integers where that is exact: five times as fast. */
static double remainder_of(double a, double b)
{
    int64_t i = fabs(a) < 1e15 ? (int64_t)a : 0, k = fabs(b) < 1e15 ? (int64_t)b : 0;

    if (k == 0 || (double)i != a || (double)k != b)
        return fmod(a, b);
    return copysign((double)(i % k), a);
}

static double divide(double a, double b) { return to_int(a / b); }

static void refuse(struct arguments *a, const char *message)
{
    diag_error(a->l->diag, a->node->at, "%s: %s", a->call->name, message);
}

static void one(struct value *out, double x)
{
    *out = value_number(x);
}

static double arg(const struct arguments *a, int i)
{
    return a->v[i].v[0];
}

static void call_arc(struct arguments *a, struct value *out)
{
    double x = arg(a, 0);

    if (x < -1 || x > 1)
        diag_warning(a->l->diag, a->node->at, "%s of a number outside of -1 to 1: taken as %d",
                     a->call->name, x < 0 ? -1 : 1);
    x = x < -1 ? -1 : x > 1 ? 1 : x;            /* what is no number stays so */
    one(out, a->call->name[1] == 'c' ? acos(x) : asin(x));
}

static void call_atan2(struct arguments *a, struct value *out)
{
    if (fabs(arg(a, 0)) < near && fabs(arg(a, 1)) < near) {
        refuse(a, "both arguments are 0");
        one(out, 0);
    } else
        one(out, atan2(arg(a, 0), arg(a, 1)));
}

static void call_logarithm(struct arguments *a, struct value *out)
{
    double x = arg(a, 0);

    one(out, 0);
    if (x <= 0)
        refuse(a, "the argument is not above 0");
    else
        one(out, a->call->name[1] == 'n' ? log(x) : log10(x));
}

static void call_sqrt(struct arguments *a, struct value *out)
{
    double x = arg(a, 0);

    one(out, x < 0 ? 0 : sqrt(x));
    if (x < 0)
        refuse(a, "the argument is negative");
}

static void call_pow(struct arguments *a, struct value *out)
{
    one(out, 1);
    if (arg(a, 0) == 0 && arg(a, 1) == 0)
        refuse(a, "both arguments are 0");
    else
        one(out, pow(arg(a, 0), arg(a, 1)));
}

static void call_min(struct arguments *a, struct value *out)
{
    double x = arg(a, 0);

    for (int i = 1; i < a->n; i++)
        x = arg(a, i) < x ? arg(a, i) : x;
    one(out, x);
}

static void call_max(struct arguments *a, struct value *out)
{
    double x = arg(a, 0);

    for (int i = 1; i < a->n; i++)
        x = arg(a, i) > x ? arg(a, i) : x;
    one(out, x);
}

static void call_select(struct arguments *a, struct value *out)
{
    const struct ast *list = a->node->args;
    double x = arg(a, 0);

    if (a->n == 4 && list->flags & AST_PLAIN && !(list->flags & AST_COMMA_BEFORE))
        refuse(a, "a comma must stand before the fourth argument");
    one(out, x < 0 ? arg(a, 1) : x == 0 || a->n == 3 ? arg(a, 2) : arg(a, 3));
}

static int32_t bits(double x) { return (int32_t)to_int(x); }

static void call_bitwise(struct arguments *a, struct value *out)
{
    char op = a->call->name[8];         /* bitwise_and, _or, _xor */
    int32_t x = bits(arg(a, 0));

    for (int i = 1; i < a->n; i++) {
        int32_t y = bits(arg(a, i));
        x = op == 'a' ? x & y : op == 'o' ? x | y : x ^ y;
    }
    one(out, x);
}

/* --- random numbers ----------------------------------------------------------- */

struct stream { uint32_t state; };

static void call_seed(struct arguments *a, struct value *out)
{
    struct lang *l = a->l;

    l->stream = arena_grow(l->mem, l->stream, l->n_stream, &l->room_stream, sizeof *l->stream);
    l->stream[l->n_stream].state = (uint32_t)bits(arg(a, 0));
    one(out, (double)l->n_stream++);
}

static void call_rand(struct arguments *a, struct value *out)
{
    double number = to_int(arg(a, 0));

    one(out, 0);
    if (number < 0 || number >= (double)a->l->n_stream) {
        diag_error(a->l->diag, a->node->at, "rand of a stream that no seed() has made");
        return;
    }
    struct stream *s = &a->l->stream[(size_t)number];
    s->state = s->state * 1812433253u + 12345u;
    one(out, (double)s->state / 4294967295.0);
}

/* --- vectors ------------------------------------------------------------------- */

static vec3 point(const struct arguments *a, int i)
{
    return vec(a->v[i].v[0], a->v[i].v[1], a->v[i].v[2]);
}

static void three(struct value *out, vec3 p)
{
    *out = value_vector(3, (double[]) { p.x, p.y, p.z });
}

static void call_vdot(struct arguments *a, struct value *out)
{
    one(out, vec_dot(point(a, 0), point(a, 1)));
}

static void call_vlength(struct arguments *a, struct value *out)
{
    one(out, vec_length(point(a, 0)));
}

static void call_vcross(struct arguments *a, struct value *out)
{
    three(out, vec_cross(point(a, 0), point(a, 1)));
}

static void call_vnormalize(struct arguments *a, struct value *out)
{
    vec3 p = point(a, 0);
    double length = vec_length(p);
    bool is_zero = p.x == 0 && p.y == 0 && p.z == 0;

    if (is_zero)
        diag_warning(a->l->diag, a->node->at, "vnormalize of a zero vector");
    three(out, is_zero ? p : vec(p.x / length, p.y / length, p.z / length));
}

static void call_vrotate(struct arguments *a, struct value *out)
{
    struct transform t = transform_rotate(point(a, 1));

    three(out, mat_point(&t.to, point(a, 0)));
}

static void call_vaxis_rotate(struct arguments *a, struct value *out)
{
    struct transform t = transform_axis_rotate(point(a, 1), a->v[2].v[0]);

    three(out, mat_point(&t.to, point(a, 0)));
}

static void call_vturbulence(struct arguments *a, struct value *out)
{
    double octaves = fmax(1, fmin(NOISE_MOST_OCTAVES, arg(a, 2)));

    /* POV-Ray keeps omega and lambda in single precision. */
    three(out, noise_vector_turbulence(point(a, 3), (int)octaves, (float)arg(a, 1),
                                       (float)arg(a, 0)));
}

/* --- arrays, names, files ------------------------------------------------------- */

static void call_dimensions(struct arguments *a, struct value *out)
{
    one(out, array_dimensions(a->v[0].thing));
}

static void call_dimension_size(struct arguments *a, struct value *out)
{
    one(out, (double)array_size(a->v[0].thing, value_whole(arg(a, 1))));
}

static void call_defined(struct arguments *a, struct value *out)
{
    one(out, array_is_defined(a->l, a->from[0]));
}

static void call_file_exists(struct arguments *a, struct value *out)
{
    one(out, file_exists(a->l, a->from[0]->at, a->v[0].text.bytes));
}

/* --- objects -------------------------------------------------------------------- */

static const char *what_lacks(const struct object *o)
{
    const char *lacks = o->more->unsupported;

    for (size_t i = 0; i < o->n_child && !lacks; i++)
        lacks = what_lacks(o->child[i]);
    return lacks;
}

/* What is to be known of an object, looked up once: there may be millions of
 * parts, and of questions. */
struct asked { const char *lacks; bool has_inside; struct bounds extent; };

static const struct asked *asked_of(struct lang *l, const struct object *o)
{
    const void **known = intern_at(&l->asked, l->mem, &o, sizeof o);

    if (!*known) {
        struct asked *asked = arena_alloc(l->mem, sizeof *asked);
        asked->lacks = what_lacks(o);
        asked->has_inside = object_has_inside(o);
        asked->extent = object_extent(o);
        *known = asked;
    }
    return *known;
}

/* The answer is as if what is not supported were not there; what follows from
 * it may be no mistake of the scene. */
static bool is_unknown(struct arguments *a, const char *lacks)
{
    if (lacks)
        diag_unsupported(a->l->diag, a->node->at,
                         arena_format(a->l->mem, "%s of %s", a->call->name, lacks));
    a->l->guessed |= lacks != NULL;
    return lacks;
}

static void call_inside(struct arguments *a, struct value *out)
{
    const struct object *o = a->v[0].thing;
    const struct asked *asked = asked_of(a->l, o);

    if (!is_unknown(a, asked->lacks) && !asked->has_inside)
        refuse(a, "the object has no inside");
    one(out, object_inside(o, point(a, 1), &a->l->trees));
}

static void call_trace(struct arguments *a, struct value *out)
{
    vec3 hit = vec(0, 0, 0), normal = vec(0, 0, 0);

    is_unknown(a, asked_of(a->l, a->v[0].thing)->lacks);
    if (!object_trace(a->v[0].thing, point(a, 1), point(a, 2), &a->l->trees, &hit, &normal))
        hit = normal = vec(0, 0, 0);
    three(out, hit);
    struct value *place = a->n > 3 ? array_place(a->l, a->from[3]) : NULL;
    if (place)
        three(place, normal);
}

static double limited(double x) { return fmax(-1e10, fmin(1e10, x)) + 0.0; }

static void call_extent(struct arguments *a, struct value *out)
{
    bool low = a->call->name[1] == 'i';

    if (a->v[0].type == VALUE_PIGMENT) {
        const struct pigment *p = a->v[0].thing;
        const struct image *image = p->kind == PIGMENT_IMAGE ? p->image->image : NULL;
        three(out, image && !low ? vec(image->width, image->height, 0) : vec(0, 0, 0));
        return;
    }
    struct bounds b = asked_of(a->l, a->v[0].thing)->extent;
    vec3 p = low ? b.low : b.high;
    three(out, vec(limited(p.x), limited(p.y), limited(p.z)));
}

/* --- the table ------------------------------------------------------------------ */

#define MATH(name, function, help) \
    { name, help, "F", .of_one = function, .in_functions = true }
#define RUN(name, takes, function, help) { name, help, takes, .run = function }
#define BOTH(name, takes, function, help) \
    { name, help, takes, .run = function, .in_functions = true }

const struct call calls[] = {
    MATH("abs", fabs, "absolute value"),
    BOTH("acos", "F", call_arc, "arc cosine, in radians"),
    MATH("acosh", acosh, "inverse hyperbolic cosine"),
    RUN("asc", "S", call_asc, "code of a text's first character"),
    BOTH("asin", "F", call_arc, "arc sine, in radians"),
    MATH("asinh", asinh, "inverse hyperbolic sine"),
    MATH("atan", atan, "arc tangent, in radians"),
    BOTH("atan2", "FF", call_atan2, "angle of the point (second, first), in radians"),
    MATH("atanh", atanh, "inverse hyperbolic tangent"),
    { "bitwise_and", "bits that all arguments have", "F*", .run = call_bitwise, .commas = true },
    { "bitwise_or", "bits that some argument has", "F*", .run = call_bitwise, .commas = true },
    { "bitwise_xor", "bits that an odd number of arguments have", "F*", .run = call_bitwise,
      .commas = true },
    MATH("ceil", ceil, "next integer up"),
    RUN("chr", "F", call_chr, "the character of a code"),
    RUN("concat", "S*", call_concat, "texts joined to one"),
    MATH("cos", cos, "cosine of radians"),
    MATH("cosh", cosh, "hyperbolic cosine"),
    RUN("datetime", "F|S", call_datetime, "days since 2000 as a text"),
    RUN("defined", "D", call_defined, "is a name declared?"),
    MATH("degrees", degrees, "radians in degrees"),
    RUN("dimension_size", "AF", call_dimension_size, "size of an array's dimension, from 1"),
    RUN("dimensions", "A", call_dimensions, "number of an array's dimensions"),
    { "div", "integer quotient", "FF", .of_two = divide, .in_functions = true },
    MATH("exp", exp, "e to a power"),
    RUN("file_exists", "S", call_file_exists, "is there a file of that name?"),
    MATH("floor", floor, "next integer down"),
    RUN("inside", "OV", call_inside, "is a point inside of an object?"),
    MATH("int", to_int, "integer part"),
    { "internal", "a function that is built in, by number", "F", .in_functions = true },
    BOTH("ln", "F", call_logarithm, "natural logarithm"),
    BOTH("log", "F", call_logarithm, "logarithm to base 10"),
    { "max", "largest of the arguments", "F*", .run = call_max, .commas = true,
      .in_functions = true },
    RUN("max_extent", "P", call_extent, "upper corner of an object's box"),
    { "min", "smallest of the arguments", "F*", .run = call_min, .commas = true,
      .in_functions = true },
    RUN("min_extent", "P", call_extent, "lower corner of an object's box"),
    { "mod", "remainder, with the sign of the first", "FF", .of_two = remainder_of, .in_functions = true },
    BOTH("pow", "FF", call_pow, "first to the power of the second"),
    { "prod", "product over a range, in functions", "DFFF", .in_functions = true },
    MATH("radians", radians, "degrees in radians"),
    RUN("rand", "F", call_rand, "next random number of a stream, 0 to 1"),
    RUN("seed", "F", call_seed, "a new random stream"),
    BOTH("select", "FFF|F", call_select, "one of two or three, by the sign of the first"),
    MATH("sin", sin, "sine of radians"),
    MATH("sinh", sinh, "hyperbolic sine"),
    BOTH("sqrt", "F", call_sqrt, "square root"),
    RUN("str", "FFF", call_str, "a number as a text: number, width, digits"),
    RUN("strcmp", "SS", call_strcmp, "compares texts: 0 when equal"),
    RUN("strlen", "S", call_strlen, "length of a text"),
    RUN("strlwr", "S", call_strlwr, "a text in small letters"),
    RUN("strupr", "S", call_strupr, "a text in capital letters"),
    RUN("substr", "SFF", call_substr, "part of a text: first character, how many"),
    { "sum", "sum over a range, in functions", "DFFF", .in_functions = true },
    MATH("tan", tan, "tangent of radians"),
    MATH("tanh", tanh, "hyperbolic tangent"),
    RUN("trace", "OVV|R", call_trace, "where a ray meets an object first"),
    RUN("val", "S", call_val, "the number that a text begins with"),
    RUN("vaxis_rotate", "VVF", call_vaxis_rotate, "a point rotated about an axis by degrees"),
    RUN("vcross", "VV", call_vcross, "cross product"),
    RUN("vdot", "VV", call_vdot, "dot product"),
    RUN("vlength", "V", call_vlength, "length of a vector"),
    RUN("vnormalize", "V", call_vnormalize, "a vector of length 1"),
    RUN("vrotate", "VV", call_vrotate, "a point rotated by degrees about x, y, z"),
    RUN("vstr", "FNSFF", call_vstr, "a vector as a text: components, vector, separator, width, digits"),
    { "vturbulence", "the noise's vector: lambda, omega, octaves, point", "FFFV",
      .run = call_vturbulence, .last_comma = true },
    { .name = NULL },
};

/* --- running one ------------------------------------------------------------------ */

static bool fits(struct value *v, char wanted, const struct ast *from)
{
    double c[5];

    switch (wanted) {
    case 'F': return value_is_number(v) && v->n == 1;
    case 'N': return value_is_number(v);
    case 'V':
        if (!value_components(v, 3, c))
            return false;
        *v = value_vector(3, c);
        return true;
    case 'S': return v->type == VALUE_TEXT;
    case 'A': return v->type == VALUE_ARRAY;
    case 'O': return v->type == VALUE_OBJECT && from->kind != AST_CALL;
    case 'P': return v->type == VALUE_OBJECT || v->type == VALUE_PIGMENT;
    case 'R': return value_is_number(v) && v->n == 3;
    default: return true;
    }
}

static const char *wanted_name(char wanted)
{
    switch (wanted) {
    case 'F': return "a number";
    case 'N': case 'V': return "a vector";
    case 'S': return "a text";
    case 'A': return "an array's name";
    case 'R': return "the name of a vector";
    case 'P': return "the name of an object or pigment";
    default: return "the name of an object";
    }
}

/* How many arguments a row takes: the letters before '|' at least. */
static void count(const char *takes, int *least, int *most)
{
    const char *bar = strchr(takes, '|');

    *most = strchr(takes, '*') ? 0x7fffffff : (int)strlen(takes) - (bar != NULL);
    *least = bar ? (int)(bar - takes) : strchr(takes, '*') ? 1 : *most;
}

static char letter(const char *takes, int i)
{
    for (int k = 0; *takes; takes++) {
        if (*takes == '|')
            continue;
        if (takes[1] == '*' || k == i)
            return *takes;
        k++;
    }
    return 'D';
}

static bool check(struct arguments *a)
{
    int least, most;

    count(a->call->takes, &least, &most);
    if (a->n < least || a->n > most) {
        diag_error(a->l->diag, a->node->at, "%s takes %s%d argument%s, not %d", a->call->name,
                   least < most ? "at least " : "", least, least == 1 ? "" : "s", a->n);
        return false;
    }
    for (int i = 0; i < a->n; i++) {
        char wanted = letter(a->call->takes, i);
        if (fits(&a->v[i], wanted, a->from[i]))
            continue;
        wrong_type(a->l, a->from[i]->at, &a->v[i], wanted_name(wanted));
        return false;
    }
    return true;
}

static bool is_one_number(const struct value *v)
{
    return v->type == VALUE_NUMBER && v->n == 1;
}

/* The usual case: a function of one number or two. */
static bool quick(struct lang *l, const struct call *call, const struct ast *list,
                  struct value *out)
{
    struct value b;

    if (!(list->flags & AST_PLAIN) || list->flags & AST_LAST_COMMA
        || list->n != (call->of_one ? 1 : 2))
        return false;
    evaluate(l, list->first, out);
    if (!call->of_one)
        evaluate(l, list->first->next, &b);
    else {
        b.type = out->type;
        b.n = out->n;
    }
    out->rest = REST_NONE;
    if (is_one_number(out) && is_one_number(&b)) {
        out->v[0] = call->of_one ? call->of_one(out->v[0]) : call->of_two(out->v[0], b.v[0]);
        return true;
    }
    if (!fits(out, 'F', list->first) || !fits(&b, 'F', list->first)) {
        wrong_type(l, list->first->at, fits(out, 'F', list->first) ? &b : out, "a number");
        one(out, 0);
    } else
        one(out, call->of_one ? call->of_one(out->v[0]) : call->of_two(out->v[0], b.v[0]));
    return true;
}

static bool only_names(const struct call *call)
{
    return call->takes[0] == 'D';
}

static void run_with(struct arguments *a, struct value *out)
{
    if (a->call->of_one)
        one(out, a->call->of_one(arg(a, 0)));
    else if (a->call->of_two)
        one(out, a->call->of_two(arg(a, 0), arg(a, 1)));
    else
        a->call->run(a, out);
}

void call_run(struct lang *l, const struct ast *node, struct value *out)
{
    const struct call *call = node->word->call;
    struct value usual[USUAL_VALUES];
    const struct ast *from[USUAL_VALUES];
    struct arguments a = { .l = l, .node = node, .call = call, .v = usual, .from = from };
    struct values list;

    if ((call->of_one || call->of_two) && quick(l, call, node->args, out))
        return;
    harmless(out);
    if (!call->run && !call->of_one && !call->of_two) {
        diag_error(l->diag, node->at, "'%s' can be used in function { } only", call->name);
        return;
    }
    list.last_comma = false;
    if (only_names(call)) {
        a.n = node->args->first != NULL && !node->args->first->next;
        from[0] = node->args->first;
    } else
        a.n = evaluate_list(l, node->args, &list, call->commas);
    if (a.n > 0 && list.last_comma && !only_names(call) && !call->last_comma) {
        diag_error(l->diag, node->at, "%s: nothing stands behind the last comma", call->name);
        return;
    }
    if (a.n < 0)
        return;
    if (a.n > USUAL_VALUES) {
        a.v = arena_array(l->mem, (size_t)a.n, sizeof *a.v);
        a.from = arena_array(l->mem, (size_t)a.n, sizeof *a.from);
    }
    for (int i = 0; i < a.n && !only_names(call); i++) {
        a.v[i] = list.item[i].value;
        a.from[i] = list.item[i].from;
    }
    if (only_names(call))
        usual[0] = (struct value) { .type = VALUE_NONE };
    if (check(&a))
        run_with(&a, out);
}

/* --- constants ---------------------------------------------------------------------- */

static void get_pi(const struct lang *l, struct value *out) { (void)l; one(out, M_PI); }
static void get_on(const struct lang *l, struct value *out) { (void)l; one(out, 1); }
static void get_off(const struct lang *l, struct value *out) { (void)l; one(out, 0); }
static void get_clock(const struct lang *l, struct value *out) { one(out, l->setup.clock); }
static void get_clock_on(const struct lang *l, struct value *out) { one(out, l->setup.clock_on); }
static void get_version(const struct lang *l, struct value *out) { one(out, l->version / 100.0); }

static void get_now(const struct lang *l, struct value *out)
{
    static const double epoch = 946684800;      /* 2000-01-01 in seconds since 1970 */
    struct timespec t;

    (void)l;
    clock_gettime(CLOCK_REALTIME, &t);
    one(out, ((double)t.tv_sec - epoch + (double)t.tv_nsec * 1e-9) / 86400);
}

static void axis(struct value *out, int n, int which)
{
    *out = value_vector(n, (double[]) { 0, 0, 0, 0, 0 });
    out->v[which] = 1;
}

static void get_x(const struct lang *l, struct value *out) { (void)l; axis(out, 3, 0); }
static void get_y(const struct lang *l, struct value *out) { (void)l; axis(out, 3, 1); }
static void get_z(const struct lang *l, struct value *out) { (void)l; axis(out, 3, 2); }
static void get_t(const struct lang *l, struct value *out) { (void)l; axis(out, 4, 3); }
static void get_u(const struct lang *l, struct value *out) { (void)l; axis(out, 2, 0); }
static void get_v(const struct lang *l, struct value *out) { (void)l; axis(out, 2, 1); }

const struct constant constants[] = {
    { "clock", "the time of the picture", get_clock, 0 },
    { "clock_on", "1 in animations", get_clock_on, 0 },
    { "false", "0", get_off, 0 },
    { "no", "0", get_off, 0 },
    { "now", "days since 2000-01-01", get_now, 0 },
    { "off", "0", get_off, 0 },
    { "on", "1", get_on, 0 },
    { "pi", "3.14159...", get_pi, 0 },
    { "t", "<0, 0, 0, 1>", get_t, 4 },
    { "true", "1", get_on, 0 },
    { "u", "<1, 0>", get_u, 5 },
    { "v", "<0, 1>", get_v, 6 },
    { "version", "the language's version", get_version, 0 },
    { "x", "<1, 0, 0>", get_x, 1 },
    { "y", "<0, 1, 0>", get_y, 2 },
    { "yes", "1", get_on, 0 },
    { "z", "<0, 0, 1>", get_z, 3 },
    { .name = NULL },
};
