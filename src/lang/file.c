/* file.c: files that a scene reads and writes, and which it may.
 *
 * A scene is somebody else's program: it reads from its own folder and the
 * library only, and writes only where the command line allows it.  Paths are
 * resolved before they are compared, so neither ".." nor a link leads out. */
#include "lang/file.h"

#include <dirent.h>
#include <ctype.h>
#include <errno.h>
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>
#include <unistd.h>

#include "lang/array.h"
#include "lang/eval.h"
#include "lang/frame.h"
#include "lang/number.h"
#include "lang/parsing.h"
#include "lang/scope.h"

/* --- which files ------------------------------------------------------------------ */

static bool is_below(const char *path, const char *folder)
{
    char resolved[PATH_MAX];

    if (!realpath(*folder ? folder : ".", resolved))
        return false;
    size_t n = strlen(resolved);
    return strncmp(path, resolved, n) == 0 && (path[n] == '/' || path[n] == '\0' || n == 1);
}

static bool is_below_any(const char *path, const char *const *folder, size_t n)
{
    for (size_t i = 0; i < n; i++)
        if (is_below(path, folder[i]))
            return true;
    return false;
}

/* The library is trusted: links in it (fonts) may lead where they like. */
static bool in_library(const struct lang_setup *s, const char *path)
{
    for (size_t i = 0; i < s->n_library && !strstr(path, ".."); i++) {
        size_t n = strlen(s->library[i]);
        if (n && strncmp(path, s->library[i], n) == 0 && (path[n] == '/' || path[n - 1] == '/'))
            return true;
    }
    return false;
}

/* The empty file of every system tells a scene nothing. */
static bool is_nothing(const char *path)
{
    return strcmp(path, "/dev/null") == 0;
}

static bool may_read(const struct lang *l, const char *path)
{
    const struct lang_setup *s = &l->setup;
    char resolved[PATH_MAX];

    if (is_nothing(path) || in_library(s, path))
        return true;
    if (!realpath(path, resolved))
        return false;
    return is_below(resolved, l->folder) || is_below_any(resolved, s->library, s->n_library)
        || is_below_any(resolved, s->allow_read, s->n_allow_read)
        || is_below_any(resolved, s->allow_write, s->n_allow_write);
}

/* A file that is to be made does not exist yet: its folder counts, unless
 * the name is a link's, which would make a file wherever it points. */
static bool resolve_target(struct lang *l, const char *path, char resolved[PATH_MAX])
{
    struct stat st;
    const char *slash = strrchr(path, '/');
    const char *folder = slash ? arena_text(l->mem, path, (size_t)(slash - path + 1)) : ".";

    return realpath(path, resolved)
        || (errno == ENOENT && lstat(path, &st) != 0 && realpath(folder, resolved));
}

static bool may_write(struct lang *l, const char *path)
{
    const struct lang_setup *s = &l->setup;
    char resolved[PATH_MAX];

    return resolve_target(l, path, resolved)
        && is_below_any(resolved, s->allow_write, s->n_allow_write);
}

/* Nothing is written by a check that was not told where to write, so the scene may
 * act as if in its own folder. */
static bool may_pretend(struct lang *l, const char *path)
{
    char resolved[PATH_MAX];

    return l->setup.checks && l->setup.n_allow_write == 0 && resolve_target(l, path, resolved) && is_below(resolved, l->folder);
}

static bool is_file(const char *path)
{
    struct stat st;

    return is_nothing(path) || (stat(path, &st) == 0 && S_ISREG(st.st_mode));
}

static char *joined(struct lang *l, const char *folder, const char *name)
{
    size_t n = strlen(folder);

    if (*name == '/' || n == 0)
        return arena_text(l->mem, name, strlen(name));
    return arena_format(l->mem, "%s%s%s", folder, folder[n - 1] == '/' ? "" : "/", name);
}

static const char *in_folders(struct lang *l, const char *name)
{
    char *path = joined(l, l->folder, name);

    for (size_t i = 0; !is_file(path); i++) {
        if (*name == '/' || i == l->setup.n_library)
            return NULL;
        path = joined(l, l->setup.library[i], name);
    }
    return path;
}

static bool ends_in(const char *name, const char *const *extensions)
{
    const char *dot = strrchr(name, '.');

    for (; dot && extensions && *extensions; extensions++)
        if (strcmp(dot + 1, *extensions) == 0)
            return true;
    return false;
}

