/* build_special.c: shapes with a syntax of their own.  They are read in full;
 * those that the renderer lacks stand in the scene as named nothings. */
#include <string.h>

#include "lang/build.h"
#include "lang/gradient.h"

static struct object *nothing(struct lang *l, const struct item *block)
{
    struct object *o = object_start(l, OBJECT_UNION, block->at);

    object_more(l->scene_mem, o)->unsupported = arena_text(l->scene_mem, block->text,
                                                           strlen(block->text));
    return o;
}

static bool word_is_next(struct reader *r, const char *word)
{
    return reader_peek(r)->kind == ITEM_WORD && item_is(reader_peek(r), word);
}

/* Takes any of the words that stand next; which was the last is told. */
static const char *take_words(struct reader *r, const char *const *words)
{
    const char *last = NULL;

    for (bool more = true; more;) {
        more = false;
        for (const char *const *w = words; *w; w++)
            if (reader_takes_word(r, *w)) {
                last = *w;
                more = true;
            }
    }
    return last;
}

static double bound(struct reader *r, const char *what, double low, double high)
{
    struct loc at = reader_at(r);
    double x = reader_number(r, false, what);

    if (x >= low && x <= high)
        return x;
    diag_error(r->lang->diag, at, "%s must be between %g and %g, not %g", what, low, high, x);
    return low;
}

/* --- lists of points ------------------------------------------------------------------- */

enum { MOST_POINTS = 1 << 24 };

struct points {
    double (*v)[4];                     /* point, then a radius */
    size_t n;
};

/* N, then N points of that many components, each with a number behind it if
 * with_number. */
static struct points read_points(struct reader *r, const char *what, int components,
                                 bool with_number)
{
    size_t n = (size_t)bound(r, arena_format(r->lang->mem, "number of points of %s", what), 0,
                             MOST_POINTS);
    struct points p = { 0 };
    size_t room = 0;

    for (size_t i = 0; i < n; i++) {
        p.v = arena_grow(r->lang->mem, p.v, p.n, &room, sizeof *p.v);
        double *v = p.v[p.n++];
        memset(v, 0, sizeof *p.v);
        if (!reader_vector(r, true, components, v, "a point"))
            break;
        if (with_number)
            v[3] = reader_number(r, true, "radius");
    }
    return p;
}

/* Of a named nothing, whose more is its own. */
static struct bounds *reach_of(struct object *o)
{
    return &((struct object_more *)o->more)->reach;
}

/* So that max_extent is right before the shape can be drawn. */
static void reach_to(struct object *o, vec3 p, double radius)
{
    *reach_of(o) = bounds_join(*reach_of(o), (struct bounds) {
        { p.x - radius, p.y - radius, p.z - radius }, { p.x + radius, p.y + radius, p.z + radius } });
}

/* Of a curve about y: through all its points. */
static void reach_around(struct object *o, const struct points *p)
{
    for (size_t i = 0; i < p->n; i++) {
        double r = fabs(p->v[i][0]), y = p->v[i][1];
        *reach_of(o) = bounds_join(*reach_of(o), (struct bounds) { { -r, y, -r }, { r, y, r } });
    }
}

static void at_least(struct lang *l, const struct item *block, const struct points *p, size_t least)
{
    if (p->n < least && !l->reader->failed)
        build_wrong(l, block, "this %s needs at least %zu points, not %zu", block->text, least, p->n);
}

static const char *const splines[] = { "linear_spline", "quadratic_spline", "cubic_spline",
                                       "bezier_spline", NULL };

static size_t least_points(const char *spline)
{
    if (!spline || strcmp(spline, "linear_spline") == 0)
        return 2;
    return strcmp(spline, "quadratic_spline") == 0 ? 3 : 4;
}

static bool is_bezier(const char *spline) { return spline && strcmp(spline, "bezier_spline") == 0; }

static void fours(struct lang *l, const struct item *block, const char *spline,
                  const struct points *p)
{
    if (is_bezier(spline) && p->n % 4 != 0)
        build_wrong(l, block, "a bezier_spline needs four points a piece: %zu is no multiple of 4", p->n);
}

