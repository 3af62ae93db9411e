/* source.h: the texts that a scene is made of, and places in them. */
#ifndef RTC_SOURCE_H
#define RTC_SOURCE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/arena.h"

/* A range of bytes in one source; line and column are worked out only when
 * a message is printed. */
struct loc {
    uint32_t source;                    /* 0: nowhere (the command line) */
    uint32_t begin, end;
};

struct source {
    const char *path;                   /* as the user wrote or would write it */
    const char *text;                   /* two NULs follow the last byte */
    size_t size;
    struct loc included_at;             /* the #include that brought it; source 0 for the scene */
    uint32_t *line;                     /* offsets of line starts; made when first needed */
    size_t n_line;
};

struct sources {
    struct arena *mem;
    struct source **source;             /* [0] is unused */
    size_t n, room;
};

struct position { unsigned line, column; };     /* from 1; columns count bytes */

void sources_init(struct sources *s, struct arena *mem);

/* Adds a text that lives as long as the sources; returns its number. */
uint32_t source_add(struct sources *s, const char *path, const char *text, size_t size,
                    struct loc included_at);

/* Reads a whole file (or standard input for "-"); false with errno set.
 * EISDIR for a folder, EFBIG beyond limit bytes (0: 1 GiB). */
bool source_read(struct sources *s, const char *path, struct loc included_at, size_t limit,
                 uint32_t *number);

const struct source *source_at(const struct sources *s, uint32_t number);  /* NULL: nowhere */

/* Lines end with LF, CR LF, LF CR or a lone CR, as POV-Ray counts them. */
struct position source_position(const struct sources *s, uint32_t number, uint32_t offset);

/* The text of a line without its end; the pointer is into the source. */
const char *source_line(const struct sources *s, uint32_t number, unsigned line, size_t *length);

#endif
