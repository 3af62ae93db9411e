/* field.h: rows that say which words and values a block takes.
 *
 * A row stands for one member of a struct: its word, its type, where it is
 * kept, its range and a sentence of help.  Reserved words, argument parsing,
 * range errors, suggestions and the manual's word lists are computed from
 * the rows; the default is the value in the block's default struct. */
#ifndef RTC_FIELD_H
#define RTC_FIELD_H

#include <stddef.h>

enum field_type {
    FIELD_FLAG,         /* bool: a word without a value, or with an optional number (on, off) */
    FIELD_INT,          /* int, truncated */
    FIELD_NUM,          /* double */
    FIELD_NUM_OR_1,     /* double; 1 when no number follows ("metallic") */
    FIELD_DEGREES,      /* double, degrees */
    FIELD_POINT2,       /* double[2] */
    FIELD_POINT,        /* vec3: a point or direction; a number fills all three */
    FIELD_POINT4,       /* double[4] */
    FIELD_RGB,          /* rgb: colour without filter and transmit; a number is grey */
    FIELD_COLOUR,       /* colour with filter and transmit */
    FIELD_TEXT,         /* const char * */
    FIELD_CUSTOM,       /* the block's own code reads what follows */
    FIELD_IGNORED,      /* one number or none; has no effect on the picture */
};

struct field {
    const char *name;                   /* NULL ends a table; "" in a header argument */
    enum field_type type;
    size_t offset;                      /* of the member in its struct */
    double low, high;                   /* allowed range of every component; low > high: any */
    const char *help;                   /* one line, no final stop */
    const char *unsupported;            /* not NULL: parsed, named in a warning, no effect yet */
};

#define ANY 1, 0                        /* a range without limits */
#define FIELD_END { .name = NULL }

#endif
