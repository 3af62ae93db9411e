/* reader.c: a block's body as a stream of evaluated items.
 *
 * All open readers share one stack of frames; a reader's own frames are those
 * from its base up.  Directives are carried out when the item behind them is
 * asked for. */
#include "lang/reader.h"

#include <string.h>

#include "lang/eval.h"
#include "lang/frame.h"
#include "lang/function.h"
#include "lang/array.h"
#include "lang/guess.h"
#include "lang/scope.h"

/* --- frames ------------------------------------------------------------------ */

struct frame *frame_push(struct lang *l, enum frame_kind kind, const struct ast *list,
                         const struct ast *node)
{
    l->frame = arena_grow(l->mem, l->frame, l->n_frame, &l->room_frame, sizeof *l->frame);
    struct frame *f = &l->frame[l->n_frame++];
    *f = (struct frame) { .kind = kind, .next = list ? list->first : NULL, .node = node };
    if (node)
        f->at = node->at;
    return f;
}

void frame_pop(struct lang *l)
{
    struct frame *f = &l->frame[--l->n_frame];

    if (f->kind == FRAME_MACRO || f->kind == FRAME_INCLUDE)
        scope_close(l);
    l->n_call -= f->kind == FRAME_MACRO;
    l->n_include -= f->kind == FRAME_INCLUDE;
}

void reader_start(struct reader *r, struct lang *l, const struct ast *list)
{
    r->lang = l;                /* one by one: clearing all of it took longer than the rest */
    r->outer = l->reader;
    r->base = l->n_frame;
    r->has_item = r->has_node = r->failed = r->unclosed = r->strict = false;
    r->brace = list->at;
    r->close = list->close;
    l->reader = r;
    l->nesting++;
    frame_push(l, FRAME_LIST, list, NULL);
}

void reader_open(struct reader *r, struct lang *l, const struct ast *body)
{
    static const struct ast nothing;

    if (l->nesting >= l->limits->nesting * 2)
        lang_limit(l, body->at, "nested too deeply (--max-nesting=N would let it)");
    reader_start(r, l, body ? body : &nothing);
}

/* POV-Ray carries out the directives that stand where it wants something else, and says
 * only then that it is not there: what they write counts. */
void error_is_late(struct lang *l)
{
    unsigned before = l->diag->errors - 1;

    if (before && before != l->late.errors)
        return;                 /* an earlier one was not */
    l->late.errors = l->diag->errors;
    l->late.nesting = l->nesting;
}

bool lang_is_quiet(const struct lang *l)
{
    return l->diag->errors && l->diag->errors != l->late.errors;
}

/* Here is what is no directive, or the end of a block. */
static void end_lateness(struct lang *l)
{
    if (l->nesting <= l->late.nesting)
        l->late.errors = 0;
}

void reader_close(struct reader *r)
{
    struct lang *l = r->lang;

    if (l->late.errors && r->outer)
        end_lateness(l);
    while (l->n_frame > r->base)
        frame_pop(l);
    l->reader = r->outer;
    l->nesting--;
}

/* --- walking -------------------------------------------------------------------- */

/* What the mistake was to declare is known from now on: one mistake, one message. */
static void declare_meant(struct lang *l, const struct ast *a)
{
    struct name *meant = a->more ? a->more->meant : NULL;

    if (meant)
        scope_declare_broken(l, meant, a->at);
}

static void note_askew(struct lang *l, const struct ast_more *more)
{
    diag_note(l->diag, more->askew, "or is it this one's? what closes it, in line %u, stands further left",
              source_position(l->sources, more->askew_end.source, more->askew_end.begin).line);
}

void say_parse_error(struct lang *l, const struct ast *a)
{
    diag_error(l->diag, a->at, "%s", a->text);
    declare_meant(l, a);
    if (a->other.source)
        diag_note(l->diag, a->other, "%s", a->note);
    if (a->more && a->more->askew.source)
        note_askew(l, a->more);
}

/* What could not be parsed is said when it is reached: in a branch that is
 * never taken anything may stand. */
static void say_error(struct reader *r, const struct ast *a)
{
    r->failed = true;
    if (a->op == '}' && r->lang->skipping)      /* its '{' is what was missing */
        return;
    if (r->unclosed && a->other.source == r->brace.source && a->other.begin == r->brace.begin)
        return;
    say_parse_error(r->lang, a);
    r->lang->stopped |= (a->flags & AST_FATAL) != 0;
    if (a->op == AST_ERROR_LATE)
        error_is_late(r->lang);
}

/* Behind such a place, the list makes sense again at the next block or
 * directive, or macro when what came before waits for it. */