/* With an extension of its kind the exact name comes first, else last. */
static const char *any_name(struct lang *l, const char *name, const char *const *extensions)
{
    bool exact_first = !extensions || ends_in(name, extensions);
    const char *path = exact_first ? in_folders(l, name) : NULL;

    for (; !path && extensions && *extensions; extensions++)
        path = in_folders(l, arena_format(l->mem, "%s.%s", name, *extensions));
    return path || exact_first ? path : in_folders(l, name);
}

/* --- names from systems that do not mind case ---------------------------------------- */

/* What a folder calls an entry, whatever the case; NULL: it has none. */
static char *entry_like(struct lang *l, const char *folder, const char *name)
{
    char *like = NULL;
    DIR *dir;

    if (access(joined(l, folder, name), F_OK) == 0)
        return arena_text(l->mem, name, strlen(name));
    if (!(dir = opendir(*folder ? folder : ".")))
        return NULL;
    for (struct dirent *e; !like && (e = readdir(dir));)
        if (strcasecmp(e->d_name, name) == 0)
            like = arena_text(l->mem, e->d_name, strlen(e->d_name));
    closedir(dir);
    return like;
}

static char *path_like(struct lang *l, const char *folder, const char *name)
{
    char *path = arena_text(l->mem, folder, strlen(folder));

    while (*name) {
        size_t n = strcspn(name, "/\\");
        char *entry = n ? entry_like(l, path, arena_text(l->mem, name, n)) : NULL;
        if (!entry)
            return NULL;
        path = joined(l, path, entry);
        name += n + (name[n] != '\0');
    }
    return is_file(path) ? path : NULL;
}

static char *like_in_folders(struct lang *l, const char *name)
{
    char *path = path_like(l, l->folder, name);

    for (size_t i = 0; !path && i < l->setup.n_library; i++)
        path = path_like(l, l->setup.library[i], name);
    return path;
}

/* Old scenes were written where '\\' parts folders and case does not count. */
static const char *name_like(struct lang *l, struct loc at, const char *name,
                             const char *const *extensions)
{
    char *path = like_in_folders(l, name);

    for (; !path && extensions && *extensions; extensions++)
        path = like_in_folders(l, arena_format(l->mem, "%s.%s", name, *extensions));
    if (path && may_read(l, path))
        diag_warning(l->diag, at, "there is no '%s': '%s' is taken", name, path);
    return path;
}

/* --- finding them ------------------------------------------------------------------ */

static void note_folders(struct lang *l)
{
    const char *list = *l->folder ? l->folder : "./";

    for (size_t i = 0; i < l->setup.n_library; i++)
        list = arena_format(l->mem, "%s, %s", list, l->setup.library[i]);
    diag_note(l->diag, (struct loc) { 0 }, "looked for in %s", list);
}

const char *file_find(struct lang *l, struct loc at, const char *name,
                      const char *const *extensions, const char *what, bool quiet)
{
    const char *path = any_name(l, name, extensions);

    if (!path && !quiet && *name != '/')
        path = name_like(l, at, name, extensions);
    if (path && may_read(l, path))
        return path;
    if (quiet)
        return NULL;
    if (path || *name == '/')
        diag_error(l->diag, at, "the scene may not read '%s': it is outside of its folder; "
                   "--allow-read would let it", path ? path : name);
    else {
        diag_error(l->diag, at, "cannot find %s '%s'", what, name);
        note_folders(l);
    }
    return NULL;
}

const char *lang_find_file(struct lang *l, struct loc at, const char *name,
                           const char *const *extensions, const char *what)
{
    return file_find(l, at, name, extensions, what, false);
}

/* "" is the folder itself, as in POV-Ray. */
bool file_exists(struct lang *l, struct loc at, const char *name)
{
    return !*name || file_find(l, at, name, NULL, "file", true);
}

/* --- open files --------------------------------------------------------------------- */

struct handle {
    FILE *file;
    bool writes;
    int next;                           /* reading: the character to come, or EOF */
    unsigned line;
    const char *path;
    bool is_pretended;                  /* the file has no name: nothing is written in a check */
    struct handle *others;              /* of the same scene, for the end */
};

/* What the scene has written before, in a check that keeps it in a nameless file. */
static FILE *written_before(struct lang *l, const char *path)
{
    for (struct handle *h = l->handle; h; h = h->others)
        if (h->is_pretended && h->file && strcmp(h->path, path) == 0) {
            FILE *f = h->file;
            h->file = NULL;
            return f;
        }
    return NULL;
}

static FILE *pretend(struct lang *l, struct loc at, const char *path, bool append)
{
    FILE *f = append ? written_before(l, path) : NULL;

    diag_warning(l->diag, at, "'%s' is not written by this check; a picture needs "
                 "--allow-write=FOLDER", path);
    return f ? f : tmpfile();
}

