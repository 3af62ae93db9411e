/* function.c: compiling function { }.
 *
 * The body is compiled when it is declared: names of numbers are frozen at
 * their values, macros are spliced in. */
#include "lang/function.h"

#include <math.h>
#include <string.h>

#include "lang/build.h"
#include "lang/call.h"
#include "lang/chain.h"
#include "lang/code.h"
#include "lang/eval.h"
#include "lang/frame.h"
#include "lang/guess.h"
#include "lang/scope.h"
#include "pattern/function.h"

enum { MOST_NAMES = MOST_PARAMETERS + 16 };

struct compiling {
    struct lang *l;
    struct function *f;
    size_t room_code;
    const struct name *name[MOST_NAMES];    /* parameters, and counters of sum and prod */
    int reg[MOST_NAMES];
    int n_name, n_parameter;
    int base;                               /* register of the slot 0 of the chain at work */
    bool failed;
};

static void compile(struct compiling *c, const struct ast *a, int to);
static void compile_list(struct compiling *c, const struct ast *list, int to);

static void fail(struct compiling *c, struct loc at, const char *message)
{
    if (!c->failed)
        diag_error(c->l->diag, at, "%s", message);
    c->failed = true;
}

static struct code *emit(struct compiling *c, enum operation op, int to)
{
    struct function *f = c->f;

    f->code = arena_grow(c->l->scene_mem, f->code, f->n_code, &c->room_code, sizeof *f->code);
    if (to + 6 > f->n_register)
        f->n_register = to + 6;
    f->code[f->n_code] = (struct code) { .op = (uint16_t)op, .to = (uint32_t)to };
    return &f->code[f->n_code++];
}

static void emit_number(struct compiling *c, double x, int to)
{
    struct code *code = emit(c, CODE_NUMBER, to);

    code->number = x;
    code->count = 1;
}

/* The last code, when it loads a constant that is not in parentheses. */
static struct code *last_constant(const struct function *f, size_t before)
{
    struct code *code = f->n_code > before ? &f->code[f->n_code - 1 - before] : NULL;

    return code && code->op == CODE_NUMBER && code->count ? code : NULL;
}

/* POV-Ray works out what stands between two constants, but not what is in parentheses. */
static void enclose(struct function *f)
{
    struct code *code = last_constant(f, 0);

    if (!code)
        return;
    code->count = 0;
    code->number += 0.0;                /* -0 is kept as 0 */
}

/* --- chains: operators of one level of parentheses --------------------------- */

static void chain_operand(struct chain *chain, const struct ast *a, int slot)
{
    struct compiling *c = chain->arg;
    int base = c->base;

    compile(c, a, base + slot);
    c->base = base;
}

static void emit_unary(struct compiling *c, struct loc at, int op, int to)
{
    if (op == '!')
        fail(c, at, "'!' cannot be used in a function");
    else if (op == '-' && last_constant(c->f, 0))
        last_constant(c->f, 0)->number *= -1;
    else if (op == '-')
        emit(c, CODE_NEG, to);
}

static void chain_unary(struct chain *chain, struct loc at, int op, int slot)
{
    struct compiling *c = chain->arg;

    emit_unary(c, at, op, c->base + slot);
}

static enum operation operation_of(int op)
{
    switch (op) {
    case '+': return CODE_ADD;
    case '-': return CODE_SUB;
    case '*': return CODE_MUL;
    case '/': return CODE_DIV;
    case '<': return CODE_LT;
    case '>': return CODE_GT;
    case '=': return CODE_EQ;
    case '&': return CODE_AND;
    case '|': return CODE_OR;
    case AST_OP_LE: return CODE_LE;
    case AST_OP_GE: return CODE_GE;
    default: return CODE_NE;
    }
}

/* Two constants are worked out at once, where even 1/0 has a value. */
static void emit_binary(struct compiling *c, struct loc at, int op, int to)
{
    struct code *left = last_constant(c->f, 1), *right = last_constant(c->f, 0);

    if (op == '/' && left && right) {
        left->number /= right->number;
        c->f->n_code--;
        return;
    }
    if (op == '/' && right && right->number == 0)
        fail(c, at, "division by zero");
    emit(c, operation_of(op), to);
}

