/* options.c: rtc's own options, a row each. */
#include "cli/options.h"

#include <limits.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "base/name.h"
#include "cli/version.h"
#include "lang/lang.h"

struct option {
    const char *name;                   /* without its dashes; NULL: only a letter */
    char letter;
    const char *value;                  /* what the help calls it; NULL: takes none */
    bool (*read)(struct options *o, const struct option *row, const char *said, const char *value);
    size_t offset;                      /* of the member that is set */
    double low, high;                   /* of a number */
    const char *help;
};

static bool usage_message(const char *severity, const char *format, va_list args)
{
    fprintf(stderr, "rtc: %s: ", severity);
    vfprintf(stderr, format, args);
    fputc('\n', stderr);
    return false;
}

bool option_error(const char *format, ...)
{
    va_list args;

    va_start(args, format);
    usage_message("error", format, args);
    va_end(args);
    return false;
}

void option_warning(const struct options *o, const char *format, ...)
{
    va_list args;

    if (o->quiet)
        return;
    va_start(args, format);
    usage_message("warning", format, args);
    va_end(args);
}

void list_add(struct options *o, struct list *list, const char *item)
{
    list->item = arena_grow(o->mem, list->item, list->n, &list->room, sizeof *list->item);
    list->item[list->n++] = item;
}

/* --- readers ------------------------------------------------------------- */

static void *member(struct options *o, const struct option *row)
{
    return (char *)o + row->offset;
}

static bool read_flag(struct options *o, const struct option *row, const char *said,
                      const char *value)
{
    (void)said, (void)value;
    *(bool *)member(o, row) = true;
    return true;
}

static bool read_text(struct options *o, const struct option *row, const char *said,
                      const char *value)
{
    if (!*value)
        return option_error("%s: the value is empty", said);
    *(const char **)member(o, row) = value;
    return true;
}

static bool read_list(struct options *o, const struct option *row, const char *said,
                      const char *value)
{
    if (!*value)
        return option_error("%s: the value is empty", said);
    list_add(o, member(o, row), value);
    return true;
}

/* A whole number in the row's range; 1e9 is one too. */
static bool whole(const struct option *row, const char *said, const char *value, double *out)
{
    char *end;

    *out = strtod(value, &end);
    if (end == value || *end || !(*out == floor(*out)))
        return option_error("%s: not a whole number: '%s'", said, value);
    if (!(*out >= row->low && *out <= row->high))
        return option_error("%s: %s is not between %.0f and %.0f", said, value, row->low, row->high);
    return true;
}

static bool read_count(struct options *o, const struct option *row, const char *said,
                       const char *value)
{
    double n;

    if (!whole(row, said, value, &n))
        return false;
    *(unsigned *)member(o, row) = (unsigned)n;
    return true;
}

static bool read_amount(struct options *o, const struct option *row, const char *said,
                        const char *value)
{
    double n;

    if (!whole(row, said, value, &n))
        return false;
    *(size_t *)member(o, row) = (size_t)n;
    return true;
}

static bool read_real(struct options *o, const struct option *row, const char *said,
                      const char *value)
{
    double *out = member(o, row);
    char *end;

    *out = strtod(value, &end);
    if (end == value || *end || !(*out >= row->low && *out <= row->high))
        return option_error("%s: not a number between %g and %g: '%s'", said, row->low, row->high,
                            value);
    return true;
}

/* Bytes, with K, M, G or T for powers of 1024. */
static bool read_bytes(struct options *o, const struct option *row, const char *said,
                       const char *value)
{
    static const char units[] = "KMGT";
    char *end;
    double n = strtod(value, &end);
    const char *unit = *end ? strchr(units, *end >= 'a' ? *end - 32 : *end) : NULL;

    if (unit && end != value) {
        n *= pow(1024, (double)(unit - units + 1));
        end++;
        if (*end == 'i')
            end++;
        if (*end == 'B' || *end == 'b')
            end++;
    }
    if (end == value || *end || isnan(n))
        return option_error("%s: not a size such as 500M or 8G: '%s'", said, value);
    if (!(n >= row->low && n <= row->high))
        return option_error("%s: %s is not between %.0f and %.0f bytes", said, value, row->low, row->high);
    *(size_t *)member(o, row) = (size_t)n;
    return true;
}

