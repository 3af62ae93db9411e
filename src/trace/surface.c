/* surface.c: looks become numbers: equal ones the same. */
#include "trace/surface.h"

#include <string.h>

#include "trace/shader.h"
#include "trace/sky.h"

static struct shader *shader_of(struct plan *p)
{
    if (!p->shader)
        p->shader = arena_alloc(p->mem, sizeof *p->shader);
    return (struct shader *)p->shader;          /* const for all but its builder */
}

static bool is_plain(const struct texture *t)
{
    return t->kind == TEXTURE_PLAIN && !t->above && t->pigment->kind == PIGMENT_COLOUR;
}

static const struct gloss *gloss_of(struct plan *p, const struct finish *f)
{
    struct shader *s = shader_of(p);
    const void **known = intern_at(&s->finish, p->mem, &f, sizeof f);

    if (!*known) {
        const struct gloss *g = gloss_new(p->mem, &p->scene->settings, f);
        *known = intern_copy(&s->gloss, p->mem, g, sizeof *g);
    }
    return *known;
}

/* Surfaces with one colour and the same gloss are shaded together, but for
 * those that can be seen through. */
static uint32_t plain_group(struct plan *p, const struct gloss *g, bool can_transmit)
{
    struct { const struct gloss *gloss; uint64_t can_transmit; } key = { g, can_transmit };
    struct shader *s = shader_of(p);
    const void **one = intern_at(&s->group, p->mem, &key, sizeof key);

    if (!*one) {
        *one = arena_copy(p->mem, &s->n_group, sizeof s->n_group);
        s->n_group++;
    }
    return *(const uint32_t *)*one;
}

static const struct program *plain_program(struct plan *p, const struct texture *t)
{
    struct { colour colour; const struct gloss *gloss; } key;
    struct shader *s = shader_of(p);

    memset(&key, 0, sizeof key);
    key.colour = t->pigment->colour;
    key.gloss = gloss_of(p, t->finish);
    const void **one = intern_at(&s->plain, p->mem, &key, sizeof key);
    if (!*one) {
        struct program *made = program_plain(p->mem, t->pigment, key.gloss);
        made->group = plain_group(p, key.gloss, made->can_transmit);
        s->n_program++;
        *one = made;
    }
    return *one;
}

static void mark_groups(struct shader *s, struct program *made)
{
    made->group = s->n_group++;
    s->n_program++;
}

static const struct program *program_of(struct plan *p, const struct texture *t,
                                        const struct transform *place)
{
    struct { const struct texture *texture; struct transform place; } key;
    struct shader *s = shader_of(p);

    if (!t)
        return NULL;
    if (is_plain(t))
        return plain_program(p, t);
    memset(&key, 0, sizeof key);
    key.texture = t;
    memcpy(&key.place.to, &place->to, sizeof place->to);
    const void **one = intern_at(&s->program, p->mem, &key, sizeof key);
    if (!*one) {
        struct program *made = program_new(p->mem, &p->scene->settings, t, place);
        mark_groups(s, made);
        *one = made;
    }
    return *one;
}

static const struct program **face_programs(struct plan *p, const struct look *look)
{
    const struct mesh *m = look->mesh;
    const struct program **face = arena_array(p->mem, m->n_texture, sizeof *face);

    for (size_t i = 0; i < m->n_texture; i++)
        face[i] = program_of(p, m->texture[i], look->place);
    shader_of(p)->has_face_textures = true;
    return face;
}

/* The finish's old word for it overrides the interior's; shading.md 3.3. */
static const struct interior *interior_of(struct plan *p, const struct look *look)
{
    const struct texture *t = look->texture;

    if (t->kind != TEXTURE_PLAIN || !(t->finish->ior > 0))
        return look->interior;
    struct interior in = look->interior ? *look->interior : interior_default;
    in.ior = t->finish->ior;
    return arena_copy(p->mem, &in, sizeof in);
}