static void chain_binary(struct chain *chain, struct loc at, int op, int slot)
{
    struct compiling *c = chain->arg;

    emit_binary(c, at, op, c->base + slot);
}

static void chain_member(struct chain *chain, const struct ast *a, int slot)
{
    (void)slot;
    fail(chain->arg, a->at, "only a vector function has components");
}

static const struct chain_ops code_ops = { chain_operand, chain_unary, chain_binary,
                                           chain_member, NULL, true };

static void compile_chain(struct compiling *c, const struct ast *a, const struct ast *list, int to)
{
    struct chain chain;
    int base = c->base;

    c->base = to;
    chain_start(&chain, c->l, &code_ops, c);
    if (a)
        chain_add(&chain, a);
    else
        chain_add_list(&chain, list);
    if (!chain_end(&chain, a ? a->at : list->at))
        c->failed = true;
    c->base = base;
}

/* --- operands -------------------------------------------------------------------- */

/* x and u are one parameter, y and v another: the last in the list counts. */
static char axis_of(const char *name)
{
    static const char names[] = "xyzuv";
    const char *at = name[1] ? NULL : strchr(names, name[0]);

    return !at ? 0 : at - names < 3 ? *at : at[-3];
}

static int axis_register(const struct compiling *c, char axis)
{
    int i = c->n_parameter - 1;

    while (i >= 0 && axis_of(c->name[i]->text) != axis)
        i--;
    return i;
}

static int register_of(const struct compiling *c, const struct name *name)
{
    for (int i = c->n_name; i-- > c->n_parameter;)
        if (c->name[i] == name)
            return c->reg[i];
    for (int i = 0; i < c->n_parameter; i++)
        if (c->name[i] == name)
            return c->reg[i];
    return -1;
}

static void compile_name(struct compiling *c, const struct ast *a, int to)
{
    int reg = register_of(c, a->name);
    struct value v;

    if (reg >= 0) {
        emit(c, CODE_MOVE, to)->from = (uint16_t)reg;
        return;
    }
    unsigned errors = c->l->diag->errors;
    evaluate(c->l, a, &v);
    if (errors != c->l->diag->errors)
        c->failed = true;
    else if (v.type != VALUE_NUMBER || v.n != 1)
        fail(c, a->at, arena_format(c->l->mem, "a %s cannot be used in a function: numbers only",
                                    value_name(&v)));
    else
        emit_number(c, v.v[0], to);
}

static void compile_constant(struct compiling *c, const struct ast *a, int to)
{
    char axis = axis_of(a->name->text);
    int reg = axis ? axis_register(c, axis) : -1;
    struct value v;

    if (reg >= 0) {
        emit(c, CODE_MOVE, to)->from = (uint16_t)reg;
        return;
    }
    if (axis) {                         /* not among the parameters: 0 */
        diag_warning(c->l->diag, a->at, "'%s' is no parameter of this function: it is 0",
                     a->word->text);
        emit_number(c, 0, to);
        enclose(c->f);
        return;
    }
    if (!word_is(a->word, "pi") && !word_is(a->word, "clock")) {
        fail(c, a->at, arena_format(c->l->mem, "'%s' is no parameter of this function",
                                    a->word->text));
        return;
    }
    a->word->constant->get(c->l, &v);
    emit_number(c, v.v[0], to);
}