static bool read_samples(struct options *o, const struct option *row, const char *said,
                         const char *value)
{
    double n;

    if (!whole(row, said, value, &n))
        return false;
    double side = floor(sqrt(n) + 0.5);
    if (side * side != n)
        return option_error("%s: %s is not a square number; the nearest is %.0f", said, value,
                            side * side);
    o->samples = (unsigned)n;
    return true;
}

static bool read_bits(struct options *o, const struct option *row, const char *said,
                      const char *value)
{
    (void)row;
    o->bits = (unsigned)atoi(value);
    if (strcmp(value, "8") != 0 && strcmp(value, "16") != 0)
        return option_error("%s: 8 or 16, not '%s'", said, value);
    return true;
}

static bool read_crop(struct options *o, const struct option *row, const char *said,
                      const char *value)
{
    int end = 0;

    (void)row;
    if (strspn(value, "0123456789,") != strlen(value) || strlen(value) > 40 ||
        sscanf(value, "%u,%u,%u,%u%n", &o->crop.x, &o->crop.y, &o->crop.width, &o->crop.height,
               &end) != 4 || value[end])
        return option_error("%s: not four numbers X,Y,WIDTH,HEIGHT: '%s'", said, value);
    if (!o->crop.width || !o->crop.height)
        return option_error("%s: the part is empty: '%s'", said, value);
    o->has_crop = true;
    return true;
}

/* One of the words separated by | in the row's value; its number. */
static bool choice(const struct option *row, const char *said, const char *value, int *out)
{
    const char *word = row->value;

    for (*out = 0; word; ++*out) {
        size_t length = strcspn(word, "|");
        if (strlen(value) == length && strncmp(word, value, length) == 0)
            return true;
        word = word[length] ? word + length + 1 : NULL;
    }
    return option_error("%s: one of %s, not '%s'", said, row->value, value);
}

static bool read_dump(struct options *o, const struct option *row, const char *said,
                      const char *value)
{
    int n;

    if (!choice(row, said, value, &n))
        return false;
    o->task = TASK_DUMP_TOKENS + (enum task)n;
    return true;
}

static bool read_diagnostics(struct options *o, const struct option *row, const char *said,
                             const char *value)
{
    int n;

    if (!choice(row, said, value, &n))
        return false;
    o->diagnostics = (enum diag_style)n;
    return true;
}

static bool read_stats(struct options *o, const struct option *row, const char *said,
                       const char *value)
{
    (void)row;
    o->stats = strcmp(value, "json") == 0 ? STATS_JSON : STATS_TEXT;
    if (*value && o->stats == STATS_TEXT)
        return option_error("%s: only json, not '%s'", said, value);
    return true;
}

static bool read_check(struct options *o, const struct option *row, const char *said,
                       const char *value)
{
    (void)row, (void)said, (void)value;
    o->task = TASK_CHECK;
    return true;
}

static bool read_explain(struct options *o, const struct option *row, const char *said,
                         const char *value)
{
    (void)row, (void)said, (void)value;
    o->task = TASK_EXPLAIN;
    return true;
}

static bool read_declare(struct options *o, const struct option *row, const char *said,
                         const char *value)
{
    const char *equals = strchr(value, '=');

    (void)row;
    if (!equals || equals == value || !equals[1] || strchr("0123456789", *value))
        return option_error("%s: not NAME=VALUE: '%s'", said, value);
    list_add(o, &o->declare, value);
    return true;
}

static bool read_clock(struct options *o, const struct option *row, const char *said,
                       const char *value)
{
    o->has_clock = true;
    return read_real(o, row, said, value);
}

/* A-B, both within what +KFI and +KFF take. */
static bool read_frames(struct options *o, const struct option *row, const char *said,
                        const char *value)
{
    struct animation *a = &o->animation;
    unsigned first, last;
    int end = 0;

    if (strspn(value, "0123456789-") != strlen(value) || strlen(value) > 20 ||
        sscanf(value, "%u-%u%n", &first, &last, &end) != 2 || value[end] ||
        first > row->high || last > row->high)
        return option_error("%s: not FIRST-LAST such as 1-100: '%s'", said, value);
    if (first > last)
        return option_error("%s: the last frame is before the first: '%s'", said, value);
    a->is_on = true;
    a->initial_frame = (int)first;
    a->final_frame = (int)last;
    return true;
}