static void note_use(struct plan *p, const struct surface *s)
{
    const struct program *side[] = { s->program, s->interior_program };

    for (int i = 0; i < 2; i++) {
        if (!side[i])
            continue;
        p->has_reflection |= side[i]->has_mirror;
        p->has_refraction |= side[i]->can_transmit;
    }
    p->has_transparency |= !s->is_opaque;
    shader_of(p)->has_interior |= s->interior != NULL;
    shader_of(p)->has_fading |= s->interior && fabs(s->interior->fade_distance) > 0;
    shader_of(p)->has_double |= s->double_illuminate;
}

static bool faces_want_uv(const struct look *look, const struct program *const *face)
{
    for (size_t i = 0; face && i < look->mesh->n_texture; i++)
        if (face[i]->wants_uv)
            return true;
    return false;
}

static bool faces_transmit(const struct look *look, const struct program *const *face)
{
    for (size_t i = 0; face && i < look->mesh->n_texture; i++)
        if (face[i]->can_transmit)
            return true;
    return false;
}

/* What tells surfaces apart once their textures are programs. */
struct surface_key {
    const struct program *program, *interior_program;
    const void *mesh, *interior, *solid;
    const struct finish *old_words;     /* finish { ior }: an interior of its own */
    bool double_illuminate, hollow, uv_mapping;
};

/* No more than its program?  Most are, and the program knows them. */
static bool is_lone(const struct surface_key *k)
{
    return !k->interior_program && !k->mesh && !k->interior && !k->solid && !k->old_words
           && !k->double_illuminate && !k->hollow && !k->uv_mapping;
}

static bool has_caustics(const struct surface *s)
{
    return s->interior && s->interior->caustics != 0;
}

/* Which program shades a point: is it the same one on both sides, all over? */
static void choose_group(struct plan *p, struct surface *s)
{
    bool is_one = !s->interior_program && !s->program->face;

    s->is_mixed = !is_one;
    s->group = is_one ? s->program->group : shader_of(p)->n_group++;
    s->is_even = is_one && s->program->is_plain && !has_caustics(s);
}

static uint32_t add_surface(struct plan *p, const struct look *look,
                            const struct surface_key *key)
{
    struct shader *s = shader_of(p);
    const struct program **face = NULL;
    struct program *whole = NULL;

    p->surface = arena_grow(p->mem, p->surface, p->n_surface, &s->room_surface,
                            sizeof *p->surface);
    if (look->mesh && look->mesh->n_texture) {
        face = face_programs(p, look);
        whole = arena_copy(p->mem, key->program, sizeof *whole);
        whole->face = face;
    }
    struct surface *made = &p->surface[p->n_surface];
    *made = (struct surface) {
        .texture = look->texture, .interior_texture = look->interior_texture,
        .interior = interior_of(p, look), .solid = look->solid,
        .double_illuminate = look->double_illuminate, .hollow = look->hollow,
        .uv_mapping = look->uv_mapping,
        .wants_uv = look->uv_mapping || key->program->wants_uv || faces_want_uv(look, face)
                    || (key->interior_program && key->interior_program->wants_uv),
        .program = whole ? whole : key->program, .interior_program = key->interior_program,
        .is_opaque = !key->program->can_transmit
                     && !(key->interior_program && key->interior_program->can_transmit)
                     && !faces_transmit(look, face),
    };
    choose_group(p, made);
    note_use(p, made);
    return (uint32_t)p->n_surface++;
}

/* An object-level uv_mapping puts the whole texture into uv space, where the
 * object's own place means nothing. */
static const struct transform *texture_room(const struct look *look)
{
    return look->uv_mapping ? &transform_identity : look->place;
}

static uint32_t lone_surface(struct plan *p, const struct look *look, const struct surface_key *key)
{
    struct program *program = (struct program *)key->program;   /* const for all but its builder */

    if (!program->lone)
        program->lone = 1 + add_surface(p, look, key);
    return program->lone - 1;
}

