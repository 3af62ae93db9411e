/* frame.h: where the readers are: a stack of lists that are being walked. */
#ifndef RTC_FRAME_H
#define RTC_FRAME_H

#include "lang/state.h"

enum frame_kind {
    FRAME_LIST,                 /* a block's body */
    FRAME_BRANCH,               /* of an #if */
    FRAME_WHILE, FRAME_FOR, FRAME_SWITCH,
    FRAME_MACRO, FRAME_INCLUDE, /* these have a scope */
};

struct macro {
    const struct name *name;
    const struct ast *node;     /* AST_MACRO */
    int n;                      /* parameters */
};

struct frame {
    enum frame_kind kind;
    const struct ast *next;     /* the item to come; NULL: at the end */
    const struct ast *node;     /* the directive or call */
    uint32_t bulk;              /* how many of next's constants are taken */
    bool bulk_comma;            /* the one before was taken, its comma was not */
    double step, end;           /* FRAME_FOR; FRAME_WHILE: rounds, and what its condition asked for */
    unsigned still;             /* FRAME_WHILE: rounds that changed nothing of that */
    struct loc at;              /* of the call or directive */
};

/* Pushes a frame for a list onto the innermost reader. */
struct frame *frame_push(struct lang *l, enum frame_kind kind, const struct ast *list,
                         const struct ast *node);
/* At the end of its list: a loop goes on (true), anything else is popped. */
bool round_counts(struct lang *l, struct loc at);       /* false: --max-iterations, which was said */
bool frame_end(struct lang *l);
void frame_pop(struct lang *l);
bool frame_break(struct reader *r, const struct ast *node);

/* The next node that is neither directive nor macro call, carrying out what
 * comes before it; NULL at the end. */
const struct ast *reader_step(struct reader *r);
const struct ast *reader_look(struct reader *r);    /* the same, not taken */

/* The reader stands at the word version where a statement should. */
void version_without_hash(struct lang *l, struct reader *r);

/* The error just said came of a directive in the place of something else. */
void error_is_late(struct lang *l);
bool lang_is_quiet(const struct lang *l);       /* what the scene would say now may be wrong */

/* After a mistake at the top level: on to the next block or directive. */
void reader_resume(struct reader *r);

void reader_start(struct reader *r, struct lang *l, const struct ast *list);

bool label_matches(struct lang *l, const struct ast *label, double x);      /* of a #switch */

/* Carries out a directive. */
void direct(struct reader *r, const struct ast *node);

/* Runs a macro: its frame is pushed.  False: it is none, or an error was said. */
bool macro_call(struct lang *l, const struct ast *call);
bool is_macro(const struct name *name);

/* The value of what stands in a list on the right of '='; false: reported.
 * semicolon: one was found in it. */
bool thing_value(struct lang *l, struct reader *r, struct value *out);      /* one, from a reader */
bool declared_value(struct lang *l, const struct ast *list, struct value *out, bool *semicolon);

#endif
