/* array.c: arrays and their elements. */
#include "lang/array.h"

#include <math.h>
#include <string.h>

#include "lang/eval.h"
#include "lang/frame.h"
#include "lang/guess.h"
#include "lang/scope.h"

static const double slack = 1e-10;      /* added before a subscript is truncated, as POV-Ray does */

int array_dimensions(const void *array)
{
    return ((const struct array *)array)->n_dimension;
}

size_t array_size(const void *array, int dimension)
{
    const struct array *a = array;

    return dimension >= 1 && dimension <= a->n_dimension ? a->size[dimension - 1] : 0;
}

/* --- sharing -------------------------------------------------------------------- */

void value_keep(struct value *v)
{
    if (v->type == VALUE_ARRAY)
        ((struct array *)v->thing)->owner = NULL;
    if (value_is_number(v))
        v->rest = REST_NONE;
}

/* The array in a variable, with no other variable looking at it. */
static struct array *own_array(struct lang *l, struct value *variable)
{
    const struct array *shared = variable->thing;

    if (shared->owner == variable)
        return (struct array *)shared;
    struct array *a = arena_copy(l->mem, shared, sizeof *a);
    a->item = arena_copy(l->mem, shared->item, shared->n * sizeof *a->item);
    for (size_t i = 0; i < a->n; i++)
        value_keep(&a->item[i]);
    a->owner = variable;
    variable->thing = a;
    return a;
}

/* --- subscripts ------------------------------------------------------------------- */

/* One subscript for each dimension; returns what comes behind them, which
 * belongs to an array in the array.  False: reported. */
static bool offset(struct lang *l, const struct array *a, const struct ast *node, bool strict,
                   const struct ast **subscript, size_t *at)
{
    *at = 0;
    for (int d = 0; d < a->n_dimension; d++, *subscript = (*subscript)->next) {
        double x;
        if (!*subscript) {
            diag_error(l->diag, node->at, "'%s' has %d dimensions: subscripts are missing",
                       node->name->text, a->n_dimension);
            return false;
        }
        if (!(strict ? evaluate_condition : evaluate_number)(l, *subscript, "a number as subscript",
                                                             &x))
            return false;
        if (!(floor(x + slack) >= 0) || !(floor(x + slack) < (double)a->size[d])) {
            const struct ast *said = (*subscript)->first;
            const struct binding *b = scope_find(node->name);
            diag_error(l->diag, said ? said->at : (*subscript)->at,
                       "subscript %g is outside of 0 to %zu", x, a->size[d] - 1);
            if (b && b->at.source)
                diag_note(l->diag, b->at, "'%s' is declared here", node->name->text);
            return false;
        }
        *at = *at * a->size[d] + (size_t)(x + slack);
    }
    return true;
}

static struct value *variable_of(struct lang *l, const struct ast *node)
{
    struct binding *b = scope_find(node->name);

    if (b)
        return b->value;
    say_undeclared(l, node->at, node->name->text, NULL);
    return NULL;
}

static bool check_array(struct lang *l, const struct ast *node, const struct value *v)
{
    if (v->type == VALUE_ARRAY)
        return true;
    if (v->type == VALUE_NONE)
        diag_error(l->diag, node->at, "this element of '%s' was never set", node->name->text);
    else if (!scope_find(node->name) || !scope_find(node->name)->is_broken)
        diag_error(l->diag, node->at, "'%s' is a %s, not an array", node->name->text,
                   value_name(v));
    return false;
}

const struct value *array_item(struct lang *l, const struct ast *node, bool quiet)
{
    const struct value *v = quiet && !scope_find(node->name) ? NULL : variable_of(l, node);
    const struct ast *subscript = node->args->first;
    size_t at;

    while (v && subscript) {
        if (quiet && v->type != VALUE_ARRAY)
            return NULL;
        if (!check_array(l, node, v))
            return NULL;
        const struct array *a = v->thing;
        if (!offset(l, a, node, false, &subscript, &at))
            return NULL;
        v = &a->item[at];
    }
    if (!v || v->type != VALUE_NONE)
        return v;
    if (!quiet)
        diag_error(l->diag, node->at, "this element of '%s' was never set", node->name->text);
    return NULL;
}

