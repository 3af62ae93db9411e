/* surface.h: textures as short programs, evaluated for arrays of points. */
#ifndef RTC_SURFACE_H
#define RTC_SURFACE_H

#include "trace/geometry.h"
#include "trace/plan.h"

/* The number of the surface with this look, made if it is new.  object: the
 * leaf's node in the scene; textures and interior already inherited; place:
 * world from the space in which the texture's place ends. */
struct look {
    const struct texture *texture, *interior_texture;
    const struct transform *place;
    const struct interior *interior;
    const void *solid;
    bool double_illuminate, hollow, uv_mapping;
    uint32_t object_flags;
    const struct mesh *mesh;            /* its face textures belong to the look too */
};
uint32_t surface_of(struct plan *p, const struct look *look);

/* Prepares plan->shader from plan->light and the surfaces, and notes for
 * --explain what shading leaves out.  After geometry_build; once. */
void shader_build(struct plan *p);

#endif
