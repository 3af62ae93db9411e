/* source.c: the texts that a scene is made of. */
#include "base/source.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

enum { READ_STEP = 1 << 16 };
static const size_t default_limit = (size_t)1 << 30;

void sources_init(struct sources *s, struct arena *mem)
{
    *s = (struct sources) { .mem = mem, .n = 1 };
    s->source = arena_grow(mem, NULL, 0, &s->room, sizeof *s->source);
}

uint32_t source_add(struct sources *s, const char *path, const char *text, size_t size,
                    struct loc included_at)
{
    struct source *src = arena_alloc(s->mem, sizeof *src);

    *src = (struct source) { .path = path, .text = text, .size = size,
                             .included_at = included_at };
    s->source = arena_grow(s->mem, s->source, s->n, &s->room, sizeof *s->source);
    s->source[s->n] = src;
    return (uint32_t)s->n++;
}

/* Reads in growing steps: the size of a pipe is not known beforehand. */
static char *slurp(struct arena *mem, FILE *f, size_t expected, size_t limit, size_t *size)
{
    size_t room = expected + READ_STEP;
    char *text = arena_alloc(mem, room + 2);

    for (*size = 0;;) {
        size_t got = fread(text + *size, 1, room - *size, f);
        *size += got;
        if (*size > limit) {
            errno = EFBIG;
            return NULL;
        }
        if (*size < room)
            break;
        char *more = arena_alloc(mem, room * 2 + 2);
        memcpy(more, text, *size);
        text = more;
        room *= 2;
    }
    if (ferror(f))
        return NULL;
    text[*size] = text[*size + 1] = '\0';
    return text;
}

bool source_read(struct sources *s, const char *path, struct loc included_at, size_t limit,
                 uint32_t *number)
{
    bool standard_input = strcmp(path, "-") == 0;
    FILE *f = standard_input ? stdin : fopen(path, "rb");
    struct stat st;
    size_t size = 0;

    if (!f)
        return false;
    if (fstat(fileno(f), &st) == 0 && S_ISDIR(st.st_mode)) {
        fclose(f);
        errno = EISDIR;
        return false;
    }
    size_t most = limit ? limit : default_limit;
    size_t expected = S_ISREG(st.st_mode) && (size_t)st.st_size < most ? (size_t)st.st_size : 0;
    char *text = slurp(s->mem, f, expected, most, &size);
    int error = errno;
    if (!standard_input)
        fclose(f);
    errno = error;
    if (!text)
        return false;
    const char *shown = standard_input ? "<stdin>" : arena_text(s->mem, path, strlen(path));
    *number = source_add(s, shown, text, size, included_at);
    return true;
}

const struct source *source_at(const struct sources *s, uint32_t number)
{
    return number && number < s->n ? s->source[number] : NULL;
}

/* Calls for each line start; CR LF and LF CR are one end each. */
static size_t list_lines(const struct source *src, uint32_t *line)
{
    size_t n = 0;

    if (line)
        line[n] = 0;
    n++;
    for (size_t i = 0; i < src->size; i++) {
        char c = src->text[i];
        if (c != '\n' && c != '\r')
            continue;
        char next = i + 1 < src->size ? src->text[i + 1] : '\0';
        if ((next == '\n' || next == '\r') && next != c)
            i++;
        if (line)
            line[n] = (uint32_t)i + 1;
        n++;
    }
    return n;
}

static void index_lines(const struct sources *s, struct source *src)
{
    src->n_line = list_lines(src, NULL);
    src->line = arena_array(s->mem, src->n_line, sizeof *src->line);
    list_lines(src, src->line);
}

static struct source *indexed(const struct sources *s, uint32_t number)
{
    if (!number || number >= s->n)
        return NULL;
    struct source *src = s->source[number];
    if (!src->line)
        index_lines(s, src);
    return src;
}

struct position source_position(const struct sources *s, uint32_t number, uint32_t offset)
{
    const struct source *src = indexed(s, number);
    size_t low = 0;

    if (!src)
        return (struct position) { 0, 0 };
    for (size_t high = src->n_line; high - low > 1;) {
        size_t middle = (low + high) / 2;
        if (src->line[middle] <= offset)
            low = middle;
        else
            high = middle;
    }
    return (struct position) { (unsigned)low + 1, offset - src->line[low] + 1 };
}

const char *source_line(const struct sources *s, uint32_t number, unsigned line, size_t *length)
{
    const struct source *src = indexed(s, number);

    *length = 0;
    if (!src || line < 1 || line > src->n_line)
        return "";
    const char *begin = src->text + src->line[line - 1];
    const char *end = src->text + src->size;
    while (begin + *length < end && begin[*length] != '\r' && begin[*length] != '\n')
        ++*length;
    return begin;
}