static const struct ast *resume(const struct lang *l, const struct ast *a)
{
    while (a && a->kind != AST_BLOCK && a->kind < AST_DECLARE && a->kind != AST_ERROR
           && !(l->late.errors && a->kind == AST_CALL && is_macro(a->name)))
        a = a->next;
    return a;
}

static bool is_directive(const struct ast *a)
{
    return a->kind >= AST_DECLARE && a->kind != AST_CASE;
}

static const struct ast *step(struct reader *r)
{
    struct lang *l = r->lang;

    l->stopped = l->stopped || l->diag->full;   /* else a loop would go on making messages that nobody sees */
    while (!l->stopped) {
        struct frame *f = &l->frame[l->n_frame - 1];
        const struct ast *a = f->next;
        if (!a) {
            if (l->n_frame - 1 == r->base)
                return NULL;
            frame_end(l);
        } else if (a->kind == AST_BULK)
            return a;
        else if (is_directive(a)) {
            f->next = a->next;
            direct(r, a);
        } else if (a->kind == AST_ERROR) {
            say_error(r, a);
            f->next = resume(l, a->next);
        } else if (a->kind == AST_CALL && is_macro(a->name)) {
            f->next = a->next;
            macro_call(l, a);
        } else {
            f->next = a->next;
            if (a->kind != AST_CASE)
                return a;
            label_matches(l, a, 0);
        }
    }
    return NULL;
}

const struct ast *reader_step(struct reader *r)
{
    const struct ast *a = step(r);

    if (r->lang->late.errors && a)
        end_lateness(r->lang);
    return a;
}

const struct ast *reader_look(struct reader *r)
{
    if (!r->has_node) {
        r->node = reader_step(r);
        r->has_node = true;
    }
    return r->node;
}

static const struct ast *take_node(struct reader *r)
{
    const struct ast *a = reader_look(r);

    r->has_node = false;
    return a;
}

/* --- items -------------------------------------------------------------------------- */

/* Is a directive or the end of a spliced list next, so that an operator could
 * follow from there? */
static bool may_go_on(const struct reader *r)
{
    const struct lang *l = r->lang;
    const struct frame *f = &l->frame[l->n_frame - 1];

    if (!r->outer)              /* the top level has no expressions */
        return false;
    if (!f->next)
        return l->n_frame - 1 > r->base;
    return f->next->kind >= AST_DECLARE || f->next->kind == AST_TAIL
        || (f->next->kind == AST_CALL && is_macro(f->next->name));
}

/* A directive follows where none may follow a number; behind a text it is left for later. */
static bool is_cut_short(const struct reader *r, struct value_chain *c)
{
    bool cut = r->strict && !c->chain.failed && chain_is_interrupted(r);

    c->chain.interrupted |= cut && value_is_number(&c->value[0]);
    return cut || c->chain.interrupted;
}

static void read_value(struct reader *r, const struct ast *a, struct item *i)
{
    struct lang *l = r->lang;
    struct value_chain c;

    i->kind = ITEM_VALUE;
    if (!may_go_on(r)) {
        (r->strict ? evaluate_strictly : evaluate)(l, a, &i->value);
        return;
    }
    value_chain_start(&c, l);
    c.chain.strict = r->strict;
    chain_add(&c.chain, a);
    if (is_cut_short(r, &c)) {
        value_chain_end(&c, a->at, &i->value);
        return;
    }
    while (!l->stopped && reader_look(r) && chain_continues(r->node))
        chain_add(&c.chain, take_node(r));
    value_chain_end(&c, a->at, &i->value);
}

static void read_name(struct reader *r, const struct ast *a, struct item *i)
{
    struct binding *b = scope_find(a->name);

    i->text = a->name->text;
    if (!b) {
        i->kind = ITEM_NAME;
        return;
    }
    read_value(r, a, i);
    i->name = a->name->text;
}

static void read_call(struct reader *r, const struct ast *a, struct item *i)
{
    if (!scope_find(a->name)) {
        i->kind = ITEM_NAME;
        i->text = a->name->text;
        i->body = a->args;
    } else
        read_value(r, a, i);
}

static void read_block(struct reader *r, const struct ast *a, struct item *i)
{
    struct lang *l = r->lang;

    i->word = a->word;
    i->text = a->name ? a->name->text : NULL;
    i->body = a->body;
    i->brace = a->body ? a->body->at : a->at;
    i->kind = a->kind == AST_ENTRY ? ITEM_ENTRY : a->kind == AST_BRACES ? ITEM_BRACES
        : a->word ? ITEM_BLOCK : ITEM_NAME;
    if (i->kind == ITEM_BLOCK && word_is(a->word, "spline")) {
        i->kind = ITEM_VALUE;
        spline_make(l, a, &i->value);
    }
}