/* The arguments of a call, into to, to + 1 ...; -1: failed. */
static int compile_arguments(struct compiling *c, const struct ast *list, int to)
{
    int n = 0;
    bool comma = true;

    if (list->flags & AST_PLAIN && list->first
        && (!(list->flags & AST_ALL_COMMAS) || list->flags & AST_LAST_COMMA)) {
        fail(c, list->at, "commas must stand between the arguments in a function");
        return -1;
    }
    if (list->flags & AST_PLAIN) {
        for (const struct ast *a = list->first; a && !c->failed; a = a->next)
            compile(c, a, to + n++);
        return c->failed ? -1 : n;
    }
    struct reader r;
    const struct ast *a;
    reader_start(&r, c->l, list);
    while (!c->failed && (a = reader_step(&r))) {
        if (a->kind == AST_COMMA)
            comma = true;
        else if (!comma || !ast_is_value(a))
            fail(c, a->at, "expected a comma between arguments");
        else {
            compile(c, a, to + n++);
            comma = false;
        }
    }
    c->failed = c->failed || r.failed;
    reader_close(&r);
    return c->failed ? -1 : n;
}

static void say_count(struct compiling *c, const struct ast *a, const char *name, int wanted, int n)
{
    fail(c, a->at, arena_format(c->l->mem, "%s takes %d argument%s, not %d", name, wanted,
                                wanted == 1 ? "" : "s", n));
}

enum { SUM_ARGUMENTS = 4 };

/* The arguments of sum and prod; a call among them leaves the commas in the list. */
static bool sum_arguments(const struct ast *list, const struct ast *argument[SUM_ARGUMENTS])
{
    bool packed = list->flags & AST_PLAIN;
    int n = 0;

    for (const struct ast *a = list->first; a; a = a->next) {
        if (a->kind == AST_COMMA)
            continue;
        if (n == SUM_ARGUMENTS || !ast_is_value(a))
            return false;
        argument[n++] = a;
        if (!packed && n < SUM_ARGUMENTS && !(a->next && a->next->kind == AST_COMMA))
            return false;
    }
    return n == SUM_ARGUMENTS && argument[0]->kind == AST_NAME
        && (!packed || list->flags & AST_ALL_COMMAS);
}

/* sum(i, from, to, term) */
static void compile_sum(struct compiling *c, const struct ast *a, int to)
{
    const struct ast *argument[SUM_ARGUMENTS];
    bool is_sum = word_is(a->word, "sum");

    if (!sum_arguments(a->args, argument)) {
        fail(c, a->at, "sum and prod take a new name, two bounds and a term");
        return;
    }
    if (scope_find(argument[0]->name)) {
        fail(c, argument[0]->at, arena_format(c->l->mem, "'%s' is declared already: it cannot count here",
                                              argument[0]->name->text));
        return;
    }
    compile(c, argument[1], to);
    compile(c, argument[2], to + 1);
    if (c->n_name == MOST_NAMES) {
        fail(c, a->at, "too many sums in each other");
        return;
    }
    size_t at = (size_t)(emit(c, is_sum ? CODE_SUM : CODE_PROD, to) - c->f->code);
    c->name[c->n_name] = argument[0]->name;
    c->reg[c->n_name++] = to + 2;
    compile(c, argument[3], to + 3);
    c->n_name--;
    c->f->code[at].count = (uint32_t)(c->f->n_code - at - 1);
}

static double sqrt_in_function(double x) { return sqrt(x); }
static double degrees_in_function(double x) { return x * (180 / M_PI); }

/* Functions with checks outside have none inside: the values come at run time;
 * and POV-Ray rounds degrees otherwise there. */
static double (*unchecked(const char *name))(double)
{
    static const struct { const char *name; double (*function)(double); } rows[] = {
        { "acos", acos }, { "asin", asin }, { "ln", log }, { "log", log10 },
        { "sqrt", sqrt_in_function }, { "degrees", degrees_in_function },
    };

    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++)
        if (strcmp(rows[i].name, name) == 0)
            return rows[i].function;
    return NULL;
}

static void compile_many(struct compiling *c, const struct ast *a, int n, int to)
{
    bool is_min = word_is(a->word, "min");

    if (n < 2)
        say_count(c, a, a->word->text, 2, n);
    for (int i = n - 1; i > 0; i--)
        emit(c, is_min ? CODE_MIN : CODE_MAX, to + i - 1);
}

