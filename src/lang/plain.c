/* plain.c: blocks that need no grammar.
 *
 * Most of a large scene is blocks of nothing but words, names, constants,
 * commas and blocks of the same kind.  Such a block is read here in one go; the
 * tree is the one that the grammar would make.  Whatever else is met ends the
 * attempt, and the block is read again, token by token. */
#include <string.h>

#include "lang/parsing.h"

enum {
    DEEPEST = 8,                /* blocks within each other, and ... */
    LONGEST = 2048,             /* ... bytes: what an attempt in vain may cost */
};

/* What stands before an item: facts about signs and '<' (see may_begin in scan.l). */
enum before { BEFORE_OPEN, BEFORE_WORD, BEFORE_CONSTANT, BEFORE_OTHER };

struct attempt {
    struct parse *parse;
    char *at;                   /* behind what was read */
    char *most;                 /* it ends here in vain */
    unsigned depth;
    const struct word *around;  /* whose braces are read; NULL right behind the '{' */
};

static struct loc loc_of(const struct parse *p, const char *begin, const char *end)
{
    return (struct loc) { p->source, (uint32_t)(begin - p->text), (uint32_t)(end - p->text) };
}

static struct ast *block(struct attempt *a, struct name *name, char *begin);

/* Does nothing follow a name that makes more of it: a call, an index, an operator? */
static bool stands_alone(char next)
{
    return next == ',' || next == '}' || is_letter(next);
}

static struct ast *word_item(struct attempt *a, struct name *name, char *begin, char *end,
                             enum before *before)
{
    const struct word *word = name->word;
    enum word_class class = word->class;

    if (class != WORD_PLAIN && class != WORD_RGB && class != WORD_COLOUR && class != WORD_TEXTURE)
        return NULL;
    if (*a->at == '{')
        return word_shuts_out(a->around, word) ? NULL : block(a, name, begin);
    *before = class == WORD_TEXTURE ? BEFORE_OTHER : BEFORE_WORD;
    struct ast *node = ast_new(a->parse, AST_WORD, loc_of(a->parse, begin, end));
    node->name = name;
    node->word = word;
    return node;
}

static struct ast *name_item(struct attempt *a, enum before *before)
{
    struct parse *p = a->parse;
    char *begin = a->at, *end = begin;

    while (is_letter(*end) || (*end >= '0' && *end <= '9'))
        end++;
    struct name *name = name_intern(&p->lang->names, begin, (size_t)(end - begin));
    const struct word *word = name->word;
    a->at = skip_spaces(end);
    *before = BEFORE_OTHER;
    if (word && word->class != WORD_CONSTANT)
        return word_item(a, name, begin, end, before);
    if (!stands_alone(*a->at) || name->length > LONGEST_NAME)
        return NULL;
    struct ast *node = ast_new(p, word ? AST_CONSTANT : AST_NAME, loc_of(p, begin, end));
    node->name = name;
    node->word = word;
    return node;
}

static struct ast *comma(struct attempt *a)
{
    char *begin = a->at++;

    return ast_new(a->parse, AST_COMMA, loc_of(a->parse, begin, a->at));
}

/* Many constants in a row are better packed by the scanner. */
struct row { unsigned components, n; };

static struct ast *constant_item(struct attempt *a, enum before *before, struct row *row)
{
    struct constant c;
    char first = *a->at;
    bool may_begin = *before == BEFORE_OPEN || *before == BEFORE_WORD
        || (*before == BEFORE_CONSTANT && first != '-' && first != '+');

    if (!may_begin || !constant_read(a->at, &c))
        return NULL;
    a->at = skip_spaces(c.end);
    char next = *a->at;
    if (!stands_alone(next) && next != '<' && !(next >= '0' && next <= '9'))
        return NULL;
    row->n = row->components == c.n && *before == BEFORE_OPEN ? row->n + 1 : 1;
    row->components = c.n;
    *before = BEFORE_CONSTANT;
    return row->n < SHORTEST_RUN ? constant_node(a->parse, &c) : NULL;
}

/* Up to and with the closing brace; false: there is more to it. */
static bool items(struct attempt *a, struct ast *list, const struct word *word)
{
    enum before before = BEFORE_OPEN;
    struct row row = { 0, 0 };

    for (;;) {
        struct ast *item;
        a->at = skip_spaces(a->at);
        if (a->at > a->most)
            return false;
        if (*a->at == '}')
            return true;
        if (is_letter(*a->at))
            item = name_item(a, &before);
        else if (*a->at == ',') {
            item = comma(a);
            before = BEFORE_OPEN;
        } else
            item = constant_item(a, &before, &row);
        if (!item)
            return false;
        ast_add(list, item);
        a->around = word;
    }
}

/* The opening brace is next. */
static struct ast *block(struct attempt *a, struct name *name, char *begin)
{
    struct parse *p = a->parse;
    char *brace = a->at++;
    struct ast *list = ast_list(p, loc_of(p, brace, a->at));
    const struct word *around = a->around;

    a->around = NULL;
    if (++a->depth > DEEPEST || p->n_open + a->depth > p->lang->limits->nesting || !items(a, list, name->word)
        || (a->at[-1] <= ' ' && is_askew(p, brace, a->at)))
        return NULL;
    a->around = around;
    a->depth--;
    a->at++;
    list->close = loc_of(p, a->at - 1, a->at);
    list->flags |= AST_CLOSED;
    struct ast *node = ast_new(p, AST_BLOCK, loc_of(p, begin, begin + name->length));
    node->name = name;
    node->word = name->word;
    node->body = list;
    return node;
}

struct ast *plain_block(struct parse *p, struct name *name, char *begin, char **end)
{
    struct attempt a = { .parse = p, .at = skip_spaces(begin + name->length) };
    struct arena_mark mark = arena_mark(p->mem);

    if (*a.at != '{')
        return NULL;
    a.most = p->size - (size_t)(a.at - p->text) > LONGEST ? a.at + LONGEST : p->text + p->size;
    struct ast *node = block(&a, name, begin);
    if (node)
        p->closed = node->body->at;
    else if (p->mem != p->lang->mem)        /* where names are */
        arena_recycle(p->mem, mark);
    *end = a.at;
    return node;
}