static bool print_help(struct options *o, const struct option *row, const char *said,
                       const char *value);
static bool print_version(struct options *o, const struct option *row, const char *said,
                          const char *value)
{
    (void)row, (void)said, (void)value;
    version_print(stdout);
    o->task = TASK_NOTHING;
    return true;
}

static bool print_words(struct options *o, const struct option *row, const char *said,
                        const char *value)
{
    (void)row, (void)said, (void)value;
    lang_list_words(stdout);
    o->task = TASK_NOTHING;
    return true;
}

/* --- the table ----------------------------------------------------------- */

#define AT(m) offsetof(struct options, m)
#define LIMIT(m) offsetof(struct options, limits.m)
#define MOST_BYTES 1e15
#define SIDE 1000000

static const struct option table[] = {
    { "output", 'o', "FILE", read_text, AT(output), 0, 0, "the picture; - is standard output (default: SCENE.png here)" },
    { "width", 'W', "N", read_count, AT(width), 1, SIDE, "pixels across (default 800; alone, keeps the shape 4:3)" },
    { "height", 'H', "N", read_count, AT(height), 1, SIDE, "pixels down (default 600)" },
    { "samples", 0, "N", read_samples, 0, 1, 65536, "rays a pixel, a square number (default 1: its centre)" },
    { "crop", 0, "X,Y,W,H", read_crop, 0, 0, 0, "only this part of the picture, from its upper left corner" },
    { "bits", 0, "8|16", read_bits, 0, 0, 0, "bits a channel (default 8)" },
    { "alpha", 0, NULL, read_flag, AT(alpha), 0, 0, "write what is behind all objects as transparent" },
    { "threads", 't', "N", read_count, AT(threads), 1, 4096, "default: all processors" },
    { "include-dir", 'I', "DIR", read_list, AT(library), 0, 0, "look for included files here too; repeatable" },
    { "declare", 0, "NAME=VALUE", read_declare, 0, 0, 0, "declare before the scene is read; repeatable" },
    { "clock", 0, "N", read_clock, AT(clock), -1e300, 1e300, "what the scene sees as clock" },
    { "frames", 0, "A-B", read_frames, 0, 0, 1e6, "an animation: frames A to B, clock from 0 to 1" },
    { "resume", 0, NULL, read_flag, AT(resume), 0, 0, "skip frames whose pictures exist" },
    { "check", 0, NULL, read_check, 0, 0, 0, "read the scene, make no picture" },
    { "dump", 0, "tokens|ast|scene|plan", read_dump, 0, 0, 0, "print a stage, make no picture" },
    { "explain", 0, NULL, read_explain, 0, 0, 0, "print what the plan holds and leaves out" },
    { "stats", 0, "[=json]", read_stats, 0, 0, 0, "print times and counts at the end" },
    { "quiet", 'q', NULL, read_flag, AT(quiet), 0, 0, "no warnings, no progress" },
    { "strict", 0, NULL, read_flag, AT(strict), 0, 0, "what is not supported is an error" },
    { "lint", 0, NULL, read_flag, AT(lint), 0, 0, "warn of what is legal but seldom meant, too" },
    { "diagnostics", 0, "full|short|json", read_diagnostics, 0, 0, 0, "how messages look" },
    { "allow-read", 0, "DIR", read_list, AT(allow_read), 0, 0, "a scene may read files here too; repeatable" },
    { "allow-write", 0, "DIR", read_list, AT(allow_write), 0, 0, "a scene may write files here; repeatable" },
    { "max-memory", 0, "SIZE", read_bytes, LIMIT(memory), 1 << 20, MOST_BYTES, "for scene and plan (default 8G)" },
    { "max-iterations", 0, "N", read_real, LIMIT(iterations), 1, 1e300, "rounds of loops, macro calls, included files (default 1e9)" },
    { "max-nesting", 0, "N", read_count, LIMIT(nesting), 1, 100000, "blocks in each other (default 1000)" },
    { "max-include-depth", 0, "N", read_count, LIMIT(include_depth), 1, 1000, "files in each other (default 32)" },
    { "max-call-depth", 0, "N", read_count, LIMIT(call_depth), 1, 10000, "macro calls in each other (default 98)" },
    { "max-csg-depth", 0, "N", read_count, LIMIT(csg_depth), 1, 10000, "objects in each other (default 1000)" },
    { "max-trace-depth", 0, "N", read_count, LIMIT(trace_depth), 1, 256, "the highest max_trace_level (default 256)" },
    { "max-array-items", 0, "N", read_amount, LIMIT(array_items), 1, MOST_BYTES, "of all dimensions of one array (default 268435456)" },
    { "max-string", 0, "SIZE", read_bytes, LIMIT(string_bytes), 1, MOST_BYTES, "bytes of one string (default 64M)" },
    { "max-source", 0, "SIZE", read_bytes, LIMIT(source_bytes), 1, INT_MAX, "bytes of one source file (default 1G)" },
    { "isa", 0, "baseline|v3|v4", read_text, AT(isa), 0, 0, "the instruction set to use (default: the best there is)" },
    { "list-words", 0, NULL, print_words, 0, 0, 0, "print all reserved words and what they are" },
    { "help", 'h', NULL, print_help, 0, 0, 0, "print this text" },
    { "version", 0, NULL, print_version, 0, 0, 0, "print the version and what it was built with" },
    { NULL, 0, NULL, NULL, 0, 0, 0, NULL },
};