static struct object *make_lathe(struct lang *l, struct reader *r, const struct item *block)
{
    struct object *o = nothing(l, block);
    const char *spline = take_words(r, splines);
    struct points p = read_points(r, "lathe", 2, false);
    bool smooth = spline && least_points(spline) > 2 && !is_bezier(spline);

    reach_around(o, &p);
    at_least(l, block, &p, least_points(spline));
    fours(l, block, spline, &p);
    for (size_t i = smooth ? 1 : 0; i < p.n - (smooth && p.n > 0 ? 1 : 0); i++)
        if (p.v[i][0] < 0) {
            build_wrong(l, block, "a lathe's points must not lie left of the axis");
            break;
        }
    build_modifiers(r, o, block, NULL, NULL, NULL);
    return o;
}

static bool same_point(const double *a, const double *b, int n)
{
    for (int i = 0; i < n; i++)
        if (a[i] != b[i])
            return false;
    return true;
}

/* Loops end where they began; the last may be left open. */
static bool is_closed(const struct points *p, int n)
{
    size_t first = 0;

    for (size_t i = 1; i < p->n; i++)
        if (i > first && same_point(p->v[i], p->v[first], n))
            first = i + 1;
    return first >= p->n;
}

static void check_prism(struct lang *l, const struct item *block, const char *spline,
                        const struct points *p)
{
    bool linear = !spline || strcmp(spline, "linear_spline") == 0;

    at_least(l, block, p, linear ? 3 : is_bezier(spline) ? 4 : least_points(spline) + 2);
    fours(l, block, spline, p);
    if (linear && p->n >= 3 && !is_closed(p, 2) && !l->reader->failed)
        diag_warning(l->diag, block->at, "this prism's outline is not closed: it is closed by a straight line");
}

static bool takes_open(struct reader *r, const struct item *i, void *arg)
{
    (void)arg;
    (void)r;
    return i->kind == ITEM_WORD && item_is(i, "open");
}

static struct object *make_prism(struct lang *l, struct reader *r, const struct item *block)
{
    static const char *const words[] = { "linear_sweep", "conic_sweep", NULL };
    struct object *o = nothing(l, block);
    const char *spline = NULL, *last;

    while ((last = take_words(r, splines)) || take_words(r, words))
        spline = last ? last : spline;
    double low = reader_number(r, false, "height of prism");
    double high = reader_number(r, true, "height of prism");
    reader_skip_comma(r);
    struct points p = read_points(r, "prism", 2, false);
    for (size_t i = 0; i < p.n; i++) {
        reach_to(o, vec(p.v[i][0], low, p.v[i][1]), 0);
        reach_to(o, vec(p.v[i][0], high, p.v[i][1]), 0);
    }
    check_prism(l, block, spline, &p);
    build_modifiers(r, o, block, takes_open, NULL, NULL);
    return o;
}

static struct object *make_sor(struct lang *l, struct reader *r, const struct item *block)
{
    struct object *o = nothing(l, block);
    struct points p = read_points(r, "sor", 2, false);

    reach_around(o, &p);
    at_least(l, block, &p, 4);
    for (size_t i = 0; i < p.n; i++) {
        bool sinks = i >= 2 && i + 1 < p.n && !(p.v[i][1] > p.v[i - 1][1]);
        if (p.v[i][0] < 0 || sinks) {
            build_wrong(l, block, sinks ? "a sor's heights must grow from point to point"
                                        : "a sor's points must not lie left of the axis");
            break;
        }
    }
    build_modifiers(r, o, block, takes_open, NULL, NULL);
    return o;
}

static bool takes_tolerance(struct reader *r, const struct item *i, void *arg)
{
    (void)arg;
    if (i->kind != ITEM_WORD || !item_is(i, "tolerance"))
        return false;
    reader_number(r, false, "tolerance");
    return true;
}

