/* arena.c: memory with one owner. */
#include <config.h>

#include "base/arena.h"

#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>

struct arena_block {
    struct arena_block *before;
    size_t size, used;                  /* bytes, this header included */
};

enum { ALIGN = 16, HEADER = (sizeof(struct arena_block) + 15) & ~15, FIRST_BLOCK = 1 << 14, LARGEST_STEP = 1 << 22,
       LARGE = 1 << 16 };

void arena_init(struct arena *a, struct budget *budget)
{
    *a = (struct arena) { .budget = budget };
}

static void fail(const struct arena *a, size_t limit)
{
    if (a->budget && a->budget->exceeded)
        a->budget->exceeded(limit);
    fputs("rtc: out of memory\n", stderr);
    exit(4);
}

static void fail_at_limit(const struct arena *a)
{
    fail(a, a->budget ? a->budget->limit : 0);
}

static void charge(struct arena *a, size_t size)
{
    if (!a->budget)
        return;
    size_t used = atomic_fetch_add(&a->budget->used, size) + size;
    if (a->budget->limit && used > a->budget->limit)
        fail_at_limit(a);
}

/* Zeroed.  Large blocks come from the system and go back to it when they end;
 * malloc would keep some of them. */
static struct arena_block *take(struct arena *a, size_t size)
{
    charge(a, size);
    void *b = size < LARGE ? calloc(1, size)
                           : mmap(NULL, size, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (!b || b == MAP_FAILED)
        fail(a, 0);
    *(struct arena_block *)b = (struct arena_block) { .size = size, .used = HEADER };
    return b;
}

static void give_back(struct arena *a, struct arena_block *b)
{
    if (a->budget)
        atomic_fetch_sub(&a->budget->used, b->size);
    if (b->size < LARGE)
        free(b);
    else
        munmap(b, b->size);
}

/* Blocks double, so that a small scene costs one page or four and a large
 * one few calls. */
static struct arena_block *new_block(struct arena *a, size_t need)
{
    size_t size = a->block ? a->block->size * 2 : FIRST_BLOCK;

