/* ast.c: making the nodes of the tree. */
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "lang/parsing.h"

enum { DEEPEST = 10000 };       /* of an expression: the evaluator recurses */

/* Of what large scenes are made of, no more than is used; n: of a LITERAL. */
static size_t size_of(enum ast_kind kind, unsigned n)
{
    switch (kind) {
    case AST_COMMA: case AST_COLON: case AST_SEMICOLON: return offsetof(struct ast, number);
    case AST_NUMBER:  return offsetof(struct ast, number) + sizeof(double);
    case AST_LITERAL: return offsetof(struct ast, v) + n * sizeof(double);
    default:          return sizeof(struct ast);
    }
}

static struct ast *new_of(struct parse *p, enum ast_kind kind, struct loc at, unsigned n)
{
    struct ast *node = arena_alloc_aligned(p->mem, size_of(kind, n), _Alignof(struct ast));

    node->kind = (uint8_t)kind;
    node->at = at;
    node->n = (uint16_t)n;
    return node;
}

struct ast *ast_new(struct parse *p, enum ast_kind kind, struct loc at) { return new_of(p, kind, at, 0); }

struct ast *ast_literal(struct parse *p, struct loc at, const double v[], unsigned n)
{
    struct ast *node = new_of(p, AST_LITERAL, at, n);

    memcpy(node->v, v, n * sizeof *v);
    return node;
}

struct ast *ast_copy(struct arena *mem, const struct ast *a)
{
    struct ast *copy = arena_alloc(mem, sizeof *copy);

    memcpy(copy, a, size_of(a->kind, a->n));
    copy->next = NULL;
    return copy;
}

struct ast *ast_list(struct parse *p, struct loc at)
{
    return ast_new(p, AST_LIST, at);
}

struct ast *ast_add(struct ast *list, struct ast *item)
{
    if (!item)
        return list;
    if (list->last)
        list->last->next = item;
    else
        list->first = item;
    list->last = item;
    return list;
}

bool ast_is_value(const struct ast *a)
{
    return a->kind >= AST_NUMBER && a->kind <= AST_CONDITION && a->kind != AST_TAIL;
}

const struct ast *ast_leftmost(const struct ast *a)
{
    while (a->kind == AST_BINARY || a->kind == AST_MEMBER || a->kind == AST_CONDITION)
        a = a->left;
    return a;
}

/* A list of values with at most one comma between them becomes plain: the
 * commas go, flags keep what they said.  A call may be a macro, which leaves
 * anything behind: not plain. */
static bool is_plain(const struct ast *list)
{
    bool may_comma = false;

    for (const struct ast *a = list->first; a; a = a->next) {
        if (a->kind == AST_COMMA ? !may_comma
            : !ast_is_value(a) || (a->flags & AST_HAS_CALL && a->kind == AST_CALL))
            return false;
        may_comma = a->kind != AST_COMMA;
    }
    return true;
}

struct ast *ast_pack(struct ast *list)
{
    struct ast *from = list->first;
    bool had_comma = true, all = true, before = false;

    if (!is_plain(list))
        return list;
    list->first = list->last = NULL;
    list->flags |= AST_PLAIN;
    for (struct ast *next; from; from = next) {
        next = from->next;
        from->next = NULL;
        if (from->kind == AST_COMMA) {
            had_comma = true;
            continue;
        }
        all = all && had_comma;
        before = had_comma;
        had_comma = false;
        list->n += list->n < UINT16_MAX;
        ast_add(list, from);
    }
    if (all)
        list->flags |= AST_ALL_COMMAS;
    if (before)
        list->flags |= AST_COMMA_BEFORE;
    if (had_comma && list->first)
        list->flags |= AST_LAST_COMMA;
    return list;
}

/* Commas are optional, but with some of them in a list one more was meant. */
void ast_check_commas(struct parse *p, const struct ast *list)
{
    const struct ast *missing = NULL, *before = NULL;
    bool some = false;

    for (const struct ast *a = list->first; a; before = a, a = a->next) {
        some = some || a->kind == AST_COMMA;
        if (!missing && before && ast_is_value(a) && ast_is_value(before))
            missing = a;
    }
    if (!some || !missing)
        return;
    scanner_uncover(p);
    diag_warning(p->lang->diag, missing->at, "there is no comma before this component");
}

/* What cannot stand in ( ) or < >, behind a value and without a comma. */
static bool is_stranger(const struct ast *a, const struct ast *before)
{
    return (a->kind == AST_WORD || a->kind == AST_BLOCK) && a->name && before
           && ast_is_value(before);
}

/* A bracket that is never closed: the list ends where something stands that
 * cannot be in it, which is where the message points. */
static void end_early(struct parse *p, struct ast *list)
{
    const char *text = p->pending->text;
    bool angle = strcmp(text, "missing '>'") == 0;
    struct ast *before = NULL, *a = list->first;

    if (!angle && strcmp(text, "missing ')'") != 0)
        return;
    while (a && !is_stranger(a, before)) {
        before = a;
        a = a->next;
    }
    if (!a)
        return;
    p->pending = ast_error(p, a->at, p->pending->other, "expected %s, found '%s'",
                           angle ? "'>'" : "',' or ')'", a->name->text);
    before->next = NULL;
    list->last = before;
}

/* What was wrong with the closing bracket is said at the end of the list. */
struct ast *ast_close(struct parse *p, struct ast *list, struct loc open, struct loc close)
{
    list->at = open;
    list->close = close;
    list->flags |= AST_CLOSED;
    if (p->pending && p->pending->other.source)
        end_early(p, list);
    ast_add(list, p->pending);
    p->pending = NULL;
    return list;
}

