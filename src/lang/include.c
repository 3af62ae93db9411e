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
    const struct ast *tree;
    struct library_file *next;
};

static bool is_same(const struct stat *a, const struct stat *b)
{
    return a->st_dev == b->st_dev && a->st_ino == b->st_ino && a->st_size == b->st_size
        && a->st_mtim.tv_sec == b->st_mtim.tv_sec && a->st_mtim.tv_nsec == b->st_mtim.tv_nsec;
}

static const struct ast *cached(struct lang *l, const char *path, const struct stat *st)
{
    for (struct library_file *f = l->file; f; f = f->next)
        if (strcmp(f->path, path) == 0 && is_same(&f->stat, st))
            return f->tree;
    return NULL;
}

static const struct ast *parse_file(struct lang *l, const char *path, struct loc at)
{
    struct stat st = { 0 };
    uint32_t number;

    if (stat(path, &st) == 0) {
        const struct ast *tree = cached(l, path, &st);
        if (tree)
            return tree;
    }
    if (!source_read(l->sources, path, at, l->limits->source_bytes, &number)) {
        lang_cannot_read(l, at, path);
        return NULL;
    }
    struct library_file *f = arena_alloc(l->mem, sizeof *f);
    *f = (struct library_file) { path, st, parse_source(l, number), l->file };
    l->file = f;
    return f->tree;
}

void include(struct lang *l, const struct ast *node)
{
    static const char *const extensions[] = { "inc", "INC", NULL };
    struct text name;

    if (!evaluate_text(l, node->right, "a file's name", &name))
        return;
    if (l->n_include + 1 >= l->limits->include_depth) {
        diag_error(l->diag, node->at, "files include each other more than %u deep "
                   "(--max-include-depth=N would let them)", l->limits->include_depth);
        l->stopped = true;
        return;
    }
    const char *path = lang_find_file(l, node->right->at, name.bytes, extensions, "file");
    const struct ast *tree = path ? parse_file(l, path, node->at) : NULL;
    if (!tree) {                /* all that it declares would be the next mistakes */
        l->stopped = true;
        return;
    }
    scope_open(l);
    frame_push(l, FRAME_INCLUDE, tree, node);
    l->n_include++;
}
