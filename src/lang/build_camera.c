/* build_camera.c: camera { }. */
#include <string.h>

#include "lang/build.h"

const struct field camera_kinds[] = {
    { "perspective", FIELD_CUSTOM, CAMERA_PERSPECTIVE, ANY, "as eyes and lenses see" },
    { "orthographic", FIELD_CUSTOM, CAMERA_ORTHOGRAPHIC, ANY, "parallel rays" },
    { "fisheye", FIELD_CUSTOM, CAMERA_FISHEYE, ANY, "a round picture of a wide view" },
    { "ultra_wide_angle", FIELD_CUSTOM, CAMERA_ULTRA_WIDE, ANY, "a square picture of a wide view" },
    { "omnimax", FIELD_CUSTOM, CAMERA_OMNIMAX, ANY, "for dome theatres" },
    { "panoramic", FIELD_CUSTOM, CAMERA_PANORAMIC, ANY, "half around, upright lines stay" },
    { "cylinder", FIELD_CUSTOM, CAMERA_CYLINDER1, ANY, "projections on cylinders, 1 to 4" },
    { "spherical", FIELD_CUSTOM, CAMERA_SPHERICAL, ANY, "all around" },
    { "mesh_camera", FIELD_CUSTOM, CAMERA_PERSPECTIVE, ANY, "a ray for each face of a mesh" },
    FIELD_END,
};

/* The type must come before everything else: facts sdl.md 6.9. */
static void skip_mesh_camera(struct lang *l, const struct item *block)
{
    struct reader r;

    reader_open(&r, l, block->body);
    for (int i = 0; i < 2 || (reader_skip_comma(&r), reader_is_number(&r)); i++)
        reader_number(&r, i > 0, "mesh_camera");
    for (struct item i = reader_next(&r); i.kind != ITEM_END; i = reader_next(&r))
        if (!build_object(l, &i) && !item_is(&i, "smooth"))
            build_unknown(l, &i, "mesh_camera", NULL);
    reader_close(&r);
    diag_unsupported(l->diag, block->at, "mesh_camera");
}

static void read_kind(struct reader *r, struct camera_words *w)
{
    const struct item *next = reader_peek(r);

    if (next->kind != ITEM_WORD && next->kind != ITEM_BLOCK)
        return;
    const struct field *f = field_find(camera_kinds, next->word->text);
    if (!f)
        return;
    struct item i = reader_next(r);
    w->kind = (enum camera_kind)f->offset;
    if (i.kind == ITEM_BLOCK)
        skip_mesh_camera(r->lang, &i);
    if (w->kind != CAMERA_CYLINDER1)
        return;
    struct loc at = reader_at(r);
    int n = reader_whole(r, false, "kind of cylinder camera");
    if (n < 1 || n > 4)
        diag_error(r->lang->diag, at, "cylinder cameras have the kinds 1 to 4");
    else
        w->kind = (enum camera_kind)(CAMERA_CYLINDER1 + n - 1);
}

static void read_angle(struct reader *r, struct camera_words *w)
{
    if (w->kind == CAMERA_ORTHOGRAPHIC && !reader_is_number(r))
        return;
    struct loc at = reader_at(r);

    w->angle = reader_number(r, false, "angle");
    if (w->angle < 0)
        diag_error(r->lang->diag, at, "angle must not be negative");
    w->has_angle = true;
    if (w->kind != CAMERA_SPHERICAL)
        return;
    w->h_angle = w->angle;
    w->v_angle = w->angle / 2;
    reader_skip_comma(r);
    if (reader_is_number(r))
        w->v_angle = reader_number(r, false, "vertical angle");
}

static void read_blur(struct reader *r, struct camera_words *w)
{
    w->blur_samples = reader_whole(r, false, "blur_samples");
    w->blur_samples_min = 0;
    reader_skip_comma(r);
    if (!reader_is_number(r))
        return;
    w->blur_samples_min = w->blur_samples;
    w->blur_samples = reader_whole(r, false, "blur_samples");
}

static void skip_bokeh(struct lang *l, const struct item *block)
{
    struct reader r;

    reader_open(&r, l, block->body);
    struct item i = reader_next(&r);
    if (item_is_block(&i, "pigment"))
        build_pigment(l, &i, build_of(l)->texture->pigment);
    else
        build_unknown(l, &i, "bokeh", NULL);
    reader_close(&r);
    diag_unsupported(l->diag, block->at, "bokeh");
}

static void note_given(const struct item *i, struct camera_words *w)
{
    w->has_up |= item_is(i, "up");
    w->has_right |= item_is(i, "right");
    w->has_look_at |= item_is(i, "look_at");
    w->has_focal_point |= item_is(i, "focal_point");
}

