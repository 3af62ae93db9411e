/* message.c: what a scene says: #debug, #warning, #error.
 *
 * As in POV-Ray no line end is added, and text waits until its line is
 * complete; a last line without end is never shown. */
#include "lang/message.h"

#include <string.h>

#include "lang/eval.h"
#include "lang/frame.h"

enum { LINE_WIDTH = 80, LINE_ROOM = 20, DEBUG_MOST = 200, DEBUG_CUT = 156, TEXT_MOST = 160,
       TEXT_CUT = 124 };

/* Bytes of characters above 127 are shown as one space each. */
static size_t plain_text(const struct text *t, char *out)
{
    size_t n = 0;

    for (size_t i = 0; i < t->size; i++) {
        unsigned char c = (unsigned char)t->bytes[i];
        if (c < 0x80)
            out[n++] = (char)c;
        else if (c >= 0xc0)
            out[n++] = ' ';
    }
    out[n] = '\0';
    return n;
}

/* The longest part of a line that fits: up to the last space in the final
 * quarter, else all of the width. */
static size_t fold(const char *line, size_t n)
{
    if (n <= LINE_WIDTH)
        return n;
    for (size_t i = LINE_WIDTH; i > LINE_WIDTH - LINE_ROOM; i--)
        if (line[i] == ' ' || line[i] == '\t')
            return i;
    return LINE_WIDTH;
}

/* Shows all full lines; what is left moves to the start. */
static void print_full(FILE *out, char *line, size_t *n)
{
    while (*n > LINE_WIDTH) {
        size_t part = fold(line, *n);
        if (out)
            fprintf(out, "%.*s\n", (int)part, line);
        *n -= part;
        memmove(line, line + part, *n);
    }
}

/* Adds to a line that waits, and shows what is complete. */
static void add(struct lang *l, char **line, size_t *n, size_t *room, const char *text,
                FILE *out)
{
    for (; *text; text++) {
        *line = arena_grow(l->mem, *line, *n, room, 1);
        if (*text != '\n' && *text != '\r') {
            (*line)[(*n)++] = *text;
            if (*n > 2 * LINE_WIDTH)        /* too long to wait for its end */
                print_full(out, *line, n);
            continue;
        }
        print_full(out, *line, n);
        if (out)
            fprintf(out, "%.*s\n", (int)*n, *line);
        *n = 0;
    }
}

static char *cut(struct lang *l, const struct text *t, size_t most, size_t keep)
{
    char *text = arena_alloc(l->mem, t->size + 4);
    size_t n = plain_text(t, text);

    if (n > most)
        strcpy(text + keep, "...");
    return text;
}

static void trim(char *text)
{
    size_t n = strlen(text);

    while (n && (text[n - 1] == '\n' || text[n - 1] == ' '))
        text[--n] = '\0';
}

void message_say(struct lang *l, const struct ast *node)
{
    struct text t;

    if (!evaluate_text(l, node->right, "a text", &t))
        return;
    bool spoken = node->op == 'w' || node->op == 'e';
    char *text = cut(l, &t, spoken ? TEXT_MOST : DEBUG_MOST, spoken ? TEXT_CUT : DEBUG_CUT);
    if (node->op == 'e') {
        trim(text);
        diag_error(l->diag, node->at, "%s", text);
        l->stopped = true;
    } else if (lang_is_quiet(l))
        return;
    else if (node->op == 'w') {
        trim(text);
        diag_remark(l->diag, node->at, text);
    } else
        add(l, &l->debug_line, &l->n_debug, &l->room_debug, text, l->setup.debug);
}

void message_end(struct lang *l)
{
    if (l->setup.debug)
        fflush(l->setup.debug);
}
