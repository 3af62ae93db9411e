/* ini.c: POV-Ray's INI files (facts sdl.md 9.2). */
#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

#include "cli/options.h"

enum { DEEPEST = 10, LONGEST_LINE = 4096 };

/* A line without its comment and the spaces around it; quotes protect. */
static char *trimmed(char *line)
{
    char quote = '\0', *c = line;

    for (; *c && *c != '\n' && *c != '\r'; c++) {
        if (quote ? *c == quote : *c == '"' || *c == '\'')
            quote = quote ? '\0' : *c;
        else if (!quote && (*c == ';' || *c == '#'))
            break;
    }
    *c = '\0';
    line += strspn(line, " \t");
    for (c = line + strlen(line); c > line && (c[-1] == ' ' || c[-1] == '\t');)
        *--c = '\0';
    return line;
}

/* Width = "320" means Width=320.  A declared text keeps its quotes. */
static const char *unquoted(struct options *o, const char *line)
{
    const char *equals = strchr(line, '='), *value = equals + 1 + strspn(equals + 1, " \t");
    size_t length = strlen(value);

    if (length < 2 || !strchr("\"'", value[0]) || value[length - 1] != value[0])
        return line;
    return arena_format(o->mem, "%.*s=%.*s", (int)(equals - line), line, (int)length - 2, value + 1);
}

static bool read_line(struct options *o, const char *line)
{
    line = arena_text(o->mem, line, strlen(line));
    if ((line[0] == '+' || line[0] == '-') && povray_is_switch(line))
        return povray_switches(o, line);
    if (povray_is_assignment(line))
        return povray_assignment(o, unquoted(o, line));
    if (strchr(line, '=') || line[0] == '+' || line[0] == '-')
        return option_error("unknown option '%s'", line);
    return povray_bare(o, line);
}

/* Lines before the first section count always, those of a section when its
 * name was asked for. */
static bool read_lines(struct options *o, FILE *f, const char *path, const char *section)
{
    char text[LONGEST_LINE];
    bool counts = true;

    for (unsigned number = 1; fgets(text, sizeof text, f); number++) {
        char *line = trimmed(text);
        if (line[0] == '[') {
            size_t length = strcspn(line + 1, "]");
            counts = section && strlen(section) == length &&
                     strncasecmp(line + 1, section, length) == 0;
        } else if (*line && counts && !read_line(o, line))
            return option_error("  in line %u of %s", number, path);
    }
    return true;
}

/* Files may name each other in a ring. */
static bool read_file(struct options *o, const char *path, const char *section)
{
    FILE *f = fopen(path, "r");

    if (!f)
        return option_error("%s: %s", path, strerror(errno));
    if (++o->ini_depth > DEEPEST) {
        fclose(f);
        return option_error("%s: INI files nested too deep", path);
    }
    bool done = read_lines(o, f, path, section);
    o->ini_depth--;
    fclose(f);
    return done;
}

bool ini_read(struct options *o, const char *path)
{
    const char *bracket = strchr(path, '[');

    if (!bracket)
        return read_file(o, path, NULL);
    return read_file(o, arena_text(o->mem, path, (size_t)(bracket - path)),
                     arena_text(o->mem, bracket + 1, strcspn(bracket + 1, "]")));
}

/* --- the INI file beside a scene ------------------------------------------ */

static bool is_key(const char *line, const char *key)
{
    size_t n = strcspn(line, "= \t");

    return strlen(key) == n && strncasecmp(line, key, n) == 0;
}

static const char *base_name(const char *path)
{
    const char *slash = strrchr(path, '/');

    return slash ? slash + 1 : path;
}

static const char *value_of(struct options *o, const char *line)
{
    const char *equals = strchr(unquoted(o, line), '=');

    return base_name(equals + 1 + strspn(equals + 1, " \t"));
}

/* Only what tells of frames and clocks; true: the file is about this scene. */
static bool read_frames(struct options *o, FILE *f)
{
    static const char *const keys[] = { "Initial_Frame", "Final_Frame", "Initial_Clock",
                                        "Final_Clock", "Cyclic_Animation" };
    char text[LONGEST_LINE];
    bool is_ours = false;

    while (fgets(text, sizeof text, f)) {
        const char *line = trimmed(text);
        if (!strchr(line, '='))
            continue;
        if (is_key(line, "Input_File_Name"))
            is_ours = strcmp(value_of(o, line), base_name(o->scene)) == 0;
        for (size_t i = 0; i < sizeof keys / sizeof *keys; i++)
            if (is_key(line, keys[i]) && !povray_assignment(o, unquoted(o, line)))
                return false;
    }
    return is_ours;
}

void ini_beside(struct options *o)
{
    const char *name = base_name(o->scene), *dot = strrchr(name, '.');
    struct options own = *o;

    if (!dot || o->has_clock || o->animation.is_on)
        return;
    const char *path = arena_format(o->mem, "%.*s.ini", (int)(dot - o->scene), o->scene);
    FILE *f = fopen(path, "r");
    bool is_ours = f && read_frames(&own, f);
    if (f)
        fclose(f);
    if (!is_ours || !own.animation.is_on)
        return;
    o->animation = own.animation;
    o->animation.subset_start = o->animation.subset_end = o->animation.initial_frame;
    option_warning(o, "checked as frame %d of an animation, as %s says", o->animation.initial_frame,
                   path);
}
