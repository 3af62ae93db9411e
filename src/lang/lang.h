/* lang.h: from a scene's text to a scene. */
#ifndef RTC_LANG_H
#define RTC_LANG_H

#include <stdbool.h>
#include <stdio.h>

#include "base/arena.h"
#include "base/bitmap.h"
#include "base/diag.h"
#include "base/limits.h"
#include "base/source.h"
#include "scene/scene.h"

/* What the command line says to the language. */
struct lang_setup {
    struct arena *mem;                  /* for the tree and the values: ends after lang_build */
    struct arena *scene_mem;            /* for the scene */
    struct sources *sources;
    struct diag *diag;
    const struct limits *limits;
    const char *const *library;         /* -I folders, then the installed ones */
    size_t n_library;
    const char *const *allow_read, *const *allow_write;     /* folders */
    size_t n_allow_read, n_allow_write;
    const char *const *declare;         /* NAME=VALUE */
    size_t n_declare;
    const char *header;                 /* a file to include before the scene; NULL: none */
    unsigned width, height;             /* image_width, image_height */
    bool checks;                        /* no picture will be made: files are not written either */
    double version;                     /* +MV; 0: not given */
    double clock, initial_clock, final_clock, clock_delta;
    bool clock_on;
    int frame_number, initial_frame, final_frame;
    FILE *debug;                        /* where #debug goes: stderr; NULL: nowhere */
    bool (*load_image)(struct arena *mem, const char *path, const char *type, struct bitmap *out,
                       const char **error);
};

struct lang;
struct lang *lang_new(const struct lang_setup *setup);

/* bytes -> tokens -> AST, of the main file; NULL: it could not be read (said
 * through diag).  Syntax errors are reported; the tree holds what was understood. */
const struct ast *lang_parse(struct lang *l, const char *path);

/* AST -> values -> scene.  Look at diag->errors afterwards. */
struct scene *lang_build(struct lang *l, const struct ast *tree);

/* Both at once: each statement is carried out as soon as it has been read, and
 * most of its tree is given up then, so that memory grows with the scene only.
 * NULL: the file could not be read. */
struct scene *lang_read(struct lang *l, const char *path);

void lang_dump_tokens(struct lang *l, const char *path, FILE *out);     /* --dump=tokens */
void lang_dump_ast(const struct lang *l, const struct ast *tree, FILE *out);
bool lang_limit_reached(const struct lang *l);       /* then the program ends with EXIT_LIMIT */
void lang_free(struct lang *l);         /* closes files that the scene left open,
                                           and frees what is not in mem */

/* All reserved words with their one-line help, from the tables: for the
 * manual and for completion. */
void lang_list_words(FILE *out);

#endif
