/* guess.h: "did you mean". */
#ifndef RTC_GUESS_H
#define RTC_GUESS_H

#include "lang/state.h"

struct guess {
    const char *wrong;          /* as the user wrote it */
    const char *best;           /* NULL: nothing is near */
    unsigned distance;
};

struct guess guess_start(const char *wrong);
void guess_try(struct guess *g, const char *word);
void guess_fields(struct guess *g, const struct field *fields);     /* all of a table; NULL: none */
void guess_names(struct guess *g, const struct lang *l);            /* what the scene declared */
void guess_words(struct guess *g, const struct lang *l);            /* all reserved words */

/* "; did you mean 'phong'?" or "", in l->mem: the end of a message. */
const char *guess_text(const struct guess *g, const struct lang *l);

/* "'BallRadius' is declared here", where that was the guess. */
void guess_note(const struct guess *g, struct lang *l);
void note_declared(struct lang *l, const char *name);       /* if a place is known */

/* "undeclared name 'Blu' in pigment; did you mean 'Blue'?", with what helps: a name of the
 * scene, a word, or a file of the library that declares it.  where: " in pigment" or "";
 * NULL: words that are no values would not help. */
void say_undeclared(struct lang *l, struct loc at, const char *name, const char *where);

#endif
