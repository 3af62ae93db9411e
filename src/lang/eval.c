/* eval.c: expressions to values. */
#include "lang/eval.h"

#include <math.h>
#include <string.h>

#include "lang/array.h"
#include "lang/call.h"
#include "lang/chain.h"
#include "lang/frame.h"
#include "lang/function.h"
#include "lang/guess.h"
#include "lang/scope.h"

static const double tolerance = 1e-10;  /* POV-Ray's, absolute */

bool is_true(double x)
{
    return fabs(x) > tolerance;
}

/* NaN equals NaN: the difference is not large. */
bool is_equal(double a, double b)
{
    return !(fabs(a - b) > tolerance);
}

void harmless(struct value *out)
{
    *out = value_number(1);             /* as a radius or scale 0 would be the next mistake */
}

void wrong_type(struct lang *l, struct loc at, const struct value *v, const char *wanted)
{
    diag_error(l->diag, at, "expected %s, found %s", wanted, value_describe(l, v));
}

/* --- operators -------------------------------------------------------------- */

static double compare(int op, double a, double b)
{
    switch (op) {
    case '<': return a < b;
    case '>': return a > b;
    case AST_OP_LE: return a <= b || is_equal(a, b);
    case AST_OP_GE: return a >= b || is_equal(a, b);
    case '=': return is_equal(a, b);
    default: return !is_equal(a, b);
    }
}

/* Where an operator is: the last one before its right side. */
static struct loc operator_at(const struct lang *l, const struct ast *node)
{
    const struct source *s = source_at(l->sources, node->at.source);
    uint32_t i = node->right->at.begin;

    while (s && i > node->at.begin)
        if (s->text[--i] == node->op)
            return (struct loc) { node->at.source, i, i + 1 };
    return node->at;
}

static double divide(struct lang *l, struct loc at, double a, double b)
{
    if (b != 0)
        return a / b;
    diag_warning(l->diag, at, "division by zero");
    return INFINITY;
}

static double operate(struct lang *l, struct loc at, int op, double a, double b)
{
    switch (op) {
    case '+': return a + b;
    case '-': return a - b;
    case '*': return a * b;
    case '/': return divide(l, at, a, b);
    case '&': return is_true(a) && is_true(b);
    case '|': return is_true(a) || is_true(b);
    default: return compare(op, a, b);
    }
}

/* The smaller operand grows: a number into all components, a vector by zeros. */
static void extend(struct value *v, int n)
{
    for (int i = v->n; i < n; i++)
        v->v[i] = v->n == 1 ? v->v[0] : 0;
    if (n > v->n)
        v->n = (int16_t)n;
}

static void fill(struct value *v)
{
    for (int i = v->n; i < MOST_COMPONENTS; i++)
        v->v[i] = value_component(v, i);
}

/* The left operand is as wide as the place wants when it is a number or stands in
 * parentheses: 3 + <1, 2> is <4, 5, 3> where three are wanted, <1, 2> + 3 is <4, 5, 0>. */
static void mix(struct lang *l, struct loc at, int op, struct value *a, struct value *b)
{
    bool wide = a->rest == REST_WIDE || (a->n == 1 && a->rest == REST_NONE);
    int n = a->n > b->n ? a->n : b->n;

    fill(a);
    extend(a, n);
    b->rest = REST_NONE;
    fill(b);
    for (int i = 0; i < n; i++)
        a->v[i] = operate(l, at, op, a->v[i], b->v[i]);
    for (int i = n; wide && i < MOST_COMPONENTS; i++)
        a->v[i] = op == '/' && b->v[i] == 0 ? HUGE_VAL : operate(l, at, op, a->v[i], b->v[i]);
    if (wide)
        a->rest = REST_WIDE;
}

/* Is there nothing behind the components that a place could ask for? */
static bool is_usual(const struct value *a, const struct value *b)
{
    return a->rest == REST_NONE && (a->n > 1 || b->n > 2);
}

static void compare_texts(struct lang *l, struct loc at, int op, struct value *a,
                          const struct value *b)
{
    if (strchr("+-*/&|", op)) {
        diag_error(l->diag, at, "'%c' cannot join texts%s", op, op == '+' ? ": use concat" : "");
        harmless(a);
    } else
        *a = value_number(compare(op, text_compare(&a->text, &b->text), 0));
}

