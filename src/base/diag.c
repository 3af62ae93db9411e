/* diag.c: messages with file:line:col, the source line and a caret. */
#include "base/diag.h"

#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

enum {
    WIDEST_LINE = 200,
    MOST_TEXT = 1024,
    MOST_REPEATS = 1000,        /* of errors: a loop that makes the same ones over and over ends */
};

struct said { struct loc at; uint32_t hash; bool is_error; };

static const struct { const char *name, *colour; } severities[] = {
    [SEVERITY_NOTE] = { "note", "\033[1;36m" },
    [SEVERITY_WARNING] = { "warning", "\033[1;35m" },
    [SEVERITY_ERROR] = { "error", "\033[1;31m" },
};
static const char bold[] = "\033[1m", green[] = "\033[1;32m", plain[] = "\033[0m";

void diag_init(struct diag *d, struct sources *sources, FILE *out)
{
    *d = (struct diag) { .sources = sources, .out = out, .most_errors = 20, .most_warnings = 100 };
}

struct loc loc_join(struct loc first, struct loc last)
{
    if (first.source == last.source && last.end > first.end)
        first.end = last.end;
    return first;
}

static const char *paint(const struct diag *d, const char *code)
{
    return d->colour ? code : "";
}

/* How many bytes of text are one character of UTF-8; 0: none is. */
static size_t utf8_length(const unsigned char *text, size_t left)
{
    size_t n = *text < 0x80 ? 1 : *text < 0xc2 ? 0 : *text < 0xe0 ? 2 : *text < 0xf0 ? 3
        : *text < 0xf5 ? 4 : 0;

    if (n > left || (*text == 0xe0 && text[1] < 0xa0) || (*text == 0xed && text[1] > 0x9f)
        || (*text == 0xf0 && text[1] < 0x90) || (*text == 0xf4 && text[1] > 0x8f))
        return 0;
    for (size_t i = 1; i < n; i++)
        if ((text[i] & 0xc0) != 0x80)
            return 0;
    return n;
}

/* Bytes that are no character count as one, as they are taken as Latin-1. */
static size_t characters(const char *text, size_t length)
{
    size_t count = 0;

    for (size_t i = 0, n; i < length; i += n ? n : 1, count++)
        n = utf8_length((const unsigned char *)text + i, length - i);
    return count;
}

/* A place in its line; columns count characters. */
static struct position position(const struct diag *d, uint32_t source, uint32_t offset)
{
    struct position p = source_position(d->sources, source, offset);
    size_t length, before = p.column ? p.column - 1 : 0;
    const char *line = source_line(d->sources, source, p.line, &length);

    if (p.column)
        p.column = 1 + (unsigned)characters(line, before < length ? before : length);
    return p;
}

/* Bytes that are not UTF-8 are taken as Latin-1, as old scenes have them. */
static void json_text(FILE *out, const char *text, size_t length)
{
    fputc('"', out);
    for (size_t i = 0, n; i < length; i += n ? n : 1) {
        unsigned char c = (unsigned char)text[i];
        n = utf8_length((const unsigned char *)text + i, length - i);
        if (c == '"' || c == '\\')
            fprintf(out, "\\%c", c);
        else if (c < 0x20 || c == 0x7f || n == 0)
            fprintf(out, "\\u%04x", c);
        else
            fwrite(text + i, 1, n, out);
    }
    fputc('"', out);
}

/* Notes nest in the message they belong to, so an object is closed only when
 * the next message comes or the run ends. */
static void json_message(struct diag *d, enum severity severity, struct loc at, const char *text)
{
    const struct source *src = source_at(d->sources, at.source);
    struct position from = position(d, at.source, at.begin);
    struct position to = position(d, at.source, at.end);

    if (severity == SEVERITY_NOTE) {
        fputs(d->open_json == 1 ? ",\"notes\":[" : ",", d->out);
        d->open_json = 2;
    } else {
        diag_end(d);
        d->open_json = 1;
    }
    fprintf(d->out, "{\"severity\":\"%s\"", severities[severity].name);
    if (src) {
        fputs(",\"file\":", d->out);
        json_text(d->out, src->path, strlen(src->path));
        fprintf(d->out, ",\"line\":%u,\"column\":%u,\"endLine\":%u,\"endColumn\":%u",
                from.line, from.column, to.line, to.column);
    }
    fputs(",\"message\":", d->out);
    json_text(d->out, text, strlen(text));
    if (severity == SEVERITY_NOTE)
        fputc('}', d->out);
}