static struct object *make_sweep(struct lang *l, struct reader *r, const struct item *block)
{
    static const char *const words[] = { "linear_spline", "cubic_spline", "b_spline", NULL };
    struct object *o = nothing(l, block);
    struct loc at = reader_at(r);
    const char *spline = take_words(r, words);

    if (!spline)
        diag_error(l->diag, at, "sphere_sweep begins with linear_spline, cubic_spline or b_spline");
    reader_skip_comma(r);
    struct points p = read_points(r, "sphere_sweep", 3, true);
    for (size_t i = 0; i < p.n; i++)
        reach_to(o, vec(p.v[i][0], p.v[i][1], p.v[i][2]), fabs(p.v[i][3]));
    at_least(l, block, &p, spline && strcmp(spline, "linear_spline") == 0 ? 2 : 4);
    build_modifiers(r, o, block, takes_tolerance, NULL, NULL);
    return o;
}

static struct object *make_polygon(struct lang *l, struct reader *r, const struct item *block)
{
    struct object *o = nothing(l, block);
    struct points p = read_points(r, "polygon", 3, false);

    for (size_t i = 0; i < p.n; i++)
        reach_to(o, vec(p.v[i][0], p.v[i][1], p.v[i][2]), 0);
    at_least(l, block, &p, 3);
    if (p.n >= 3 && !is_closed(&p, 3) && !r->failed)
        diag_warning(l->diag, block->at, "this polygon is not closed: it is closed by a straight line");
    build_modifiers(r, o, block, NULL, NULL, NULL);
    return o;
}

/* --- blob ---------------------------------------------------------------------------------- */

static bool is_blob_look(const struct item *i)
{
    return item_is_block(i, "texture") || item_is_block(i, "pigment") || item_is_block(i, "normal")
           || item_is_block(i, "finish");
}

static void read_component(struct lang *l, const struct item *block)
{
    struct object spare = { .kind = OBJECT_UNION, .place = &transform_identity, .more = &object_no_more };
    struct transform t;
    struct reader r;

    reader_open(&r, l, block->body);
    build_vector(&r, false, "centre of the component");
    if (item_is(block, "cylinder"))
        build_vector(&r, true, "end of the component");
    reader_number(&r, true, "radius of the component");
    reader_skip_comma(&r);
    reader_takes_word(&r, "strength");
    reader_number(&r, false, "strength of the component");
    for (struct item i = reader_next(&r); i.kind != ITEM_END; i = reader_next(&r)) {
        bool known = is_blob_look(&i) ? build_modifier(&r, &spare, &i, block)
                                      : build_transform(&r, &i, &t);
        if (!known)
            build_unknown(l, &i, "a blob's component", NULL);
    }
    reader_close(&r);
}

static bool read_blob_item(struct reader *r, const struct item *i, size_t *n)
{
    if (i->kind == ITEM_WORD && item_is(i, "threshold"))
        reader_number(r, false, "threshold");
    else if (i->kind == ITEM_WORD && item_is(i, "component")) {
        reader_number(r, false, "strength of the component");
        reader_number(r, true, "radius of the component");
        build_vector(r, true, "centre of the component");
        ++*n;
    } else if (item_is_block(i, "sphere") || item_is_block(i, "cylinder")) {
        read_component(r->lang, i);
        ++*n;
    } else
        return false;
    return true;
}

static bool more_blob(struct reader *r, const struct item *i, void *arg)
{
    return read_blob_item(r, i, arg);
}

static struct object *make_blob(struct lang *l, struct reader *r, const struct item *block)
{
    struct object *o = nothing(l, block);
    size_t n = 0;

    build_modifiers(r, o, block, more_blob, &n, NULL);
    if (n == 0)
        build_wrong(l, block, "a blob needs a component");
    return o;
}

/* --- surfaces by numbers --------------------------------------------------------------------- */

