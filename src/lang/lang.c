/* lang.c: from a scene's text to a scene. */
#include "lang/lang.h"

#include <errno.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>

#include "lang/build.h"
#include "lang/file.h"
#include "lang/frame.h"
#include "lang/message.h"
#include "lang/number.h"
#include "lang/parsing.h"
#include "lang/scope.h"
#include "lang/state.h"

enum { MOST_NOTES = 6 };

/* Which macro calls and includes an error is in, the innermost first. */
static void add_context(struct diag *d, void *arg)
{
    struct lang *l = arg;
    int notes = 0;
    struct loc last = { 0 };

    for (unsigned i = l->n_frame; i-- > 0;) {
        const struct frame *f = &l->frame[i];
        if (f->kind != FRAME_MACRO && f->kind != FRAME_INCLUDE)
            continue;
        if (memcmp(&f->at, &last, sizeof last) == 0)
            continue;                   /* a macro that calls itself */
        last = f->at;
        if (++notes > MOST_NOTES)
            return;
        if (f->kind == FRAME_MACRO)
            diag_note(d, f->at, "in macro '%s', called here", f->node->name->text);
        else
            diag_note(d, f->at, "in the file included here");
    }
}

void lang_limit(struct lang *l, struct loc at, const char *format, ...)
{
    char text[512];
    va_list args;

    bool first = !l->diag->errors;      /* else a mistake may be why it does not end */

    if (l->limit_reached)
        return;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    diag_error(l->diag, at, "%s", text);
    l->stopped = true;
    l->limit_reached = first;
}

/* An eighth is left for what recurses less, and for the library. */
static void measure_stack(struct lang *l)
{
    enum { USUAL = 8 << 20, MOST = 1 << 30 };
    struct rlimit limit;
    rlim_t room = getrlimit(RLIMIT_STACK, &limit) == 0 ? limit.rlim_cur : USUAL;

    l->stack_base = __builtin_frame_address(0);
    l->stack_room = room < MOST ? (size_t)room / 8 * 7 : MOST;
}

bool lang_stack_is_low(const struct lang *l)
{
    const char *here = __builtin_frame_address(0);

    return (size_t)(here < l->stack_base ? l->stack_base - here : here - l->stack_base) > l->stack_room;
}

bool lang_may_nest(struct lang *l, struct loc at, const struct nest *n)
{
    const struct limits *most = l->limits;

    if (n->levels > most->pattern_levels)
        lang_limit(l, at, "patterns and functions are nested more than %u deep", most->pattern_levels);
    else if (n->parts > most->pattern_parts)
        lang_limit(l, at, "patterns and functions that hold each other come to more than %.0f",
                   most->pattern_parts);
    else
        return true;
    return false;
}

void lang_cannot_read(struct lang *l, struct loc at, const char *path)
{
    if (errno == EFBIG)
        lang_limit(l, at, "'%s' has more than %zu bytes (--max-source=SIZE would let it)", path,
                   l->limits->source_bytes);
    else
        diag_error(l->diag, at, "cannot read '%s': %s", path, strerror(errno));
}

bool lang_limit_reached(const struct lang *l)
{
    return l->limit_reached;
}

/* --- what is declared before the scene begins -------------------------------------- */

static void predeclare(struct lang *l, const char *name, struct value v)
{
    *scope_declare_global(l, name_intern(&l->names, name, strlen(name)), (struct loc) { 0 })->value
        = v;
}

/* These pass through text with six digits in POV-Ray, and so they do here. */
static double six_digits(double x)
{
    char text[64];

    snprintf(text, sizeof text, "%g", x);
    return number_of_text(text);
}

