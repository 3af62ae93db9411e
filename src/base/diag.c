/* diag.c: messages with file:line:col, the source line and a caret. */
#include "base/diag.h"

#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

enum { WIDEST_LINE = 200 };

static const struct { const char *name, *colour; } severities[] = {
    [SEVERITY_NOTE] = { "note", "\033[1;36m" },
    [SEVERITY_WARNING] = { "warning", "\033[1;35m" },
    [SEVERITY_ERROR] = { "error", "\033[1;31m" },
};
static const char bold[] = "\033[1m", green[] = "\033[1;32m", plain[] = "\033[0m";

void diag_init(struct diag *d, struct sources *sources, FILE *out)
{
    *d = (struct diag) { .sources = sources, .out = out, .most_errors = 20 };
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
    struct position from = source_position(d->sources, at.source, at.begin);
    struct position to = source_position(d->sources, at.source, at.end);

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

/* Control characters and bytes that are no text would confuse a terminal. */
static void print_line(FILE *out, const char *line, size_t length)
{
    for (size_t i = 0; i < length; i++) {
        unsigned char c = (unsigned char)line[i];
        fputc(c == '\t' ? ' ' : c < 0x20 || c == 0x7f ? '?' : c, out);
    }
    fputc('\n', out);
}

static void show_source(struct diag *d, struct loc at)
{
    struct position from = source_position(d->sources, at.source, at.begin);
    size_t length, skip = 0;
    const char *line = source_line(d->sources, at.source, from.line, &length);
    size_t caret = from.column - 1, wide = at.end > at.begin ? at.end - at.begin : 1;

    if (caret > length)
        caret = length;
    if (caret > WIDEST_LINE / 2)
        skip = caret - WIDEST_LINE / 2;
    if (length - skip > WIDEST_LINE)
        length = skip + WIDEST_LINE;
    if (caret + wide > length)
        wide = length > caret ? length - caret : 1;
    fputs("  ", d->out);
    print_line(d->out, line + skip, length - skip);
    fprintf(d->out, "  %*s%s^", (int)(caret - skip), "", paint(d, green));
    for (size_t i = 1; i < wide; i++)
        fputc('~', d->out);
    fprintf(d->out, "%s\n", paint(d, plain));
}

static void text_message(struct diag *d, enum severity severity, struct loc at, const char *text)
{
    const struct source *src = source_at(d->sources, at.source);

    if (src) {
        struct position p = source_position(d->sources, at.source, at.begin);
        fprintf(d->out, "%s%s:%u:%u:%s ", paint(d, bold), src->path, p.line, p.column,
                paint(d, plain));
    } else
        fputs("rtc: ", d->out);
    fprintf(d->out, "%s%s:%s %s\n", paint(d, severities[severity].colour),
            severities[severity].name, paint(d, plain), text);
    if (src && d->style == DIAG_FULL)
        show_source(d, at);
}

/* A scene's own words must not steer the terminal. */
static void tame(char *text)
{
    for (; *text; text++)
        if (((unsigned char)*text < 0x20 && *text != '\n' && *text != '\t') || *text == 0x7f)
            *text = '?';
}

static void message(struct diag *d, enum severity severity, struct loc at, const char *format,
                    va_list args)
{
    char text[1024];

    vsnprintf(text, sizeof text, format, args);
    if (d->style != DIAG_JSON)
        tame(text);
    if (d->style == DIAG_JSON)
        json_message(d, severity, at, text);
    else
        text_message(d, severity, at, text);
}

static void add_context(struct diag *d)
{
    void (*context)(struct diag *, void *) = d->context;

    d->context = NULL;                  /* notes have none of their own */
    if (context)
        context(d, d->context_arg);
    d->context = context;
}

void diag_error(struct diag *d, struct loc at, const char *format, ...)
{
    va_list args;

    d->errors++;
    d->muted = d->full = d->errors > d->most_errors;
    if (d->muted)
        return;
    va_start(args, format);
    message(d, SEVERITY_ERROR, at, format, args);
    va_end(args);
    add_context(d);
}

void diag_warning(struct diag *d, struct loc at, const char *format, ...)
{
    va_list args;

    d->warnings++;
    d->muted = d->quiet || d->full;
    if (d->muted)
        return;
    va_start(args, format);
    message(d, SEVERITY_WARNING, at, format, args);
    va_end(args);
    add_context(d);
}

void diag_note(struct diag *d, struct loc at, const char *format, ...)
{
    va_list args;

    if (d->muted)
        return;
    va_start(args, format);
    message(d, SEVERITY_NOTE, at, format, args);
    va_end(args);
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