static void compile_func(struct compiling *c, const struct ast *a, int to)
{
    const struct call *call = a->word->call;

    if (!call->in_functions || word_is(a->word, "internal")) {
        fail(c, a->at, arena_format(c->l->mem, "'%s' cannot be used in a function",
                                    a->word->text));
        return;
    }
    if (word_is(a->word, "sum") || word_is(a->word, "prod")) {
        compile_sum(c, a, to);
        return;
    }
    int n = compile_arguments(c, a->args, to);
    if (n < 0)
        return;
    if (word_is(a->word, "min") || word_is(a->word, "max")) {
        compile_many(c, a, n, to);
        return;
    }
    if (word_is(a->word, "select")) {
        if (n != 3 && n != 4)
            say_count(c, a, "select", 3, n);
        emit(c, n == 3 ? CODE_SELECT3 : CODE_SELECT4, to);
        return;
    }
    int wanted = (int)strlen(call->takes);
    if (n != wanted) {
        say_count(c, a, call->name, wanted, n);
        return;
    }
    double (*one)(double) = unchecked(call->name);
    one = one ? one : call->of_one;
    if (wanted == 1)
        emit(c, CODE_ONE, to)->one = one;
    else
        emit(c, CODE_TWO, to)->two = call->of_two ? call->of_two
            : word_is(a->word, "atan2") ? atan2 : pow;
}

static const struct function *called(struct compiling *c, const struct ast *a)
{
    struct binding *b = scope_find(a->name);

    if (!b && a->name == c->l->declaring) {
        diag_warning(c->l->diag, a->at, "function '%s' calls itself: that never ends", a->name->text);
        c->f->is_recursive = true;
        return c->f;
    }
    if (b && b->value->type == VALUE_FUNCTION && !a->params)
        return b->value->thing;
    struct guess g = guess_start(a->name->text);
    guess_names(&g, c->l);
    fail(c, a->at, arena_format(c->l->mem, "'%s' is no function%s", a->name->text,
                                b ? "" : guess_text(&g, c->l)));
    return NULL;
}

static void compile_call(struct compiling *c, const struct ast *a, int component, int to)
{
    const struct function *f = called(c, a);

    if (!f)
        return;
    int n = compile_arguments(c, a->args, to);
    if (n < 0)
        return;
    if (n != f->n_parameter && f != c->f)
        say_count(c, a, a->name->text, f->n_parameter, n);
    else if (component < 0 && f->n_component > 1)
        fail(c, a->at, "a vector function needs a component here: .x, .red ...");
    else if (component >= f->n_component)
        fail(c, a->at, "the function has no such component");
    else {
        if (f == c->f) {                /* refused where it is called */
            emit_number(c, 0, to);
            return;
        }
        c->f->is_recursive |= f->is_recursive;
        if (f->unsupported)
            c->f->unsupported = f->unsupported;
        nest_add(&c->f->nest, f->nest);
        struct code *code = emit(c, CODE_CALL, to);
        code->function = f;
        code->from = (uint16_t)(component < 0 ? 0 : component);
    }
}

static void compile_gray(struct compiling *c, const struct ast *a, int to)
{
    static const double weight[3] = { 0.297, 0.589, 0.114 };

    for (int i = 0; i < 3; i++) {
        compile_call(c, a, i, to + (i > 0));
        emit_number(c, weight[i], to + 1 + (i > 0));
        emit(c, CODE_MUL, to + (i > 0));
        if (i)
            emit(c, CODE_ADD, to);
    }
}

static void compile_member(struct compiling *c, const struct ast *a, int to)
{
    if (a->left->kind != AST_CALL)
        fail(c, a->at, "only a vector function has components here");
    else if (a->index >= AST_GRAY)
        compile_gray(c, a->left, to);
    else
        compile_call(c, a->left, a->index, to);
}

static bool is_logic(const struct ast *a)
{
    return a->kind == AST_BINARY && (a->op == '&' || a->op == '|');
}

