/* build_block.c: what all blocks have in common: words with values, unknown
 * words, transforms, declared things to start from. */
#include <float.h>
#include <stdarg.h>
#include <string.h>

#include "lang/ast.h"
#include "lang/build.h"
#include "lang/colour.h"
#include "lang/frame.h"
#include "lang/guess.h"
#include "lang/parsing.h"
#include "lang/scope.h"

/* --- items ------------------------------------------------------------------- */

bool item_is_thing(const struct item *i, enum value_type type)
{
    return i->kind == ITEM_VALUE && i->value.type == type;
}

const void *build_start(struct reader *r, enum value_type type)
{
    if (!item_is_thing(reader_peek(r), type))
        return NULL;
    return reader_next(r).value.thing;
}

const void *build_named(const struct item *block, enum value_type type)
{
    const struct ast *list = block->body, *a = list ? list->first : NULL;

    if (!a || a->kind != AST_NAME || a->next || !(list->flags & AST_CLOSED))
        return NULL;
    const struct binding *b = scope_find(a->name);
    return b && !b->deprecated && b->value->type == type ? b->value->thing : NULL;
}

bool build_flag(struct reader *r)
{
    return reader_is_number(r) ? reader_number(r, false, "a flag") > 0 : true;
}

vec3 build_vector(struct reader *r, bool comma, const char *what)
{
    double v[3] = { 0, 0, 0 };

    reader_vector(r, comma, 3, v, what);
    return vec(v[0], v[1], v[2]);
}

/* --- messages ---------------------------------------------------------------- */

static bool is_argument(const struct item *i)
{
    return i->kind == ITEM_COMMA || (i->kind == ITEM_VALUE && !item_is_object(i))
        || (i->kind == ITEM_WORD && (i->word->class == WORD_RGB || i->word->class == WORD_COLOUR));
}

/* What follows an unknown word is its values: nothing is said about them. */
static void skip_values(struct lang *l)
{
    struct reader *r = l->reader;

    if (!r || l->stopped)
        return;
    while (is_argument(reader_peek(r)))
        reader_next(r);
    r->failed = true;
}

static const char *table_guess(struct lang *l, const struct item *i,
                               const struct field *const *tables)
{
    struct guess g = guess_start(i->text);

    for (; tables && *tables; tables++)
        guess_fields(&g, *tables);
    return guess_text(&g, l);
}

/* A statement in the middle of a block: its closing brace is missing. */
static bool is_statement(const struct item *i)
{
    return i->kind == ITEM_BLOCK && i->word->block
        && (i->word->block->use || i->word->block->makes == VALUE_NONE);
}

static void unknown_name(struct lang *l, const struct item *i, const char *block,
                         const struct field *const *tables)
{
    const char *guess = table_guess(l, i, tables);

    if (*guess)
        diag_error(l->diag, i->at, "unknown word '%s' in %s%s", i->text, block, guess);
    else
        say_undeclared(l, i->at, i->text, arena_format(l->mem, " in %s", block));
}

/* The block in which a word has a meaning: "; it belongs in finish { }". */
static const char *home_text(struct lang *l, const struct item *i)
{
    static const struct { const struct field *table; const char *block; } homes[] = {
        { interior_fields, "interior" }, { finish_fields, "finish" },
        { settings_fields, "global_settings" }, { image_fields, "image_map" },
    };

    if (i->word->pattern)
        return "; it belongs in pigment { }";
    for (size_t h = 0; h < sizeof homes / sizeof *homes; h++)
        if (field_find(homes[h].table, i->text))
            return arena_format(l->mem, "; it belongs in %s { }", homes[h].block);
    return "";
}

/* Is it known that the scene's text closes all that it opens? */
static bool has_all_braces(const struct lang *l)
{
    return l->streamed && l->streamed->has_counted && l->streamed->lacking < 0;
}

/* A word that is known, but not here. */
static void misplaced_word(struct lang *l, const struct item *i, const char *block,
                           const struct field *const *tables)
{
    const char *guess = table_guess(l, i, tables);

    if (i->kind == ITEM_WORD && i->word->block) {
        diag_error(l->diag, i->at, "'%s' needs braces: %s { }", i->text, i->text);
        if (l->reader)
            l->reader->unclosed = true;
    } else
        diag_error(l->diag, i->at, "'%s' cannot stand in %s%s", i->text, block,
                   *guess ? guess : home_text(l, i));
}