static struct object *by_coefficients(struct lang *l, struct reader *r, const struct item *block,
                                      size_t n)
{
    struct object *o = nothing(l, block);
    double *v = arena_array(l->mem, n, sizeof *v);

    reader_list(r, block->text, n, v);
    build_modifiers(r, o, block, NULL, NULL, NULL);
    return o;
}

static struct object *make_cubic(struct lang *l, struct reader *r, const struct item *block)
{
    return by_coefficients(l, r, block, 20);
}

static struct object *make_quartic(struct lang *l, struct reader *r, const struct item *block)
{
    return by_coefficients(l, r, block, 35);
}

static struct object *make_poly(struct lang *l, struct reader *r, const struct item *block)
{
    size_t n = (size_t)bound(r, "order of poly", 2, 35);

    return by_coefficients(l, r, block, (n + 1) * (n + 2) * (n + 3) / 6);
}

/* xyz(i, j, k): c, ... */
static struct object *make_polynomial(struct lang *l, struct reader *r, const struct item *block)
{
    struct object *o = nothing(l, block);
    double powers[3];

    bound(r, "order of polynomial", 2, 35);
    reader_skip_comma(r);
    while (reader_takes_word(r, "xyz")) {
        reader_arguments(r, "xyz", 3, powers);
        if (reader_peek(r)->kind == ITEM_COLON)
            reader_next(r);
        else
            diag_error(l->diag, reader_at(r), "expected ':' and a number behind xyz ( )");
        reader_number(r, false, "factor");
        reader_skip_comma(r);
    }
    build_modifiers(r, o, block, NULL, NULL, NULL);
    return o;
}

/* --- bicubic_patch ----------------------------------------------------------------------------- */

static bool read_patch_word(struct reader *r)
{
    static const char *const words[] = { "type", "flatness", "u_steps", "v_steps", "accuracy", NULL };
    double v[2];

    for (const char *const *w = words; *w; w++)
        if (reader_takes_word(r, *w)) {
            reader_number(r, false, *w);
            return true;
        }
    if (!reader_takes_word(r, "uv_vectors"))
        return false;
    for (int i = 0; i < 4; i++)
        reader_vector(r, i > 0, 2, v, "uv_vectors");
    return true;
}

static struct object *make_patch(struct lang *l, struct reader *r, const struct item *block)
{
    struct object *o = nothing(l, block);

    while (read_patch_word(r))
        reader_skip_comma(r);
    for (int i = 0; i < 16; i++)
        reach_to(o, build_vector(r, true, "one of the 16 points of bicubic_patch"), 0);
    build_modifiers(r, o, block, NULL, NULL, NULL);
    return o;
}

/* --- text, height_field ---------------------------------------------------------------------------- */

static struct object *make_text(struct lang *l, struct reader *r, const struct item *block)
{
    static const char *const fonts[] = { "ttf", "TTF", "ttc", "TTC", NULL };
    struct object *o = nothing(l, block);

    if (reader_takes_word(r, "internal"))
        reader_number(r, false, "number of the built-in font");
    else {
        if (!reader_takes_word(r, "ttf"))
            diag_error(l->diag, reader_at(r), "text begins with ttf and a file name, or internal and a number");
        struct loc at = reader_at(r);
        const char *name = reader_text(r, false, "font file");
        if (name && *name)
            lang_find_file(l, at, name, fonts, "font");
    }
    reader_text(r, true, "the letters");
    reader_number(r, true, "thickness of text");
    build_vector(r, true, "offset of letters");
    build_modifiers(r, o, block, NULL, NULL, NULL);
    return o;
}

static bool read_field_item(struct reader *r, const struct item *i, void *arg)
{
    (void)arg;
    if (i->kind != ITEM_WORD)
        return false;
    if (item_is(i, "smooth"))
        build_flag(r);
    else if (item_is(i, "water_level"))
        reader_number(r, false, "water_level");
    else
        return false;
    return true;
}