static void read_thing(struct reader *r, const struct ast *a, struct item *i)
{
    i->kind = ITEM_VALUE;
    if (a->kind == AST_ARRAY)
        array_make(r->lang, a, &i->value);
    else
        function_make(r->lang, a, &i->value);
}

/* The next of a run of constants, or the comma behind one. */
static void read_bulk(struct reader *r, const struct ast *a, struct item *i)
{
    struct lang *l = r->lang;
    struct frame *f = &l->frame[l->n_frame - 1];
    const struct ast_bulk *run = &a->bulk;

    if (f->bulk_comma) {
        i->kind = ITEM_COMMA;
        f->bulk_comma = false;
        if (f->bulk == run->n) {
            f->next = a->next;
            f->bulk = 0;
        }
        return;
    }
    i->kind = ITEM_VALUE;
    i->value = value_vector((int)run->components, run->v + (size_t)f->bulk * run->components);
    f->bulk++;
    f->bulk_comma = true;
}

static void read_item(struct reader *r, const struct ast *a, struct item *i)
{
    switch (a->kind) {
    case AST_WORD:
        i->kind = ITEM_WORD;
        i->word = a->word;
        i->text = a->name->text;
        return;
    case AST_BLOCK: case AST_ENTRY: case AST_BRACES: read_block(r, a, i); return;
    case AST_COMMA: i->kind = ITEM_COMMA; return;
    case AST_COLON: i->kind = ITEM_COLON; return;
    case AST_BULK: read_bulk(r, a, i); return;
    case AST_NAME: read_name(r, a, i); return;
    case AST_CALL: read_call(r, a, i); return;
    case AST_INDEX:
        read_value(r, a, i);
        i->name = a->name->text;
        return;
    case AST_ARRAY: case AST_FUNCTION: read_thing(r, a, i); return;
    default: read_value(r, a, i); return;
    }
}

/* An operator without a left side, or a semicolon: neither is an item. */
static bool is_misplaced(struct reader *r, const struct ast *a)
{
    if (a->kind != AST_TAIL && a->kind != AST_SEMICOLON)
        return false;
    diag_error(r->lang->diag, a->at, a->kind == AST_TAIL ? "an operator without a left side"
               : "';' cannot stand here: it ends declarations only");
    r->failed = true;
    return true;
}

static void fetch(struct reader *r)
{
    unsigned errors = r->lang->diag->errors;
    const struct ast *a;

    r->item = (struct item) { .kind = ITEM_END, .at = r->close };
    do
        a = take_node(r);
    while (a && is_misplaced(r, a));
    if (a) {
        r->item.at = a->at;
        read_item(r, a, &r->item);
    }
    r->failed = r->failed || errors != r->lang->diag->errors;
    r->has_item = true;
}

const struct item *reader_peek(struct reader *r)
{
    if (!r->has_item)
        fetch(r);
    return &r->item;
}

struct item reader_next(struct reader *r)
{
    if (!r->has_item)
        fetch(r);
    r->has_item = r->item.kind == ITEM_END;
    return r->item;
}

/* --- plain nodes ------------------------------------------------------------------
 *
 * Most of what a large scene says is constants and the commas between them.
 * They are taken as they stand in the tree, without becoming items. */

/* The node to come, when it is in the list itself; NULL: ask for the item. */
static const struct ast *plain_node(const struct reader *r)
{
    const struct lang *l = r->lang;

    if (r->has_item || l->stopped)
        return NULL;
    return r->has_node ? r->node : l->frame[l->n_frame - 1].next;
}

static void take_plain(struct reader *r)
{
    struct frame *f = &r->lang->frame[r->lang->n_frame - 1];

    if (!r->has_node)
        f->next = f->next->next;
    r->has_node = false;
}

/* A constant that is all of a value; NULL: ask for the item. */
static const struct ast *plain_constant(const struct reader *r)
{
    const struct ast *a = plain_node(r);

    if (!a || (a->kind != AST_NUMBER && a->kind != AST_LITERAL))
        return NULL;
    const struct ast *next = a->next;
    return next && (next->kind == AST_COMMA || next->kind == AST_WORD || next->kind == AST_BLOCK)
           ? a : NULL;
}

struct loc reader_at(struct reader *r)
{
    const struct ast *a = plain_constant(r);
    if (a)
        return a->at;
    const struct item *i = reader_peek(r);

    return i->at.source ? i->at : r->brace;
}

void reader_resume(struct reader *r)
{
    struct frame *f = &r->lang->frame[r->lang->n_frame - 1];

    const struct ast *next = resume(r->lang, f->next);

    if (r->has_node || r->has_item || f->bulk_comma)
        return;
    if (next != f->next)
        end_lateness(r->lang);
    f->next = next;
}