void diag_end(struct diag *d)
{
    if (d->open_json)
        fputs(d->open_json == 2 ? "]}\n" : "}\n", d->out);
    d->open_json = 0;
    fflush(d->out);
}

/* A scene's own words must not steer the terminal, and are shown as UTF-8. */
static void put_text(FILE *out, const char *text, size_t length, bool lines)
{
    for (size_t i = 0, n; i < length; i += n ? n : 1) {
        const unsigned char *c = (const unsigned char *)text + i;
        n = utf8_length(c, length - i);
        bool control = *c < 0x20 || *c == 0x7f || (n == 0 && *c < 0xa0) || (*c == 0xc2 && c[1] < 0xa0);
        if (*c == '\t')
            fputc(' ', out);
        else if (control && !(lines && *c == '\n'))
            fputc('?', out);
        else if (n == 0)
            fprintf(out, "%c%c", 0xc0 | *c >> 6, 0x80 | (*c & 0x3f));
        else
            fwrite(c, 1, n, out);
    }
}

static bool goes_on(char c)
{
    return ((unsigned char)c & 0xc0) == 0x80;
}

/* The part of a line around a place that is shown: whole characters. */
static void choose_part(const char *line, size_t caret, size_t *skip, size_t *length)
{
    *skip = caret > WIDEST_LINE / 2 ? caret - WIDEST_LINE / 2 : 0;
    while (*skip > 0 && caret - *skip < WIDEST_LINE && goes_on(line[*skip]))
        --*skip;
    if (*length - *skip <= WIDEST_LINE)
        return;
    *length = *skip + WIDEST_LINE;
    while (*length > caret && goes_on(line[*length]))
        --*length;
}

static void show_source(struct diag *d, struct loc at)
{
    struct position from = source_position(d->sources, at.source, at.begin);
    size_t length, skip;
    const char *line = source_line(d->sources, at.source, from.line, &length);
    size_t caret = from.column - 1, wide = at.end > at.begin ? at.end - at.begin : 1;

    if (caret > length)
        caret = length;
    choose_part(line, caret, &skip, &length);
    if (caret + wide > length)
        wide = length > caret ? length - caret : 0;
    fputs("  ", d->out);
    put_text(d->out, line + skip, length - skip, false);
    fprintf(d->out, "\n  %*s%s^", (int)characters(line + skip, caret - skip), "", paint(d, green));
    for (size_t i = 1, n = characters(line + caret, wide); i < n; i++)
        fputc('~', d->out);
    fprintf(d->out, "%s\n", paint(d, plain));
}

static void text_message(struct diag *d, enum severity severity, struct loc at, const char *text)
{
    const struct source *src = source_at(d->sources, at.source);

    if (src) {
        struct position p = position(d, at.source, at.begin);
        fputs(paint(d, bold), d->out);
        put_text(d->out, src->path, strlen(src->path), false);
        fprintf(d->out, ":%u:%u:%s ", p.line, p.column, paint(d, plain));
    } else
        fputs("rtc: ", d->out);
    fprintf(d->out, "%s%s:%s ", paint(d, severities[severity].colour), severities[severity].name,
            paint(d, plain));
    put_text(d->out, text, strlen(text), true);
    fputc('\n', d->out);
    if (src && d->style == DIAG_FULL)
        show_source(d, at);
}

static void message(struct diag *d, enum severity severity, struct loc at, const char *text)
{
    if (d->style == DIAG_JSON)
        json_message(d, severity, at, text);
    else
        text_message(d, severity, at, text);
}

static uint32_t hash_of(const char *text)
{
    uint32_t hash = 2166136261u;

    for (; *text; text++)
        hash = (hash ^ (unsigned char)*text) * 16777619u;
    return hash;
}

