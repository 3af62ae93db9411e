/* call.h: built-in functions and constants, a row each. */
#ifndef RTC_CALL_H
#define RTC_CALL_H

#include "lang/state.h"

/* The arguments of one call, of the types that the row asks for. */
struct arguments {
    struct lang *l;
    const struct ast *node;
    const struct call *call;
    struct value *v;
    const struct ast **from;            /* where each was written */
    int n;
};

struct call {
    const char *name;
    const char *help;
    /* What it takes: F number, V vector (3), N number of any size, S text, A array, O object,
     * P object or pigment, R name of a vector, D any name.  '*': the one before it
     * again and again; '|': the rest may be missing. */
    const char *takes;
    double (*of_one)(double);           /* functions of numbers only ... */
    double (*of_two)(double, double);
    void (*run)(struct arguments *a, struct value *out);    /* ... and others */
    bool commas;                        /* must stand between all arguments */
    bool last_comma;                    /* one may follow the last argument */
    bool in_functions;                  /* may stand in function { } too */
    int code;                           /* there: enum code of function.c; or an internal's number */
};

extern const struct call calls[];       /* NULL name ends */
void call_run(struct lang *l, const struct ast *node, struct value *out);

struct constant {
    const char *name, *help;
    void (*get)(const struct lang *l, struct value *out);
    int axis;                           /* 1..5: x y z t, u v: parameters of functions */
};

extern const struct constant constants[];

/* text.c: the functions that take or make texts. */
void call_str(struct arguments *a, struct value *out);
void call_vstr(struct arguments *a, struct value *out);
void call_concat(struct arguments *a, struct value *out);
void call_chr(struct arguments *a, struct value *out);
void call_substr(struct arguments *a, struct value *out);
void call_strupr(struct arguments *a, struct value *out);
void call_strlwr(struct arguments *a, struct value *out);
void call_datetime(struct arguments *a, struct value *out);
void call_val(struct arguments *a, struct value *out);
void call_asc(struct arguments *a, struct value *out);
void call_strlen(struct arguments *a, struct value *out);
void call_strcmp(struct arguments *a, struct value *out);
int text_compare(const struct text *a, const struct text *b);
/* A literal, with the bytes that the charset does not have replaced. */
struct value text_literal(struct lang *l, const struct ast *a);

#endif
