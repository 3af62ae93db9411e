/* parsing.h: what the scanner and the parser share while one text is parsed. */
#ifndef RTC_PARSING_H
#define RTC_PARSING_H

#include "lang/ast.h"
#include "lang/state.h"

/* What is open around a place.  The scanner keeps the stack, so that it can
 * tell '<' the comparison from '<' the vector, close what the user forgot to
 * close, and refuse nesting beyond the limit before the parser's own stack
 * or a recursion feels it. */
enum open_kind {
    OPEN_BRACE,                 /* { } of a block */
    OPEN_FUNCTION,              /* { } of a function: '<' always compares */
    OPEN_GROUP,                 /* ( ) in which comparisons may stand */
    OPEN_ARGS,                  /* ( ) of a call */
    OPEN_BRACKET,
    OPEN_VECTOR,
    OPEN_IF, OPEN_LOOP, OPEN_SWITCH, OPEN_MACRO,    /* until #end */
};

struct open {
    uint8_t kind;               /* enum open_kind */
    bool in_function;           /* here '<' always compares */
    bool has_else;
    bool uneven;                /* an #if: not every branch left one brace open, */
    unsigned left_open;         /* this branch that many, */
    struct loc brace;           /* the last of them here */
    bool in_value;              /* a bracket in a declaration's value: no ';' belongs in it */
    const struct word *word;    /* whose { } these are; NULL: unknown */
    struct loc askew, askew_end;    /* a pair of braces in it whose end stands further left than its line */
    struct loc at;
};

/* A number or vector that was read ahead. */
struct constant {
    char *begin, *end;
    unsigned n;                 /* components */
    double v[5];
};

enum {
    SHORTEST_RUN = 8,           /* constants that are worth a node of their own */
    LONGEST_RUN = 1 << 14,      /* more of them go on in the next: one of millions would be held twice */
};
enum { LONGEST_NAME = 255 };    /* POV-Ray's limit */

struct parse {
    struct lang *lang;
    struct arena *mem;
    uint32_t source;
    char *text;
    size_t size;
    void *scanner;
    struct open *open;
    unsigned n_open;
    struct loc closed;          /* the '{' that was closed last */
    int before, last;           /* the two tokens before, ... */
    struct name *last_word;     /* ... and the last one's name */
    bool file_name;             /* a text that follows is a file's name */
    int function;               /* 1: behind the word function, 2: behind its ( ), else 0 */
    bool deep;                  /* nested beyond the limit: the rest is not read */
    int owed;                   /* a token to give again after those that close brackets, ... */
    struct name *owed_word;     /* ... and its name */
    bool ended;
    bool every_token;           /* blocks are given in parts, however plain they are */
    bool has_counted;           /* how many closing braces are missing: */
    long lacking;
    uint32_t vain;              /* the word there begins a block that is not plain; 0: none */
    struct constant ahead[SHORTEST_RUN];
    unsigned n_ahead;
    struct ast *pending;        /* a message that no list has taken yet */
    struct ast *unclosed;       /* messages about directives without #end */
    struct loc declaring;       /* behind #declare, up to its '=' */
    unsigned declaring_at;      /* n_open there */
    unsigned value_at;          /* n_open + 1 in a declaration's value, else 0 */
    unsigned semicolon_at;      /* n_open + 1 where a ';' is to come, else 0 */
    unsigned colour_at;         /* the same behind rgb */
    struct ast *root;
    void (*run)(struct lang *l, const struct ast *statements);      /* NULL: the tree is kept */
    struct arena_mark mark;     /* the tree of the statements that are read begins here */
    bool keep;                  /* values may point into it */
    bool rest_taken;            /* an included file's #if ends behind its #include */
};

/* Parses a text that is one of the sources; never NULL. */
struct ast *parse_source(struct lang *l, uint32_t source);

/* The same, but each statement of the top level is run as soon as it has been
 * read, and its tree given up unless it holds macros, functions or texts. */
void parse_and_run(struct lang *l, uint32_t source,
                   void (*run)(struct lang *l, const struct ast *statements));

/* In the scanner (scan.l). */
bool scanner_start(struct parse *p);
void scanner_end(struct parse *p);
void scanner_uncover(struct parse *p);      /* makes the text whole until the next token */
void scanner_dump(struct lang *l, uint32_t source, FILE *out);      /* in parse.y: it names tokens */
struct name *name_behind(struct parse *p, uint32_t from);      /* NULL: no name is there */
bool text_unescape(char *text, size_t *size);       /* in place; false: no such escape */
struct parse *parse_start(struct lang *l, uint32_t source);

/* Numbers, and vectors of numbers with commas between them (constant.c). */
bool constant_read(char *p, struct constant *out);  /* false: something else, or part of more */
struct ast *constant_node(struct parse *p, const struct constant *c);
static inline char *skip_spaces(char *p)
{
    while (*p == ' ' || *p == '\t' || *p == '\n' || *p == '\r')
        p++;
    return p;
}

static inline bool is_letter(char c)
{
    return ((c | 32) >= 'a' && (c | 32) <= 'z') || c == '_';
}

/* Does a '}' alone stand further left than the line where its '{' is?  It was likely meant
 * for what is around that.  (In scan.l.) */
bool is_askew(const struct parse *p, const char *open, const char *close);

/* A word and its { }, if all in them is plain (plain.c); NULL: it is not, or
 * there are none.  begin: of the word; end: behind the braces. */
struct ast *plain_block(struct parse *p, struct name *word, char *begin, char **end);

/* Nodes (ast.c). */
struct ast *ast_new(struct parse *p, enum ast_kind kind, struct loc at);      /* no LITERAL */
struct ast *ast_literal(struct parse *p, struct loc at, const double v[], unsigned n);
struct ast *ast_list(struct parse *p, struct loc at);
struct ast *ast_add(struct ast *list, struct ast *item);        /* item may be NULL */
struct ast *ast_pack(struct ast *list);     /* of values: see AST_PLAIN */
void ast_check_commas(struct parse *p, const struct ast *list);     /* before it is packed */
struct ast *ast_close(struct parse *p, struct ast *list, struct loc open, struct loc close);
/* `#if (A) merge { 1 #else union { 2 #end 3 }`: 3 becomes the end of each branch's block. */
void ast_share(struct parse *p, struct ast *branches, struct ast *rest);
struct ast *ast_unary(struct parse *p, struct loc at, int op, struct ast *right);
struct ast *ast_binary(struct parse *p, struct loc at, int op, struct ast *left, struct ast *right);
struct ast *ast_tail(struct parse *p, struct loc at, int op, struct ast *right);
struct ast *ast_condition(struct parse *p, struct loc at, struct ast *a, struct ast *b,
                          struct ast *c);
struct ast *ast_member(struct parse *p, struct loc at, struct ast *left, const char *name);
struct ast_more *ast_more(struct parse *p, struct ast *error);     /* made when there is none */
struct ast *ast_error(struct parse *p, struct loc at, struct loc other, const char *format, ...)
    __attribute__((format(printf, 4, 5)));

#endif
