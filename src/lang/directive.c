/* directive.c: what each directive does when a reader comes to it. */
#include <math.h>
#include <string.h>

#include "lang/array.h"
#include "lang/build.h"
#include "lang/code.h"
#include "lang/colour.h"
#include "lang/eval.h"
#include "lang/file.h"
#include "lang/frame.h"
#include "lang/function.h"
#include "lang/guess.h"
#include "lang/include.h"
#include "lang/message.h"
#include "lang/parsing.h"
#include "lang/scope.h"

static const double tolerance = 1e-10;

/* --- #declare ---------------------------------------------------------------- */

static bool block_value(struct lang *l, const struct item *i, struct value *out)
{
    if (i->word && build_value(l, i->word, i, out))
        return true;
    struct guess g = guess_start(i->text ? i->text : "");
    guess_words(&g, l);
    diag_error(l->diag, i->at, "'%s' cannot be declared%s", i->text ? i->text : "{ }",
               i->word ? "" : guess_text(&g, l));
    return false;
}

static bool word_value(struct lang *l, struct reader *r, struct value *out)
{
    const struct item *i = reader_peek(r);

    if (i->word->class == WORD_RGB || i->word->class == WORD_COLOUR)
        return colour_read(r, out);
    struct item word = reader_next(r);
    if (build_word_value(l, r, &word, out))
        return true;
    diag_error(l->diag, word.at, "'%s' cannot be declared", word.text);
    return false;
}

static void say_no_value(struct lang *l, const struct item *i)
{
    struct guess g = guess_start(i->text ? i->text : "");

    if (i->kind == ITEM_NAME && i->body && !i->brace.source)
        say_unknown_call(l, i->at, i->text);
    else if (i->kind == ITEM_NAME && !i->brace.source)
        say_undeclared(l, i->at, i->text, NULL);
    else if (i->kind == ITEM_NAME) {
        guess_names(&g, l);
        guess_words(&g, l);
        diag_error(l->diag, i->at, "unknown word '%s'%s", i->text, guess_text(&g, l));
        guess_note(&g, l);
    } else
        diag_error(l->diag, i->at, "expected a value, found %s", item_describe(l, i));
}

bool thing_value(struct lang *l, struct reader *r, struct value *out)
{
    const struct item *i = reader_peek(r);
    struct item item;

    *out = (struct value) { .type = VALUE_NONE };
    switch (i->kind) {
    case ITEM_WORD: return word_value(l, r, out);
    case ITEM_VALUE:
        *out = reader_next(r).value;
        value_keep(out);
        return true;
    case ITEM_BLOCK:
        item = reader_next(r);
        return block_value(l, &item, out);
    default:
        if (!r->failed && !l->stopped)
            say_no_value(l, i);
        return false;
    }
}

/* A macro that ends with "5;" brings its own semicolon. */
static bool take_semicolon(struct reader *r)
{
    const struct ast *a;

    if (r->has_item || !(a = reader_look(r)) || a->kind != AST_SEMICOLON)
        return false;
    r->has_node = false;
    return true;
}

/* POV-Ray takes `t` for no beginning of a value; -t and (t) are. */
static bool begins_well(struct lang *l, const struct ast *a)
{
    if (!ast_is_value(a))
        return true;
    const struct ast *first = ast_leftmost(a);
    if (first->kind != AST_CONSTANT || !word_is(first->word, "t"))
        return true;
    diag_error(l->diag, first->at, "'t' cannot begin a value here; (t) can");
    return false;
}

/* POV-Ray expands no macro behind the `color` of a declaration. */
static bool may_declare(struct lang *l, const struct ast *list)
{
    const struct ast *a = list->first;

    if (!begins_well(l, a))
        return false;
    if ((a->kind == AST_BINARY && !strchr("+-*/", a->op)) || a->kind == AST_CONDITION)
        diag_error(l->diag, a->at, "a comparison, '&', '|' or '?' needs parentheses around it here");
    else if (a->kind == AST_WORD && a->word->class == WORD_COLOUR && a->next
             && a->next->kind == AST_CALL && is_macro(a->next->name))
        diag_error(l->diag, a->next->at, "a macro call cannot follow '%s' in a declaration",
                   a->word->text);
    else
        return true;
    return false;
}

