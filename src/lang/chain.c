/* chain.c: an expression whose parts come from macros and directives. */
#include "lang/chain.h"

#include "lang/frame.h"

bool chain_is_interrupted(const struct reader *r)
{
    const struct lang *l = r->lang;

    for (unsigned i = l->n_frame; i-- > r->base;) {
        const struct frame *f = &l->frame[i];
        if (f->next)
            return f->next->kind >= AST_DECLARE;
        if (i > r->base && f->kind >= FRAME_BRANCH && f->kind <= FRAME_SWITCH)
            return true;                /* its #end */
    }
    return false;
}

void chain_say_interrupted(struct lang *l, struct loc at)
{
    diag_error(l->diag, at, "a directive cannot follow this value here, the #else or #end of one "
               "neither; parentheses around all of it would do");
}

static int binding_strength(const struct chain *c, int op)
{
    switch (op) {
    case '*': case '/': return 5;
    case '+': case '-': return 4;
    case '&': return c->ops->in_function ? 2 : 1;
    case '|': return 1;
    default: return 3;
    }
}

void chain_start(struct chain *c, struct lang *l, const struct chain_ops *ops, void *arg)
{
    c->lang = l;
    c->ops = ops;
    c->arg = arg;
    c->n_value = c->n_op = 0;
    c->has_operand = c->failed = c->strict = c->interrupted = false;
}

static void wrong(struct chain *c, struct loc at, const char *message)
{
    if (!c->failed)
        diag_error(c->lang->diag, at, "%s", message);
    c->failed = true;
}

static void apply(struct chain *c)
{
    c->n_op--;
    if (c->op[c->n_op].is_unary) {
        c->ops->unary(c, c->op[c->n_op].at, c->op[c->n_op].op, c->n_value - 1);
        return;
    }
    c->n_value--;
    c->ops->binary(c, c->op[c->n_op].at, c->op[c->n_op].op, c->n_value - 1);
}

static void apply_stronger(struct chain *c, int strength)
{
    while (c->n_op && (c->op[c->n_op - 1].is_unary
                       || binding_strength(c, c->op[c->n_op - 1].op) >= strength))
        apply(c);
}

/* A directive may follow a text that a comparison follows. */
static bool say_if_interrupted(struct chain *c, struct loc at)
{
    if (!c->interrupted || c->ops->is_text(c, c->n_value - 1))
        return false;
    chain_say_interrupted(c->lang, at);
    return c->failed = true;
}

static void push_op(struct chain *c, int op, bool is_unary, struct loc at)
{
    if (c->failed)
        return;
    if (say_if_interrupted(c, at))
        return;
    c->interrupted = false;
    if (!is_unary) {
        if (!c->has_operand) {
            wrong(c, at, "an operator without a left side");
            return;
        }
        apply_stronger(c, binding_strength(c, op));
    } else if (c->ops->in_function && c->n_op && c->op[c->n_op - 1].is_unary) {
        wrong(c, at, "a second sign in a row cannot stand in a function");
        return;
    }
    if (c->n_op == CHAIN_MOST) {
        wrong(c, at, "too many signs in a row");
        return;
    }
    c->op[c->n_op].op = (uint8_t)op;
    c->op[c->n_op].is_unary = is_unary;
    c->op[c->n_op++].at = at;
    c->has_operand = false;
}

static void push_value(struct chain *c, const struct ast *a)
{
    if (c->failed)
        return;
    if (c->has_operand)
        wrong(c, a->at, "a value without an operator before it");
    else {
        c->ops->operand(c, a, c->n_value++);
        c->has_operand = true;
    }
}

/* All that a list leaves behind. */
static void add_list(struct chain *c, struct reader *r)
{
    const struct ast *a;

    while (!c->lang->stopped && (a = reader_step(r))) {
        if (a->kind == AST_SEMICOLON)
            continue;
        if (a->kind < AST_NUMBER || a->kind > AST_SPLICE)
            wrong(c, a->at, "an expression cannot go on with this");
        chain_add(c, a);
        c->interrupted = !c->failed && c->strict && c->has_operand && chain_is_interrupted(r);
        if (c->failed || say_if_interrupted(c, a->at))
            return;
    }
    c->failed = c->failed || r->failed;
}

static void add_macro(struct chain *c, const struct ast *call)
{
    static const struct ast nothing = { .kind = AST_LIST };
    struct reader r;

    reader_start(&r, c->lang, &nothing);
    if (macro_call(c->lang, call))
        add_list(c, &r);
    else
        c->failed = true;
    reader_close(&r);
}

void chain_add_list(struct chain *c, const struct ast *list)
{
    struct reader r;

    reader_start(&r, c->lang, list);
    add_list(c, &r);
    reader_close(&r);
}

static void add_member(struct chain *c, const struct ast *a)
{
    chain_add(c, a->left);
    if (!c->failed && c->has_operand)
        c->ops->member(c, a, c->n_value - 1);
}

void chain_add(struct chain *c, const struct ast *a)
{
    switch (a->kind) {
    case AST_BINARY:
        chain_add(c, a->left);
        push_op(c, a->op, false, a->at);
        chain_add(c, a->right);
        return;
    case AST_TAIL:
        push_op(c, a->op, false, a->at);
        chain_add(c, a->right);
        return;
    case AST_UNARY:
        push_op(c, a->op, !(c->has_operand && a->op != '!'), a->at);
        chain_add(c, a->right);
        return;
    case AST_SPLICE: chain_add_list(c, a->first); return;
    case AST_CALL:
        if (is_macro(a->name)) {
            add_macro(c, a);
            return;
        }
        break;
    case AST_MEMBER:
        if (chain_needed(a->left)) {
            add_member(c, a);
            return;
        }
        break;
    default: break;
    }
    push_value(c, a);
}

bool chain_end(struct chain *c, struct loc at)
{
    if (!c->failed && !c->has_operand)
        wrong(c, at, "a value is missing in this expression");
    if (!c->failed && c->interrupted) {
        chain_say_interrupted(c->lang, at);
        c->failed = true;
    }
    while (!c->failed && c->n_op)
        apply(c);
    return !c->failed;
}

bool chain_continues(const struct ast *a)
{
    if (a->kind == AST_TAIL)
        return true;
    while (a->kind == AST_BINARY || a->kind == AST_MEMBER)
        a = a->left;
    return a->kind == AST_UNARY && a->op != '!';
}

bool chain_needed(const struct ast *a)
{
    if (a->kind == AST_SPLICE)
        return true;
    if (!(a->flags & AST_HAS_CALL))
        return false;
    switch (a->kind) {
    case AST_CALL: return is_macro(a->name);
    case AST_MEMBER: return chain_needed(a->left);
    case AST_UNARY: return chain_needed(a->right);
    case AST_BINARY: return chain_needed(a->left) || chain_needed(a->right);
    default: return false;
    }
}