void binary(struct lang *l, struct loc at, int op, struct value *a, const struct value *b)
{
    struct value other;

    if (a->type == VALUE_NUMBER && b->type == VALUE_NUMBER && a->n == 1 && b->n == 1) {
        a->v[0] = operate(l, at, op, a->v[0], b->v[0]);
        return;
    }
    if (a->type == VALUE_TEXT && b->type == VALUE_TEXT) {
        compare_texts(l, at, op, a, b);
        return;
    }
    if (!value_is_number(a) || !value_is_number(b)) {
        wrong_type(l, at, value_is_number(a) ? b : a, "numbers on both sides");
        harmless(a);
        return;
    }
    other = *b;
    if (other.type == VALUE_COLOUR)
        a->type = VALUE_COLOUR;
    if (!is_usual(a, b)) {
        mix(l, at, op, a, &other);
        return;
    }
    extend(a, b->n);
    extend(&other, a->n);
    for (int i = 0; i < a->n; i++)
        a->v[i] = operate(l, at, op, a->v[i], other.v[i]);
}

void unary(struct lang *l, struct loc at, int op, struct value *v)
{
    if (!value_is_number(v)) {
        wrong_type(l, at, v, "a number");
        harmless(v);
        return;
    }
    for (int i = 0; i < (v->rest == REST_WIDE ? MOST_COMPONENTS : v->n); i++)
        v->v[i] = op == '-' ? -v->v[i] : op == '!' ? !is_true(v->v[i]) : v->v[i];
}

static double grey(const struct value *v)
{
    double blue = v->n > 2 ? v->v[2] : 0;

    return 0.297 * v->v[0] + 0.589 * (v->n > 1 ? v->v[1] : 0) + 0.114 * blue;
}

/* The component replaces the first; the others stay: V.y is <V.y, V.y, V.z> where three
 * are wanted. */
void member(struct lang *l, const struct ast *a, struct value *v)
{
    int index = a->index;

    if (!value_is_number(v)) {
        wrong_type(l, a->at, v, "a vector or colour");
        harmless(v);
        return;
    }
    fill(v);
    if (index == AST_GREY)
        diag_error(l->diag, a->at, "'.grey' can be used in function { } only; here it is '.gray'");
    else if (index == AST_GRAY)
        v->v[0] = grey(v);
    else if (index >= v->n) {
        diag_error(l->diag, a->at, "a %s of %d component%s has no such component", value_name(v),
                   v->n, v->n == 1 ? "" : "s");
        harmless(v);
        return;
    } else
        v->v[0] = v->v[index];
    v->type = VALUE_NUMBER;
    v->rest = REST_KEPT;
    v->n = 1;
}

/* --- operands ---------------------------------------------------------------- */

static void eval(struct lang *l, const struct ast *a, struct value *out);

void say_unknown_call(struct lang *l, struct loc at, const char *name)
{
    struct guess g = guess_start(name);

    guess_names(&g, l);
    for (size_t i = 0; i < l->n_word; i++)
        if (l->word[i].class == WORD_FUNC || l->word[i].class == WORD_FUNC1)
            guess_try(&g, l->word[i].text);
    at.end = at.begin + (uint32_t)strlen(name);
    diag_error(l->diag, at, "unknown function '%s'%s", name, guess_text(&g, l));
    guess_note(&g, l);
    scope_declare_broken(l, name_intern(&l->names, name, strlen(name)), at);
}

static void warn_deprecated(struct lang *l, struct loc at, struct binding *b)
{
    diag_warning(l->diag, at, "%s", b->deprecated);
    if (b->warn_once)
        b->deprecated = NULL;
}

static void eval_name(struct lang *l, const struct ast *a, struct value *out)
{
    struct binding *b = scope_find(a->name);

    if (!b) {
        if (a->kind == AST_CALL)
            say_unknown_call(l, a->at, a->name->text);
        else
            say_undeclared(l, a->at, a->name->text, NULL);
        harmless(out);
        return;
    }
    if (b->deprecated)
        warn_deprecated(l, a->at, b);
    if (b->is_broken)
        diag_repeat(l->diag);
    const struct value *v = b->value;
    if (v->type == VALUE_NUMBER && v->n == 1) {
        out->type = VALUE_NUMBER;
        out->n = 1;
        out->rest = REST_NONE;
        out->v[0] = v->v[0];
        return;
    }
    *out = *v;
    if (v->type == VALUE_MACRO) {
        diag_error(l->diag, a->at, "macro '%s' is called without parentheses", a->name->text);
        harmless(out);
    } else if (v->type == VALUE_NONE) {
        diag_error(l->diag, a->at, "'%s' has no value", a->name->text);
        harmless(out);
    }
}

static void eval_index(struct lang *l, const struct ast *a, struct value *out)
{
    const struct value *v = array_item(l, a, false);

    if (v)
        *out = *v;
    else
        harmless(out);
}

