/* intern.c: equal bytes, equal value. */
#include "base/intern.h"

#include <stdint.h>
#include <string.h>

/* FNV-1a with words of eight bytes, whose upper bits are brought down. */
static uint64_t hash_of(const unsigned char *key, size_t size)
{
    uint64_t h = 0xcbf29ce484222325, word = 0;

    for (; size >= sizeof word; key += sizeof word, size -= sizeof word) {
        memcpy(&word, key, sizeof word);
        h = (h ^ word) * 0x9e3779b97f4a7c15;
        h ^= h >> 32;
    }
    for (; size > 0; key++, size--)
        h = (h ^ *key) * 0x100000001b3;
    return h ^ h >> 32;
}

static struct intern_slot *find(const struct intern *t, const void *key, size_t size)
{
    size_t i = hash_of(key, size) & (t->room - 1);

    while (t->slot[i].key && memcmp(t->slot[i].key, key, size))
        i = (i + 1) & (t->room - 1);
    return &t->slot[i];
}

static void grow(struct intern *t, struct arena *mem, size_t size)
{
    struct intern old = *t;

    t->room = old.room ? old.room * 2 : 16;
    t->slot = arena_array(mem, t->room, sizeof *t->slot);
    for (size_t i = 0; i < old.room; i++)
        if (old.slot[i].key)
            *find(t, old.slot[i].key, size) = old.slot[i];
}

struct intern_slot *intern_slot(struct intern *t, struct arena *mem, const void *key, size_t size)
{
    if (t->n * 2 >= t->room)
        grow(t, mem, size);
    struct intern_slot *s = find(t, key, size);
    if (!s->key) {
        s->key = arena_copy(mem, key, size);
        t->n++;
    }
    return s;
}

const void **intern_at(struct intern *t, struct arena *mem, const void *key, size_t size)
{
    return &intern_slot(t, mem, key, size)->value;
}

const void *intern_copy(struct intern *t, struct arena *mem, const void *key, size_t size)
{
    return intern_slot(t, mem, key, size)->key;
}