static void print_row(const struct option *row)
{
    char left[64];
    const char *value = row->value ? row->value : "";

    snprintf(left, sizeof left, "  %c%c%c --%s%s%s", row->letter ? '-' : ' ',
             row->letter ? row->letter : ' ', row->letter ? ',' : ' ', row->name,
             *value && *value != '[' ? " " : "", value);
    printf("%-34s %s\n", left, row->help);
}

static bool print_help(struct options *o, const struct option *row, const char *said,
                       const char *value)
{
    (void)said, (void)value;
    fputs("usage: rtc [options] SCENE\n"
          "Renders a scene in POV-Ray's language.  - reads it from standard input.\n\n", stdout);
    for (row = table; row->name; row++)
        print_row(row);
    fputs("\nPOV-Ray's own options (+Iscene.pov +W640 +H480 +Oout.png ...) work too: rtc(1).\n",
          stdout);
    o->task = TASK_NOTHING;
    return true;
}

/* --- from words to rows -------------------------------------------------- */

static const struct option *find_name(const char *name, size_t length)
{
    for (const struct option *row = table; row->name; row++)
        if (strlen(row->name) == length && strncmp(row->name, name, length) == 0)
            return row;
    return NULL;
}

static const struct option *find_letter(char letter)
{
    for (const struct option *row = table; row->name; row++)
        if (row->letter && row->letter == letter)
            return row;
    return NULL;
}

static bool unknown(const char *name)
{
    const char *best = NULL;
    unsigned nearest = 4;               /* edits; further than three is another word */

    for (const struct option *row = table; row->name; row++) {
        unsigned d = name_distance(name, row->name, nearest);
        if (d < nearest)
            nearest = d, best = row->name;
    }
    if (best)
        return option_error("unknown option '--%s'; did you mean '--%s'?", name, best);
    return option_error("unknown option '--%s'; --help lists them", name);
}

struct words { int n; char **word; int next; };

static bool value_missing(const char *said)
{
    return option_error("%s: the value is missing", said);
}

static bool read_long(struct options *o, struct words *w, const char *word)
{
    const char *name = word + 2, *equals = strchr(name, '=');
    size_t length = equals ? (size_t)(equals - name) : strlen(name);
    const char *said = arena_text(o->mem, word, length + 2), *value = equals ? equals + 1 : NULL;
    const struct option *row = find_name(name, length);

    if (!row)
        return unknown(said + 2);
    bool optional = row->value && row->value[0] == '[';
    if (value && !row->value)
        return option_error("%s takes no value", said);
    if (!value && row->value && !optional) {
        if (w->next == w->n)
            return value_missing(said);
        value = w->word[w->next++];
    }
    return row->read(o, row, said, value ? value : "");
}

static bool read_letter(struct options *o, struct words *w, const struct option *row,
                        const char *word)
{
    const char said[] = { '-', word[1], '\0' }, *value = word + 2;

    if (!row->value)
        return row->read(o, row, said, "");
    if (!*value) {
        if (w->next == w->n)
            return value_missing(said);
        value = w->word[w->next++];
    }
    return row->read(o, row, said, value);
}