/* NAME=number or NAME="text". */
static void declare_option(struct lang *l, const char *option)
{
    const char *equals = strchr(option, '=');
    size_t n = equals ? (size_t)(equals - option) : 0;
    char *name = arena_text(l->mem, option, n);

    if (!n || word_find(l, name)) {
        diag_error(l->diag, (struct loc) { 0 }, n ? "'%s' cannot be declared: the name is a reserved word"
                   : "'%s' cannot be declared: expected NAME=VALUE", option);
        return;
    }
    size_t size = strlen(equals + 1);
    if (equals[1] == '"' && size >= 2)
        predeclare(l, name, value_text(l, equals + 2, size - 1 - (equals[size] == '"')));
    else
        predeclare(l, name, value_number(six_digits(number_of_text(equals + 1))));
}

static void predeclare_all(struct lang *l)
{
    const struct lang_setup *s = &l->setup;

    predeclare(l, "image_width", value_number(s->width));
    predeclare(l, "image_height", value_number(s->height));
    predeclare(l, "frame_number", value_number(s->frame_number));
    predeclare(l, "initial_frame", value_number(s->initial_frame));
    predeclare(l, "final_frame", value_number(s->final_frame));
    predeclare(l, "initial_clock", value_number(six_digits(s->initial_clock)));
    predeclare(l, "final_clock", value_number(six_digits(s->final_clock)));
    predeclare(l, "clock_delta", value_number(six_digits(s->clock_delta)));
    for (size_t i = 0; i < s->n_declare; i++)
        declare_option(l, s->declare[i]);
}

struct lang *lang_new(const struct lang_setup *setup)
{
    struct lang *l = arena_alloc(setup->mem, sizeof *l);

    l->setup = *setup;
    l->mem = setup->mem;
    arena_init(&l->statements, l->mem->budget);
    l->scene_mem = setup->scene_mem;
    l->trees.mem = setup->scene_mem;
    l->sources = setup->sources;
    l->diag = setup->diag;
    l->limits = setup->limits;
    l->folder = "";
    l->version = setup->version > 0 ? value_whole(setup->version * 100 + 0.5) : 370;
    l->version_given = setup->version > 0;
    names_init(&l->names, l->mem);
    words_init(l);
    measure_stack(l);
    l->diag->context = add_context;
    l->diag->context_arg = l;
    predeclare_all(l);
    return l;
}

/* --- the stages ------------------------------------------------------------------------ */

static bool open_scene(struct lang *l, const char *path, uint32_t *number)
{
    const char *slash = strrchr(path, '/');

    if (slash && strcmp(path, "-") != 0)
        l->folder = arena_text(l->mem, path, (size_t)(slash - path + 1));
    if (!source_read(l->sources, path, (struct loc) { 0 }, l->limits->source_bytes, number)) {
        lang_cannot_read(l, (struct loc) { 0 }, path);
        return false;
    }
    l->main_source = *number;
    const char *name = slash ? slash + 1 : path;
    predeclare(l, "input_file_name", value_text(l, name, strlen(name)));
    return true;
}

const struct ast *lang_parse(struct lang *l, const char *path)
{
    uint32_t number;

    if (!open_scene(l, path, &number))
        return NULL;
    return parse_source(l, number);
}

/* What follows a mistake and can stand in objects only was meant to be in one. */
static bool is_part(const struct lang *l, const struct item *i)
{
    const struct block *b = i->kind == ITEM_BLOCK ? i->word->block : NULL;

    return l->skipping && b && b->makes != VALUE_NONE && !b->use;
}

static bool is_rest(const struct reader *r, const struct item *i)
{
    return r->failed && (i->kind == ITEM_VALUE || (i->kind == ITEM_WORD && !i->word->block));
}

/* A macro's name alone: whether ( ) follows is told by what comes after directives. */
static bool is_late(struct reader *r)
{
    const struct ast *a = r->has_item ? NULL : reader_look(r);

    return a && a->kind == AST_NAME && is_macro(a->name);
}