struct value *array_place(struct lang *l, const struct ast *node)
{
    if (node->kind != AST_NAME && node->kind != AST_INDEX) {
        diag_error(l->diag, node->at, "expected a name or an array's element");
        return NULL;
    }
    struct value *v = variable_of(l, node);
    if (node->kind == AST_NAME)
        return v;
    const struct ast *subscript = node->args->first;
    while (v && subscript) {
        size_t at;
        if (!check_array(l, node, v) || !offset(l, v->thing, node, false, &subscript, &at))
            return NULL;
        v = &own_array(l, v)->item[at];
    }
    return v;
}

/* The array that holds the element: all its elements have one type. */
static struct array *holder(struct lang *l, const struct ast *node, size_t *at)
{
    struct value *v = variable_of(l, node);
    const struct ast *subscript = node->args->first;
    struct array *a = NULL;

    while (v && subscript) {
        if (!check_array(l, node, v) || !offset(l, v->thing, node, true, &subscript, at))
            return NULL;
        a = own_array(l, v);
        v = &a->item[*at];
    }
    return v ? a : NULL;
}

/* Numbers and vectors are one type each; 5 numbers are a colour. */
static bool same_type(const struct value *a, const struct value *b)
{
    if (value_is_number(a) && value_is_number(b))
        return a->n == b->n;
    return a->type == b->type;
}

static bool may_become(struct lang *l, const struct ast *node, const struct value *old)
{
    if (old->type != VALUE_FUNCTION)
        return true;
    diag_error(l->diag, node->at, "this element of '%s' is a function already: it needs #undef "
               "before", node->name->text);
    return false;
}

void array_assign(struct lang *l, const struct ast *node, const struct value *v)
{
    size_t at = 0;
    struct array *a = holder(l, node, &at);

    if (!a || !may_become(l, node, &a->item[at]))
        return;
    if (a->like.type != VALUE_NONE && !same_type(&a->like, v)) {
        diag_error(l->diag, node->at, "'%s' is an array of %ss: its elements cannot be a %s",
                   node->name->text, value_name(&a->like), value_name(v));
        return;
    }
    a->like = a->item[at] = *v;
}

void array_undef(struct lang *l, const struct ast *node)
{
    struct value *v = array_place(l, node);

    if (!v)
        return;
    if (v->type == VALUE_NONE)
        diag_error(l->diag, node->at, "this element of '%s' was never set", node->name->text);
    v->type = VALUE_NONE;
}

static bool is_below_zero(struct lang *l, const struct ast *subscript)
{
    double x;

    return evaluate_number(l, subscript, "a number as subscript", &x) && x + slack < 0;
}

/* POV-Ray asks for one subscript for each dimension, and nothing stands below 0. */
static bool has_item(struct lang *l, const struct ast *node)
{
    const struct value *v = variable_of(l, node);
    const struct ast *subscript = node->args->first;
    size_t at;

    if (!v || !check_array(l, node, v))
        return false;
    for (const struct ast *s = subscript; s; s = s->next)
        if (is_below_zero(l, s))
            return false;
    if (!offset(l, v->thing, node, false, &subscript, &at))
        return false;
    if (subscript)
        diag_error(l->diag, subscript->at, "only the dimensions of '%s' itself can be asked for",
                   node->name->text);
    return ((const struct array *)v->thing)->item[at].type != VALUE_NONE;
}

bool array_is_defined(struct lang *l, const struct ast *node)
{
    bool is_word = node->kind == AST_TEXT || node->kind == AST_CONSTANT || node->kind == AST_WORD
        || (node->kind == AST_NUMBER && !signbit(node->number));

    if (node->kind == AST_INDEX)
        return has_item(l, node);
    if (node->kind == AST_NAME)
        return scope_find(node->name);
    if (!is_word)                       /* POV-Ray looks at one word, whatever it is */
        diag_error(l->diag, node->at, "expected a name or an array's element alone");
    return false;
}

/* --- making one ------------------------------------------------------------------------ */

static bool read_sizes(struct lang *l, const struct ast *node, struct array *a)
{
    a->n = 1;
    for (const struct ast *s = node->args->first; s; s = s->next) {
        double x;
        if (a->n_dimension == ARRAY_MOST_DIMENSIONS) {
            diag_error(l->diag, s->at, "an array has at most %d dimensions", ARRAY_MOST_DIMENSIONS);
            return false;
        }
        if (!evaluate_condition(l, s, "a number as size", &x))
            return false;
        if (!(x + slack >= 1)) {
            diag_error(l->diag, s->at, "an array's size is at least 1, not %g", x);
            return false;
        }
        size_t most = l->limits->array_items;
        if (x > (double)most || (size_t)(x + slack) > most / a->n) {
            lang_limit(l, s->at, "an array of more than %zu elements (--max-array-items=N would let it be)", most);
            return false;
        }
        a->size[a->n_dimension++] = (size_t)(x + slack);
        a->n *= (size_t)(x + slack);
    }
    return true;
}