static void eval_vector(struct lang *l, const struct ast *a, struct value *out)
{
    struct values list;
    struct value v = { .type = VALUE_NUMBER };
    int n = evaluate_list(l, a->args, &list, false);

    harmless(out);
    if (n < 0)
        return;
    if (n < 2 || n > 5 || (n == 5 && list.last_comma)) {
        diag_error(l->diag, a->at, "a vector has 2 to 5 components, not %d%s", n,
                   n == 5 ? " and a comma" : "");
        return;
    }
    for (int i = 0; i < n; i++) {
        if (!value_is_number(&list.item[i].value) || list.item[i].value.n != 1) {
            wrong_type(l, list.item[i].from->at, &list.item[i].value, "a number as component");
            return;
        }
        v.v[i] = list.item[i].value.v[0];
    }
    v.n = (int16_t)n;
    *out = v;
}

static void eval_condition(struct lang *l, const struct ast *a, struct value *out)
{
    struct value condition, other;

    evaluate(l, a->left, &condition);
    evaluate(l, a->right, out);
    evaluate(l, a->third, &other);
    if (!value_is_number(&condition) || condition.n != 1)
        wrong_type(l, a->left->at, &condition, "a number before '?'");
    else if (out->type == VALUE_TEXT || other.type == VALUE_TEXT) {
        diag_error(l->diag, a->at, "'?' and ':' choose between numbers, not texts");
        harmless(out);
    } else if (!is_true(condition.v[0]))
        *out = other;
}

static void eval_call(struct lang *l, const struct ast *a, struct value *out)
{
    struct value called;

    if (a->params) {
        const struct ast element = { .kind = AST_INDEX, .at = a->at, .name = a->name,
                                     .args = a->params };
        eval_index(l, &element, &called);
    } else
        eval_name(l, a, &called);
    harmless(out);
    if (called.type == VALUE_FUNCTION)
        function_call(l, a, called.thing, out);
    else if (called.type == VALUE_SPLINE)
        spline_call(l, a, called.thing, out);
    else if (a->params || (scope_find(a->name) && !scope_find(a->name)->is_broken))
        diag_error(l->diag, a->at, "'%s' is %s, not a function or macro", a->name->text,
                   value_describe(l, &called));
}

static void eval_binary(struct lang *l, const struct ast *a, struct value *out)
{
    struct value right;

    eval(l, a->left, out);
    eval(l, a->right, &right);
    if (out->type == VALUE_NUMBER && right.type == VALUE_NUMBER && out->n == 1 && right.n == 1
        && (a->op == '+' || a->op == '-' || a->op == '*'))
        out->v[0] = a->op == '+' ? out->v[0] + right.v[0]
            : a->op == '-' ? out->v[0] - right.v[0] : out->v[0] * right.v[0];
    else
        binary(l, a->op == '/' && value_is_number(&right) && right.v[0] == 0 ? operator_at(l, a) : a->at,
               a->op, out, &right);
}

/* A text cannot stand in parentheses, as POV-Ray looks for a comparison behind it. */
static void say_lone_text(struct lang *l, struct loc at, struct value *v)
{
    diag_error(l->diag, at, "a text in parentheses must be compared with another");
    harmless(v);
}

/* In parentheses a colour is five numbers like any others, and what is too short for the
 * place is made longer before it is used. */
static void eval_paren(struct lang *l, const struct ast *a, struct value *out)
{
    if (a->args->flags & AST_ALL_COMMAS && a->args->n > 1) {
        diag_error(l->diag, a->at, "a vector stands between < and >, not in parentheses");
        harmless(out);
        return;
    }
    evaluate_one(l, a->args, "a value in the parentheses", out);
    if (out->type == VALUE_TEXT)
        say_lone_text(l, a->at, out);
    if (!value_is_number(out))
        return;
    out->type = VALUE_NUMBER;
    out->rest = REST_NONE;
    if (out->n == 1)
        return;
    fill(out);
    out->rest = REST_WIDE;
}