bool declared_value(struct lang *l, const struct ast *list, struct value *out, bool *semicolon)
{
    struct reader r;

    if (list->first && !may_declare(l, list))
        return false;

    if (list->flags & AST_PLAIN && list->n == 1) {
        evaluate_strictly(l, list->first, out);
        value_keep(out);
        return true;
    }
    reader_open(&r, l, list);
    r.strict = true;
    bool fine = thing_value(l, &r, out);
    if (fine && *semicolon && !value_is_number(out) && chain_is_interrupted(&r)) {
        diag_error(l->diag, list->at, "no ';' can follow the directive that this value came from");
        fine = false;
    }
    if (fine && take_semicolon(&r))
        *semicolon = true;
    while (fine && out->type == VALUE_TEXTURE && item_is_block(reader_peek(&r), "texture")) {
        struct item layer = reader_next(&r);
        fine = build_value(l, layer.word, &layer, out);
    }
    if (fine && !r.failed && reader_peek(&r)->kind != ITEM_END) {
        diag_error(l->diag, reader_at(&r), "expected ';' at the end of the declaration, found %s",
                   item_describe(l, reader_peek(&r)));
        fine = false;
    }
    fine = fine && !r.failed;
    reader_close(&r);
    return fine;
}

/* Colours are kept in single precision. */
static void settle(struct value *v)
{
    if (!value_is_number(v) || v->n != 5)
        return;
    v->type = VALUE_COLOUR;
    for (int i = 0; i < 5; i++)
        v->v[i] = (double)(float)v->v[i];
}

static const char *mark_text(struct lang *l, const struct ast *marks, const struct ast *target)
{
    for (const struct ast *a = marks->first; a; a = a->next)
        if (a->kind == AST_TEXT)
            return a->text;
    return arena_format(l->mem, "'%s' is deprecated", target->name->text);
}

/* deprecated [once] ["text"]; other words were meant as a name. */
static bool check_marks(struct lang *l, const struct ast *node)
{
    for (const struct ast *a = node->marks ? node->marks->first : NULL; a; a = a->next) {
        if (a->kind == AST_TEXT || word_is(a->word, "deprecated") || word_is(a->word, "once"))
            continue;
        diag_error(l->diag, a->at, "'%s' is a reserved word: it cannot be declared",
                   a->name->text);
        return false;
    }
    if (!node->target)
        diag_error(l->diag, node->at, "the name is missing in this declaration");
    return node->target;
}

/* The name as it is seen, a #local's too. */
static bool may_replace(struct lang *l, const struct ast *node, const struct value *old,
                        const struct value *new)
{
    const char *name = node->target->name->text;

    if (old->type == VALUE_NONE)
        return true;
    if (old->type == VALUE_MACRO || (old->type == VALUE_FILE))
        diag_error(l->diag, node->target->at, "'%s' is a %s already; #undef it first", name,
                   value_name(old));
    else if (node->target->kind == AST_NAME
             && (old->type == VALUE_FUNCTION || new->type == VALUE_FUNCTION))
        diag_error(l->diag, node->target->at,
                   "'%s' is a %s already: functions need #undef before", name, value_name(old));
    else
        return true;
    return false;
}

static void mark(struct lang *l, struct binding *b, const struct ast *node)
{
    b->deprecated = mark_text(l, node->marks, node->target);
    for (const struct ast *a = node->marks->first; a; a = a->next)
        if (a->kind == AST_WORD && word_is(a->word, "once"))
            b->warn_once = true;
}

static void assign_name(struct lang *l, const struct ast *node, struct value *v)
{
    struct binding *old = scope_find(node->target->name);

    if (old && !may_replace(l, node, old->value, v))
        return;
    struct binding *b = scope_declare(l, node->target->name, node->op == 'l', node->target->at);
    b->is_broken = false;
    if (node->marks)
        mark(l, b, node);
    else if (b->deprecated)
        b->deprecated = NULL;
    if (v->type == VALUE_NUMBER && v->n == 1) {
        b->value->type = VALUE_NUMBER;
        b->value->n = 1;
        b->value->v[0] = v->v[0];
    } else
        *b->value = *v;
}

