/* share.h: which unions are placed more than once. */
#ifndef RTC_SHARE_H
#define RTC_SHARE_H

#include <stdint.h>

#include "scene/scene.h"

/* The children of a declared union; its copies point to the same. */
struct shared {
    const void *children;
    size_t n_leaf;                      /* below */
    size_t n_use;                       /* places that are worth looking at apart */
    bool is_endless;                    /* it, or what counts of it, has no bounds */
    bool has_look;                      /* some node below has a texture or interior of its own */
    bool lacks_texture, lacks_interior, lacks_interior_texture;
};

struct share {
    struct arena *mem;
    struct shared *table;
    size_t n, room;                     /* room: a power of two */
};

void share_init(struct share *s, const struct scene *scene, struct arena *mem);
const struct shared *share_find(const struct share *s, const struct object *o);
bool share_is_worth_it(const struct shared *s, bool is_csg);

#endif