static void compile(struct compiling *c, const struct ast *a, int to)
{
    if (c->failed || to > 60000) {
        fail(c, a->at, "this function is too large");
        return;
    }
    if (chain_needed(a) || is_logic(a)) {
        compile_chain(c, a, NULL, to);
        return;
    }
    switch (a->kind) {
    case AST_NUMBER: emit_number(c, a->number, to); return;
    case AST_NAME: compile_name(c, a, to); return;
    case AST_CONSTANT: compile_constant(c, a, to); return;
    case AST_INDEX: compile_name(c, a, to); return;
    case AST_PAREN:
        compile_list(c, a->args, to);
        enclose(c->f);
        return;
    case AST_FUNC: compile_func(c, a, to); return;
    case AST_CALL: compile_call(c, a, -1, to); return;
    case AST_MEMBER: compile_member(c, a, to); return;
    case AST_UNARY:
        if (a->right->kind == AST_UNARY)        /* outside, signs may be repeated */
            fail(c, a->right->at, "a second sign in a row cannot stand in a function");
        compile(c, a->right, to);
        emit_unary(c, a->at, a->op, to);
        return;
    case AST_BINARY:
        compile(c, a->left, to);
        compile(c, a->right, to + 1);
        emit_binary(c, a->at, a->op, to);
        return;
    case AST_ERROR:
        fail(c, a->at, a->text);
        return;
    case AST_VECTOR: case AST_LITERAL: fail(c, a->at, "a vector cannot be used in a function"); return;
    case AST_TEXT: fail(c, a->at, "a text cannot be used in a function"); return;
    default: fail(c, a->at, "this cannot be used in a function");
    }
}

static void compile_list(struct compiling *c, const struct ast *list, int to)
{
    for (const struct ast *a = list->first; a; a = a->next)
        if (a->kind == AST_SEMICOLON)
            fail(c, a->at, "';' cannot stand in a function");
    if (c->failed)
        return;
    if (list->flags & AST_PLAIN && list->n == 1 && !(list->flags & AST_LAST_COMMA))
        compile(c, list->first, to);
    else
        compile_chain(c, NULL, list, to);
}

/* --- declaring one ------------------------------------------------------------------ */

static void add_name(struct compiling *c, const struct name *name)
{
    c->name[c->n_name] = name;
    c->reg[c->n_name] = c->n_name;
    c->n_name++;
}

static void default_parameters(struct compiling *c)
{
    static const char *const names[] = { "x", "y", "z" };

    for (int i = 0; i < 3; i++)
        add_name(c, name_intern(&c->l->names, names[i], 1));
}

static bool may_be_parameter(const struct ast *a)
{
    return a->kind == AST_NAME || (a->kind == AST_CONSTANT && strlen(a->name->text) == 1
                                   && strchr("xyzuv", *a->name->text));
}

static void read_parameters(struct compiling *c, const struct ast *params)
{
    for (const struct ast *a = params->first; a && !c->failed; a = a->next) {
        if (a->kind == AST_COMMA && !(a != params->first && a->next && a->next->kind != AST_COMMA))
            fail(c, a->at, "a parameter is missing beside this comma");
        if (a->kind == AST_COMMA)
            continue;
        if (!may_be_parameter(a))
            fail(c, a->at, arena_format(c->l->mem, "'%s' cannot be a parameter of a function",
                                        a->name->text));
        else if (a->kind == AST_NAME && scope_find(a->name))
            fail(c, a->at, arena_format(c->l->mem, "'%s' is declared already: it cannot be "
                                        "a parameter of a function", a->name->text));
        else if (c->n_name == MOST_PARAMETERS)
            fail(c, a->at, arena_format(c->l->mem, "a function has at most %d parameters",
                                        MOST_PARAMETERS));
        else
            add_name(c, a->name);
    }
    if (c->n_name == 0)
        fail(c, params->at, "a function has at least one parameter");
}

static struct item block_item(const struct ast *block)
{
    return (struct item) { .kind = ITEM_BLOCK, .at = block->at, .word = block->word,
                           .text = block->name->text, .body = block->body,
                           .brace = block->body->at };
}