/* rgb 1, 0, 0 */
static const char *comma_hint(const struct lang *l, const struct item *i, const char *block)
{
    bool is_colour = strcmp(block, "pigment") == 0 || strcmp(block, "background") == 0;

    return i->kind == ITEM_COMMA && is_colour && reader_is_number(l->reader)
           ? ": the numbers of a colour stand between < and >" : "";
}

void build_unknown(struct lang *l, const struct item *i, const char *block,
                   const struct field *const *tables)
{
    if (l->reader && l->reader->unclosed) {     /* a brace is missing: what follows is of others */
        skip_values(l);
        return;
    }
    switch (i->kind) {
    case ITEM_NAME:
        unknown_name(l, i, block, tables);
        skip_values(l);
        return;
    case ITEM_WORD: case ITEM_BLOCK:
        if (is_statement(i)) {
            diag_error(l->diag, i->at, "'%s' cannot stand in %s%s", i->text, block,
                       has_all_braces(l) ? "" : ": is a '}' missing before it?");
            if (l->reader && l->reader->brace.source)
                diag_note(l->diag, l->reader->brace, "%s begins here", block);
            if (l->reader)
                l->reader->unclosed = true;
        } else
            misplaced_word(l, i, block, tables);
        if (i->kind == ITEM_WORD && i->word->block && !is_statement(i))
            error_is_late(l);
        if (i->kind == ITEM_WORD)
            skip_values(l);
        return;
    default:
        if (!l->reader || !l->reader->failed)       /* else it is what a number was missed for */
            diag_error(l->diag, i->at, "%s cannot stand here in %s%s", item_describe(l, i), block,
                       l->reader ? comma_hint(l, i, block) : "");
        skip_values(l);
    }
}

void build_wrong(struct lang *l, const struct item *block, const char *format, ...)
{
    va_list args;
    char text[256];

    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    diag_error(l->diag, block->at, "%s", text);
}

/* --- fields ------------------------------------------------------------------ */

const struct field *field_find(const struct field *table, const char *word)
{
    for (; table && table->name; table++)
        if (table->name[0] == word[0] && strcmp(table->name, word) == 0)
            return table;
    return NULL;
}

static double in_range(struct reader *r, const struct field *f, const char *word, struct loc at,
                       double x)
{
    if (f->low > f->high || (x >= f->low && x <= f->high))
        return x;
    if (f->low == DBL_MIN && (isinf(f->high) || x < f->low))
        diag_error(r->lang->diag, at, "%s must be above 0, not %g", word, x);
    else if (isinf(f->high))
        diag_error(r->lang->diag, at, "%s must be at least %g, not %g", word, f->low, x);
    else if (isinf(f->low) || f->low == DBL_MIN)
        diag_error(r->lang->diag, at, "%s must be at most %g, not %g", word, f->high, x);
    else
        diag_error(r->lang->diag, at, "%s must be between %g and %g, not %g", word, f->low,
                   f->high, x);
    return x < f->low ? f->low : f->high;
}

static double number(struct reader *r, const struct field *f, const char *word)
{
    struct loc at = reader_at(r);

    return in_range(r, f, word, at, reader_number(r, false, word));
}

static void vector(struct reader *r, const struct field *f, const char *word, int n, double *to)
{
    struct loc at = reader_at(r);

    reader_vector(r, false, n, to, word);
    for (int i = 0; i < n; i++)
        to[i] = in_range(r, f, word, at, to[i]);
}

/* A comma before was taken by the caller. */
bool build_field(struct reader *r, const struct field *f, const char *word, struct loc at,
                 void *thing)
{
    char *to = (char *)thing + f->offset;

    if (f->unsupported)
        diag_unsupported(r->lang->diag, at, f->unsupported);
    switch (f->type) {
    case FIELD_FLAG:
        *(bool *)to = build_flag(r);
        return true;
    case FIELD_INT:
        *(int *)to = value_whole(number(r, f, word));
        return true;
    case FIELD_NUM: case FIELD_DEGREES:
        *(double *)to = number(r, f, word);
        return true;
    case FIELD_NUM_OR_1:
        *(double *)to = reader_is_number(r) ? number(r, f, word) : 1;
        return true;
    case FIELD_POINT2:
        vector(r, f, word, 2, (double *)to);
        return true;
    case FIELD_POINT:
        vector(r, f, word, 3, (double *)to);
        return true;
    case FIELD_POINT4:
        vector(r, f, word, 4, (double *)to);
        return true;
    case FIELD_RGB:
        *(rgb *)to = colour_take_rgb(r, false, word);
        return true;
    case FIELD_COLOUR:
        *(colour *)to = colour_take(r, false, word);
        return true;
    case FIELD_TEXT:
        *(const char **)to = reader_text(r, false, word);
        return true;
    case FIELD_IGNORED:
        build_flag(r);
        return true;
    case FIELD_CUSTOM:
        break;
    }
    return false;
}