/* Nobody may be at the other end of a pipe, and a device is no file of a scene's. */
static bool is_special(const char *path)
{
    struct stat st;

    return stat(path, &st) == 0 && !S_ISREG(st.st_mode) && !S_ISDIR(st.st_mode);
}

static FILE *open_to_write(struct lang *l, struct loc at, const char *path, bool append,
                           bool *is_pretended)
{
    if (may_write(l, path) && is_special(path)) {
        diag_error(l->diag, at, "the scene may not write '%s': it is a pipe or a device", path);
        return NULL;
    }
    if (may_write(l, path))
        return fopen(path, append ? "ab" : "wb");
    *is_pretended = may_pretend(l, path);
    if (*is_pretended)
        return pretend(l, at, path, append);
    diag_error(l->diag, at, "the scene may not write '%s'; --allow-write=FOLDER would let it", path);
    return NULL;
}

static FILE *open_to_read(struct lang *l, struct loc at, const char *name, const char **path)
{
    FILE *f = written_before(l, joined(l, l->folder, name));

    if (f)
        rewind(f);
    else if ((*path = lang_find_file(l, at, name, NULL, "file")))
        f = fopen(*path, "rb");
    return f;
}

void file_open(struct lang *l, const struct ast *node)
{
    struct loc at = node->args->first->at;
    unsigned errors = l->diag->errors;
    bool reads = word_is(node->word, "read");
    struct text name;

    if (!evaluate_text(l, node->args->first, "a file's name", &name) || l->diag->errors) {
        scope_declare_broken(l, (struct name *)node->name, node->at);
        return;
    }
    if (!reads && !word_is(node->word, "write") && !word_is(node->word, "append")) {
        diag_error(l->diag, node->at, "expected read, write or append, found '%s'", node->word->text);
        scope_declare_broken(l, (struct name *)node->name, node->at);
        return;
    }
    if (scope_find(node->name)) {
        diag_error(l->diag, node->at, "'%s' is declared already", node->name->text);
        return;
    }
    struct handle *h = arena_alloc(l->mem, sizeof *h);
    *h = (struct handle) { .writes = !reads, .line = 1, .path = joined(l, l->folder, name.bytes) };
    *scope_declare_global(l, node->name, node->at)->value = value_thing(VALUE_FILE, h);
    h->file = reads ? open_to_read(l, at, name.bytes, &h->path)
        : open_to_write(l, at, h->path, word_is(node->word, "append"), &h->is_pretended);
    if (!h->file) {
        if (errors == l->diag->errors)
            diag_error(l->diag, node->at, "cannot open '%s': %s", h->path, strerror(errno));
        return;
    }
    h->next = reads ? getc(h->file) : 0;
    h->others = l->handle;
    l->handle = h;
    l->file = reads ? l->file : NULL;   /* an included file may be about to change */
}

static void close_handle(struct handle *h)
{
    if (h->file)
        fclose(h->file);
    h->file = NULL;
}

static struct handle *find_handle(struct lang *l, const struct name *name)
{
    struct binding *b = name ? name->slot : NULL;

    (void)l;
    return b && b->value->type == VALUE_FILE ? (struct handle *)b->value->thing : NULL;
}

void file_close(struct lang *l, const struct ast *node)
{
    struct handle *h = node->name ? find_handle(l, node->name) : NULL;

    if (!node->name)
        diag_warning(l->diag, node->at, "#fclose takes the name of a file");
    if (!h)
        return;
    if (!h->is_pretended)
        close_handle(h);                /* else it may be read later */
    scope_undef(l, (struct name *)node->name);
}

void files_end(struct lang *l)
{
    for (struct handle *h = l->handle; h; h = h->others)
        close_handle(h);
}

/* The handle that #read ( or #write ( begins with. */
static struct handle *named_handle(struct lang *l, const struct ast *node, const struct ast **rest)
{
    const struct ast *a = node->args->first;
    struct handle *h = a && a->kind == AST_NAME ? find_handle(l, a->name) : NULL;

    if (!h) {
        if (!(a && a->kind == AST_NAME && scope_find(a->name) && scope_find(a->name)->is_broken))
            diag_error(l->diag, a ? a->at : node->at, "expected the name of an open file");
        return NULL;
    }
    if (h->writes != (node->kind == AST_WRITE)) {
        diag_error(l->diag, a->at, "this file is open for %s", h->writes ? "writing" : "reading");
        return NULL;
    }
    if (!h->file)
        return NULL;                    /* it could not be opened, which was said */
    *rest = a->next;
    if (*rest && (*rest)->kind == AST_COMMA)
        *rest = (*rest)->next;
    return h;
}