static void eval(struct lang *l, const struct ast *a, struct value *out)
{
    switch (a->kind) {
    case AST_NUMBER:
        out->type = VALUE_NUMBER;
        out->n = 1;
        out->rest = REST_NONE;
        out->v[0] = a->number;
        return;
    case AST_NAME: eval_name(l, a, out); return;
    case AST_BINARY: eval_binary(l, a, out); return;
    case AST_UNARY:
        eval(l, a->right, out);
        unary(l, a->at, a->op, out);
        return;
    case AST_FUNC: call_run(l, a, out); return;
    case AST_PAREN: eval_paren(l, a, out); return;
    case AST_VECTOR: eval_vector(l, a, out); return;
    case AST_LITERAL:
        out->type = VALUE_NUMBER;
        out->n = (int16_t)a->n;
        out->rest = REST_NONE;
        memcpy(out->v, a->v, sizeof out->v);
        return;
    case AST_INDEX: eval_index(l, a, out); return;
    case AST_CONSTANT: a->word->constant->get(l, out); return;
    case AST_MEMBER:
        eval(l, a->left, out);
        member(l, a, out);
        return;
    case AST_TEXT: *out = text_literal(l, a); return;
    case AST_CALL: eval_call(l, a, out); return;
    case AST_CONDITION: eval_condition(l, a, out); return;
    case AST_ERROR:
        say_parse_error(l, a);
        break;
    default:
        diag_error(l->diag, a->at, "expected a value");
    }
    harmless(out);
}

/* --- chains ------------------------------------------------------------------ */

static struct value *slot_of(struct chain *c, int slot)
{
    return &((struct value_chain *)c->arg)->value[slot];
}

static void chain_operand(struct chain *c, const struct ast *a, int slot)
{
    evaluate(c->lang, a, slot_of(c, slot));
}

static void chain_unary(struct chain *c, struct loc at, int op, int slot)
{
    unary(c->lang, at, op, slot_of(c, slot));
}

static void chain_binary(struct chain *c, struct loc at, int op, int slot)
{
    binary(c->lang, at, op, slot_of(c, slot), slot_of(c, slot + 1));
}

static void chain_member(struct chain *c, const struct ast *a, int slot)
{
    member(c->lang, a, slot_of(c, slot));
}

static bool chain_is_text(struct chain *c, int slot)
{
    return slot_of(c, slot)->type == VALUE_TEXT;
}

static const struct chain_ops value_ops = { chain_operand, chain_unary, chain_binary,
                                            chain_member, chain_is_text, false };

void value_chain_start(struct value_chain *c, struct lang *l)
{
    chain_start(&c->chain, l, &value_ops, c);
}

void value_chain_end(struct value_chain *c, struct loc at, struct value *out)
{
    if (chain_end(&c->chain, at))
        *out = c->value[0];
    else
        harmless(out);
}

static void evaluate_chain(struct lang *l, const struct ast *a, bool strict, struct value *out)
{
    struct value_chain c;

    if (!(a->flags & AST_HAS_CALL) || !chain_needed(a)) {
        eval(l, a, out);
        return;
    }
    value_chain_start(&c, l);
    c.chain.strict = strict;
    chain_add(&c.chain, a);
    value_chain_end(&c, a->at, out);
}

void evaluate(struct lang *l, const struct ast *a, struct value *out)
{
    evaluate_chain(l, a, false, out);
}

void evaluate_strictly(struct lang *l, const struct ast *a, struct value *out)
{
    evaluate_chain(l, a, true, out);
}

/* --- lists -------------------------------------------------------------------- */

static struct evaluated *room_for(struct lang *l, struct values *values)
{
    int n = values->n;

    if (n >= USUAL_VALUES && (n & (n - 1)) == 0) {      /* full: at 8, 16, 32 ... */
        struct evaluated *more = arena_array(l->mem, (size_t)n * 2, sizeof *more);
        memcpy(more, values->item, (size_t)n * sizeof *more);
        values->item = more;
    }
    return &values->item[values->n++];
}

static int plain_values(struct lang *l, const struct ast *list, struct values *values)
{
    for (const struct ast *a = list->first; a; a = a->next) {
        struct evaluated *e = room_for(l, values);
        e->from = a;
        evaluate(l, a, &e->value);
        e = &values->item[values->n - 1];
    }
    values->last_comma = list->flags & AST_LAST_COMMA;
    return values->n;
}

static bool take_value(struct lang *l, struct reader *r, struct values *values)
{
    struct item i = reader_next(r);

    if (i.kind != ITEM_VALUE) {
        if (i.kind == ITEM_NAME)
            say_undeclared(l, i.at, i.text, NULL);
        else if (!r->failed)
            diag_error(l->diag, i.at, "expected a value, found %s", item_describe(l, &i));
        return false;
    }
    struct evaluated *e = room_for(l, values);
    struct ast *from = arena_alloc(l->mem, sizeof *from);
    from->kind = AST_NUMBER;
    from->at = i.at;
    e->value = i.value;
    e->from = from;
    return true;
}