bool reader_skip_comma(struct reader *r)
{
    const struct ast *a = plain_node(r);

    if (a && a->kind == AST_COMMA) {
        take_plain(r);
        return true;
    }
    if (reader_peek(r)->kind != ITEM_COMMA)
        return false;
    reader_next(r);
    return true;
}

bool reader_takes_word(struct reader *r, const char *word)
{
    const struct item *i = reader_peek(r);

    if (i->kind != ITEM_WORD || strcmp(i->word->text, word) != 0)
        return false;
    reader_next(r);
    return true;
}

/* --- values of a wanted shape ---------------------------------------------------------- */

const char *item_describe(struct lang *l, const struct item *i)
{
    switch (i->kind) {
    case ITEM_END: return "the end of the block";
    case ITEM_COMMA: return "a comma";
    case ITEM_COLON: return "a colon";
    case ITEM_ENTRY: return "[ ]";
    case ITEM_BRACES: return "{ }";
    case ITEM_VALUE:
        if (i->name && !value_is_number(&i->value))
            return arena_format(l->mem, "the %s '%s'", value_name(&i->value), i->name);
        return value_describe(l, &i->value);
    default: return arena_format(l->mem, "'%s'", i->text);
    }
}

bool reader_is_number(struct reader *r)
{
    if (plain_constant(r))
        return true;
    const struct item *i = reader_peek(r);

    return i->kind == ITEM_VALUE && value_is_number(&i->value);
}

bool reader_explains(struct reader *r)
{
    struct lang *l = r->lang;
    const struct item *i = reader_peek(r);

    if (r->failed || l->stopped)
        return true;
    r->failed = true;
    if (i->kind != ITEM_NAME)
        return false;
    say_undeclared(l, i->at, i->text, i->body ? "" : NULL);
    reader_next(r);
    return true;
}

static void say_wanted(struct reader *r, const char *what)
{
    struct lang *l = r->lang;
    const struct item *i = reader_peek(r);

    if (reader_explains(r))
        return;
    diag_error(l->diag, reader_at(r), "expected %s, found %s", what, item_describe(l, i));
    if (i->kind == ITEM_VALUE && i->name)
        note_declared(l, i->name);
    if (i->kind == ITEM_END && r->brace.source)
        diag_note(l->diag, r->brace, "the block begins here");
}

static bool take_constant(struct reader *r, int n, double *v)
{
    const struct ast *a = plain_constant(r);

    if (!a || (a->kind == AST_NUMBER ? n != 1 : n != a->n))
        return false;
    memcpy(v, a->kind == AST_NUMBER ? &a->number : a->v, (size_t)n * sizeof *v);
    take_plain(r);
    return true;
}

bool reader_vector(struct reader *r, bool comma, int n, double *v, const char *what)
{
    if (comma)
        reader_skip_comma(r);
    if (take_constant(r, n, v))
        return true;
    const struct item *i = reader_peek(r);
    if (i->kind == ITEM_VALUE && value_components(&i->value, n, v)) {
        reader_next(r);
        return true;
    }
    for (int k = 0; k < n; k++)         /* 0 as a radius or scale would be the next mistake */
        v[k] = 1;
    say_wanted(r, what);
    if (i->kind == ITEM_VALUE && value_is_number(&i->value))
        reader_next(r);
    return false;
}

double reader_number(struct reader *r, bool comma, const char *what)
{
    double x;

    reader_vector(r, comma, 1, &x, what);
    return x;
}

int reader_whole(struct reader *r, bool comma, const char *what)
{
    return value_whole(reader_number(r, comma, what));
}

const char *reader_text(struct reader *r, bool comma, const char *what)
{
    if (comma)
        reader_skip_comma(r);
    const struct item *i = reader_peek(r);
    if (i->kind == ITEM_VALUE && i->value.type == VALUE_TEXT)
        return reader_next(r).value.text.bytes;
    say_wanted(r, what);
    return "";
}

size_t reader_bulk(struct reader *r, int components, size_t most, double *out)
{
    struct lang *l = r->lang;

    if (r->has_item || (r->has_node && (!r->node || r->node->kind != AST_BULK)))
        return 0;
    const struct ast *a = reader_look(r);
    struct frame *f = &l->frame[l->n_frame - 1];
    if (!a || a->kind != AST_BULK || a != f->next || f->bulk_comma
        || (int)a->bulk.components != components)
        return 0;
    size_t left = a->bulk.n - f->bulk, n = left < most ? left : most;
    memcpy(out, a->bulk.v + (size_t)f->bulk * (size_t)components,
           n * (size_t)components * sizeof *out);
    f->bulk += (uint32_t)n;
    r->has_node = false;
    if (f->bulk == a->bulk.n) {
        f->next = a->next;
        f->bulk = 0;
    }
    return n;
}