/* Numbers do, and what is read like them: the names of functions and splines. */
static bool needs_semicolon(const struct ast *node, const struct value *v)
{
    const struct ast *first = node->value->first;

    return value_is_number(v)
        || ((v->type == VALUE_FUNCTION || v->type == VALUE_SPLINE)
            && (first->kind == AST_NAME || first->kind == AST_INDEX));
}

static void declare(struct lang *l, const struct ast *node)
{
    struct value v;
    bool semicolon = node->flags & AST_SEMI, is_broken = false;

    if ((node->marks || !node->target) && !check_marks(l, node))
        return;
    l->declaring = node->target->name;
    unsigned errors = l->diag->errors;
    if (!declared_value(l, node->value, &v, &semicolon)) {
        /* The name is known from now on: one mistake, one message. */
        if (node->target->kind != AST_NAME || scope_find(node->target->name))
            return;
        harmless(&v);
        is_broken = true;
    } else if (!semicolon && needs_semicolon(node, &v) && !l->diag->errors
               && l->version >= 350) {      /* older scenes may lack it */
        struct loc end = node->value->last ? node->value->last->at : node->at;
        end.begin = end.end;
        diag_error(l->diag, end, "';' is missing behind this declaration");
        l->reader->failed = true;       /* what follows may have been part of it */
        if (!value_is_number(&v))
            error_is_late(l);
    }
    const struct ast *first = node->value->first;
    if (errors != l->diag->errors && first && first->kind == AST_NAME && is_macro(first->name))
        error_is_late(l);       /* its ( ) might come behind directives */
    if (node->n > 1 && !value_is_number(&v))
        diag_error(l->diag, node->at, "a second ';' can follow the declaration of numbers only");
    if (v.n == 5)
        settle(&v);
    if (node->target->kind == AST_NAME)
        assign_name(l, node, &v);
    else
        array_assign(l, node->target, &v);
    if (is_broken && scope_find(node->target->name))
        scope_find(node->target->name)->is_broken = true;
}

/* --- conditions and loops ------------------------------------------------------- */

static bool holds(struct lang *l, const struct ast *branch)
{
    double x;

    if (!branch->args)
        return true;
    if (branch->op == 'i')
        return evaluate_condition(l, branch->args, "a number as condition", &x) && is_true(x);
    const struct ast *a = branch->args->first, *last = branch->args->last;
    if (last && last->kind == AST_ERROR) {
        say_parse_error(l, last);
        return false;
    }
    return a && array_is_defined(l, a) == (branch->op == 'd');
}

static void choose(struct lang *l, const struct ast *node)
{
    const struct ast *b = node->first;

    while (b && !(b->kind == AST_BRANCH && holds(l, b)))
        b = b->next;
    if (b && b->body->first)
        frame_push(l, FRAME_BRANCH, b->body, node);
}

bool round_counts(struct lang *l, struct loc at)
{
    if (++l->rounds <= l->limits->iterations)
        return true;
    lang_limit(l, at, "the loops, macros and included files of this scene have run more than %.0f times; "
               "--max-iterations=N would let them go on", l->limits->iterations);
    return false;
}

static bool while_holds(struct lang *l, const struct ast *node)
{
    double x;

    return evaluate_condition(l, node->args, "a number as condition", &x) && is_true(x);
}

/* Adds up the names that a condition asks for; false: it asks for more, such
 * as a macro or rand(), which may answer otherwise every time. */
static bool sum_of_names(const struct ast *a, double *sum)
{
    const struct binding *b;

    switch (a->kind) {
    case AST_NUMBER: case AST_LITERAL: case AST_CONSTANT:
        return true;
    case AST_NAME:
        b = scope_find(a->name);
        for (int i = 0; b && value_is_number(b->value) && i < b->value->n; i++)
            *sum = *sum * 1.25 + b->value->v[i];
        return b && value_is_number(b->value);
    case AST_UNARY:
        return sum_of_names(a->right, sum);
    case AST_BINARY:
        return sum_of_names(a->left, sum) && sum_of_names(a->right, sum);
    case AST_PAREN:
        for (a = a->args->first; a; a = a->next)
            if (!sum_of_names(a, sum))
                return false;
        return true;
    default:
        return false;
    }
}

enum { EARLY_ROUNDS = 1 << 16, MOST_STILL = 2000000 };