/* The block that a branch left open: its list ends with the message of that. */
static struct ast *open_body(struct ast *list)
{
    struct ast *last = list->last;

    if (last && last->kind == AST_DECLARE)
        last = last->value->last;
    if (!last || last->kind != AST_BLOCK || !last->body->last
        || last->body->last->kind != AST_ERROR)
        return NULL;
    return last->body;
}

static void drop_last(struct ast *list)
{
    struct ast *before = NULL;

    for (struct ast *a = list->first; a != list->last; a = a->next)
        before = a;
    if (before)
        before->next = NULL;
    else
        list->first = NULL;
    list->last = before;
}

/* The lists of all branches may end in the same items: nothing changes them. */
void ast_share(struct parse *p, struct ast *branches, struct ast *rest)
{
    for (struct ast *b = branches->first; b; b = b->next) {
        struct ast *body = b->kind == AST_BRANCH ? open_body(b->body) : NULL;
        if (!body)
            continue;
        drop_last(body);
        if (body->last)
            body->last->next = rest->first;
        else
            body->first = rest->first;
        if (rest->last)
            body->last = rest->last;
        body->close = rest->close;
    }
    p->keep = true;
}

static uint16_t depth_of(const struct ast *a)
{
    return a ? a->depth : 0;
}

/* A sum of many thousand terms is a tree as deep. */
static struct ast *measured(struct parse *p, struct ast *node)
{
    uint16_t left = depth_of(node->left), right = depth_of(node->right);
    uint16_t third = depth_of(node->third);
    uint16_t most = left > right ? left : right;

    node->depth = (uint16_t)((most > third ? most : third) + 1);
    if (node->depth <= DEEPEST)
        return node;
    lang_limit(p->lang, node->at, "nested too deeply: an expression of more than %d operators",
               DEEPEST);
    p->deep = true;
    node->depth = 0;
    node->left = node->right = NULL;
    node->kind = AST_NUMBER;
    return node;
}

static uint8_t calls(const struct ast *a, const struct ast *b)
{
    return (uint8_t)(((a ? a->flags : 0) | (b ? b->flags : 0)) & AST_HAS_CALL);
}

struct ast *ast_unary(struct parse *p, struct loc at, int op, struct ast *right)
{
    struct ast *node = ast_new(p, AST_UNARY, at);

    node->op = (uint8_t)op;
    node->right = right;
    node->flags = calls(right, NULL);
    return measured(p, node);
}

struct ast *ast_binary(struct parse *p, struct loc at, int op, struct ast *left, struct ast *right)
{
    struct ast *node = ast_new(p, AST_BINARY, at);

    node->op = (uint8_t)op;
    node->left = left;
    node->right = right;
    node->flags = calls(left, right);
    return measured(p, node);
}

struct ast *ast_tail(struct parse *p, struct loc at, int op, struct ast *right)
{
    struct ast *node = ast_new(p, AST_TAIL, at);

    node->op = (uint8_t)op;
    node->right = right;
    return node;
}

struct ast *ast_condition(struct parse *p, struct loc at, struct ast *a, struct ast *b,
                          struct ast *c)
{
    struct ast *node = ast_new(p, AST_CONDITION, at);

    node->left = a;
    node->right = b;
    node->third = c;
    return measured(p, node);
}

static const struct { const char *name; uint8_t index; } members[] = {
    { "x", 0 }, { "y", 1 }, { "z", 2 }, { "t", 3 }, { "u", 0 }, { "v", 1 },
    { "red", 0 }, { "green", 1 }, { "blue", 2 }, { "filter", 3 }, { "transmit", 4 },
    { "gray", AST_GRAY }, { "grey", AST_GREY },
};

static bool ends_file_name(const char *name)
{
    static const char *const endings[] = {
        "inc", "pov", "rt", "png", "jpg", "jpeg", "gif", "tga", "tiff", "tif", "ttf", "txt", "df3", NULL,
    };

    for (const char *const *e = endings; *e; e++)
        if (strcmp(name, *e) == 0)
            return true;
    return false;
}

struct ast *ast_member(struct parse *p, struct loc at, struct ast *left, const char *name)
{
    struct ast *node = ast_new(p, AST_MEMBER, at);

    node->left = left;
    node->flags = calls(left, NULL);
    for (size_t i = 0; i < sizeof members / sizeof *members; i++)
        if (strcmp(members[i].name, name) == 0) {
            node->index = members[i].index;
            return measured(p, node);
        }
    if (left->kind == AST_NAME && ends_file_name(name))
        return ast_error(p, at, (struct loc) { 0 }, "a file's name needs quotes: \"%s.%s\"",
                         left->name->text, name);
    return ast_error(p, at, (struct loc) { 0 }, "there is no component '.%s'", name);
}

struct ast_more *ast_more(struct parse *p, struct ast *error)
{
    if (!error->more)
        error->more = arena_alloc(p->mem, sizeof *error->more);
    return error->more;
}

struct ast *ast_error(struct parse *p, struct loc at, struct loc other, const char *format, ...)
{
    struct ast *node = ast_new(p, AST_ERROR, at);
    char text[512];
    va_list args;

    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    node->text = arena_text(p->mem, text, strlen(text));
    node->other = other;
    node->note = "opened here";
    p->keep = true;
    return node;
}
