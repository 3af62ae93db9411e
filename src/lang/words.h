/* words.h: the reserved words, gathered from the tables that give them meaning. */
#ifndef RTC_WORDS_H
#define RTC_WORDS_H

#include <stdbool.h>
#include <stdio.h>

#include "base/field.h"
#include "base/name.h"
#include "pattern/pattern.h"
#include "shape/shape.h"

struct lang;

/* What the grammar sees.  A class says how a word may be followed, never
 * what it means. */
enum word_class {
    WORD_PLAIN,                 /* alone or with { } */
    WORD_FUNC1,                 /* one argument, in which comparisons may stand: sin( ) */
    WORD_FUNC,                  /* a list of arguments */
    WORD_CONSTANT,              /* pi, x, clock */
    WORD_RGB,                   /* rgb ... srgbft: a full expression follows */
    WORD_COLOUR,                /* color, red, filter ... */
    WORD_TEXTURE,               /* texture: several blocks in a row are one declaration */
    WORD_FUNCTION, WORD_ARRAY,
};

enum directive {
    DIRECTIVE_NONE, DIRECTIVE_DECLARE, DIRECTIVE_LOCAL, DIRECTIVE_UNDEF, DIRECTIVE_IF,
    DIRECTIVE_IFDEF, DIRECTIVE_IFNDEF, DIRECTIVE_ELSE, DIRECTIVE_ELSEIF, DIRECTIVE_END,
    DIRECTIVE_WHILE, DIRECTIVE_FOR, DIRECTIVE_SWITCH, DIRECTIVE_CASE, DIRECTIVE_RANGE,
    DIRECTIVE_BREAK, DIRECTIVE_MACRO, DIRECTIVE_INCLUDE, DIRECTIVE_VERSION, DIRECTIVE_DEFAULT,
    DIRECTIVE_DEBUG, DIRECTIVE_WARNING, DIRECTIVE_ERROR, DIRECTIVE_RENDER, DIRECTIVE_STATISTICS,
    DIRECTIVE_FOPEN, DIRECTIVE_FCLOSE, DIRECTIVE_READ, DIRECTIVE_WRITE,
};

/* A word's meanings; most have one.  Which counts follows from the place. */
struct word {
    const char *text;
    const char *help;           /* one line, or NULL */
    enum word_class class;
    bool names_file;            /* the text behind it is a file name: no escapes (png, ttf ...) */
    enum directive directive;   /* behind '#' */
    const struct call *call;                /* a built-in function: call.h */
    const struct constant *constant;        /* call.h */
    const struct shape_ops *shape;
    const struct pattern_ops *pattern;
    bool begins_pattern;        /* a pattern's or what stands in its place: build.h */
    const struct block *block;              /* build.h: what its { } makes */
    const struct special_shape *special;    /* build.h: a shape that is more than a row */
    const struct field *field;              /* some block's field; only for the help */
};

/* build.h (lang-build) has the tables of the blocks:
 *     struct block { const char *word; enum value_type makes; ...; const char *help; };
 *     extern const struct block blocks[];              ended by a NULL word
 *     extern const struct field *const block_fields[]; all field tables; NULL ends
 * Shapes, patterns, built-in functions and directives have their own. */

void words_init(struct lang *l);            /* interns all of them: name->word */
const struct word *word_find(const struct lang *l, const char *text);   /* NULL: not reserved */
bool word_is(const struct word *w, const char *text);
/* Can the { } of next never stand right in those of around?  NULL: nothing is known. */
bool word_shuts_out(const struct word *around, const struct word *next);
void words_each(const struct lang *l, void (*see)(void *arg, const struct word *w), void *arg);

#endif
