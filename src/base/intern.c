/* intern.c: equal bytes, equal value. */
#include "base/intern.h"

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
    for (; size > 0; key++, size--) {
        h = (h ^ *key) * 0x100000001b3;
        h ^= h >> 32;                   /* once: a second time would undo it */
    }
    return h;
}

/* Where there is, or would be, a key with this hash.  The hash stands in the slot,
 * so that other keys, which lie far apart, are not looked at. */
static struct intern_slot *find(const struct intern *t, uint64_t hash, const void *key, size_t size)
{
    size_t i = hash & (t->room - 1);

    while (t->slot[i].key && (t->slot[i].hash != hash || memcmp(t->slot[i].key, key, size)))
        i = (i + 1) & (t->room - 1);
    return &t->slot[i];
}

static struct intern_slot *free_slot(const struct intern *t, uint64_t hash)
{
    size_t i = hash & (t->room - 1);

    while (t->slot[i].key)
        i = (i + 1) & (t->room - 1);
    return &t->slot[i];
}

static void grow(struct intern *t, struct arena *mem)
{
    struct intern old = *t;

    t->room = old.room ? old.room * 2 : 16;
    t->slot = arena_array(mem, t->room, sizeof *t->slot);
    for (size_t i = 0; i < old.room; i++)
        if (old.slot[i].key)
            *free_slot(t, old.slot[i].hash) = old.slot[i];
}

/* A table with a limit forgets all at once: what comes again soon is found, and
 * what never does costs nothing. */
static void make_room(struct intern *t, struct arena *mem)
{
    if (t->most && t->n == t->most) {
        memset(t->slot, 0, t->room * sizeof *t->slot);
        t->n = 0;
    } else if (t->n * 2 >= t->room)
        grow(t, mem);
}

static const void *keep_key(struct intern *t, struct arena *mem, const void *key, size_t size)
{
    if (!t->most)
        return arena_copy(mem, key, size);
    if (!t->keys)
        t->keys = arena_array(mem, t->most, size);
    return memcpy(t->keys + t->n * size, key, size);
}

static struct intern_slot *slot_of(struct intern *t, struct arena *mem, const void *key, size_t size)
{
    uint64_t hash = hash_of(key, size);
    struct intern_slot *s = t->room ? find(t, hash, key, size) : NULL;

    if (s && s->key)
        return s;
    make_room(t, mem);
    s = free_slot(t, hash);
    *s = (struct intern_slot) { hash, keep_key(t, mem, key, size), NULL };
    t->n++;
    return s;
}

const void **intern_at(struct intern *t, struct arena *mem, const void *key, size_t size)
{
    return &slot_of(t, mem, key, size)->value;
}

const void *intern_copy(struct intern *t, struct arena *mem, const void *key, size_t size)
{
    return slot_of(t, mem, key, size)->key;
}