static void transform_function(struct compiling *c, const struct ast *block)
{
    struct item i = block_item(block);
    struct value v = { .type = VALUE_NONE };

    c->f->kind = FUNCTION_TRANSFORM;
    c->f->n_component = 3;
    if (build_value(c->l, block->word, &i, &v) && v.type == VALUE_TRANSFORM)
        c->f->transform = v.thing;
    else
        c->failed = true;
}

static void pigment_function(struct compiling *c, const struct ast *block)
{
    struct item i = block_item(block);

    c->f->kind = FUNCTION_PIGMENT;
    c->f->n_component = 5;
    c->f->pigment = build_pigment(c->l, &i, build_of(c->l)->texture->pigment);
    nest_add(&c->f->nest, c->f->pigment->nest);
    c->f->unsupported = pigment_unsupported(c->f->pigment);
}

/* POV-Ray's list of patterns that are for surfaces or have more than a number to say. */
static bool is_for_functions(const char *word)
{
    static const char *const others[] = { "square", "triangular", "tiling", "pavement", "slope",
                                          "aoi", "average", "facets", "image_map", "bump_map" };

    for (size_t i = 0; i < sizeof others / sizeof *others; i++)
        if (strcmp(others[i], word) == 0)
            return false;
    return true;
}

static void pattern_function(struct compiling *c, const struct ast *block)
{
    struct item i = block_item(block);
    struct patterned p = patterned_new(VALUE_FUNCTION);
    struct reader r;
    struct arena *mem = c->l->scene_mem;

    reader_open(&r, c->l, i.body);
    build_patterned(&r, &p, &i);
    reader_close(&r);
    if (!p.word || p.uv_mapping || !is_for_functions(p.word))
        fail(c, block->at, p.word && !p.uv_mapping
             ? arena_format(c->l->mem, "the pattern '%s' cannot be a function", p.word)
             : "a pattern must stand in function { pattern { } }");
    c->f->kind = FUNCTION_PATTERN;
    c->f->pattern = arena_copy(mem, &p.use, sizeof p.use);
    c->f->transform = arena_copy(mem, &p.place, sizeof p.place);
    nest_add(&c->f->nest, p.nest);
    c->f->unsupported = p.unsupported;
}

static void spline_function(struct compiling *c, const struct ast *block)
{
    struct value v;

    c->failed = !spline_make(c->l, block, &v);
    if (c->failed)
        return;
    c->f->kind = FUNCTION_SPLINE;
    c->f->spline = v.thing;
    c->f->n_component = spline_components(v.thing);
    c->n_name = 1;
}

/* function { pigment { } } and the like; false: an expression. */
static bool special_function(struct compiling *c, const struct ast *body, bool has_parameters)
{
    const struct ast *a = body->first;

    if (!a || a->kind != AST_BLOCK || !a->word)
        return false;
    if (has_parameters)
        fail(c, a->at, "such a function has no list of parameters");
    else if (word_is(a->word, "transform"))
        transform_function(c, a);
    else if (word_is(a->word, "spline"))
        spline_function(c, a);
    else if (word_is(a->word, "pigment"))
        pigment_function(c, a);
    else if (word_is(a->word, "pattern"))
        pattern_function(c, a);
    else
        fail(c, a->at, arena_format(c->l->mem, "'%s { }' cannot be a function", a->word->text));
    if (!c->failed && a->next)
        fail(c, a->next->at, "nothing can follow in this function");
    return true;
}

static bool internal_function(struct compiling *c, const struct ast *body)
{
    const struct ast *a = body->first;
    double number;

    if (!a || a->next || a->kind != AST_FUNC || !word_is(a->word, "internal"))
        return false;
    if (!evaluate_number(c->l, a->args, "a number", &number)) {
        c->failed = true;
        return true;
    }
    c->f->kind = FUNCTION_INTERNAL;
    c->f->internal = internal_find(number);
    c->f->noise_generator = &c->l->scene->settings.noise_generator;
    if (number == 59)                   /* f_ridged_mf */
        c->f->weights = arena_alloc(c->l->scene_mem, sizeof *c->f->weights);
    if (!c->f->internal)
        fail(c, a->at, arena_format(c->l->mem, "there is no internal function %g", number));
    else
        c->n_name = c->f->internal->parameters;
    return true;
}