struct filling { struct lang *l; struct array *array; size_t at; };

static void say_elements(struct filling *f, const struct ast *list, size_t wanted, bool more)
{
    diag_error(f->l->diag, list->close.source ? list->close : list->at,
               "%s elements in braces: this dimension has %zu", more ? "too many" : "too few",
               wanted);
    diag_note(f->l->diag, list->at, "the braces open here");
}

static bool fill(struct filling *f, const struct ast *list, int dimension);

/* As in POV-Ray, an element is an expression or a thing, not a directive. */
static bool fill_one(struct filling *f, struct reader *r, int dimension)
{
    struct lang *l = f->l;
    struct value v = { .type = VALUE_NONE };

    if (dimension + 1 < f->array->n_dimension) {
        const struct item *i = reader_peek(r);
        if (i->kind != ITEM_BRACES) {
            diag_error(l->diag, i->at, "expected { } for the next dimension, found %s",
                       item_describe(l, i));
            return false;
        }
        return fill(f, reader_next(r).body, dimension + 1);
    }
    if (!thing_value(l, r, &v))
        return false;
    if (f->array->like.type != VALUE_NONE && !same_type(&f->array->like, &v)) {
        diag_error(l->diag, reader_at(r), "the elements of an array have one type: %s, not %s",
                   value_name(&f->array->like), value_name(&v));
        return false;
    }
    f->array->like = f->array->item[f->at++] = v;
    return true;
}

static size_t fill_fast(struct filling *f, struct reader *r, size_t most)
{
    enum { PORTION = 256 };
    double part[PORTION];
    size_t n;

    const struct value number = value_number(0);

    if (f->array->like.type != VALUE_NONE && !same_type(&f->array->like, &number))
        return 0;
    n = reader_bulk(r, 1, most < PORTION ? most : PORTION, part);
    for (size_t i = 0; i < n; i++)
        f->array->item[f->at++] = value_number(part[i]);
    if (n)
        f->array->like = number;
    return n;
}

/* POV-Ray reads no directives between the elements, so neither do we. */
static bool is_simple(struct lang *l, const struct ast *list)
{
    for (const struct ast *a = list->first; a; a = a->next)
        if (a->kind >= AST_DECLARE || (a->kind == AST_CALL && is_macro(a->name))) {
            diag_error(l->diag, a->at, "%s cannot stand between an array's elements%s",
                       a->kind == AST_CALL ? "a macro call" : "a directive",
                       a->kind == AST_CALL ? "; parentheses around it would do" : "");
            return false;
        }
    return true;
}

static bool fill(struct filling *f, const struct ast *list, int dimension)
{
    struct reader r;
    size_t n = 0, wanted = f->array->size[dimension];
    bool fine = true;

    if (!is_simple(f->l, list))
        return false;
    reader_open(&r, f->l, list);
    r.strict = true;
    while (fine && n < wanted) {
        size_t many = dimension + 1 == f->array->n_dimension ? fill_fast(f, &r, wanted - n) : 0;
        n += many;
        if (many)
            continue;
        if (reader_peek(&r)->kind == ITEM_END)
            break;
        fine = fill_one(f, &r, dimension);
        reader_skip_comma(&r);
        n++;
    }
    fine = fine && !r.failed;
    if (fine && (n < wanted || reader_peek(&r)->kind != ITEM_END)) {
        say_elements(f, list, wanted, n == wanted);
        fine = false;
    }
    reader_close(&r);
    return fine;
}

bool array_make(struct lang *l, const struct ast *node, struct value *out)
{
    struct array *a = arena_alloc(l->mem, sizeof *a);

    *out = value_thing(VALUE_ARRAY, a);
    if (!read_sizes(l, node, a)) {
        a->n = a->size[0] = 1;
        a->n_dimension = 1;
        a->item = arena_array(l->mem, 1, sizeof *a->item);
        return false;
    }
    a->item = arena_array(l->mem, a->n, sizeof *a->item);
    if (!node->body)
        return true;
    struct filling f = { l, a, 0 };
    return fill(&f, node->body, 0);
}
