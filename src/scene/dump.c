/* dump.c: a scene as a person reads it (--dump=scene). */
#include <stdarg.h>

#include "scene/scene.h"

struct printer {
    FILE *out;
    int depth;                          /* of nesting: two spaces each */
};

static void line(const struct printer *p, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

static void line(const struct printer *p, const char *format, ...)
{
    va_list args;

    fprintf(p->out, "%*s", 2 * p->depth, "");
    va_start(args, format);
    vfprintf(p->out, format, args);
    va_end(args);
    fputc('\n', p->out);
}

static struct printer deeper(const struct printer *p)
{
    return (struct printer) { p->out, p->depth + 1 };
}

/* --- values ---------------------------------------------------------------- */

#define TEXT_ROOM 128
#define TEXT (char[TEXT_ROOM]) { 0 }

static const char *vec_text(char *to, vec3 v)
{
    /* + 0: minus zero is read as zero. */
    snprintf(to, TEXT_ROOM, "<%g, %g, %g>", v.x + 0, v.y + 0, v.z + 0);
    return to;
}

static const char *rgb_text(char *to, rgb c)
{
    snprintf(to, TEXT_ROOM, "rgb <%g, %g, %g>", (double)c.r, (double)c.g, (double)c.b);
    return to;
}

static const char *colour_text(char *to, colour c)
{
    if (c.f == 0 && c.t == 0)
        return rgb_text(to, colour_rgb(c));
    snprintf(to, TEXT_ROOM, "rgbft <%g, %g, %g, %g, %g>", (double)c.r, (double)c.g, (double)c.b,
             (double)c.f, (double)c.t);
    return to;
}

static bool same_rgb(rgb a, rgb b) { return a.r == b.r && a.g == b.g && a.b == b.b; }
static bool same_vec(vec3 a, vec3 b) { return a.x == b.x && a.y == b.y && a.z == b.z; }

/* A member of a table's struct as the language writes it; members that still
 * have their default are left out. */
static void dump_field(const struct printer *p, const struct field *f, const void *thing,
                       const void *defaults)
{
    const char *at = (const char *)thing + f->offset;
    const char *was = (const char *)defaults + f->offset;

    switch (f->type) {
    case FIELD_FLAG:
        if (*(const bool *)at != *(const bool *)was)
            line(p, "%s%s", f->name, *(const bool *)at ? "" : " off");
        break;
    case FIELD_INT:
        if (*(const int *)at != *(const int *)was)
            line(p, "%s %d", f->name, *(const int *)at);
        break;
    case FIELD_NUM: case FIELD_NUM_OR_1: case FIELD_DEGREES:
        if (*(const double *)at != *(const double *)was)
            line(p, "%s %g", f->name, *(const double *)at);
        break;
    case FIELD_POINT:
        if (!same_vec(*(const vec3 *)at, *(const vec3 *)was))
            line(p, "%s %s", f->name, vec_text(TEXT, *(const vec3 *)at));
        break;
    case FIELD_RGB: {
        rgb now = *(const rgb *)at, then = *(const rgb *)was;
        if (!same_rgb(now, then))
            line(p, "%s %s", f->name, rgb_text(TEXT, now));
        break;
    }
    case FIELD_TEXT:
        if (*(const char *const *)at)
            line(p, "%s \"%s\"", f->name, *(const char *const *)at);
        break;
    default:
        break;
    }
}

static void dump_fields(const struct printer *p, const struct field *f, const void *thing,
                        const void *defaults)
{
    for (; f && f->name; f++)
        dump_field(p, f, thing, defaults);
}

/* Numbers and points without names: the start of a shape's block, in one line. */
static void dump_header(const struct printer *p, const struct field *f, const void *thing)
{
    const char *between = "";

    if (!f || !f->name)
        return;
    fprintf(p->out, "%*s", 2 * p->depth, "");
    for (; f->name; f++, between = ", ") {
        const char *at = (const char *)thing + f->offset;
        if (f->type == FIELD_POINT)
            fprintf(p->out, "%s%s", between, vec_text(TEXT, *(const vec3 *)at));
        else if (f->type == FIELD_INT)
            fprintf(p->out, "%s%d", between, *(const int *)at);
        else if (f->type == FIELD_NUM)
            fprintf(p->out, "%s%g", between, *(const double *)at + 0);
        else
            fprintf(p->out, "%s(%s)", between, f->help);
    }
    fputc('\n', p->out);
}

static void dump_place(const struct printer *p, const struct transform *t)
{
    const double (*m)[4] = t->to.m;

    if (t->is_identity)
        return;
    bool only_moved = true;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            only_moved = only_moved && m[i][j] == (i == j);
    if (only_moved)
        line(p, "translate %s", vec_text(TEXT, vec(m[0][3], m[1][3], m[2][3])));
    else
        line(p, "matrix <%g, %g, %g, %g, %g, %g, %g, %g, %g, %g, %g, %g>",
             m[0][0] + 0, m[1][0] + 0, m[2][0] + 0, m[0][1] + 0, m[1][1] + 0, m[2][1] + 0,
             m[0][2] + 0, m[1][2] + 0, m[2][2] + 0, m[0][3] + 0, m[1][3] + 0, m[2][3] + 0);
}

/* --- looks ----------------------------------------------------------------- */

static void dump_pigment(const struct printer *p, const struct pigment *pigment);
static void dump_texture(const struct printer *p, const char *word, const struct texture *t);

static void dump_pattern(const struct printer *p, const struct pattern_use *u)
{
    static const char *const wave[] = { "ramp", "triangle", "sine", "scallop", "cubic", "poly" };

    if (!u->ops)
        return;
    line(p, "%s", u->ops->name);
    struct printer in = deeper(p);
    if (u->self && u->ops->defaults) {
        dump_header(&in, u->ops->args, u->self);
        dump_fields(&in, u->ops->words, u->self, u->ops->defaults);
    }
    /* 0 is that of checker and its like, which have no waves. */
    if ((u->frequency != 1 && u->frequency != 0) || u->phase != 0)
        line(p, "frequency %g phase %g", u->frequency, u->phase);
    if (u->wave != WAVE_RAMP)
        line(p, "%s_wave", wave[u->wave]);
    if (vec_largest(u->turbulence.amount) > 0)
        line(p, "turbulence %s octaves %d omega %g lambda %g",
             vec_text(TEXT, u->turbulence.amount), u->turbulence.octaves, u->turbulence.omega,
             u->turbulence.lambda);
}

static void dump_entries(const struct printer *p, const struct map_entry *e, size_t n)
{
    struct printer in = deeper(p);

    for (size_t i = 0; i < n; i++) {
        if (e[i].pigment || e[i].texture)
            line(p, "[%g]", e[i].value);
        else
            line(p, "[%g %s]", e[i].value, colour_text(TEXT, e[i].colour));
        if (e[i].pigment)
            dump_pigment(&in, e[i].pigment);
        if (e[i].texture)
            dump_texture(&in, "texture", e[i].texture);
    }
}

static void dump_image(const struct printer *p, const struct image_use *u)
{
    if (u->image)
        line(p, "image_map %u x %u%s", u->image->width, u->image->height,
             u->image->has_transparency ? ", partly transparent" : "");
    line(p, "map_type %d interpolate %d%s", u->map_type, u->interpolate, u->once ? " once" : "");
}

static void dump_pigment(const struct printer *p, const struct pigment *pigment)
{
    struct printer in = deeper(p);

    if (pigment->kind == PIGMENT_COLOUR && !pigment->has_quick_colour) {
        line(p, "pigment { %s }", colour_text(TEXT, pigment->colour));
        return;
    }
    line(p, "pigment {");
    if (pigment->kind == PIGMENT_COLOUR)
        line(&in, "%s", colour_text(TEXT, pigment->colour));
    if (pigment->kind == PIGMENT_IMAGE)
        dump_image(&in, pigment->image);
    if (pigment->kind == PIGMENT_AVERAGE)
        line(&in, "average");
    if (pigment->uv_mapping)
        line(&in, "uv_mapping");
    dump_pattern(&in, pigment->pattern);
    dump_entries(&in, pigment->entry, pigment->n_entry);
    dump_place(&in, pigment->place);
    line(p, "}");
}

static void dump_reflection(const struct printer *p, const struct reflection *r)
{
    struct printer in = deeper(p);

    if (!(rgb_max(r->high) > 0) && !(rgb_max(r->low) > 0))
        return;
    line(p, "reflection {");
    line(&in, "%s, %s", rgb_text(TEXT, r->low), rgb_text(TEXT, r->high));
    dump_fields(&in, reflection_fields, r, &finish_default.reflection);
    line(p, "}");
}

static void dump_finish(const struct printer *p, const struct finish *f)
{
    struct printer in = deeper(p);

    line(p, "finish {");
    if (same_rgb(f->ambient, finish_default.ambient))   /* or it is told with the others */
        line(&in, "ambient %s", rgb_text(TEXT, f->ambient));
    if (f->diffuse_back != 0)
        line(&in, "diffuse %g, %g", f->diffuse, f->diffuse_back);
    else
        line(&in, "diffuse %g", f->diffuse);
    if (f->phong != 0)
        line(&in, "phong %g", f->phong);
    if (f->specular != 0)
        line(&in, "specular %g", f->specular);
    dump_fields(&in, finish_fields, f, &finish_default);
    if (f->irid != 0)
        line(&in, "irid %g thickness %g turbulence %g", f->irid, f->irid_thickness,
             f->irid_turbulence);
    dump_reflection(&in, &f->reflection);
    line(p, "}");
}

static void dump_layer(const struct printer *p, const char *word, const struct texture *t)
{
    struct printer in = deeper(p);

    line(p, "%s {", word);
    if (t->uv_mapping)
        line(&in, "uv_mapping");
    if (t->kind == TEXTURE_PLAIN) {
        dump_pigment(&in, t->pigment);
        if (t->normal)
            line(&in, "normal { ... }");
        dump_finish(&in, t->finish);
    } else {
        if (t->kind == TEXTURE_AVERAGE)
            line(&in, "average");
        dump_pattern(&in, t->pattern);
        dump_entries(&in, t->entry, t->n_entry);
    }
    dump_place(&in, t->place);
    line(p, "}");
}

static void dump_texture(const struct printer *p, const char *word, const struct texture *t)
{
    for (; t; t = t->above)
        dump_layer(p, word, t);
}

static void dump_interior(const struct printer *p, const struct interior *i)
{
    struct printer in = deeper(p);

    if (!i)
        return;
    line(p, "interior {");
    dump_fields(&in, interior_fields, i, &interior_default);
    line(p, "}");
}

/* --- objects --------------------------------------------------------------- */

static void dump_object(const struct printer *p, const struct object *o);

static const char *kind_word(const struct object *o)
{
    static const char *const word[] = {
        [OBJECT_MESH] = "mesh", [OBJECT_UNION] = "union", [OBJECT_MERGE] = "merge",
        [OBJECT_INTERSECTION] = "intersection", [OBJECT_DIFFERENCE] = "difference",
        [OBJECT_LIGHT] = "light_source",
    };
    return o->kind == OBJECT_SHAPE ? o->ops->name : word[o->kind];
}

static void dump_light(const struct printer *p, const struct light *l)
{
    struct printer in = deeper(p);
    static const char *const kind[] = { "", "spotlight", "cylinder" };

    line(p, "light_source {");
    line(&in, "%s, %s", vec_text(TEXT, l->centre), rgb_text(TEXT, l->colour));
    if (l->kind != LIGHT_POINT)
        line(&in, "%s", kind[l->kind]);
    dump_fields(&in, light_fields, l, &light_default);
    if (l->is_area)
        line(&in, "area_light %s, %s, %d, %d", vec_text(TEXT, l->axis1),
             vec_text((char[TEXT_ROOM]) { 0 }, l->axis2), l->samples1, l->samples2);
    line(p, "}");
}

static void dump_shape(const struct printer *p, const struct object *o)
{
    if (o->kind == OBJECT_MESH) {
        line(p, "%zu vertices, %zu faces, %zu normals, %zu uv_vectors, %zu textures",
             o->mesh->n_vertex, o->mesh->n_face, o->mesh->n_normal, o->mesh->n_uv,
             o->mesh->n_texture);
        return;
    }
    dump_header(p, o->ops->args, o->shape);
    dump_fields(p, o->ops->words, o->shape, o->ops->defaults);
}

static void dump_flags(const struct printer *p, unsigned flags)
{
    static const char *const word[] = {
        "inverse", "no_shadow", "no_image", "no_reflection", "hollow", "double_illuminate",
        "cutaway_textures", "no_radiosity", "uv_mapping",
    };

    for (unsigned i = 0; i < sizeof word / sizeof *word; i++)
        if (flags & 1u << i)
            line(p, "%s", word[i]);
}

static void dump_list(const struct printer *p, const char *word, const struct object *const *list,
                      size_t n)
{
    struct printer in = deeper(p);

    if (n == 0)
        return;
    line(p, "%s {", word);
    for (size_t i = 0; i < n; i++)
        dump_object(&in, list[i]);
    line(p, "}");
}

static void dump_object(const struct printer *p, const struct object *o)
{
    struct printer in = deeper(p);

    if (o->kind == OBJECT_LIGHT) {
        struct light moved = light_moved(o->light, o->place);
        dump_light(p, &moved);
        return;
    }
    line(p, "%s {%s%s", kind_word(o), o->name ? "  // " : "", o->name ? o->name : "");
    if (o->kind == OBJECT_SHAPE || o->kind == OBJECT_MESH)
        dump_shape(&in, o);
    for (size_t i = 0; i < o->n_child; i++)
        dump_object(&in, o->child[i]);
    dump_place(&in, o->place);
    dump_flags(&in, o->flags);
    dump_texture(&in, "texture", o->texture);
    dump_texture(&in, "interior_texture", o->more->interior_texture);
    dump_interior(&in, o->more->interior);
    dump_list(&in, "clipped_by", o->more->clip, o->more->n_clip);
    line(p, "}");
}

/* --- the scene ------------------------------------------------------------- */

static void dump_settings(const struct printer *p, const struct settings *s)
{
    struct printer in = deeper(p);
    static const char *const space[] = {
        "none: values are written as they are", "linear", "a power", "srgb",
    };

    if (s->version == s->effective_version)
        line(p, "#version %g;", s->version / 100.0);
    else
        line(p, "#version %g;  // treated as %g", s->version / 100.0, s->effective_version / 100.0);
    line(p, "global_settings {");
    line(&in, "assumed_gamma %g  // %s", s->gamma, space[s->space]);
    line(&in, "max_trace_level %d", s->max_trace_level);
    dump_fields(&in, settings_fields, s, &settings_default);
    line(p, "}");
}

static void dump_camera(const struct printer *p, const struct camera *c)
{
    struct printer in = deeper(p);
    static const char *const kind[] = {
        "perspective", "orthographic", "fisheye", "ultra_wide_angle", "omnimax", "panoramic",
        "cylinder 1", "cylinder 2", "cylinder 3", "cylinder 4", "spherical",
    };

    line(p, "camera {  // as worked out: no look_at or angle is left");
    line(&in, "%s", kind[c->kind]);
    line(&in, "location %s", vec_text(TEXT, c->location));
    line(&in, "direction %s", vec_text(TEXT, c->direction));
    line(&in, "right %s", vec_text(TEXT, c->right));
    line(&in, "up %s", vec_text(TEXT, c->up));
    if (c->aperture != 0)
        line(&in, "aperture %g blur_samples %d, %d  // in focus at %g", c->aperture,
             c->blur_samples_min, c->blur_samples, c->focal_distance);
    line(p, "}");
}

void scene_dump(const struct scene *s, FILE *out)
{
    struct printer p = { out, 0 };

    dump_settings(&p, &s->settings);
    dump_camera(&p, &s->camera);
    if (s->has_background)
        line(&p, "background { %s }", colour_text(TEXT, s->background));
    for (size_t i = 0; i < s->n_light; i++)
        dump_light(&p, &s->light[i]);
    for (size_t i = 0; i < s->n_object; i++) {
        struct object room;
        const struct object *o = scene_object(s, i, &room);
        if (o->kind != OBJECT_LIGHT)
            dump_object(&p, o);
    }
}
