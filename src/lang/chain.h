/* chain.h: an expression whose parts come from macros and directives.
 *
 * A macro's text is spliced where it is called, without parentheses around
 * it: with `#macro Sum(A, B) A + B #end`, Sum(2, 3) * 10 is 32.  So where a
 * macro or directive stands in an expression, the operators and operands of
 * all parts are put in one row and grouped anew, from left to right. */
#ifndef RTC_CHAIN_H
#define RTC_CHAIN_H

#include "lang/state.h"

enum { CHAIN_MOST = 64 };               /* signs in a row, and operators that wait */

struct chain;

/* What is done with operands and operators: values are computed, or code is
 * made.  Operands wait in numbered slots; a result takes the lower one. */
struct chain_ops {
    void (*operand)(struct chain *c, const struct ast *a, int slot);
    void (*unary)(struct chain *c, struct loc at, int op, int slot);
    void (*binary)(struct chain *c, struct loc at, int op, int slot);   /* slot and slot + 1 */
    void (*member)(struct chain *c, const struct ast *a, int slot);
    bool (*is_text)(struct chain *c, int slot);     /* of strict chains */
    bool in_function;                   /* '&' binds tighter than '|', and one sign is all */
};

struct chain {
    struct lang *lang;
    const struct chain_ops *ops;
    void *arg;
    struct { uint8_t op; bool is_unary; struct loc at; } op[CHAIN_MOST];
    int n_value, n_op;
    bool has_operand;                   /* an operator is due */
    bool strict;                        /* no directive may follow an operand, as POV-Ray then reads none */
    bool interrupted;                   /* one follows it */
    bool failed;
};

void chain_start(struct chain *c, struct lang *l, const struct chain_ops *ops, void *arg);
void chain_add(struct chain *c, const struct ast *a);
/* Is what a reader has come to a directive, or the end of one? */
bool chain_is_interrupted(const struct reader *r);
void chain_say_interrupted(struct lang *l, struct loc at);

bool chain_end(struct chain *c, struct loc at);     /* false: reported */

/* Adds all that a list leaves behind, as one expression. */
void chain_add_list(struct chain *c, const struct ast *list);

/* Does a node go on with what stands before it: "+ 2" or "* 2"? */
bool chain_continues(const struct ast *a);

/* Does it hold a macro call or directive outside of parentheses? */
bool chain_needed(const struct ast *a);

#endif