static int spliced_values(struct lang *l, const struct ast *list, struct values *values,
                          bool commas)
{
    struct reader r;
    bool fine = true, had_comma = true;

    reader_open(&r, l, list);
    while (fine && reader_peek(&r)->kind != ITEM_END) {
        if (reader_peek(&r)->kind == ITEM_COMMA) {
            fine = !had_comma && values->n;
            if (!fine)
                diag_error(l->diag, reader_peek(&r)->at, "a value is missing before this comma");
            had_comma = true;
            reader_next(&r);
            continue;
        }
        if (commas && !had_comma) {
            diag_error(l->diag, reader_peek(&r)->at, "a comma is missing here");
            fine = false;
            break;
        }
        fine = take_value(l, &r, values);
        had_comma = false;
    }
    fine = fine && !r.failed;
    reader_close(&r);
    values->last_comma = had_comma && values->n;
    return fine ? values->n : -1;
}

static bool is_simple(const struct ast *a)
{
    return a->kind == AST_NUMBER || a->kind == AST_TEXT || a->kind == AST_NAME
        || a->kind == AST_CONSTANT || a->kind == AST_LITERAL;
}

/* Carries out the directives of a list, up to what may be a mistake itself; strict:
 * POV-Ray takes none behind a value. */
static void run_directives(struct lang *l, const struct ast *list, bool strict)
{
    struct reader r;
    const struct ast *a;

    reader_open(&r, l, list);
    do
        a = reader_step(&r);
    while (a && (a->kind == AST_COMMA
                 || (is_simple(a) && !(strict && chain_is_interrupted(&r)))));
    reader_close(&r);
}

/* A list whose end is missing holds what was meant to stand behind it. */
bool say_unclosed(struct lang *l, const struct ast *list, bool strict)
{
    const struct ast *last = list->last;
    unsigned errors = l->diag->errors;

    if (!last || last->kind != AST_ERROR || !last->other.source)
        return false;
    run_directives(l, list, strict);
    if (errors == l->diag->errors)
        say_parse_error(l, last);
    return true;
}

int evaluate_list(struct lang *l, const struct ast *list, struct values *values, bool commas)
{
    if (say_unclosed(l, list, false))
        return -1;
    values->item = values->usual;
    values->n = 0;
    if (!(list->flags & AST_PLAIN))
        return spliced_values(l, list, values, commas);
    if (commas && !(list->flags & AST_ALL_COMMAS)) {
        diag_error(l->diag, list->at, "commas must stand between the arguments here");
        return -1;
    }
    return plain_values(l, list, values);
}

/* A list that should be one value, with operators from directives. */
static void chained(struct lang *l, const struct ast *list, bool strict, struct value *out)
{
    struct value_chain c;

    value_chain_start(&c, l);
    c.chain.strict = strict;
    chain_add_list(&c.chain, list);
    value_chain_end(&c, list->at, out);
}

static void one_of(struct lang *l, const struct ast *list, const char *what, bool strict,
                   struct value *out)
{
    if (list->flags & AST_PLAIN && list->n == 1 && !(list->flags & AST_LAST_COMMA))
        evaluate_chain(l, list->first, strict, out);
    else if (!list->first) {
        diag_error(l->diag, list->at, "expected %s", what);
        harmless(out);
    } else
        chained(l, list, strict, out);
}

void evaluate_one(struct lang *l, const struct ast *list, const char *what, struct value *out)
{
    one_of(l, list, what, false, out);
}

static bool number_of(struct lang *l, const struct ast *list, const char *what, bool strict,
                      double *out)
{
    unsigned errors = l->diag->errors;
    struct value v;

    *out = 0;
    one_of(l, list, what, strict, &v);
    if (errors != l->diag->errors)
        return false;
    if (!value_is_number(&v) || v.n != 1) {
        wrong_type(l, list->first ? list->first->at : list->at, &v, what);
        return false;
    }
    *out = v.v[0];
    return true;
}

bool evaluate_number(struct lang *l, const struct ast *list, const char *what, double *out)
{
    return number_of(l, list, what, false, out);
}

bool evaluate_condition(struct lang *l, const struct ast *list, const char *what, double *out)
{
    return number_of(l, list, what, true, out);
}

bool evaluate_text(struct lang *l, const struct ast *a, const char *what, struct text *out)
{
    unsigned errors = l->diag->errors;
    struct value v;

    evaluate(l, a, &v);
    if (v.type != VALUE_TEXT) {
        if (errors == l->diag->errors)      /* one mistake, one message */
            wrong_type(l, a->at, &v, what);
        *out = (struct text) { "", 0 };
        return false;
    }
    *out = v.text;
    return true;
}