static bool read_item(struct reader *r, const struct item *i, struct camera_words *w)
{
    struct transform t;

    if (build_transform(r, i, &t))
        w->place = transform_compose(&t, &w->place);
    else if (item_is_block(i, "normal")) {
        build_normal(r->lang, i, NULL);
        diag_unsupported(r->lang->diag, i->at, "normal (in camera)");
    } else if (item_is_block(i, "bokeh"))
        skip_bokeh(r->lang, i);
    else if (i->kind == ITEM_WORD && item_is(i, "angle"))
        read_angle(r, w);
    else if (i->kind == ITEM_WORD && item_is(i, "blur_samples"))
        read_blur(r, w);
    else {
        if (i->kind == ITEM_WORD)
            note_given(i, w);
        return build_from_table(r, camera_fields, i, w);
    }
    return true;
}

static void read_items(struct reader *r, struct camera_words *w)
{
    const struct field *const tables[] = { camera_fields, transform_fields, camera_kinds, NULL };

    read_kind(r, w);
    for (struct item i = reader_next(r); i.kind != ITEM_END; i = reader_next(r)) {
        if (read_item(r, &i, w))
            continue;
        if (i.kind == ITEM_WORD && field_find(camera_kinds, i.word->text))
            diag_error(r->lang->diag, i.at, "the camera's type '%s' must come first", i.text);
        else
            build_unknown(r->lang, &i, "camera", tables);
    }
}

static void warn_shape(struct lang *l, const struct item *block, const struct camera_words *w,
                       const struct camera *c)
{
    vec3 r = vec_unit(c->right), u = vec_unit(c->up), d = vec_unit(c->direction);
    double slant = fmax(fabs(vec_dot(r, u)), fmax(fabs(vec_dot(r, d)), fabs(vec_dot(u, d))));

    if (slant > 0.1)
        diag_warning(l->diag, block->at, "the camera's right, up and direction are not perpendicular");
    vec3 view = vec_sub(w->look_at, w->location);
    if (w->has_look_at && vec_largest(vec_cross(w->sky, vec_unit(view))) < 1e-10)
        diag_warning(l->diag, block->at, "the camera looks along its sky vector");
}

/* errors: how many there were before the block. */
static struct camera *solve(struct lang *l, const struct item *block, const struct camera_words *w,
                            unsigned errors)
{
    struct camera *c = arena_alloc(l->scene_mem, sizeof *c);
    const char *wrong = camera_solve(w, c);

    if (wrong) {
        if (l->diag->errors == errors)
            build_wrong(l, block, "%s", wrong);
        camera_solve(&camera_default, c);
    } else
        warn_shape(l, block, w, c);
    return c;
}

/* camera { Ident transforms }: they move what was worked out. */
static struct camera *moved(struct reader *r, const struct camera *from)
{
    const struct field *const tables[] = { transform_fields, NULL };
    struct camera *c = arena_copy(r->lang->scene_mem, from, sizeof *c);
    struct transform t;

    for (struct item i = reader_next(r); i.kind != ITEM_END; i = reader_next(r)) {
        if (build_transform(r, &i, &t))
            camera_move(c, &t);
        else
            build_unknown(r->lang, &i, "camera, after a declared one", tables);
    }
    return c;
}

bool make_camera(struct lang *l, const struct item *block, struct value *out)
{
    struct camera_words w = build_of(l)->camera;
    unsigned errors = l->diag->errors;
    struct camera *c;
    struct reader r;

    reader_open(&r, l, block->body);
    const struct camera *declared = build_start(&r, VALUE_CAMERA);
    if (declared)
        c = moved(&r, declared);
    else {
        read_items(&r, &w);
        c = solve(l, block, &w, errors);
    }
    reader_close(&r);
    *out = value_thing(VALUE_CAMERA, c);
    return true;
}

void build_default_camera(struct lang *l, const struct item *block)
{
    struct build *b = build_of(l);
    unsigned errors = l->diag->errors;
    struct reader r;

    reader_open(&r, l, block->body);
    read_items(&r, &b->camera);
    reader_close(&r);
    l->scene->camera = *solve(l, block, &b->camera, errors);
}

void use_camera(struct lang *l, struct loc at, const struct value *made)
{
    if (l->build->has_camera)
        diag_warning(l->diag, at, "a second camera: only the last one counts");
    l->build->has_camera = true;
    const struct camera *c = made->thing;
    if (c->aperture != 0 && c->blur_samples > 0)
        diag_unsupported(l->diag, at, "focal blur (aperture)");
    l->scene->camera = *c;
}