/* rtc's letters first, then POV-Ray's switches: "-W 320" and "-W320" are the
 * same in both, "-q" is rtc's and "-Q9" POV-Ray's. */
static bool read_short(struct options *o, struct words *w, const char *word)
{
    const struct option *row = find_letter(word[1]);

    if (row && (row->value || !word[2]))
        return read_letter(o, w, row, word);
    if (povray_is_switch(word))
        return povray_switches(o, word);
    return option_error("unknown option '%s'; --help lists them", word);
}

static bool read_word(struct options *o, struct words *w, const char *word, bool only_files)
{
    if (only_files)
        return povray_bare(o, word);
    if (strncmp(word, "--", 2) == 0)
        return read_long(o, w, word);
    if (word[0] == '-' && word[1])
        return read_short(o, w, word);
    if (word[0] == '+') {
        if (povray_is_switch(word))
            return povray_switches(o, word);
        return option_error("unknown switch '%s'; rtc(1) lists those of POV-Ray that work", word);
    }
    if (povray_is_assignment(word))
        return povray_assignment(o, word);
    return povray_bare(o, word);
}

static bool read_words(struct options *o, struct words *w)
{
    bool only_files = false;

    while (w->next < w->n && o->task != TASK_NOTHING) {
        const char *word = w->word[w->next++];
        if (!only_files && strcmp(word, "--") == 0)
            only_files = true;
        else if (!read_word(o, w, word, only_files))
            return false;
    }
    return true;
}

/* --- what follows from all of them together ------------------------------ */

/* One side alone keeps the shape of the default. */
static bool choose_size(struct options *o)
{
    if (!o->width && !o->height)
        o->width = 800, o->height = 600;
    else if (!o->height)
        o->height = (unsigned)fmax(1, floor(o->width * 0.75 + 0.5));
    else if (!o->width)
        o->width = (unsigned)fmin(SIDE, floor(o->height / 0.75 + 0.5));
    if (o->has_crop && (o->crop.x >= o->width || o->crop.width > o->width - o->crop.x ||
                        o->crop.y >= o->height || o->crop.height > o->height - o->crop.y))
        return option_error("--crop: %u,%u,%u,%u is not inside a picture of %u x %u", o->crop.x,
                            o->crop.y, o->crop.width, o->crop.height, o->width, o->height);
    return true;
}

static void choose_samples(struct options *o)
{
    if (!o->samples)
        o->samples = o->antialias ? o->antialias_depth * o->antialias_depth : 1;
}

static bool check_output(const struct options *o)
{
    static const char *const others[] = { ".jpg", ".jpeg", ".tga", ".bmp", ".ppm", ".gif", ".exr",
                                          ".hdr", ".tif", ".tiff", ".webp", NULL };
    const char *dot = o->output && !o->povray_name ? strrchr(o->output, '.') : NULL;

    for (int i = 0; dot && others[i]; i++)
        if (strcasecmp(dot, others[i]) == 0)
            return option_error("-o: only PNG pictures are written, not '%s'", o->output);
    return true;
}

static bool finish(struct options *o)
{
    if (o->task == TASK_NOTHING)
        return true;
    if (!o->scene)
        return option_error("no scene; usage: rtc [options] SCENE (--help tells more)");
    if (strcmp(o->scene, "-") == 0 && o->task == TASK_RENDER && !o->output && !o->no_file)
        return option_error("-o: a scene from standard input has no name for its picture; "
                            "say -o FILE, or -o - for standard output");
    if (o->task == TASK_CHECK)
        ini_beside(o);
    if (o->animation.initial_frame > o->animation.final_frame)
        o->animation.final_frame = o->animation.initial_frame;
    if (o->resume && !o->animation.is_on)
        return option_error("--resume (+C): only frames of an animation are resumed; "
                            "--frames A-B makes some");
    choose_samples(o);
    return choose_size(o) && check_output(o);
}

bool options_read(struct options *o, int argc, char **argv, struct arena *mem)
{
    struct words w = { argc, argv, 1 };

    *o = (struct options) {
        .mem = mem, .bits = 8, .antialias_depth = 3, .limits = LIMITS_DEFAULT,
        .animation = { .initial_frame = 1, .final_frame = 1, .step = 1, .final_clock = 1,
                       .subset_start = -1, .subset_end = -1 } };
    return read_words(o, &w) && finish(o);
}
