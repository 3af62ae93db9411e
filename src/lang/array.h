/* array.h: arrays and their elements.
 *
 * Values never change once made, so an array is copied when an element is
 * assigned, unless the variable that is assigned to owns it alone. */
#ifndef RTC_ARRAY_H
#define RTC_ARRAY_H

#include "lang/state.h"

enum { ARRAY_MOST_DIMENSIONS = 5 };

struct array {
    int n_dimension;
    size_t size[ARRAY_MOST_DIMENSIONS];
    size_t n;                           /* items in all */
    struct value *item;                 /* VALUE_NONE: never set */
    struct value like;                  /* its type is that of all items; VALUE_NONE: none was set yet */
    const struct value *owner;          /* the variable that alone refers to it, or NULL */
};

int array_dimensions(const void *array);
size_t array_size(const void *array, int dimension);    /* from 1; 0: there is none */

/* `array[3][2] { ... }` */
bool array_make(struct lang *l, const struct ast *node, struct value *out);

/* The element that NAME [i] [j] means, for reading; NULL: reported, or when
 * quiet, no such. */
const struct value *array_item(struct lang *l, const struct ast *node, bool quiet);

/* The place that a name or an element is kept in, to be written; NULL: reported. */
struct value *array_place(struct lang *l, const struct ast *node);

/* NAME [i] [j] = v */
void array_assign(struct lang *l, const struct ast *node, const struct value *v);

/* #undef NAME [i] [j] */
void array_undef(struct lang *l, const struct ast *node);

/* Is a name, or an element, declared? */
bool array_is_defined(struct lang *l, const struct ast *node);

/* A value that is copied is shared from now on. */
void value_keep(struct value *v);

#endif