/* Was the same shown for the same place?  A second error about the same words comes of the
 * first one; at the end of a text several things may be missed. */
static bool is_said(const struct diag *d, struct loc at, uint32_t hash, bool is_error)
{
    for (size_t i = 0; i < d->n_said; i++) {
        const struct said *s = &d->said[i];
        if (memcmp(&s->at, &at, sizeof at) == 0
            && (s->hash == hash || (is_error && s->is_error && at.begin != at.end)))
            return true;
    }
    return false;
}

static void remember(struct diag *d, struct loc at, uint32_t hash, bool is_error)
{
    d->said = arena_grow(d->sources->mem, d->said, d->n_said, &d->room_said, sizeof *d->said);
    d->said[d->n_said++] = (struct said) { at, hash, is_error };
}

static void add_context(struct diag *d)
{
    void (*context)(struct diag *, void *) = d->context;

    d->context = NULL;                  /* notes have none of their own */
    if (context)
        context(d, d->context_arg);
    d->context = context;
}

/* Is there room for one more? */
static bool may_show(struct diag *d, unsigned *shown, unsigned most, const char *what)
{
    if (++*shown == most + 1 && !d->quiet)
        message(d, SEVERITY_NOTE, (struct loc) { 0 }, what);
    return *shown <= most;
}

static bool shows_error(struct diag *d, struct loc at, uint32_t hash)
{
    d->full = d->full || d->errors > MOST_REPEATS;
    if (d->full || is_said(d, at, hash, true))
        return false;
    d->full = !may_show(d, &d->shown_errors, d->most_errors, "there are more errors: they are not shown");
    return !d->full;
}

static bool shows_warning(struct diag *d, struct loc at, uint32_t hash)
{
    return !d->quiet && !d->full && !is_said(d, at, hash, false)
        && may_show(d, &d->shown_warnings, d->most_warnings, "there are more warnings: they are not shown");
}

static void show(struct diag *d, enum severity severity, struct loc at, const char *text)
{
    message(d, severity, at, text);
    add_context(d);
}

void diag_error(struct diag *d, struct loc at, const char *format, ...)
{
    char text[MOST_TEXT];
    va_list args;

    d->errors++;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    uint32_t hash = hash_of(text);
    d->muted = !shows_error(d, at, hash);
    if (d->muted)
        return;
    remember(d, at, hash, true);
    show(d, SEVERITY_ERROR, at, text);
}

void diag_repeat(struct diag *d)
{
    d->full = d->full || ++d->errors > MOST_REPEATS;
    d->muted = true;
}

void diag_warning(struct diag *d, struct loc at, const char *format, ...)
{
    char text[MOST_TEXT];
    va_list args;

    d->warnings++;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    uint32_t hash = hash_of(text);
    d->muted = !shows_warning(d, at, hash);
    if (d->muted)
        return;
    remember(d, at, hash, false);
    show(d, SEVERITY_WARNING, at, text);
}

void diag_remark(struct diag *d, struct loc at, const char *text)
{
    d->warnings++;
    d->muted = d->quiet || d->full;
    if (!d->muted)
        show(d, SEVERITY_WARNING, at, text);
}

void diag_note(struct diag *d, struct loc at, const char *format, ...)
{
    char text[MOST_TEXT];
    va_list args;

    if (d->muted)
        return;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    message(d, SEVERITY_NOTE, at, text);
}

/* Scenes use few unsupported features: a plain list of them will do. */
void diag_unsupported(struct diag *d, struct loc at, const char *feature)
{
    for (size_t i = 0; i < d->n_once; i++)
        if (strcmp(d->once[i], feature) == 0)
            return;
    d->once = arena_grow(d->sources->mem, d->once, d->n_once, &d->room_once, sizeof *d->once);
    d->once[d->n_once++] = feature;
    if (d->strict)
        diag_error(d, at, "%s is not supported yet", feature);
    else
        diag_warning(d, at, "%s is not supported yet; ignored", feature);
}