bool build_from_table(struct reader *r, const struct field *table, const struct item *i,
                      void *thing)
{
    if (i->kind != ITEM_WORD)
        return false;
    const struct field *f = field_find(table, i->word->text);
    return f && build_field(r, f, f->name, i->at, thing);
}

void build_table_block(struct lang *l, const struct item *block, const char *name,
                       const struct field *table, void *thing)
{
    const struct field *const tables[] = { table, NULL };
    struct reader r;

    reader_open(&r, l, block->body);
    for (struct item i = reader_next(&r); i.kind != ITEM_END; i = reader_next(&r))
        if (!build_from_table(&r, table, &i, thing))
            build_unknown(l, &i, name, tables);
    reader_close(&r);
}

/* --- transforms -------------------------------------------------------------- */

const struct field transform_fields[] = {
    { "translate", FIELD_CUSTOM, 0, ANY, "moves" },
    { "rotate", FIELD_CUSTOM, 0, ANY, "turns, degrees about x, then y, then z" },
    { "scale", FIELD_CUSTOM, 0, ANY, "stretches" },
    { "matrix", FIELD_CUSTOM, 0, ANY, "twelve numbers" },
    { "transform", FIELD_CUSTOM, 0, ANY, "a declared transform, or several in braces" },
    FIELD_END,
};

static struct transform read_scale(struct reader *r)
{
    struct loc at = reader_at(r);
    vec3 by = build_vector(r, false, "the factors of scale");

    if (by.x == 0 || by.y == 0 || by.z == 0)
        diag_warning(r->lang->diag, at, "scale by 0 flattens: 0 is taken as 1");
    return transform_scale(vec(by.x != 0 ? by.x : 1, by.y != 0 ? by.y : 1,
                               by.z != 0 ? by.z : 1));
}

static struct transform read_matrix(struct reader *r)
{
    struct transform t = transform_identity;
    double v[12];

    if (reader_list(r, "matrix", 12, v) && !transform_matrix(v, &t))
        diag_error(r->lang->diag, reader_at(r), "this matrix flattens everything: it has no inverse");
    return t;
}

/* transform T, or transform { } */
static struct transform read_transform(struct reader *r, const struct item *i)
{
    if (i->kind == ITEM_BLOCK) {
        struct value v;
        make_transform(r->lang, i, &v);
        return *(const struct transform *)v.thing;
    }
    const struct transform *t = build_start(r, VALUE_TRANSFORM);
    if (t)
        return *t;
    diag_error(r->lang->diag, reader_at(r), "expected a declared transform; found %s",
               item_describe(r->lang, reader_peek(r)));
    return transform_identity;
}

bool build_transform(struct reader *r, const struct item *i, struct transform *t)
{
    if (i->kind != ITEM_WORD && i->kind != ITEM_BLOCK)
        return false;
    if (item_is(i, "transform"))
        *t = read_transform(r, i);
    else if (i->kind == ITEM_BLOCK)
        return false;
    else if (item_is(i, "translate"))
        *t = transform_translate(build_vector(r, false, "the vector of translate"));
    else if (item_is(i, "rotate"))
        *t = transform_rotate(build_vector(r, false, "the angles of rotate"));
    else if (item_is(i, "scale"))
        *t = read_scale(r);
    else if (item_is(i, "matrix"))
        *t = read_matrix(r);
    else
        return false;
    return true;
}

bool make_transform(struct lang *l, const struct item *block, struct value *out)
{
    const struct field *const tables[] = { transform_fields, NULL };
    struct transform all = transform_identity, next;
    bool inverse = false;
    struct reader r;

    reader_open(&r, l, block->body);
    for (struct item i = reader_next(&r); i.kind != ITEM_END; i = reader_next(&r)) {
        if (item_is_thing(&i, VALUE_TRANSFORM))
            next = *(const struct transform *)i.value.thing;
        else if (i.kind == ITEM_WORD && item_is(&i, "inverse")) {
            inverse = true;
            continue;
        } else if (!build_transform(&r, &i, &next)) {
            build_unknown(l, &i, "transform", tables);
            continue;
        }
        all = transform_compose(&next, &all);
    }
    reader_close(&r);
    if (inverse)
        all = transform_inverse(&all);
    *out = value_thing(VALUE_TRANSFORM, arena_copy(l->scene_mem, &all, sizeof all));
    return true;
}
