/* eval.h: expressions to values. */
#ifndef RTC_EVAL_H
#define RTC_EVAL_H

#include "lang/chain.h"

/* The value of an expression; a harmless 0 after an error.  Macros that stand
 * in it are spliced in as text would be. */
void evaluate(struct lang *l, const struct ast *a, struct value *out);

/* The same where POV-Ray reads no directives behind a complete operand: in declarations,
 * arguments of macros, conditions. */
void evaluate_strictly(struct lang *l, const struct ast *a, struct value *out);

/* A chain of values: as evaluate, for nodes that come one by one. */
struct value_chain { struct chain chain; struct value value[CHAIN_MOST]; };
void value_chain_start(struct value_chain *c, struct lang *l);
void value_chain_end(struct value_chain *c, struct loc at, struct value *out);

/* The one value of a list (a condition, a subscript, parentheses). */
void evaluate_one(struct lang *l, const struct ast *list, const char *what, struct value *out);
bool evaluate_number(struct lang *l, const struct ast *list, const char *what, double *out);
bool evaluate_condition(struct lang *l, const struct ast *list, const char *what, double *out);
bool evaluate_text(struct lang *l, const struct ast *a, const char *what, struct text *out);

/* All values of a list with optional commas between them; returns how many,
 * -1 after an error.  They are in usual[] or, when there are many, in l->mem. */
enum { USUAL_VALUES = 8 };
struct evaluated { struct value value; const struct ast *from; };
struct values { struct evaluated usual[USUAL_VALUES], *item; int n; bool last_comma; };
int evaluate_list(struct lang *l, const struct ast *list, struct values *values, bool commas);

bool say_unclosed(struct lang *l, const struct ast *list, bool strict); /* its closing bracket is missing,
                                                                           which is said behind its directives */
bool is_true(double x);
bool is_equal(double a, double b);
void binary(struct lang *l, struct loc at, int op, struct value *left, const struct value *right);
void unary(struct lang *l, struct loc at, int op, struct value *v);
void member(struct lang *l, const struct ast *a, struct value *v);     /* v becomes its component */
void harmless(struct value *out);
void wrong_type(struct lang *l, struct loc at, const struct value *v, const char *wanted);

/* `sine(1)`: at is the call. */
void say_unknown_call(struct lang *l, struct loc at, const char *name);

#endif