/* The file is looked for, so that its absence is told today. */
static void read_field_source(struct reader *r)
{
    struct drawn drawn = { 0 };

    if (build_drawn(r, &drawn))
        return;
    struct loc at = reader_at(r);
    const struct item *i = reader_peek(r);
    if (i->kind == ITEM_WORD && field_find(image_types, i->word->text)) {
        reader_next(r);
        at = reader_at(r);
    }
    const char *name = reader_text(r, false, "picture of height_field");
    if (name && *name)
        lang_find_file(r->lang, at, name, NULL, "picture");
    if (reader_takes_word(r, "gamma") && !reader_takes_word(r, "srgb"))
        reader_number(r, false, "gamma");
    if (reader_takes_word(r, "premultiplied"))
        build_flag(r);
}

static struct object *make_height_field(struct lang *l, struct reader *r, const struct item *block)
{
    struct object *o = nothing(l, block);

    *reach_of(o) = (struct bounds) { { 0, 0, 0 }, { 1, 1, 1 } };
    read_field_source(r);
    build_modifiers(r, o, block, read_field_item, NULL, NULL);
    return o;
}

/* --- surfaces by functions ---------------------------------------------------------------------------- */

/* An isosurface, as far as it is looked at. */
struct iso {
    const struct function *function;    /* NULL: it has none, which was said */
    double max_gradient;
    bool evaluates;                     /* max_gradient is found while rendering */
    vec3 low, high;
};

static void read_container(struct lang *l, const struct item *block, struct iso *iso)
{
    struct reader r, in;

    reader_open(&r, l, block->body);
    struct item i = reader_next(&r);
    if (item_is_block(&i, "box") || item_is_block(&i, "sphere")) {
        reader_open(&in, l, i.body);
        iso->low = iso->high = build_vector(&in, false, "contained_by");
        if (item_is(&i, "box"))
            iso->high = build_vector(&in, true, "contained_by");
        else {
            double radius = reader_number(&in, true, "contained_by");
            iso->low = vec_sub(iso->low, vec(radius, radius, radius));
            iso->high = vec_add(iso->high, vec(radius, radius, radius));
        }
        if (reader_peek(&in)->kind != ITEM_END)
            build_unknown(l, reader_peek(&in), "contained_by", NULL);
        reader_close(&in);
    } else
        build_unknown(l, &i, "contained_by: it takes a box or a sphere", NULL);
    reader_close(&r);
}

/* Words and how many numbers follow. */
static bool read_counted(struct reader *r, const struct item *i, const char *word, int n)
{
    if (i->kind != ITEM_WORD || !item_is(i, word))
        return false;
    for (int k = 0; k < n; k++)
        reader_number(r, k > 0, word);
    return true;
}

static bool read_iso_word(struct reader *r, const struct item *i, void *arg)
{
    struct iso *iso = arg;

    if (item_is_block(i, "contained_by")) {
        read_container(r->lang, i, iso);
        return true;
    }
    if (i->kind == ITEM_WORD && item_is(i, "max_gradient")) {
        iso->max_gradient = reader_number(r, false, "max_gradient");
        return true;
    }
    if (read_counted(r, i, "evaluate", 3)) {
        iso->evaluates = true;
        return true;
    }
    return read_counted(r, i, "threshold", 1) || read_counted(r, i, "accuracy", 1)
           || read_counted(r, i, "max_trace", 1) || read_counted(r, i, "all_intersections", 0)
           || read_counted(r, i, "open", 0);
}

static const struct function *read_function(struct reader *r, const struct item *block)
{
    if (item_is_thing(reader_peek(r), VALUE_FUNCTION))
        return reader_next(r).value.thing;
    diag_error(r->lang->diag, reader_at(r), "%s needs function { } first; found %s", block->text,
               item_describe(r->lang, reader_peek(r)));
    return NULL;
}

static void check_gradient(struct lang *l, const struct item *block, const struct iso *iso)
{
    const struct function *f = iso->function;
    vec3 at = iso->low;

    if (!f || iso->evaluates || function_parameters(f) != 3 || function_components(f) != 1)
        return;
    double found = gradient_steepest(f, iso->low, iso->high, &at);
    if (found > iso->max_gradient * 1.05)
        diag_warning(l->diag, block->at, "isosurface: max_gradient is %g, but the function's is at "
                     "least %.3g, as at <%.3g, %.3g, %.3g>: there may be holes", iso->max_gradient,
                     found, at.x, at.y, at.z);
}