/* A loop whose condition asks for names that stay as they are will not end.
 * Only long loops are looked at.  Who asks for more rounds than usual gets
 * them. */
static bool never_ends(struct lang *l, struct frame *f)
{
    static const struct limits usual = LIMITS_DEFAULT;
    double sum = 0;
    bool known = true;

    if (++f->step < EARLY_ROUNDS || l->limits->iterations > usual.iterations)
        return false;
    for (const struct ast *a = f->node->args->first; a && known; a = a->next)
        known = sum_of_names(a, &sum);
    f->still = known && sum == f->end ? f->still + 1 : 0;
    f->end = sum;
    if (f->still < MOST_STILL)
        return false;
    lang_limit(l, f->node->at, "this #while never ends: %d rounds have changed nothing that its "
               "condition asks for (--max-iterations=1e10 would let it go on)", MOST_STILL);
    return true;
}

static bool while_goes_on(struct lang *l, struct frame *f)
{
    const struct ast *node = f->node;
    unsigned which = l->n_frame - 1;

    return while_holds(l, node) && round_counts(l, node->at)
        && !never_ends(l, &l->frame[which]);
}

static void start_while(struct lang *l, const struct ast *node)
{
    if (while_holds(l, node) && round_counts(l, node->at))
        frame_push(l, FRAME_WHILE, node->body, node);
}

static bool for_goes_on(struct lang *l, struct frame *f)
{
    struct binding *b = scope_find(f->node->name);

    if (!b || b->value->type != VALUE_NUMBER || b->value->n != 1) {
        diag_error(l->diag, f->node->at, "the loop's variable '%s' is no number any more",
                   f->node->name->text);
        return false;
    }
    double x = b->value->v[0];
    return (f->step > 0 ? x - f->end < tolerance : x - f->end > -tolerance)
        && round_counts(l, f->node->at);
}

static bool for_numbers(struct lang *l, const struct ast *node, double v[3])
{
    struct values list;
    struct ast rest = *node->args;

    if (rest.first && rest.first->kind == AST_COMMA)
        rest.first = rest.first->next;
    int n = node->name ? evaluate_list(l, &rest, &list, false) : -1;
    if (n < 0)
        return false;
    if (n < 2 || n > 3) {
        diag_error(l->diag, node->at, "#for takes a name, a start, an end and perhaps a step");
        return false;
    }
    v[2] = 1;
    for (int i = 0; i < n; i++) {
        if (list.item[i].value.type != VALUE_NUMBER || list.item[i].value.n != 1) {
            wrong_type(l, list.item[i].from->at, &list.item[i].value, "a number");
            return false;
        }
        v[i] = list.item[i].value.v[0];
    }
    if (v[2] == 0)
        diag_error(l->diag, node->at, "a #for loop with step 0 never ends");
    return v[2] != 0;
}

static void start_for(struct lang *l, const struct ast *node)
{
    double v[3];

    if (!node->name && node->args->first && node->args->first->kind == AST_ERROR)
        say_parse_error(l, node->args->first);
    if (!for_numbers(l, node, v))
        return;
    struct binding *b = scope_find(node->name);
    if (b && (b->value->type == VALUE_FUNCTION || b->value->type == VALUE_MACRO
              || b->value->type == VALUE_FILE)) {
        diag_error(l->diag, node->at, "'%s' is a %s already: it cannot count a loop",
                   node->name->text, value_name(b->value));
        return;
    }
    b = scope_declare(l, node->name, true, node->at);
    *b->value = value_number(v[0]);
    struct frame *f = frame_push(l, FRAME_FOR, node->body, node);
    f->end = v[1];
    f->step = v[2];
    if (!for_goes_on(l, f))
        frame_pop(l);
}

bool frame_end(struct lang *l)
{
    struct frame *f = &l->frame[l->n_frame - 1];
    bool again = false;
    unsigned which = l->n_frame - 1;

    bool is_loop = f->kind == FRAME_WHILE || f->kind == FRAME_FOR;

    if (is_loop && !(f->node->body->flags & AST_CLOSED))
        ;                       /* its #end, from which it would go back, is missing */
    else if (f->kind == FRAME_WHILE)
        again = while_goes_on(l, f);
    else if (f->kind == FRAME_FOR) {
        struct binding *b = scope_find(f->node->name);
        if (b && b->value->type == VALUE_NUMBER)
            b->value->v[0] += f->step;
        again = for_goes_on(l, f);
    }
    if (again && !l->stopped)
        l->frame[which].next = l->frame[which].node->body->first;
    else
        frame_pop(l);
    return again;
}