enum { REGISTERS_OF_LEVEL = 64 };       /* they stand on the stack, for many points at once */

bool function_make(struct lang *l, const struct ast *node, struct value *out)
{
    struct function *f = arena_alloc(l->scene_mem, sizeof *f);
    struct compiling c = { .l = l, .f = f };

    *f = (struct function) { .kind = FUNCTION_CODE, .n_component = 1, .at = node->at };
    *out = value_thing(VALUE_FUNCTION, f);
    if (node->params)
        read_parameters(&c, node->params);
    else
        default_parameters(&c);
    if (!c.failed && !special_function(&c, node->body, node->params)
        && !internal_function(&c, node->body)) {
        f->n_parameter = f->n_register = c.n_parameter = c.n_name;
        compile_list(&c, node->body, c.n_name);
    }
    f->n_parameter = c.n_name;
    if (c.failed || f->n_register > 65000) {
        f->n_code = 0;
        f->n_register = f->n_parameter + 1;
        emit_number(&c, 0, f->n_parameter);
        f->kind = FUNCTION_CODE;
    }
    f->nest.levels += (unsigned)f->n_register / REGISTERS_OF_LEVEL;
    return lang_may_nest(l, node->at, &f->nest) && !c.failed;
}

bool function_run_counted(struct lang *l, struct loc at, const struct function *f,
                          const double *arguments, double *out)
{
    double left = l->limits->iterations - l->rounds, all = left;

    function_run(f, arguments, out, &left);
    l->rounds += all - left;
    if (left < 0)
        lang_limit(l, at, "the loops and sums of this scene have run more than %.0f times; "
                   "--max-iterations=N would let them go on", l->limits->iterations);
    return left >= 0;
}

void function_call(struct lang *l, const struct ast *node, const struct function *f,
                   struct value *out)
{
    struct values list;
    double argument[MOST_PARAMETERS], result[MOST_COMPONENTS];
    int n = evaluate_list(l, node->args, &list, false);

    if (n < 0)
        return;
    if (n != f->n_parameter || list.last_comma) {
        diag_error(l->diag, node->at, "function '%s' takes %d argument%s, not %d%s",
                   node->name->text, f->n_parameter, f->n_parameter == 1 ? "" : "s", n,
                   list.last_comma ? " and a comma" : "");
        return;
    }
    if (f->is_recursive) {
        diag_error(l->diag, node->at, "function '%s' calls itself without end", node->name->text);
        return;
    }
    if (f->unsupported) {
        diag_error(l->diag, node->at, "function '%s' needs %s, which is not supported yet",
                   node->name->text, f->unsupported);
        return;
    }
    for (int i = 0; i < n; i++) {
        const struct value *v = &list.item[i].value;
        if (!value_is_number(v) || v->n != 1) {
            wrong_type(l, list.item[i].from->at, v, "a number");
            return;
        }
        argument[i] = v->v[0];
    }
    function_run_counted(l, node->at, f, argument, result);
    *out = value_vector(f->n_component, result);
}

bool function_as_pattern(struct lang *l, struct loc at, const struct function *f,
                         struct function_pattern *out, const char **unsupported)
{
    *unsupported = f->unsupported;
    if (f->n_component != 1 || f->n_parameter != 3)
        diag_error(l->diag, at, "a pattern needs a function of x, y, z that gives one number");
    else if (f->is_recursive)
        diag_error(l->diag, at, "this function calls itself without end");
    else {
        out->function = (struct callable) { function_values, f };
        return true;
    }
    return false;
}

const struct function *function_of_grey(struct lang *l, const struct pigment *p, struct loc at)
{
    struct function *f = arena_alloc(l->scene_mem, sizeof *f);

    *f = (struct function) { .kind = FUNCTION_GREY, .n_parameter = 3, .n_component = 1,
                             .pigment = p, .unsupported = pigment_unsupported(p), .at = at };
    nest_add(&f->nest, p->nest);
    return f;
}