    if (size > LARGEST_STEP)
        size = LARGEST_STEP;
    if (size < need)
        size = need;
    struct arena_block *b = take(a, size);
    b->before = a->block;
    a->block = b;
    return b;
}

void *arena_alloc_aligned(struct arena *a, size_t size, size_t align)
{
    if (size > SIZE_MAX / 4)
        fail_at_limit(a);
    struct arena_block *b = a->block;
    if (b) {
        uintptr_t at = ((uintptr_t)b + b->used + align - 1) & ~(uintptr_t)(align - 1);
        size_t used = at - (uintptr_t)b + size;
        if (used <= b->size) {
            b->used = used;
            return (void *)at;
        }
    }
    new_block(a, size + align + sizeof *b + ALIGN);
    return arena_alloc_aligned(a, size, align);
}

/* Blocks begin at a multiple of ALIGN, so that counting from there is enough. */
void *arena_alloc(struct arena *a, size_t size)
{
    struct arena_block *b = a->block;
    size_t from = b ? (b->used + ALIGN - 1) & ~(size_t)(ALIGN - 1) : 0;

    if (!b || from > b->size || size > b->size - from)
        return arena_alloc_aligned(a, size, ALIGN);
    b->used = from + size;
    return (char *)b + from;
}

void *arena_array(struct arena *a, size_t n, size_t size)
{
    size_t total;

    if (__builtin_mul_overflow(n, size, &total))
        fail_at_limit(a);
    return arena_alloc(a, total);
}

void *arena_copy(struct arena *a, const void *from, size_t size)
{
    void *to = arena_alloc(a, size);

    if (size)
        memcpy(to, from, size);
    return to;
}

char *arena_text(struct arena *a, const char *text, size_t length)
{
    char *copy = arena_alloc(a, length + 1);

    if (length)
        memcpy(copy, text, length);
    return copy;
}

char *arena_format(struct arena *a, const char *format, ...)
{
    va_list args, again;

    va_start(args, format);
    va_copy(again, args);
    int length = vsnprintf(NULL, 0, format, args);
    char *text = arena_alloc(a, (size_t)length + 1);
    vsnprintf(text, (size_t)length + 1, format, again);
    va_end(again);
    va_end(args);
    return text;
}

size_t arena_size(const struct arena *a)
{
    size_t size = 0;

    for (const struct arena_block *b = a->block; b; b = b->before)
        size += b->size;
    for (const struct arena_block *b = a->large; b; b = b->before)
        size += b->size;
    return size;
}

struct arena_mark arena_mark(const struct arena *a)
{
    return (struct arena_mark) { a->block, a->block ? a->block->used : 0, a->n_large };
}

static void drop_large(struct arena *a)
{
    struct arena_block *b = a->large;

    a->large = b->before;
    a->n_large--;
    give_back(a, b);
}

static void drop_block(struct arena *a)
{
    struct arena_block *b = a->block;

    a->block = b->before;
    give_back(a, b);
}

static void clear(struct arena_block *b, size_t from)
{
    if (b->used > from)
        memset((char *)b + from, 0, b->used - from);
    b->used = from;
}

/* A block of the usual size that was begun after the mark is kept, so that
 * the next round finds its memory at hand. */
void arena_recycle(struct arena *a, struct arena_mark mark)
{
    while (a->n_large > mark.n_large)
        drop_large(a);
    while (a->block != mark.block
           && (a->block->before != mark.block || a->block->size > LARGEST_STEP))
        drop_block(a);
    if (a->block)
        clear(a->block, a->block == mark.block ? mark.used : HEADER);
}

void arena_free(struct arena *a)
{
    while (a->large)
        drop_large(a);
    while (a->block)
        drop_block(a);
}

/* --- arrays that grow -------------------------------------------------------- */

/* A large array has a block of its own, which the system moves to where there
 * is more room without copying: no old copies are left behind. */
static void *new_large(struct arena *a, const void *items, size_t used, size_t size)
{
    struct arena_block *b = take(a, HEADER + size);

    b->before = a->large;
    a->large = b;
    a->n_large++;
    return used ? memcpy((char *)b + HEADER, items, used) : (char *)b + HEADER;
}

static void *grow_large(struct arena *a, struct arena_block **at, size_t size)
{
    size += HEADER;
    charge(a, size - (*at)->size);
    struct arena_block *b = mremap(*at, (*at)->size, size, MREMAP_MAYMOVE);
    if (b == MAP_FAILED)
        fail(a, 0);
    b->size = size;
    *at = b;
    return (char *)b + HEADER;
}

static struct arena_block **find_large(struct arena *a, const void *items)
{
    struct arena_block **at = &a->large;

    while (*at && (char *)*at + HEADER != items)
        at = &(*at)->before;
    return at;
}

void *arena_grow(struct arena *a, void *items, size_t n, size_t *room, size_t size)
{
    size_t bytes;

    if (n < *room)
        return items;
    *room = *room ? *room * 2 : 8;
    if (__builtin_mul_overflow(*room, size, &bytes) || bytes > SIZE_MAX / 4)
        fail_at_limit(a);
    if (bytes >= LARGE) {
        struct arena_block **known = find_large(a, items);
        return *known ? grow_large(a, known, bytes) : new_large(a, items, n * size, bytes);
    }
    void *more = arena_alloc(a, bytes);
    if (n)
        memcpy(more, items, n * size);
    return more;
}

void arena_drop(struct arena *a, void *items)
{
    struct arena_block **known = find_large(a, items), *b = *known;

    if (!b)
        return;
    *known = b->before;
    a->n_large--;
    give_back(a, b);
}

/* What cannot be made smaller stays as large as it is. */
static struct arena_block *cut_large(struct arena *a, struct arena_block *b, size_t size)
{
    struct arena_block *cut = size < LARGE ? MAP_FAILED : mremap(b, b->size, size, MREMAP_MAYMOVE);

    if (cut == MAP_FAILED)
        return b;
    if (a->budget)
        atomic_fetch_sub(&a->budget->used, cut->size - size);
    cut->size = size;
    return cut;
}

void *arena_take(struct arena *to, struct arena *from, void *items, size_t n, size_t size)
{
    struct arena_block **known = find_large(from, items), *b = *known;

    if (!b)
        return arena_copy(to, items, n * size);
    *known = b->before;
    from->n_large--;
    b = cut_large(to, b, HEADER + n * size);
    b->before = to->large;
    to->large = b;
    to->n_large++;
    return (char *)b + HEADER;
}
