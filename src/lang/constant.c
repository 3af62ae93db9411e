/* constant.c: numbers and vectors of numbers, read from the text at once. */
#include <string.h>

#include "lang/number.h"
#include "lang/parsing.h"

/* A signed number and the place behind it; NULL: something else. */
static char *number(char *p, double *out)
{
    bool minus = *p == '-';

    if (*p == '-' || *p == '+')
        p++;
    if (!((*p >= '0' && *p <= '9') || (*p == '.' && p[1] >= '0' && p[1] <= '9')))
        return NULL;
    p = number_scan(p, out);
    if (minus)
        *out = -*out;
    return *p == '.' || is_letter(*p) ? NULL : p;
}

bool constant_read(char *p, struct constant *out)
{
    out->begin = p;
    out->n = *p != '<';
    if (out->n)
        return (out->end = number(p, out->v));
    do {
        if (out->n == 5 || !(p = number(skip_spaces(p + 1), out->v + out->n++)))
            return false;
        p = skip_spaces(p);
    } while (*p == ',');
    out->end = p + 1;
    return *p == '>' && out->n >= 2;
}

struct ast *constant_node(struct parse *p, const struct constant *c)
{
    bool vector = *c->begin == '<';
    struct loc at = { p->source, (uint32_t)(c->begin - p->text), (uint32_t)(c->end - p->text) };

    if (vector)
        return ast_literal(p, at, c->v, c->n);
    struct ast *node = ast_new(p, AST_NUMBER, at);
    node->number = c->v[0];
    return node;
}
