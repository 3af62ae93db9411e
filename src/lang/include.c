/* include.c: other files as part of the scene.
 *
 * A file is parsed once and its tree spliced in wherever it is included. */
#include "lang/include.h"

#include <errno.h>
#include <string.h>
#include <sys/stat.h>

#include "lang/eval.h"
#include "lang/file.h"
#include "lang/frame.h"
#include "lang/parsing.h"
#include "lang/scope.h"

struct library_file {
    const char *path;
    struct stat stat;
    uint32_t source;
    const struct ast *tree;
    struct library_file *next;
};

static bool is_same(const struct stat *a, const struct stat *b)
{
    return a->st_dev == b->st_dev && a->st_ino == b->st_ino && a->st_size == b->st_size
        && a->st_mtim.tv_sec == b->st_mtim.tv_sec && a->st_mtim.tv_nsec == b->st_mtim.tv_nsec;
}

static const struct library_file *cached(struct lang *l, const char *path, const struct stat *st)
{
    for (struct library_file *f = l->file; f; f = f->next)
        if (strcmp(f->path, path) == 0 && is_same(&f->stat, st))
            return f;
    return NULL;
}

static const struct library_file *parse_file(struct lang *l, const char *path, struct loc at)
{
    struct stat st = { 0 };
    uint32_t number;

    if (stat(path, &st) == 0) {
        const struct library_file *known = cached(l, path, &st);
        if (known)
            return known;
    }
    if (!source_read(l->sources, path, at, l->limits->source_bytes, &number)) {
        lang_cannot_read(l, at, path);
        return NULL;
    }
    struct library_file *f = arena_alloc(l->mem, sizeof *f);
    *f = (struct library_file) { path, st, number, parse_source(l, number), l->file };
    l->file = f;
    return f;
}

static bool has_open_if(const struct ast *tree)
{
    for (const struct ast *a = tree->first; a; a = a->next)
        if (a->kind == AST_ERROR && a->op == 'i')
            return true;
    return false;
}

/* An #if that a file leaves open ends in the scene that included it: what stands behind
 * that #include is then read as if it stood at the end of the file. */
static const struct ast *with_rest(struct lang *l, const struct library_file *f,
                                   const struct ast *node)
{
    const struct source *file = source_at(l->sources, f->source);
    const struct source *scene = source_at(l->sources, node->at.source);
    uint32_t from = node->right->at.end;
    size_t size = file->size + 1 + scene->size - from;
    char *text = arena_alloc(l->mem, size + 2);

    memcpy(text, file->text, file->size);
    text[file->size] = '\n';
    memcpy(text + file->size + 1, scene->text + from, scene->size - from);
    l->streamed->rest_taken = true;
    return parse_source(l, source_add(l->sources, file->path, text, size, node->at));
}

void include(struct lang *l, const struct ast *node)
{
    static const char *const extensions[] = { "inc", "INC", NULL };
    struct text name;

    if (!evaluate_text(l, node->right, "a file's name", &name)) {
        l->stopped = true;      /* all that it declares would be the next mistakes */
        return;
    }
    if (l->n_include + 1 >= l->limits->include_depth) {
        diag_error(l->diag, node->at, "files include each other more than %u deep "
                   "(--max-include-depth=N would let them)", l->limits->include_depth);
        l->stopped = true;
        return;
    }
    if (!round_counts(l, node->at))
        return;
    const char *path = lang_find_file(l, node->right->at, name.bytes, extensions, "file");
    const struct library_file *f = path ? parse_file(l, path, node->at) : NULL;
    if (!f) {
        l->stopped = true;
        return;
    }
    bool goes_on = l->streamed && l->n_frame == 1 && has_open_if(f->tree);
    const struct ast *tree = goes_on ? with_rest(l, f, node) : f->tree;
    scope_open(l);
    frame_push(l, FRAME_INCLUDE, tree, node);
    l->n_include++;
}
