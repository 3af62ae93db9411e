/* scene.c: all that the user described, gathered. */
#include "scene/scene.h"

const struct settings settings_default = {
    .version = 370, .effective_version = 362,
    .space = SPACE_RAW, .gamma = 1,
    .max_trace_level = 5,
    .adc_bailout = 1.0 / 255,
    .ambient_light = { 1, 1, 1 },
    .irid_wavelength = { 0.70f, 0.52f, 0.48f },
    .noise_generator = 2, .number_of_waves = 10,
};

#define MEMBER(m) offsetof(struct settings, m)

const struct field settings_fields[] = {
    { "assumed_gamma", FIELD_CUSTOM, MEMBER(gamma), ANY, "what the scene's colours mean: a number or srgb" },
    { "max_trace_level", FIELD_CUSTOM, MEMBER(max_trace_level), ANY, "reflections and refractions in a row" },
    { "adc_bailout", FIELD_NUM, MEMBER(adc_bailout), ANY, "rays that matter less are not followed" },
    { "ambient_light", FIELD_RGB, MEMBER(ambient_light), ANY, "light from everywhere" },
    { "irid_wavelength", FIELD_RGB, MEMBER(irid_wavelength), ANY, "wavelengths of irid" },
    { "number_of_waves", FIELD_INT, MEMBER(number_of_waves), ANY, "sources of waves and ripples" },
    { "noise_generator", FIELD_INT, MEMBER(noise_generator), 1, 3, "which noise patterns use" },
    { "charset", FIELD_CUSTOM, 0, ANY, "of texts: ascii, utf8 or sys" },
    { "mm_per_unit", FIELD_IGNORED, 0, ANY, "millimetres in a unit, for subsurface" },
    { "max_intersections", FIELD_INT, MEMBER(max_intersections), ANY, "read, but not needed" },
    { "hf_gray_16", FIELD_IGNORED, 0, ANY, "read, but not needed" },
    { "subsurface", FIELD_CUSTOM, 0, ANY, "light below surfaces", "subsurface" },
    { "radiosity", FIELD_CUSTOM, 0, ANY, "light between surfaces", "radiosity" },
    { "photons", FIELD_CUSTOM, 0, ANY, "light through and off shiny things", "photons" },
    FIELD_END,
};

void scene_init(struct scene *s, struct arena *mem)
{
    *s = (struct scene) { .mem = mem, .settings = settings_default };
    camera_solve(&camera_default, &s->camera);
}

void scene_add_light(struct scene *s, const struct light *l)
{
    s->light = arena_grow(s->mem, s->light, s->n_light, &s->room_light, sizeof *s->light);
    s->light[s->n_light++] = *l;
}

static struct object *moved_copy(struct arena *mem, const struct object *o,
                                 const struct transform *t)
{
    struct object *copy = object_copy(mem, o);

    object_move(mem, copy, t);
    return copy;
}

/* Lights shine wherever they stand in an object; place: world from o's outer space. */
static void add_lights(struct scene *s, const struct object *o, const struct transform *place)
{
    if (o->kind != OBJECT_LIGHT && o->n_child == 0)
        return;
    struct transform inner = transform_compose(place, o->place);
    if (o->kind == OBJECT_LIGHT && o->light) {
        struct light moved = light_moved(o->light, &inner);
        if (moved.looks_like)
            moved.looks_like = moved_copy(s->mem, moved.looks_like, &inner);
        if (moved.projected_through)
            moved.projected_through = moved_copy(s->mem, moved.projected_through, &inner);
        scene_add_light(s, &moved);
    }
    for (size_t i = 0; i < o->n_child; i++)
        add_lights(s, o->child[i], &inner);
}

/* An earlier object like this one, or o, which later ones may be like. */
static const struct object *kind_of(struct scene *s, const struct object *o)
{
    uintptr_t by = (uintptr_t)o->texture >> 4 ^ (uintptr_t)o->ops >> 3;
    const struct object **known = &s->kind[(by ^ by >> 6) % SCENE_KINDS];

    if (!*known || !object_is_like(*known, o))
        *known = o;
    return *known;
}

bool scene_add(struct scene *s, struct object *o)
{
    const struct object *like = o->kind == OBJECT_SHAPE ? kind_of(s, o) : o;

    s->listed = arena_grow(s->mem, s->listed, s->n_object, &s->room_object, sizeof *s->listed);
    s->listed[s->n_object++] = (struct listed) { like, o->shape };
    add_lights(s, o, &transform_identity);
    return like != o;
}

const struct object *scene_object(const struct scene *s, size_t i, struct object *room)
{
    const struct listed *l = &s->listed[i];

    if (l->like->shape == l->shape)
        return l->like;
    *room = *l->like;
    room->shape = l->shape;
    return room;
}

void scene_forget_objects(struct scene *s)
{
    arena_drop(s->mem, s->listed);
    s->listed = NULL;
    s->n_object = s->room_object = 0;
}
