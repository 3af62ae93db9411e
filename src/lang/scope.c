/* scope.c: which value a name has where.
 *
 * name->slot is the innermost binding, so a look-up costs one load; closing a
 * scope uncovers what its bindings hid. */
#include "lang/scope.h"

#include <string.h>

#include "lang/eval.h"

unsigned scope_open(struct lang *l)
{
    if (!l->scope)              /* scope[0] stands for the global one */
        l->scope = arena_grow(l->mem, NULL, 0, &l->room_scope, sizeof *l->scope);
    l->scope = arena_grow(l->mem, l->scope, l->n_scope + 1, &l->room_scope, sizeof *l->scope);
    l->scope[++l->n_scope] = NULL;
    return l->n_scope;
}

static void unlink_binding(struct binding *b)
{
    struct binding **at = (struct binding **)&b->name->slot;

    while (*at && *at != b)
        at = &(*at)->outer;
    if (*at)
        *at = b->outer;
}

void scope_close(struct lang *l)
{
    for (struct binding *b = l->scope[l->n_scope], *next; b; b = next) {
        next = b->sibling;
        unlink_binding(b);
        b->sibling = l->spare;
        l->spare = b;
    }
    l->n_scope--;
}

static struct binding *binding_new(struct lang *l, struct name *name, unsigned scope,
                                   struct loc at)
{
    struct binding *b = l->spare;

    if (b)
        l->spare = b->sibling;
    else
        b = arena_alloc(l->mem, sizeof *b);
    b->own.type = VALUE_NONE;
    b->name = name;
    b->value = &b->own;
    b->outer = b->sibling = NULL;
    b->scope = scope;
    b->deprecated = NULL;
    b->warn_once = b->is_broken = false;
    b->at = at;
    if (scope) {
        b->sibling = l->scope[scope];
        l->scope[scope] = b;
    }
    return b;
}

static struct binding *innermost(struct lang *l, struct name *name, struct loc at)
{
    struct binding *b = binding_new(l, name, l->n_scope, at);

    b->outer = name->slot;
    name->slot = b;
    return b;
}

static struct binding *global(struct lang *l, struct name *name, struct loc at)
{
    struct binding **place = (struct binding **)&name->slot;

    while (*place && (*place)->scope)
        place = &(*place)->outer;
    if (!*place)
        *place = binding_new(l, name, 0, at);
    return *place;
}

struct binding *scope_declare(struct lang *l, struct name *name, bool local, struct loc at)
{
    struct binding *b = name->slot;

    if (b && (!local || b->scope == l->n_scope))
        return b;
    return local ? innermost(l, name, at) : global(l, name, at);
}

void scope_declare_broken(struct lang *l, struct name *name, struct loc at)
{
    if (scope_find(name))
        return;
    struct binding *b = global(l, name, at);
    harmless(b->value);
    b->is_broken = true;
}

struct binding *scope_declare_global(struct lang *l, struct name *name, struct loc at)
{
    return global(l, name, at);
}

struct binding *scope_parameter(struct lang *l, struct name *name, struct value *refers,
                                struct loc at)
{
    struct binding *b = innermost(l, name, at);

    if (refers)
        b->value = refers;
    return b;
}

void scope_undef(struct lang *l, struct name *name)
{
    struct binding *b = name->slot;

    (void)l;
    if (b)
        name->slot = b->outer;
}

bool scope_is_outer(const struct lang *l, const struct binding *b, unsigned scope)
{
    (void)l;
    return b->scope < scope;
}

const struct binding *lang_binding(const struct lang *l, const char *name)
{
    struct name *n = name_find(&l->names, name, strlen(name));

    return n ? n->slot : NULL;
}

const struct value *lang_value(const struct lang *l, const char *name)
{
    const struct binding *b = lang_binding(l, name);

    return b ? b->value : NULL;
}
