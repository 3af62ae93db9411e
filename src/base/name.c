/* name.c: interned words. */
#include "base/name.h"

#include <ctype.h>
#include <stdbool.h>
#include <string.h>

enum { FIRST_ROOM = 1024, LONGEST_COMPARED = 64 };

void names_init(struct names *t, struct arena *mem)
{
    *t = (struct names) { .mem = mem, .room = FIRST_ROOM };
    t->slot = arena_array(mem, t->room, sizeof *t->slot);
}

/* FNV-1a, 32 bits. */
static uint32_t hash(const char *text, size_t length)
{
    uint32_t h = 2166136261u;

    for (size_t i = 0; i < length; i++)
        h = (h ^ (unsigned char)text[i]) * 16777619u;
    return h;
}

static size_t place(const struct names *t, const char *text, size_t length, uint32_t h)
{
    size_t i = h & (t->room - 1);

    while (t->slot[i] && !(t->slot[i]->hash == h && t->slot[i]->length == length
                           && memcmp(t->slot[i]->text, text, length) == 0))
        i = (i + 1) & (t->room - 1);
    return i;
}

static void grow(struct names *t)
{
    struct names old = *t;

    t->room *= 2;
    t->slot = arena_array(t->mem, t->room, sizeof *t->slot);
    for (size_t i = 0; i < old.room; i++)
        if (old.slot[i])
            t->slot[place(t, old.slot[i]->text, old.slot[i]->length, old.slot[i]->hash)]
                = old.slot[i];
}

struct name *name_find(const struct names *t, const char *text, size_t length)
{
    return t->slot[place(t, text, length, hash(text, length))];
}

struct name *name_intern(struct names *t, const char *text, size_t length)
{
    uint32_t h = hash(text, length);
    size_t i = place(t, text, length, h);

    if (t->slot[i])
        return t->slot[i];
    if (t->n * 2 >= t->room) {
        grow(t);
        i = place(t, text, length, h);
    }
    struct name *name = arena_alloc(t->mem, sizeof *name);
    *name = (struct name) { .text = arena_text(t->mem, text, length),
                            .length = (uint32_t)length, .hash = h };
    t->slot[i] = name;
    t->n++;
    return name;
}

static unsigned smallest(unsigned a, unsigned b, unsigned c)
{
    unsigned m = a < b ? a : b;

    return m < c ? m : c;
}

static unsigned change(char a, char b)
{
    if (a == b)
        return 0;
    return tolower((unsigned char)a) == tolower((unsigned char)b) ? 1 : 2;
}

/* Optimal string alignment distance; all costs doubled so that a change of
 * case can count half. */
unsigned name_distance(const char *a, const char *b, unsigned limit)
{
    size_t n = strlen(a), m = strlen(b);
    unsigned row[3][LONGEST_COMPARED + 1];

    if (n > LONGEST_COMPARED || m > LONGEST_COMPARED)
        return limit + 1;
    for (size_t j = 0; j <= m; j++)
        row[0][j] = (unsigned)j * 2;
    for (size_t i = 1; i <= n; i++) {
        unsigned *now = row[i % 3], *up = row[(i + 2) % 3], *up2 = row[(i + 1) % 3];
        now[0] = (unsigned)i * 2;
        for (size_t j = 1; j <= m; j++) {
            now[j] = smallest(up[j] + 2, now[j - 1] + 2, up[j - 1] + change(a[i - 1], b[j - 1]));
            bool swapped = i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1];
            if (swapped && up2[j - 2] + 2 < now[j])
                now[j] = up2[j - 2] + 2;
        }
    }
    return (row[n % 3][m] + 1) / 2;
}
