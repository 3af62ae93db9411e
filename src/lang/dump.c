/* dump.c: --dump=tokens and --dump=ast. */
#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "lang/parsing.h"

static const char *const kinds[] = {
    [AST_LIST] = "list", [AST_WORD] = "word", [AST_BLOCK] = "block", [AST_BRACES] = "braces",
    [AST_ENTRY] = "entry", [AST_COMMA] = "comma", [AST_COLON] = "colon",
    [AST_SEMICOLON] = "semicolon", [AST_BULK] = "constants", [AST_ERROR] = "error",
    [AST_NUMBER] = "number", [AST_TEXT] = "text", [AST_NAME] = "name", [AST_INDEX] = "element",
    [AST_CALL] = "call", [AST_FUNC] = "call", [AST_CONSTANT] = "constant",
    [AST_VECTOR] = "vector", [AST_LITERAL] = "constant vector", [AST_PAREN] = "parentheses", [AST_MEMBER] = "component",
    [AST_UNARY] = "sign", [AST_BINARY] = "operator", [AST_TAIL] = "operator without left side",
    [AST_CONDITION] = "choice", [AST_SPLICE] = "directive as operand", [AST_ARRAY] = "array",
    [AST_FUNCTION] = "function", [AST_DECLARE] = "declare", [AST_UNDEF] = "#undef",
    [AST_IF] = "#if", [AST_BRANCH] = "branch", [AST_WHILE] = "#while", [AST_FOR] = "#for",
    [AST_SWITCH] = "#switch", [AST_CASE] = "#case", [AST_BREAK] = "#break",
    [AST_MACRO] = "#macro", [AST_INCLUDE] = "#include", [AST_VERSION] = "#version",
    [AST_MESSAGE] = "message", [AST_DEFAULT] = "#default", [AST_FOPEN] = "#fopen",
    [AST_FCLOSE] = "#fclose", [AST_READ] = "#read", [AST_WRITE] = "#write",
};

struct dump { FILE *out; const struct lang *lang; int depth; };

static void dump(struct dump *d, const struct ast *a);

static void under(struct dump *d, const struct ast *a)
{
    d->depth++;
    if (a)
        dump(d, a);
    d->depth--;
}

/* Where a list was expected there may be a message instead. */
static void dump_list(struct dump *d, const struct ast *list)
{
    if (!list)
        return;
    if (list->kind == AST_ERROR) {
        under(d, list);
        return;
    }
    d->depth++;
    for (const struct ast *a = list->first; a; a = a->next)
        dump(d, a);
    d->depth--;
}

static void print_op(FILE *out, int op)
{
    const char *text = op == AST_OP_LE ? "<=" : op == AST_OP_GE ? ">=" : op == AST_OP_NE ? "!=" : NULL;

    if (text)
        fprintf(out, " %s", text);
    else
        fprintf(out, " %c", op);
}

/* As few digits as give the number back. */
static void print_number(FILE *out, double x)
{
    char text[32];

    for (int digits = 6; digits <= 17; digits++) {
        snprintf(text, sizeof text, "%.*g", digits, x);
        if (strtod(text, NULL) == x)
            break;
    }
    fputs(text, out);
}

static void dump_expression(struct dump *d, const struct ast *a)
{
    switch (a->kind) {
    case AST_NUMBER:
        fputc(' ', d->out);
        print_number(d->out, a->number);
        fputc('\n', d->out);
        return;
    case AST_LITERAL:
        for (unsigned i = 0; i < a->n; i++) {
            fputs(i ? ", " : " ", d->out);
            print_number(d->out, a->v[i]);
        }
        fputc('\n', d->out);
        return;
    case AST_TEXT: fprintf(d->out, " \"%s\"\n", a->text); return;
    case AST_MEMBER:
        fprintf(d->out, " %d\n", a->index);
        under(d, a->left);
        return;
    case AST_UNARY: case AST_BINARY: case AST_TAIL:
        print_op(d->out, a->op);
        fputc('\n', d->out);
        under(d, a->left);
        under(d, a->right);
        return;
    case AST_CONDITION:
        fputc('\n', d->out);
        under(d, a->left);
        under(d, a->right);
        under(d, a->third);
        return;
    case AST_SPLICE:
        fputc('\n', d->out);
        dump_list(d, a->first);
        return;
    default:
        fprintf(d->out, "%s%s\n", a->name ? " " : "", a->name ? a->name->text : "");
        if (a->args && a->kind == AST_INDEX)
            dump_list(d, a->args);
        else if (a->args)
            dump_list(d, a->args);
        if (a->body)
            under(d, a->body);
    }
}

static void dump_directive(struct dump *d, const struct ast *a)
{
    switch (a->kind) {
    case AST_DECLARE:
        fprintf(d->out, " #%s\n", a->op == 'l' ? "local" : "declare");
        under(d, a->target);
        dump_list(d, a->value);
        return;
    case AST_UNDEF:
        fputc('\n', d->out);
        under(d, a->target);
        return;
    case AST_IF:
        fputc('\n', d->out);
        dump_list(d, a);
        return;
    case AST_INCLUDE: case AST_VERSION: case AST_MESSAGE:
        fputc('\n', d->out);
        under(d, a->right);
        return;
    default:
        fprintf(d->out, "%s%s\n", a->name ? " " : "", a->name ? a->name->text : "");
        dump_list(d, a->args);
        if (a->body)
            under(d, a->body);
    }
}

static void dump(struct dump *d, const struct ast *a)
{
    struct position p = source_position(d->lang->sources, a->at.source, a->at.begin);

    fprintf(d->out, "%*s%u:%u %s", d->depth * 2, "", p.line, p.column, kinds[a->kind]);
    if (a->kind >= AST_DECLARE)
        dump_directive(d, a);
    else if (a->kind >= AST_NUMBER)
        dump_expression(d, a);
    else if (a->kind == AST_LIST) {
        fputc('\n', d->out);
        dump_list(d, a);
    } else if (a->kind == AST_BULK)
        fprintf(d->out, " %u of %u\n", a->bulk.n, a->bulk.components);
    else if (a->kind == AST_ERROR)
        fprintf(d->out, " %s\n", a->text);
    else if (a->kind == AST_COMMA || a->kind == AST_COLON || a->kind == AST_SEMICOLON)
        fputc('\n', d->out);
    else {
        fprintf(d->out, "%s%s\n", a->name ? " " : "", a->name ? a->name->text : "");
        dump_list(d, a->body);
    }
}

void lang_dump_ast(const struct lang *l, const struct ast *tree, FILE *out)
{
    struct dump d = { out, l, 0 };

    if (tree)
        dump(&d, tree);
}

void lang_dump_tokens(struct lang *l, const char *path, FILE *out)
{
    uint32_t number;

    if (source_read(l->sources, path, (struct loc) { 0 }, l->limits->source_bytes, &number))
        scanner_dump(l, number, out);
    else
        diag_error(l->diag, (struct loc) { 0 }, "cannot read '%s': %s", path, strerror(errno));
}
