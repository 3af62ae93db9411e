/* ast.h: the tree of a scene's text: flat lists of items.
 *
 * Constant once parsed; it holds no values.  Everything between two braces
 * (brackets, parentheses of a call, angle brackets) is one list of items in
 * which directives may stand; a reader (reader.h) walks it. */
#ifndef RTC_AST_H
#define RTC_AST_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/arena.h"
#include "base/name.h"
#include "base/source.h"

struct word;

enum ast_kind {
    AST_LIST,           /* the root, and the body of every block: first */

    /* Items that are no values. */
    AST_WORD,           /* a reserved word alone: name, word */
    AST_BLOCK,          /* a word (or an unknown name) and { }: name, word, body */
    AST_BRACES,         /* { } alone: body */
    AST_ENTRY,          /* [ ]: body */
    AST_COMMA,
    AST_COLON,
    AST_SEMICOLON,
    AST_BULK,           /* a run of constants, each with a comma behind it: bulk */
    AST_ERROR,          /* what could not be parsed, said when it is reached: text; note
                           at other, if that has a source; more, or NULL */

    /* Values: expressions. */
    AST_NUMBER,         /* number */
    AST_TEXT,           /* text, size */
    AST_NAME,           /* name */
    AST_INDEX,          /* NAME [..] [..]: name; a list of AST_LIST in args */
    AST_CALL,           /* NAME ( ): a function, spline or macro: name, args */
    AST_FUNC,           /* a built-in function: word, args */
    AST_CONSTANT,       /* pi, x, clock ...: word */
    AST_VECTOR,         /* < >: args */
    AST_LITERAL,        /* < > of nothing but numbers: n, v */
    AST_PAREN,          /* ( ): args */
    AST_MEMBER,         /* .x: left, index */
    AST_UNARY,          /* op, right */
    AST_BINARY,         /* op, left, right */
    AST_TAIL,           /* an operator whose left side comes from before a directive: op, right */
    AST_CONDITION,      /* a ? b : c: left, right, third */
    AST_SPLICE,         /* a directive in an operand's place: first */
    AST_ARRAY,          /* array[ ] { }: dims (AST_LISTs) in args, body or NULL */
    AST_FUNCTION,       /* function (params) { }: params, body */

    /* Directives. */
    AST_DECLARE,        /* op 'd' or 'l': target, value (a list), marks */
    AST_UNDEF,          /* target */
    AST_IF,             /* first: AST_BRANCHes */
    AST_BRANCH,         /* args: the condition (NULL: #else); body.  op: 'i' if, 'd' ifdef, 'n' ifndef */
    AST_WHILE,          /* args, body */
    AST_FOR,            /* name, args, body */
    AST_SWITCH,         /* args, body */
    AST_CASE,           /* in a switch's body: args; op: 'c' case, 'r' range, 'e' else */
    AST_BREAK,
    AST_MACRO,          /* name, params, body */
    AST_INCLUDE,        /* right */
    AST_VERSION,        /* right; third: an AST_ERROR about what follows, or NULL */
    AST_MESSAGE,        /* op: 'd' debug, 'w' warning, 'e' error, 'r' render, 's' statistics: right */
    AST_DEFAULT,        /* body */
    AST_FOPEN,          /* name, right, word (read, write, append) */
    AST_FCLOSE,         /* name */
    AST_READ,           /* args */
    AST_WRITE,          /* args */
};

/* Facts about lists (AST_LIST) and spines, worked out while parsing. */
enum {
    AST_PLAIN = 1 << 0,         /* a list of nothing but expressions, commas dropped */
    AST_ALL_COMMAS = 1 << 1,    /* of a plain list: a comma stood between every two */
    AST_LAST_COMMA = 1 << 2,    /* of a plain list: one stood after the last */
    AST_HAS_CALL = 1 << 3,      /* a NAME ( ) outside of parentheses: perhaps a macro */
    AST_SEMI = 1 << 4,          /* a declaration that ended with ';' */
    AST_CLOSED = 1 << 5,        /* a block whose closing brace was found */
    AST_FATAL = 1 << 6,         /* an error behind which nothing makes sense */
    AST_COMMA_BEFORE = 1 << 7,  /* of a plain list: a comma stood before the last */
};

struct ast_bulk {
    uint32_t components;        /* 1: numbers, 2..5: vectors */
    uint32_t n;
    double *v;
};

/* What few errors have. */
struct ast_more {
    struct name *meant;         /* a name that is declared after all, or NULL */
    struct loc askew, askew_end;    /* braces whose end looks like another's; source 0: none */
};

struct ast {
    uint8_t kind, flags;
    uint8_t op;                 /* '+' '-' '*' '/' '!' '<' '>' '=' '&' '|', or one of below */
    uint8_t index;              /* MEMBER: 0..4, or AST_GRAY */
    uint16_t depth;             /* of an expression */
    uint16_t n;                 /* values in a plain list, saturated; components; of a DECLARE: semicolons */
    struct loc at;
    struct ast *next;           /* the item after this one */
    union {
        double number;
        double v[5];
        struct {
            const char *text;
            union { size_t size; const char *note; };
            struct loc other;
            struct ast_more *more;  /* ERROR: NULL as a rule */
        };
        struct { struct ast *left, *right, *third; };
        struct ast_bulk bulk;
        struct {
            struct name *name;
            const struct word *word;
            struct ast *args;   /* an AST_LIST, or several */
            struct ast *body;   /* an AST_LIST */
            struct ast *params; /* AST_NAMEs */
        };
        struct { struct ast *target, *value, *marks; };     /* DECLARE, UNDEF */
        struct { struct ast *first, *last; struct loc close; };     /* LIST, IF, SPLICE */
    };
};

enum {
    AST_ERROR_LATE = 'd',       /* of an ERROR: a directive stands in the place of something else */
    AST_ERROR_LABEL = 'e',      /* an #else, #case ... that belongs to nothing */
};
enum { AST_OP_LE = 'l', AST_OP_GE = 'g', AST_OP_NE = 'n' };
enum { AST_GRAY = 8, AST_GREY };      /* .grey: in functions only */

bool ast_is_value(const struct ast *a);

/* Nodes of some kinds are smaller than the struct: a copy that is not, and stands alone. */
struct ast *ast_copy(struct arena *mem, const struct ast *a);
const struct ast *ast_leftmost(const struct ast *a);    /* the operand that an expression begins with */

#endif