/* --- #switch ----------------------------------------------------------------------- */

/* A label that execution falls into says its mistakes, too. */
bool label_matches(struct lang *l, const struct ast *label, double x)
{
    struct values list;
    double v;

    if (label->op == 'e')
        return true;
    if (label->op == 'c')
        return evaluate_condition(l, label->args, "a number", &v) && is_equal(v, x);
    if (evaluate_list(l, label->args, &list, false) != 2) {
        diag_error(l->diag, label->at, "#range takes two numbers");
        return false;
    }
    return x >= list.item[0].value.v[0] && x <= list.item[1].value.v[0];
}

static bool say_no_label(struct lang *l, struct loc at)
{
    diag_error(l->diag, at, "#case or #range must follow #switch ( )");
    return false;
}

/* Directives and macros may stand before the first label: they are carried out. */
static bool begin_switch(struct lang *l, const struct ast *from, const struct ast *label)
{
    struct ast list = { .kind = AST_LIST };
    struct reader r;

    for (const struct ast *a = from; a != label; a = a->next) {
        ast_add(&list, ast_copy(l->mem, a));
    }
    reader_start(&r, l, &list);
    const struct ast *a = reader_step(&r);
    reader_close(&r);
    return !a || say_no_label(l, a->at);
}

static void start_switch(struct lang *l, const struct ast *node)
{
    const struct ast *a = node->body->first, *first = a;
    double x;

    if (!evaluate_condition(l, node->args, "a number", &x))
        return;
    while (a && a->kind != AST_CASE)
        a = a->next;
    if (a != first && !begin_switch(l, first, a))
        return;
    if (!a || !a->args) {
        say_no_label(l, a ? a->at : node->at);
        return;
    }
    for (; a; a = a->next)
        if (a->kind == AST_CASE && label_matches(l, a, x)) {
            frame_push(l, FRAME_SWITCH, node->body, node)->next = a->next;
            return;
        }
}

/* --- #break -------------------------------------------------------------------------- */

static bool can_leave(enum frame_kind kind)
{
    return kind == FRAME_WHILE || kind == FRAME_FOR || kind == FRAME_SWITCH
        || kind == FRAME_MACRO;
}

bool frame_break(struct reader *r, const struct ast *node)
{
    struct lang *l = r->lang;
    unsigned i = l->n_frame;

    while (i > r->base + 1 && !can_leave(l->frame[i - 1].kind))
        i--;
    if (i <= r->base + 1) {
        diag_error(l->diag, node->at, "#break outside of a loop, #switch or macro");
        return false;
    }
    while (l->n_frame >= i)
        frame_pop(l);
    return true;
}

/* --- macros ------------------------------------------------------------------------- */

bool is_macro(const struct name *name)
{
    struct binding *b = name->slot;

    return b && b->value->type == VALUE_MACRO;
}

static bool check_parameters(struct lang *l, const struct ast *node, int *n)
{
    bool comma = true;

    *n = 0;
    for (const struct ast *a = node->params->first; a; a = a->next) {
        if (a->kind == AST_COMMA) {
            if (comma)
                diag_error(l->diag, a->at, "a parameter is missing before this comma");
            comma = true;
            continue;
        }
        if (a->kind != AST_NAME) {
            diag_error(l->diag, a->at, "'%s' is a reserved word: it cannot be a parameter",
                       a->name->text);
            return false;
        }
        comma = false;
        if (++*n > MOST_PARAMETERS) {
            diag_error(l->diag, a->at, "a macro has at most %d parameters", MOST_PARAMETERS);
            return false;
        }
    }
    return true;
}

static bool has_macros(struct lang *l, struct loc at)
{
    if (l->version < 310)
        diag_error(l->diag, at, "there are no macros before #version 3.1; %g is set",
                   l->version / 100.0);
    return l->version >= 310;
}

/* An #else or #case that belongs to nothing in a body; NULL: there is none.  POV-Ray sees it
 * in what it passes over, where all other mistakes stay unseen. */