/* --- #read ------------------------------------------------------------------------------ */

static void advance(struct handle *h)
{
    h->line += h->next == '\n';
    h->next = getc(h->file);
}

static void skip_comment(struct handle *h)
{
    if (h->next == '/') {
        while (h->next != EOF && h->next != '\n')
            advance(h);
        return;
    }
    int before = 0;
    advance(h);
    while (h->next != EOF && !(before == '*' && h->next == '/')) {
        before = h->next;
        advance(h);
    }
    advance(h);
}

static void skip_space(struct handle *h)
{
    while (h->next != EOF && (strchr(" \t\r\n\v\f/", h->next) || h->next == 0)) {
        bool comment = h->next == '/';
        advance(h);
        if (comment && (h->next == '/' || h->next == '*'))
            skip_comment(h);
    }
}

static bool read_number(struct handle *h, double *out)
{
    char text[256];
    size_t n = 0;
    bool minus = false;

    skip_space(h);
    if (h->next == '-' || h->next == '+') {
        minus = h->next == '-';
        advance(h);
        skip_space(h);
    }
    while (h->next != EOF && h->next != 0 && n < sizeof text - 1
           && (strchr("0123456789.eE", h->next)
               || (n && strchr("+-", h->next) && strchr("eE", text[n - 1])))) {
        text[n++] = (char)h->next;
        advance(h);
    }
    text[n] = '\0';
    *out = number_of_text(text) * (minus ? -1 : 1);
    char *point = strchr(text, '.');
    return n > 0 && !(point && strchr(point + 1, '.'));
}

static bool read_vector(struct handle *h, struct value *out)
{
    double v[5];
    int n = 0;

    advance(h);
    do {
        if (n == 5 || !read_number(h, &v[n++]))
            return false;
        skip_space(h);
        if (h->next == ',')
            advance(h);
        skip_space(h);
    } while (h->next != '>' && h->next != EOF);
    if (h->next != '>' || n < 2)
        return false;
    advance(h);
    *out = value_vector(n, v);
    return true;
}

/* With the escapes that texts of a scene have. */
static bool read_text(struct lang *l, struct handle *h, struct value *out)
{
    char *text = NULL;
    size_t n = 0, room = 0;
    bool escaped = false;

    for (advance(h); h->next != EOF && (escaped || h->next != '"'); advance(h)) {
        text = arena_grow(l->mem, text, n, &room, 1);
        text[n++] = (char)h->next;
        escaped = h->next == '\\' && !escaped;
    }
    if (h->next == EOF)
        return false;
    advance(h);
    if (text && !text_unescape(text, &n))
        return false;
    *out = value_text(l, text ? text : "", n);
    return true;
}

static bool read_one(struct lang *l, struct handle *h, struct value *out)
{
    double x;

    if (h->next == '<')
        return read_vector(h, out);
    if (h->next == '"')
        return read_text(l, h, out);
    if (!read_number(h, &x))
        return false;
    *out = value_number(x);
    return true;
}

static void lose_word(struct handle *h)
{
    do
        advance(h);
    while (h->next != EOF && (isalnum(h->next) || h->next == '_' || h->next == '.'));
}

/* A comma must follow an item; whatever else does is lost.  False: that was the last. */
static bool read_separator(struct lang *l, struct handle *h)
{
    struct value lost;

    skip_space(h);
    if (h->next == EOF)
        return false;
    if (h->next == '"')
        read_text(l, h, &lost);
    else if (isalnum(h->next) || h->next == '_' || h->next == '.')
        lose_word(h);
    else
        advance(h);
    return true;
}

static bool may_be_read(const struct value *v)
{
    return v->type == VALUE_NONE || v->type == VALUE_TEXT
        || (v->type == VALUE_NUMBER && (v->n == 1 || v->n == 3));
}

/* What is read takes the place of a number, vector or text; of any of these in an array. */
static void store(struct lang *l, const struct ast *target, const struct value *v)
{
    struct value *place;

    if (target->kind == AST_NAME && !scope_find(target->name))
        place = scope_declare_global(l, target->name, target->at)->value;
    else if (!(place = array_place(l, target)))
        return;
    else if (!may_be_read(place) || (place->type == VALUE_NONE && target->kind == AST_INDEX)) {
        diag_error(l->diag, target->at, "#read needs a new name, a number, a vector or a text; "
                   "'%s' is %s", target->name->text, value_name(place));
        return;
    }
    *place = *v;
}

/* Nothing can be read into them, which was said. */
static void miss_names(struct lang *l, const struct ast *node)
{
    for (const struct ast *a = node->args->first; a; a = a->next)
        if (a->kind == AST_NAME)
            scope_declare_broken(l, a->name, a->at);
}