uint32_t surface_of(struct plan *p, const struct look *look)
{
    struct shader *s = shader_of(p);
    struct surface_key key;

    memset(&key, 0, sizeof key);
    key.program = program_of(p, look->texture, texture_room(look));
    key.interior_program = program_of(p, look->interior_texture, texture_room(look));
    key.interior = look->interior;
    key.mesh = look->mesh && look->mesh->n_texture ? look->mesh : NULL;
    key.double_illuminate = look->double_illuminate;
    key.hollow = look->hollow;
    key.uv_mapping = look->uv_mapping;
    if (look->texture->kind == TEXTURE_PLAIN && look->texture->finish->ior > 0)
        key.old_words = look->texture->finish;
    /* Which solid it is matters to rays inside of it only. */
    bool can_enter = look->interior || key.mesh || key.old_words || key.program->can_transmit
                     || (key.interior_program && key.interior_program->can_transmit);
    key.solid = can_enter ? look->solid : NULL;
    if (is_lone(&key))
        return lone_surface(p, look, &key);
    const void **one = intern_at(&s->surface, p->mem, &key, sizeof key);
    if (!*one) {
        uint32_t number = add_surface(p, look, &key);
        *one = arena_copy(p->mem, &number, sizeof number);
    }
    return *(const uint32_t *)*one;
}

/* ---- lights and notes ---- */

static void add_lamps(struct plan *p)
{
    struct shader *s = shader_of(p);
    struct lamp *lamp = arena_array(p->mem, p->n_light, sizeof *lamp);

    for (size_t i = 0; i < p->n_light; i++) {
        lamp[i] = lamp_of(&p->light[i]);
        p->has_shadows |= !lamp[i].shadowless;
    }
    s->lamp = lamp;
    s->n_lamp = p->n_light;
}

static int tally_of(struct plan *p, const struct program *program)
{
    int k = 0;

    while (k < p->n_tally && p->tally[k] != program)
        k++;
    if (k == p->n_tally && k < PLAN_TALLIES)
        p->tally[p->n_tally++] = program;
    return k;
}

/* A mesh may be crossed more often than is found at once. */
static bool is_clear_mesh(const struct plan *p, const struct leaf *l)
{
    return !l->ops && (l->surface == NO_LEAF || !p->surface[l->surface].is_opaque);
}

static void make_tallies(struct plan *p)
{
    bool can = !p->shader->has_fading;

    for (size_t i = 0; i < p->n_surface && can; i++) {
        struct surface *s = &p->surface[i];
        int k = s->is_opaque ? 0 : tally_of(p, s->program);
        can = s->is_opaque || (s->is_even && k < PLAN_TALLIES);
        s->tally = (uint8_t)k;
    }
    for (size_t i = 0; i < p->n_leaf && can && p->n_tally; i++)
        can = !is_clear_mesh(p, &p->leaf[i]);
    if (!can)
        p->n_tally = 0;
}

static void left_out(struct plan *p, bool used, const char *stage)
{
    if (!used)
        plan_note(p, "%s: left out, nothing in the scene needs it", stage);
}

void shader_build(struct plan *p)
{
    struct shader *s = shader_of(p);

    add_lamps(p);
    s->sky = sky_new(p->mem, p->scene);
    make_tallies(p);
    plan_note(p, "looks: %zu surfaces, %zu texture programs in %u groups that are shaded together",
              p->n_surface, s->n_program, s->n_group);
    plan_note(p, "lights: %zu", s->n_lamp);
    left_out(p, p->scene->sky_sphere, "sky");
    left_out(p, p->scene->n_fog > 0, "fog");
    left_out(p, p->has_shadows, "shadow rays");
    left_out(p, p->has_transparency, "light through transparent objects");
    left_out(p, p->has_refraction, "refracted rays");
    left_out(p, p->has_reflection, "reflected rays");
    left_out(p, s->has_face_textures, "textures of single mesh faces");
}