static const struct ast *stray_label(const struct ast *body)
{
    const struct ast *a = body->first;

    while (a && !(a->kind == AST_ERROR && a->op == AST_ERROR_LABEL))
        a = a->next;
    return a;
}

static void define_macro(struct lang *l, const struct ast *node)
{
    const struct ast *stray = stray_label(node->body);
    int n;

    if (!has_macros(l, node->at))
        return;
    if (stray) {
        diag_error(l->diag, stray->at, "%s", stray->text);
        return;
    }

    if (node->args) {
        say_parse_error(l, node->args);
        if (!node->name)
            return;
    } else if (!node->name)
        diag_error(l->diag, node->at, "#macro takes a name and its parameters in ( )");
    if (!node->name || !check_parameters(l, node, &n))
        return;
    struct binding *old = scope_find(node->name);
    if (old && old->value->type != VALUE_MACRO) {
        diag_error(l->diag, node->at, "'%s' is a %s already: it cannot be a macro",
                   node->name->text, value_name(old->value));
        return;
    }
    struct macro *m = arena_alloc(l->mem, sizeof *m);
    *m = (struct macro) { node->name, node, n };
    struct binding *b = scope_declare_global(l, node->name, node->at);
    *b->value = value_thing(VALUE_MACRO, m);
    b->at = node->at;
}

/* A macro's argument before its scope is open. */
struct argument { struct value value; struct value *refers; };

/* A name alone is passed by reference, but for functions, and for what ends
 * before the macro begins: the locals of macros in the list of arguments. */
static bool by_reference(struct lang *l, const struct ast *a, unsigned scope, struct argument *out)
{
    if (a->kind != AST_NAME && a->kind != AST_INDEX)
        return false;
    if (a->kind == AST_INDEX) {
        struct binding *array = scope_find(a->name);
        if (!array || array->scope > scope || !array_item(l, a, true))
            return false;
        out->refers = array_place(l, a);
        return out->refers;
    }
    struct binding *b = scope_find(a->name);
    if (!b || b->value->type == VALUE_FUNCTION || b->value->type == VALUE_MACRO
        || b->deprecated || b->scope > scope)
        return false;
    out->refers = b->value;
    return true;
}

/* Is a name all that stands between two commas? */
static const struct ast *lone(const struct ast *a)
{
    return !a->next || a->next->kind == AST_COMMA ? a : NULL;
}

static bool take_argument(struct lang *l, struct reader *r, unsigned scope, struct argument *out)
{
    const struct ast *a = r->has_item ? NULL : reader_look(r);

    *out = (struct argument) { .refers = NULL };
    if (a && lone(a) && by_reference(l, a, scope, out)) {
        r->has_node = false;
        return true;
    }
    if (!thing_value(l, r, &out->value))
        return false;
    while (out->value.type == VALUE_TEXTURE && item_is_block(reader_peek(r), "texture")) {
        struct item layer = reader_next(r);
        if (!build_value(l, layer.word, &layer, &out->value))
            return false;
    }
    if (out->value.n == 5)
        settle(&out->value);
    return true;
}

/* Without looking at items: a name must be seen before it is evaluated. */
static bool more_arguments(struct reader *r)
{
    return r->has_item ? r->item.kind != ITEM_END : reader_look(r) != NULL;
}

static void skip_raw_comma(struct reader *r)
{
    if (r->has_item)
        reader_skip_comma(r);
    else if (reader_look(r) && r->node->kind == AST_COMMA)
        r->has_node = false;
}

/* As many as commas say: when there are too many, not all were taken. */
static int count_given(const struct ast *list, int taken)
{
    int n = 1;

    if (list->flags & AST_PLAIN)
        return list->n;
    for (const struct ast *a = list->first; a; a = a->next)
        n += a->kind == AST_COMMA;
    return n > taken ? n : taken;
}

static const char *missing_name(struct lang *l, const struct macro *m, int n)
{
    const struct ast *a = m->node->params->first;

    for (; a && (n > 0 || a->kind == AST_COMMA); a = a->next)
        n -= a->kind != AST_COMMA;
    return a && a->name ? arena_format(l->mem, ": '%s' is missing", a->name->text) : "";
}

