/* intern.c: equal bytes, equal value. */
#include "trace/intern.h"

#include <stdint.h>
#include <string.h>

/* FNV-1a */
static uint64_t hash_of(const unsigned char *key, size_t size)
{
    uint64_t h = 0xcbf29ce484222325;

    for (size_t i = 0; i < size; i++)
        h = (h ^ key[i]) * 0x100000001b3;
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

const void **intern_at(struct intern *t, struct arena *mem, const void *key, size_t size)
{
    if (t->n * 2 >= t->room)
        grow(t, mem, size);
    struct intern_slot *s = find(t, key, size);
    if (!s->key) {
        s->key = arena_copy(mem, key, size);
        t->n++;
    }
    return &s->value;
}
