/* options.h: what the command line says. */
#ifndef RTC_OPTIONS_H
#define RTC_OPTIONS_H

#include <stdbool.h>
#include <stddef.h>

#include "base/arena.h"
#include "base/diag.h"
#include "base/limits.h"

struct list {                           /* of texts, in the order given */
    const char **item;
    size_t n, room;
};

enum task {                             /* how far a run goes */
    TASK_RENDER, TASK_CHECK, TASK_EXPLAIN, TASK_DUMP_TOKENS, TASK_DUMP_AST, TASK_DUMP_SCENE,
    TASK_DUMP_PLAN,
    TASK_NOTHING,                       /* --help, --version: the answer was given */
};
enum stats_style { STATS_NONE, STATS_TEXT, STATS_JSON };

struct animation {                      /* facts sdl.md 9.4 */
    bool is_on;
    int initial_frame, final_frame, step;
    double initial_clock, final_clock;
    double subset_start, subset_end;    /* frames, or shares of them below 1; -1: not given */
    bool cyclic;
};

struct crop { unsigned x, y, width, height; };

struct options {
    const char *scene;                  /* "-": standard input */
    const char *output;                 /* "-": standard output; NULL: the scene's name; DIR/ */
    bool no_file;                       /* -F: render, but write nothing */
    bool povray_name;                   /* output came as +O: .png is added to any other ending */
    enum task task;
    unsigned width, height;             /* 0: not given */
    unsigned threads;                   /* 0: as many as there are */
    unsigned samples;                   /* a square; 0: not given */
    bool antialias;                     /* +A: depth * depth samples */
    unsigned antialias_depth;
    unsigned bits;                      /* 8 or 16 */
    bool alpha;
    bool has_crop;
    struct crop crop;                   /* the picture has this size */
    double part[4];                     /* +SC +EC +SR +ER, 0: not given; the picture keeps its size */
    struct list library, declare, allow_read, allow_write;
    struct limits limits;
    enum diag_style diagnostics;
    enum stats_style stats;
    bool quiet, strict, lint;
    bool no_debug;                      /* -GD */
    const char *debug_file;             /* +GDfile */
    const char *header;                 /* +HIfile */
    double version;                     /* +MV; 0: not given */
    double clock;
    bool has_clock;
    struct animation animation;
    bool resume;                        /* frames whose pictures exist are skipped */
    const char *isa;                    /* --isa; NULL: the best this machine has */
    unsigned ini_depth;                 /* INI files being read */
    struct arena *mem;
};

/* False: a message was printed; the program ends with EXIT_USAGE. */
bool options_read(struct options *o, int argc, char **argv, struct arena *mem);

/* "rtc: error: ..." for the command line; returns false. */
bool option_error(const char *format, ...) __attribute__((format(printf, 1, 2)));
void option_warning(const struct options *o, const char *format, ...)
    __attribute__((format(printf, 2, 3)));
void list_add(struct options *o, struct list *list, const char *item);

/* POV-Ray's own spelling: povray.c. */
bool povray_is_switch(const char *word);            /* "+W320", "-D" */
bool povray_switches(struct options *o, const char *word);  /* one or more, with spaces between */
bool povray_is_assignment(const char *word);        /* "Width=320" */
bool povray_assignment(struct options *o, const char *word);
bool povray_bare(struct options *o, const char *word);      /* a file's name: scene, folder/ or .ini */

/* An INI file: ini.c.  path may end in [section]. */
bool ini_read(struct options *o, const char *path);

/* A scene that is checked may be one of an animation, which SCENE.ini beside it
 * tells: its first frame is checked then. */
void ini_beside(struct options *o);

#endif