static void say_count(struct lang *l, const struct ast *call, const struct macro *m, int n)
{
    diag_error(l->diag, call->at, "macro '%s' takes %d argument%s, not %d%s", m->name->text, m->n,
               m->n == 1 ? "" : "s", n > m->n ? count_given(call->args, n) : n,
               n < m->n ? missing_name(l, m, n) : "");
    diag_note(l->diag, m->node->at, "it is defined here");
}

static bool spliced_arguments(struct lang *l, const struct ast *call, const struct macro *m,
                              struct argument *argument)
{
    struct reader r;
    unsigned scope = l->n_scope;
    int n = 0;
    bool fine = true;

    reader_open(&r, l, call->args);
    r.strict = true;
    while (fine && n < m->n && more_arguments(&r)) {
        fine = take_argument(l, &r, scope, &argument[n++]);
        skip_raw_comma(&r);
    }
    fine = fine && !r.failed;
    if (fine && (n < m->n || reader_peek(&r)->kind != ITEM_END)) {
        say_count(l, call, m, reader_peek(&r)->kind == ITEM_END ? n : m->n + 1);
        fine = false;
    }
    reader_close(&r);
    return fine;
}

/* `Turned(Ball, x) -y`: behind a macro that leaves an object, the sign begins the next
 * argument, whose comma is missing. */
static struct ast *apart(struct lang *l, const struct ast *list)
{
    struct ast *to = arena_alloc(l->mem, sizeof *to);

    *to = (struct ast) { .kind = AST_LIST, .at = list->at, .close = list->close };
    for (const struct ast *a = list->first; a; a = a->next) {
        struct ast *left = ast_copy(l->mem, a), *right = NULL;
        if (a->kind == AST_BINARY && strchr("+-", a->op) && a->left->kind == AST_CALL
            && is_macro(a->left->name)) {
            right = ast_copy(l->mem, a);
            right->kind = AST_UNARY;
            left = ast_copy(l->mem, a->left);
        }
        ast_add(to, left);
        ast_add(to, right);
    }
    return to;
}

static bool plain_arguments(struct lang *l, const struct ast *call, const struct macro *m,
                            struct argument *argument)
{
    if (call->args->n + 1 == m->n) {
        struct ast again = *call;
        again.args = apart(l, call->args);
        return spliced_arguments(l, &again, m, argument);
    }
    if (call->args->n != m->n) {
        say_count(l, call, m, call->args->n);
        return false;
    }
    unsigned errors = l->diag->errors;
    for (const struct ast *a = call->args->first; a; a = a->next, argument++) {
        argument->refers = NULL;
        if (by_reference(l, a, l->n_scope, argument))
            continue;
        if (!begins_well(l, a))
            return false;
        evaluate_strictly(l, a, &argument->value);
        if (argument->value.n == 5)
            settle(&argument->value);
        value_keep(&argument->value);
    }
    return errors == l->diag->errors;
}

static void bind_arguments(struct lang *l, const struct macro *m, struct argument *argument)
{
    for (const struct ast *a = m->node->params->first; a; a = a->next) {
        if (a->kind != AST_NAME)
            continue;
        struct binding *b = scope_parameter(l, a->name, argument->refers, a->at);
        if (!argument->refers)
            b->own = argument->value;
        argument++;
    }
}

bool macro_call(struct lang *l, const struct ast *call)
{
    const struct binding *b = call->name->slot;
    const struct macro *m = b->value->thing;
    enum { FEW = 8 };
    struct argument few[FEW], *argument = few;
    struct ast plain = *call->args;

    if (l->n_call + l->n_include >= l->limits->call_depth) {
        diag_error(l->diag, call->at, "macro '%s' calls are nested more than %u deep: does it ever end? "
                   "(--max-call-depth=N would let it go on)", m->name->text, l->limits->call_depth);
        l->stopped = true;
        return false;
    }
    if (lang_stack_is_low(l)) {
        lang_limit(l, call->at, "macro '%s' calls are nested too deeply for the system's stack "
                   "(ulimit -s)", m->name->text);
        return false;
    }
    if (say_unclosed(l, call->args, true) || !has_macros(l, call->at) || !round_counts(l, call->at))
        return false;
    if (m->n > FEW)
        argument = arena_array(l->mem, (size_t)m->n, sizeof *argument);
    if (!(plain.flags & AST_PLAIN ? plain_arguments : spliced_arguments)(l, call, m, argument))
        return false;
    scope_open(l);
    bind_arguments(l, m, argument);
    frame_push(l, FRAME_MACRO, m->node->body, call);
    l->n_call++;
    return true;
}

