/* state.h: all that the language knows while it reads a scene. */
#ifndef RTC_STATE_H
#define RTC_STATE_H

#include "base/name.h"
#include "lang/ast.h"
#include "lang/lang.h"
#include "lang/reader.h"
#include "lang/value.h"
#include "lang/words.h"
#include "scene/object.h"

/* A name's meaning.  Scoping is dynamic (facts sdl.md 4.1): name->slot is the
 * innermost binding, outer the one it hides. */
struct binding {
    struct value *value;                /* own, or what a macro's parameter refers to */
    struct value own;
    struct name *name;
    struct binding *outer;
    struct binding *sibling;            /* the next of its scope */
    unsigned scope;                     /* 0: global */
    const char *deprecated;             /* what each use warns of; NULL: nothing */
    bool warn_once;
    bool is_broken;                     /* its declaration was wrong, which was said */
    struct loc at;                      /* where it was declared */
};

struct frame;                           /* frame.h: where readers are */
struct stream;                          /* rand */

struct lang {
    struct lang_setup setup;
    const char *folder;                 /* the scene's own, with a final "/" or empty */
    struct arena *mem;                  /* tree and values */
    struct arena statements;            /* the tree of a text that is run while it is read */
    struct arena *scene_mem;            /* what is part of the scene or of a declared thing */
    struct sources *sources;
    struct diag *diag;
    const struct limits *limits;
    struct scene *scene;                /* being built */
    struct object_trees trees;          /* of what trace and inside were asked about */
    struct intern asked;                /* what is known of objects that were asked about: call.c */
    struct build *build;                /* lang-build's own: defaults, cameras; NULL at first */
    struct names names;

    struct word *word;                  /* all of them */
    size_t n_word;

    struct frame *frame;                /* of all open readers, innermost last */
    unsigned n_frame;
    size_t room_frame;
    struct reader *reader;              /* the innermost */
    unsigned nesting;                   /* open readers */
    unsigned n_call, n_include;         /* open macro calls and includes */
    struct binding **scope;             /* bindings of each open scope; [0] is unused */
    unsigned n_scope;
    struct binding *spare;              /* bindings of closed scopes, linked by sibling */
    size_t room_scope;
    double rounds;                      /* of all loops so far */
    double budget_rounds;

    const struct name *declaring;       /* what is being declared */
    int version;                        /* number * 100, as #version says */
    bool version_given;
    struct loc version_at;              /* the scene's last #version */
    uint32_t main_source;               /* the scene's own text */
    struct parse *streamed;             /* the same, run while it is read */
    bool charset_utf8;                  /* global_settings { charset utf8 } */
    struct stream *stream;
    size_t n_stream, room_stream;
    struct library_file *file;          /* parsed includes */
    struct handle *handle;              /* open files */
    char *debug_line;                   /* #debug text that has no line end yet */
    size_t n_debug, room_debug;
    char *warning_line;
    size_t n_warning, room_warning;

    const char *stack_base;             /* where C's stack was, ... */
    size_t stack_room;                  /* ... and what of it may be used */
    bool guessed;                       /* trace or inside met what is not supported */
    bool skipping;                      /* on to the next block or directive of the top level */
    struct { unsigned errors, nesting; } late;      /* the error that waits for what follows; 0: none */
    bool stopped;                       /* read nothing more */
    bool limit_reached;                 /* exit code 4 */
};

/* --- for the builders ------------------------------------------------------ */

/* What build.h has to offer; called from here:
 *
 * bool build_value(struct lang *l, const struct word *word, const struct item *block,
 *                  struct value *out);
 *     The value of `#declare T = word { block }` (also a macro's argument, an
 *     array's element): out->type says what.  For further `texture { }`
 *     blocks of a layered declaration it is called again with out as the
 *     call before left it; at the first call out->type is VALUE_NONE.
 *     word->text may be a shape's, "object", "texture", "light_source",
 *     "camera", "transform" and so on, but not "spline", "function", "array".
 *     False: not a thing that can be declared; nothing was reported.
 * bool build_word_value(struct lang *l, struct reader *r, const struct item *word,
 *                  struct value *out);
 *     The same for a word without block: `transform T1`; the reader stands
 *     behind the word.
 * void build_statement(struct lang *l, struct reader *r, struct item item);
 *     One item of the top level that is no value: object, camera, light ...
 *     (also a VALUE_OBJECT: a declared object's bare name).
 * void build_default(struct lang *l, struct reader *r);
 *     The body of #default { }.
 * void build_version(struct lang *l);   after #version changed l->version
 * void build_end(struct lang *l);       after the last item: camera solved, warnings
 * bool build_pigment_function(struct lang *l, const struct item *block, ...) comes later.
 * and from colour.h:
 * bool colour_read(struct reader *r, struct value *out);
 *     A colour specification (facts sdl.md 3); the next item is a word of class
 *     WORD_RGB or WORD_COLOUR, or a value of type VALUE_COLOUR. */

/* The value a visible name has, or NULL. */
const struct value *lang_value(const struct lang *l, const char *name);
const struct binding *lang_binding(const struct lang *l, const char *name);

/* An error after which nothing more is read; the program ends with EXIT_LIMIT. */
void lang_limit(struct lang *l, struct loc at, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* Values that come from macros recurse: is C's stack used up? */
bool lang_stack_is_low(const struct lang *l);

/* Not too much in each other; false: reported. */
bool lang_may_nest(struct lang *l, struct loc at, const struct nest *n);

void lang_cannot_read(struct lang *l, struct loc at, const char *path);     /* by errno */

/* Finds a file for reading (a picture, a font) as #include does: the scene's
 * own folder, then the library; extensions ("png", "PNG"; NULL ends) are tried
 * too.  The path is in l->mem; NULL: not found or not allowed, which is reported. */
const char *lang_find_file(struct lang *l, struct loc at, const char *name,
                           const char *const *extensions, const char *what);

/* A value's doubles as n components, by the rules of facts sdl.md 2.3; false
 * if it is no number or has more. */
bool value_components(const struct value *v, int n, double *out);
int value_whole(double x);               /* towards 0, and the nearest int there is; NaN: the least */
struct value value_number(double x);
struct value value_vector(int n, const double *v);
struct value value_text(struct lang *l, const char *bytes, size_t size);
struct value value_thing(enum value_type type, const void *thing);

/* A float function at n points of its parameters (arrays of n doubles);
 * f is the thing of a VALUE_FUNCTION. */
struct function;
int function_parameters(const struct function *f);
int function_components(const struct function *f);
double function_at(const struct function *f, const double *arguments);

#endif
