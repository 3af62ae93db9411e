/* arena.h: memory with one owner; a stage ends with one arena_free. */
#ifndef RTC_ARENA_H
#define RTC_ARENA_H

#include <stdatomic.h>
#include <stddef.h>

/* How much all arenas together may hold.  When an allocation would exceed
 * the limit, exceeded(limit) is called, when the system has no more,
 * exceeded(0); it must not return: running out of memory is a limit reached, never a NULL. */
struct budget {
    _Atomic size_t used;                /* bytes */
    size_t limit;                       /* bytes; 0: none */
    void (*exceeded)(size_t limit);
};

struct arena {
    struct budget *budget;              /* may be NULL: nothing is counted */
    struct arena_block *block;
    struct arena_block *large;          /* arrays that grow, each in its own */
    size_t n_large;
};

void arena_init(struct arena *a, struct budget *budget);
void *arena_alloc(struct arena *a, size_t size);    /* zeroed, 16-byte aligned; never NULL */
void *arena_alloc_aligned(struct arena *a, size_t size, size_t align);  /* a power of two */
void *arena_array(struct arena *a, size_t n, size_t size);  /* n * size, overflow checked */
void *arena_copy(struct arena *a, const void *from, size_t size);
char *arena_text(struct arena *a, const char *text, size_t length);    /* with a final NUL */
char *arena_format(struct arena *a, const char *format, ...)
    __attribute__((format(printf, 2, 3)));
size_t arena_size(const struct arena *a);           /* bytes taken from the system */
void arena_free(struct arena *a);                   /* everything; the arena may be used again */

/* A place to go back to: what was made after the mark is given up and its memory
 * used again. */
struct arena_mark {
    struct arena_block *block;
    size_t used, n_large;
};
struct arena_mark arena_mark(const struct arena *a);
void arena_recycle(struct arena *a, struct arena_mark mark);

/* Grows the array *items of *room items of the given size so that one more
 * fits behind n; the old copy of a small array stays in the arena until it ends. */
void *arena_grow(struct arena *a, void *items, size_t n, size_t *room, size_t size);

/* An array that grew and is needed no more; memory comes back if it was large. */
void arena_drop(struct arena *a, void *items);

/* n items that grew in from become to's and grow no more.  A large array is not
 * copied but given over, without what it does not use. */
void *arena_take(struct arena *to, struct arena *from, void *items, size_t n, size_t size);

#endif
