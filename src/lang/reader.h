/* reader.h: a block's body as a stream of evaluated items.
 *
 * The parser makes a tree of flat items.  A reader walks one body, carries
 * out the directives it meets, expands macro calls and includes in place, and
 * hands the builders what is left: values, words, blocks, entries, commas. */
#ifndef RTC_READER_H
#define RTC_READER_H

#include <stdbool.h>

#include "lang/value.h"

struct lang;                            /* the whole state: lang.h */
struct ast;                             /* a node of the tree: ast.h */
struct word;                            /* a reserved word: words.h */

enum item_kind {
    ITEM_END,                           /* the closing brace */
    ITEM_VALUE,                         /* any value: a number, a text, a declared texture ... */
    ITEM_WORD,                          /* a reserved word that takes no block here */
    ITEM_BLOCK,                         /* a reserved word and its { } */
    ITEM_ENTRY,                         /* [ ... ] of a map */
    ITEM_COMMA,
    ITEM_NAME,                          /* a name that is not declared; body: its { } or NULL */
    ITEM_BRACES,                        /* { } without a word: body */
    ITEM_COLON,
};

struct item {
    enum item_kind kind;
    struct loc at;                      /* of the whole item's first word or value */
    const struct word *word;            /* WORD and BLOCK */
    const char *text;                   /* the word or name as written */
    struct value value;                 /* VALUE */
    const char *name;                   /* VALUE: the declared name it came from alone, or NULL */
    const struct ast *body;             /* BLOCK and ENTRY: open a reader on it */
    struct loc brace;                   /* BLOCK and ENTRY: the opening brace, for notes */
};

/* Where in a list of items a builder is.  Readers live on the C stack and
 * close in the reverse order of opening. */
struct reader {
    struct lang *lang;
    struct reader *outer;
    unsigned base;                      /* its first frame in lang->frame[] */
    bool has_item;                      /* item was looked at, not taken */
    struct item item;
    bool has_node;                      /* so was node: what comes after item, or next */
    const struct ast *node;
    bool failed;                        /* part of the list was not understood, which was said:
                                           say nothing of what is missing */
    bool strict;                        /* no directive may follow a number in it: see chain.h */
    bool unclosed;                      /* its closing brace, or another's, is missing, which was said */
    struct loc brace, close;            /* of the list; close.source 0: unknown */
};

/* Opens the body of a block or entry; counts nesting.  Open a block before
 * asking the outer reader for its next item: directives run in order. */
void reader_open(struct reader *r, struct lang *lang, const struct ast *body);
void reader_close(struct reader *r);    /* also after an error; runs nothing more */

const struct item *reader_peek(struct reader *r);   /* the same until reader_next */
struct item reader_next(struct reader *r);          /* ITEM_END again and again at the end */
bool reader_skip_comma(struct reader *r);           /* takes one if it is next */
bool reader_takes_word(struct reader *r, const char *word); /* takes that word if it is next */

/* One value of the wanted shape, with an optional comma before it when
 * comma; on any other item an error that names what ("radius of sphere") is
 * reported and a harmless value returned, the item left in place.
 * Promotion follows facts sdl.md 2.3. */
double reader_number(struct reader *r, bool comma, const char *what);
int reader_whole(struct reader *r, bool comma, const char *what);        /* value_whole of it */
bool reader_vector(struct reader *r, bool comma, int n, double *v, const char *what);
const char *reader_text(struct reader *r, bool comma, const char *what);
bool reader_is_number(struct reader *r);            /* is a number of any size next? */

/* Copies up to most values of that many components that stand next as plain
 * constants, each with a comma behind it, which is taken too; returns how
 * many.  The fast way through vertex lists: call it before reader_vector and
 * after each; 0 means "use reader_vector". */
size_t reader_bulk(struct reader *r, int components, size_t most, double *out);

/* `< n numbers >` of any n up to 7770: matrix, cubic, quartic, poly.  Values
 * of fewer or more components are errors (what: "matrix"). */
bool reader_list(struct reader *r, const char *what, size_t n, double *out);
/* The same in ( ): polynomial's xyz ( ), julia_fractal's pwr ( ). */
bool reader_arguments(struct reader *r, const char *what, size_t n, double *out);

/* What stands next is not what was wanted: one message a list.  True: it was a name that
 * is not declared, or something was said before. */
bool reader_explains(struct reader *r);

/* The loc of what stands next, or of the closing brace. */
struct loc reader_at(struct reader *r);
/* "sphere", "'phong'", "a number", "the end of the block": for messages. */
/* What the parser found wrong, and the notes that belong to it. */
void say_parse_error(struct lang *l, const struct ast *error);
const char *item_describe(struct lang *l, const struct item *i);

#endif