static struct object *make_isosurface(struct lang *l, struct reader *r, const struct item *block)
{
    struct object *o = nothing(l, block);
    struct iso iso = { read_function(r, block), 1.1, false, vec(-1, -1, -1), vec(1, 1, 1) };
    unsigned errors = l->diag->errors;

    build_modifiers(r, o, block, read_iso_word, &iso, NULL);
    reach_to(o, iso.low, 0);
    reach_to(o, iso.high, 0);
    if (errors == l->diag->errors)
        check_gradient(l, block, &iso);
    return o;
}

static bool read_parametric_word(struct reader *r, const struct item *i, void *arg)
{
    static const char *const axes[] = { "x", "y", "z" };

    if (i->kind != ITEM_WORD || !item_is(i, "precompute"))
        return read_iso_word(r, i, arg);
    reader_number(r, false, "precompute");
    for (int k = 0; k < 3; k++) {       /* x, y, z: words that are values elsewhere */
        reader_skip_comma(r);
        if (reader_is_number(r) || word_is_next(r, axes[k]))
            reader_next(r);
    }
    return true;
}

static struct object *make_parametric(struct lang *l, struct reader *r, const struct item *block)
{
    struct object *o = nothing(l, block);
    struct iso iso = { 0 };
    double v[2];

    for (int i = 0; i < 3; i++) {
        reader_skip_comma(r);
        read_function(r, block);
    }
    reader_vector(r, true, 2, v, "lowest u and v");
    reader_vector(r, true, 2, v, "highest u and v");
    build_modifiers(r, o, block, read_parametric_word, &iso, NULL);
    return o;
}

/* --- julia_fractal --------------------------------------------------------------------------------------- */

static bool read_julia_word(struct reader *r, const struct item *i, void *arg)
{
    static const char *const functions[] = {
        "hypercomplex", "quaternion", "sqr", "cube", "exp", "ln", "sin", "asin", "cos", "acos",
        "tan", "atan", "sinh", "asinh", "cosh", "acosh", "tanh", "atanh", "reciprocal",
    };
    double v[4];

    (void)arg;
    if (i->kind != ITEM_WORD)
        return false;
    if (item_is(i, "slice")) {
        reader_vector(r, false, 4, v, "slice");
        reader_number(r, true, "slice");
        return true;
    }
    if (item_is(i, "pwr")) {
        reader_arguments(r, "pwr", 2, v);
        return true;
    }
    for (size_t f = 0; f < sizeof functions / sizeof *functions; f++)
        if (item_is(i, functions[f]))
            return true;
    return read_counted(r, i, "max_iteration", 1) || read_counted(r, i, "precision", 1);
}

static struct object *make_julia(struct lang *l, struct reader *r, const struct item *block)
{
    struct object *o = nothing(l, block);
    double v[4];

    reader_vector(r, false, 4, v, "parameter of julia_fractal");
    build_modifiers(r, o, block, read_julia_word, NULL, NULL);
    return o;
}

/* --- headers of shapes that have no row yet ----------------------------------------------------------------- */

/* v vector, u two components, n number; capitals: may be left out. */
static const struct { const char *word, *header; bool open; } headers[] = {
    { "torus", "nn", false }, { "superellipsoid", "u", false }, { "ovus", "nn", false },
    { "disc", "vvnN", false }, { "quadric", "vvvn", false }, { "cone", "vnvn", true },
    { "cylinder", "vvn", true }, { "box", "vv", false }, { "sphere", "vn", false },
    { "plane", "vn", false }, { "triangle", "vvv", false }, { "smooth_triangle", "vvvvvv", false },
};