/* --- the rest ------------------------------------------------------------------------- */

static void undef(struct lang *l, const struct ast *node)
{
    const struct ast *target = node->target;

    if (target->kind == AST_INDEX)
        array_undef(l, target);
    else if (!scope_find(target->name))
        diag_warning(l->diag, target->at, "#undef of '%s', which is not declared",
                     target->name->text);
    else
        scope_undef(l, target->name);
}

static void use_version(struct lang *l, struct loc at, double number, bool semicolon)
{
    int version = value_whole(floor(number * 100 + 0.5));

    if (version > 370) {
        diag_error(l->diag, at, "this scene is for version %g of the language; rtc knows 3.7", number);
        return;
    }
    if (!semicolon)
        diag_warning(l->diag, at, "';' is missing behind #version");
    l->version = version;
    l->version_given = true;
    build_version(l);
}

static void set_version(struct lang *l, const struct ast *node)
{
    struct value v;
    const struct ast *first = ast_leftmost(node->right);

    if (first->kind == AST_CALL && is_macro(first->name)) {
        diag_error(l->diag, first->at, "a macro call behind #version needs parentheses");
        return;
    }
    if (node->third) {
        diag_error(l->diag, node->third->at, "%s", node->third->text);
        return;
    }
    evaluate(l, node->right, &v);
    if (v.type != VALUE_NUMBER || v.n != 1) {
        wrong_type(l, node->right->at, &v, "a number");
        return;
    }
    use_version(l, node->right->at, v.v[0], node->flags & AST_SEMI);
    if (node->at.source == l->main_source)
        l->version_at = node->at;
}

/* `version 3.7;` without '#': POV-Ray takes the ';' for the end of the scene. */
void version_without_hash(struct lang *l, struct reader *r)
{
    struct loc at = reader_look(r)->at;
    unsigned errors = l->diag->errors;

    r->has_node = false;
    const struct ast *follows = l->frame[l->n_frame - 1].next;
    if (chain_is_interrupted(r)
        || (follows && follows->kind == AST_CALL && is_macro(follows->name)))
        diag_error(l->diag, at, "'version' lacks its '#' and its number");
    double number = l->diag->errors == errors ? reader_number(r, false, "version") : 0;
    if (l->diag->errors != errors)
        return;
    const struct ast *next = r->has_item ? NULL : reader_look(r);
    bool ends = next && next->kind == AST_SEMICOLON;
    use_version(l, at, number, ends);
    if (ends && l->diag->errors == errors)
        diag_warning(l->diag, at, "'version' lacks its '#': nothing behind it is read, in POV-Ray neither");
    else if (l->diag->errors == errors)
        diag_warning(l->diag, at, "'version' lacks its '#'");
    l->stopped |= ends;
}

static void set_default(struct lang *l, const struct ast *node)
{
    struct reader r;

    reader_open(&r, l, node->body);
    build_default(l, &r);
    reader_close(&r);
}

void direct(struct reader *r, const struct ast *node)
{
    struct lang *l = r->lang;

    switch (node->kind) {
    case AST_DECLARE: declare(l, node); return;
    case AST_UNDEF: undef(l, node); return;
    case AST_IF: choose(l, node); return;
    case AST_WHILE: start_while(l, node); return;
    case AST_FOR: start_for(l, node); return;
    case AST_SWITCH: start_switch(l, node); return;
    case AST_BREAK: frame_break(r, node); return;
    case AST_MACRO: define_macro(l, node); return;
    case AST_INCLUDE: include(l, node); return;
    case AST_VERSION: set_version(l, node); return;
    case AST_MESSAGE: message_say(l, node); return;
    case AST_DEFAULT: set_default(l, node); return;
    case AST_FOPEN: file_open(l, node); return;
    case AST_FCLOSE: file_close(l, node); return;
    case AST_READ: file_read(l, node); return;
    case AST_WRITE: file_write(l, node); return;
    default: return;
    }
}