void file_read(struct lang *l, const struct ast *node)
{
    const struct ast *a;
    struct handle *h = named_handle(l, node, &a);
    struct value v;
    bool is_last = false;

    if (!h)
        miss_names(l, node);

    for (; h && a; a = a->next) {
        if (a->kind == AST_COMMA)
            continue;
        if (a->kind != AST_NAME && a->kind != AST_INDEX) {
            diag_error(l->diag, a->at, "#read takes names and elements of arrays");
            return;
        }
        skip_space(h);
        if (h->next == EOF) {
            diag_warning(l->diag, node->at, "nothing is left to read: '%s' %s", a->name->text,
                         scope_find(a->name) ? "keeps what it was" : "gets no value");
            if (!is_last && !scope_find(a->name))
                scope_declare_global(l, a->name, a->at);
            is_last = true;
            break;
        }
        if (!read_one(l, h, &v)) {
            diag_error(l->diag, node->at, "%s:%u: expected a number, vector or text in the data",
                       h->path, h->line);
            l->stopped = true;          /* a loop would come here again */
            return;
        }
        store(l, a, &v);
        is_last = !read_separator(l, h);
    }
    if (h && h->next == EOF && is_last) {
        close_handle(h);
        scope_undef(l, node->args->first->name);
    }
}

/* --- #write ------------------------------------------------------------------------------ */

static void write_value(struct handle *h, const struct value *v)
{
    if (v->type == VALUE_TEXT) {
        for (size_t i = 0; i < v->text.size; i++) {
            unsigned char c = (unsigned char)v->text.bytes[i];
            if (c < 0x80 || c >= 0xc0)
                putc(c < 0x80 ? c : ' ', h->file);
        }
        return;
    }
    if (v->n == 1) {
        fprintf(h->file, "%g", v->v[0]);
        return;
    }
    for (int i = 0; i < v->n; i++)
        fprintf(h->file, "%c%g", i ? ',' : '<', v->v[i]);
    fputs("> ", h->file);
}

static const struct format { const char *word; int bytes; double low, high; bool big; } formats[] = {
    { "sint8", 1, -128, 127, false }, { "uint8", 1, 0, 255, false },
    { "sint16be", 2, -32768, 32767, true }, { "sint16le", 2, -32768, 32767, false },
    { "uint16be", 2, 0, 65535, true }, { "uint16le", 2, 0, 65535, false },
    { "sint32be", 4, -2147483648.0, 2147483647, true },
    { "sint32le", 4, -2147483648.0, 2147483647, false },
};

static const struct format *find_format(const struct item *i)
{
    for (size_t k = 0; i->kind == ITEM_WORD && k < sizeof formats / sizeof *formats; k++)
        if (word_is(i->word, formats[k].word))
            return &formats[k];
    return NULL;
}

static void write_binary(struct handle *h, const struct format *f, const struct value *v)
{
    for (int i = 0; i < v->n; i++) {
        double x = floor(v->v[i] + 0.5);
        uint32_t bits = (uint32_t)(int64_t)(x < f->low ? f->low : x > f->high ? f->high : x);
        for (int k = 0; k < f->bytes; k++)
            putc((int)(bits >> 8 * (f->big ? f->bytes - 1 - k : k) & 0xff), h->file);
    }
}

static bool write_item(struct lang *l, struct handle *h, const struct item *i,
                       const struct format **format)
{
    if (i->kind == ITEM_COMMA)
        *format = NULL;
    else if (find_format(i))
        *format = find_format(i);
    else if (i->kind == ITEM_VALUE && value_is_number(&i->value) && *format)
        write_binary(h, *format, &i->value);
    else if (i->kind == ITEM_VALUE && (value_is_number(&i->value) || i->value.type == VALUE_TEXT)
             && !(i->value.type == VALUE_COLOUR && i->name)) {
        if (l->diag->errors == 0)
            write_value(h, &i->value);
    } else {
        diag_error(l->diag, i->at, "#write cannot write %s", item_describe(l, i));
        return false;
    }
    return true;
}

void file_write(struct lang *l, const struct ast *node)
{
    const struct ast *rest;
    struct handle *h = named_handle(l, node, &rest);
    const struct format *format = NULL;
    struct reader r;

    if (!h)
        return;
    struct ast list = *node->args;
    list.first = (struct ast *)rest;
    reader_open(&r, l, &list);
    while (reader_peek(&r)->kind != ITEM_END) {
        struct item i = reader_next(&r);
        if (!write_item(l, h, &i, &format))
            break;
    }
    reader_close(&r);
}