static struct object *make_header(struct lang *l, struct reader *r, const struct item *block)
{
    struct object *o = nothing(l, block);
    const char *header = "";
    bool open = false;
    double v[2];

    for (size_t i = 0; i < sizeof headers / sizeof *headers; i++)
        if (strcmp(headers[i].word, block->word->text) == 0) {
            header = headers[i].header;
            open = headers[i].open;
        }
    for (const char *c = header; *c; c++) {
        if (c != header)
            reader_skip_comma(r);
        if (*c == 'v')
            build_vector(r, false, "a point of the shape");
        else if (*c == 'u')
            reader_vector(r, false, 2, v, "the exponents");
        else if (*c == 'n' || reader_is_number(r))
            reader_number(r, false, "a number of the shape");
    }
    build_modifiers(r, o, block, open ? takes_open : NULL, NULL, NULL);
    return o;
}

const struct field shape_more_fields[] = {
#define WORD(word, help) { word, FIELD_CUSTOM, 0, ANY, help }
    WORD("threshold", "of blob, isosurface"), WORD("component", "of blob"),
    WORD("strength", "of blob"), WORD("open", "without caps"),
    WORD("linear_spline", "straight pieces"), WORD("quadratic_spline", "a kind of curve"),
    WORD("cubic_spline", "a kind of curve"), WORD("bezier_spline", "a kind of curve"),
    WORD("b_spline", "a kind of curve"), WORD("linear_sweep", "prism: straight up"),
    WORD("conic_sweep", "prism: to a point"), WORD("tolerance", "of sphere_sweep"),
    WORD("smooth", "of height_field, mesh_camera"), WORD("water_level", "of height_field"),
    WORD("contained_by", "of isosurface, parametric"), WORD("max_gradient", "of isosurface"),
    WORD("evaluate", "of isosurface"), WORD("max_trace", "of isosurface"),
    WORD("all_intersections", "of isosurface"), WORD("precompute", "of parametric"),
    WORD("max_iteration", "of julia_fractal"), WORD("precision", "of julia_fractal"),
    WORD("slice", "of julia_fractal"), WORD("hypercomplex", "of julia_fractal"),
    WORD("quaternion", "of julia_fractal"), WORD("sqr", "of julia_fractal"),
    WORD("cube", "of julia_fractal"), WORD("reciprocal", "of julia_fractal"),
    WORD("pwr", "of julia_fractal"), WORD("ttf", "of text"), WORD("internal", "of text"),
    WORD("xyz", "of polynomial"), WORD("type", "of bicubic_patch"),
    WORD("flatness", "of bicubic_patch"), WORD("u_steps", "of bicubic_patch"),
    WORD("v_steps", "of bicubic_patch"), WORD("target", "of photons"),
    WORD("pass_through", "of photons"), WORD("collect", "of photons"),
    WORD("reflection", "of photons"), WORD("refraction", "of photons"),
    WORD("importance", "of radiosity"),
    FIELD_END,
};

const struct special_shape special_shapes[] = {
    { "bicubic_patch", make_patch, false }, { "blob", make_blob, false },
    { "cubic", make_cubic, false }, { "height_field", make_height_field, false },
    { "isosurface", make_isosurface, false }, { "julia_fractal", make_julia, false },
    { "lathe", make_lathe, false }, { "parametric", make_parametric, false },
    { "poly", make_poly, false }, { "polygon", make_polygon, false },
    { "polynomial", make_polynomial, false }, { "prism", make_prism, false },
    { "quartic", make_quartic, false }, { "sor", make_sor, false },
    { "sphere_sweep", make_sweep, false }, { "text", make_text, false },
    { "torus", make_header, true }, { "superellipsoid", make_header, true },
    { "ovus", make_header, true }, { "disc", make_header, true }, { "quadric", make_header, true },
    { "cone", make_header, true }, { "cylinder", make_header, true }, { "box", make_header, true },
    { "sphere", make_header, true }, { "plane", make_header, true },
    { "triangle", make_header, true }, { "smooth_triangle", make_header, true },
    { .word = NULL },
};
