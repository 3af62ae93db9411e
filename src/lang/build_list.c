/* build_list.c: < > and ( ) with more numbers than a vector has. */
#include <string.h>

#include "lang/build.h"
#include "lang/eval.h"
#include "lang/frame.h"

/* The node that stands next, an optional comma before it taken; NULL: an item
 * was evaluated already. */
static const struct ast *next_node(struct reader *r)
{
    const struct ast *a = r->has_item ? NULL : reader_look(r);

    if (!a || (a->kind != AST_COMMA && a->kind != AST_BULK))
        return a;
    reader_skip_comma(r);
    return r->has_item ? NULL : reader_look(r);
}

static bool take_numbers(struct lang *l, const struct ast *a, const char *what, size_t n,
                         double *out)
{
    struct values values;
    int got = a->kind == AST_LITERAL ? a->n : evaluate_list(l, a->args, &values, false);

    if (got < 0)
        return false;
    if ((size_t)got != n) {
        diag_error(l->diag, a->at, "%s needs %zu numbers, not %d", what, n, got);
        return false;
    }
    for (size_t i = 0; i < n; i++)
        if (a->kind == AST_LITERAL)
            out[i] = a->v[i];
        else if (!value_components(&values.item[i].value, 1, &out[i])) {
            diag_error(l->diag, a->at, "%s: value %zu is no number", what, i + 1);
            return false;
        }
    return true;
}

static bool read_list(struct reader *r, enum ast_kind kind, const char *what, size_t n, double *out)
{
    const struct ast *a = next_node(r);

    memset(out, 0, n * sizeof *out);
    if (a && (a->kind == kind || (a->kind == AST_LITERAL && kind == AST_VECTOR))) {
        r->has_node = false;
        return take_numbers(r->lang, a, what, n, out);
    }
    diag_error(r->lang->diag, reader_at(r), "expected %zu numbers in %s for %s; found %s", n,
               kind == AST_VECTOR ? "< >" : "( )", what,
               item_describe(r->lang, reader_peek(r)));
    return false;
}

bool reader_list(struct reader *r, const char *what, size_t n, double *out)
{
    return read_list(r, AST_VECTOR, what, n, out);
}

bool reader_arguments(struct reader *r, const char *what, size_t n, double *out)
{
    return read_list(r, AST_PAREN, what, n, out);
}