/* An expression is nothing at the top level: the directives in it are not carried out. */
static bool say_expression(struct lang *l, struct reader *r)
{
    const struct ast *a = r->has_item ? NULL : reader_look(r);

    if (!a || (a->kind != AST_PAREN && a->kind != AST_VECTOR && a->kind != AST_UNARY)
        || (a->kind != AST_UNARY && a->args->flags & AST_PLAIN))
        return false;
    diag_error(l->diag, a->at, "an expression cannot stand outside of all blocks");
    r->has_node = false;
    return true;
}

static bool has_more(struct reader *r)
{
    return !r->lang->stopped && (r->has_item ? r->item.kind != ITEM_END : reader_look(r) != NULL);
}

static bool is_version(struct reader *r)
{
    const struct ast *a = r->has_item ? NULL : reader_look(r);

    return a && a->kind == AST_CONSTANT && word_is(a->word, "version");
}

/* One statement; false: what follows makes no sense up to the next block or directive. */
static bool build_item(struct lang *l, struct reader *r)
{
    unsigned errors = l->diag->errors;
    bool late = is_late(r);

    if (say_expression(l, r))
        return false;
    if (is_version(r)) {
        version_without_hash(l, r);
        return errors == l->diag->errors;
    }
    struct item i = reader_next(r);
    if (i.kind != ITEM_END)
        build_statement(l, r, i);
    if (late && errors != l->diag->errors)
        error_is_late(l);
    return !is_part(l, &i)
        && ((errors == l->diag->errors && !is_rest(r, &i)) || i.kind == ITEM_BLOCK);
}

static void build_items(struct lang *l, const struct ast *tree)
{
    struct reader r;

    reader_open(&r, l, tree);
    if (l->skipping)
        reader_resume(&r);
    while (has_more(&r)) {
        l->skipping = !build_item(l, &r);
        if (l->skipping)
            reader_resume(&r);
        r.failed = false;
        l->stopped = l->stopped || l->diag->full;
    }
    reader_close(&r);
}

static void begin_scene(struct lang *l)
{
    l->scene = arena_alloc(l->scene_mem, sizeof *l->scene);
    scene_init(l->scene, l->scene_mem);
    build_version(l);
}

static struct scene *end_scene(struct lang *l)
{
    build_end(l);
    message_end(l);
    files_end(l);
    return l->scene;
}

struct scene *lang_build(struct lang *l, const struct ast *tree)
{
    begin_scene(l);
    if (tree)
        build_items(l, tree);
    return end_scene(l);
}

static void include_header(struct lang *l, const char *name)
{
    const char *text = arena_format(l->mem, "#include \"%s\"%c", name, '\0');

    build_items(l, parse_source(l, source_add(l->sources, "Include_Header", text, strlen(text),
                                              (struct loc) { 0 })));
}

struct scene *lang_read(struct lang *l, const char *path)
{
    uint32_t number;

    if (!open_scene(l, path, &number))
        return NULL;
    begin_scene(l);
    if (l->setup.header)
        include_header(l, l->setup.header);
    parse_and_run(l, number, build_items);
    return end_scene(l);
}

void lang_free(struct lang *l)
{
    files_end(l);
    arena_free(&l->statements);
    if (l->diag->context_arg == l)
        l->diag->context = NULL;
}

static int by_text(const void *a, const void *b)
{
    const struct word *const *v = a, *const *w = b;

    return strcmp((*v)->text, (*w)->text);
}

void lang_list_words(FILE *out)
{
    struct arena mem;
    struct lang l = { .mem = &mem };

    arena_init(&mem, NULL);
    names_init(&l.names, &mem);
    words_init(&l);
    const struct word **list = arena_array(&mem, l.n_word, sizeof *list);
    for (size_t i = 0; i < l.n_word; i++)
        list[i] = &l.word[i];
    qsort(list, l.n_word, sizeof *list, by_text);
    for (size_t i = 0; i < l.n_word; i++)
        fprintf(out, "%s\t%s\n", list[i]->text, list[i]->help ? list[i]->help : "");
    arena_free(&mem);
}
