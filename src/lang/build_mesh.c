/* build_mesh.c: mesh { } and mesh2 { }. */
#include <stdlib.h>
#include <string.h>

#include "lang/build.h"
#include "lang/frame.h"
#include "lang/parsing.h"

/* A mesh under construction: lists that grow in the tree's arena and are
 * copied, at their true size, into the scene's; where the size is known at
 * first, they begin there. */
struct list { void *item; size_t n, room; bool in_scene; };

struct making {
    struct lang *lang;
    struct object *object;
    struct mesh *mesh;
    struct list vertex, normal, uv, texture;
    struct list face, face_normal, face_uv, face_texture;       /* the last three: empty, or of each face */
    bool said;                          /* that a triangle is degenerate */
    unsigned errors;                    /* before it: lists that were not understood have no number of things */
    bool has_faces;                     /* mesh2: group 1 is over */
    bool has_vertices, has_normals, has_uvs, has_textures, has_uv_indices, has_normal_indices;
};

const struct field mesh_fields[] = {
    { "uv_vectors", FIELD_CUSTOM, 0, ANY, "three places in the texture" },
    { "texture_list", FIELD_CUSTOM, 0, ANY, "textures of faces or corners" },
    { "vertex_vectors", FIELD_CUSTOM, 0, ANY, "mesh2: the corners" },
    { "normal_vectors", FIELD_CUSTOM, 0, ANY, "mesh2: the normals" },
    { "face_indices", FIELD_CUSTOM, 0, ANY, "mesh2: three corners a face" },
    { "normal_indices", FIELD_CUSTOM, 0, ANY, "mesh2: three normals a face" },
    { "uv_indices", FIELD_CUSTOM, 0, ANY, "mesh2: three uv_vectors a face" },
    { "inside_vector", FIELD_CUSTOM, 0, ANY, "makes a closed mesh solid" },
    FIELD_END,
};

static void *push(struct making *m, struct list *list, size_t size)
{
    list->in_scene = list->in_scene && list->n < list->room;
    list->item = arena_grow(m->lang->mem, list->item, list->n, &list->room, size);
    return (char *)list->item + size * list->n++;
}

/* How many constants of a list stand in runs: as many as will surely come. */
static size_t run_length(struct reader *r)
{
    const struct frame *f = &r->lang->frame[r->lang->n_frame - 1];
    size_t n = 0;

    for (const struct ast *a = f->next; a; a = a->next)
        n += a->kind == AST_BULK ? a->bulk.n : 0;
    return n;
}

/* Of the n things that are announced, some more than stand in runs: the last
 * few may not make one. */
static void reserve(struct making *m, struct list *list, size_t sure, size_t n, size_t size)
{
    if (sure == 0 || n == 0 || list->n > 0)
        return;
    n = sure < n && n - sure > SHORTEST_RUN ? sure + SHORTEST_RUN : n;
    list->item = arena_array(m->lang->scene_mem, n, size);
    list->room = n;
    list->in_scene = true;
}

static void *kept(struct making *m, const struct list *list, size_t size)
{
    if (list->in_scene)
        return list->item;
    return list->n > 0 ? arena_copy(m->lang->scene_mem, list->item, list->n * size) : NULL;
}

/* --- the end ----------------------------------------------------------------------------- */

static bool same(vec3 a, vec3 b) { return a.x == b.x && a.y == b.y && a.z == b.z; }

static bool is_degenerate(const vec3 *v, const struct three *f)
{
    vec3 a = v[f->of[0]], b = v[f->of[1]], c = v[f->of[2]];
    vec3 n = vec_cross(vec_sub(b, a), vec_sub(c, a));

    return same(a, b) || same(b, c) || same(a, c) || !(vec_largest(n) > 0);
}

static const struct three no_three = { { MESH_NONE, MESH_NONE, MESH_NONE } };

/* The face's three of a list that begins when the first face has some. */
static struct three *three_at(struct making *m, struct list *list, size_t face)
{
    while (list->n <= face)
        *(struct three *)push(m, list, sizeof no_three) = no_three;
    return (struct three *)list->item + face;
}

static void move_three(struct list *list, size_t from, size_t to)
{
    struct three *three = list->item;

    if (list->n > 0)
        three[to] = three[from];
}

/* Three equal normals make a flat face. */
static void flatten_face(const struct making *m, size_t face)
{
    struct three *three = m->face_normal.item;
    const uint32_t *k = m->face_normal.n > 0 ? three[face].of : no_three.of;
    const vec3 *normal = m->normal.item;

    if (k[0] != MESH_NONE && same(normal[k[0]], normal[k[1]]) && same(normal[k[1]], normal[k[2]]))
        three[face] = no_three;
}

/* Makes lists as long as there are faces, or leaves them empty. */
static void fill_up(struct making *m, struct list *list)
{
    if (list->n > 0 && m->face.n > 0)
        three_at(m, list, m->face.n - 1);
}

/* Degenerate faces are dropped. */
static size_t clean_faces(struct making *m)
{
    const struct three *face = m->face.item;
    size_t n = 0;

    for (size_t i = 0; i < m->face.n; i++) {
        if (is_degenerate(m->vertex.item, &face[i]))
            continue;
        flatten_face(m, i);
        move_three(&m->face, i, n);
        move_three(&m->face_normal, i, n);
        move_three(&m->face_uv, i, n);
        move_three(&m->face_texture, i, n++);
    }
    return n;
}

static struct bounds box_of(const struct mesh *m)
{
    struct bounds b = BOUNDS_EMPTY;

    for (size_t i = 0; i < m->n_face; i++)
        for (int k = 0; k < 3; k++) {
            vec3 p = m->vertex[m->face[i].of[k]];
            b = bounds_join(b, (struct bounds) { p, p });
        }
    return b;
}

static void complete(struct making *m)
{
    struct mesh *mesh = m->mesh;

    fill_up(m, &m->face_normal);
    fill_up(m, &m->face_uv);
    fill_up(m, &m->face_texture);
    mesh->n_face = clean_faces(m);
    mesh->vertex = kept(m, &m->vertex, sizeof(vec3));
    mesh->n_vertex = m->vertex.n;
    mesh->normal = kept(m, &m->normal, sizeof(vec3));
    mesh->n_normal = m->normal.n;
    mesh->uv = kept(m, &m->uv, sizeof(vec2));
    mesh->n_uv = m->uv.n;
    mesh->face = kept(m, &m->face, sizeof(struct three));
    mesh->face_normal = kept(m, &m->face_normal, sizeof(struct three));
    mesh->face_uv = kept(m, &m->face_uv, sizeof(struct three));
    mesh->face_texture = kept(m, &m->face_texture, sizeof(struct three));
    mesh->texture = kept(m, &m->texture, sizeof(struct texture *));
    mesh->n_texture = m->texture.n;
    mesh->box = box_of(mesh);
}

static struct making start(struct lang *l, const struct item *block)
{
    struct making m = { .lang = l, .object = object_start(l, OBJECT_MESH, block->at) };

    m.object->mesh = m.mesh = arena_alloc(l->scene_mem, sizeof *m.mesh);
    return m;
}

/* --- triangles of mesh { } ------------------------------------------------------------------ */

static uint32_t add_vertex(struct making *m, vec3 p)
{
    *(vec3 *)push(m, &m->vertex, sizeof p) = p;
    return (uint32_t)(m->vertex.n - 1);
}

static vec3 unit_normal(struct making *m, struct loc at, vec3 n)
{
    vec3 unit = vec_unit(n);

    if (vec_largest(unit) > 0)
        return unit;
    diag_warning(m->lang->diag, at, "a normal of length 0: taken as x");
    return vec(1, 0, 0);
}

static uint32_t add_normal(struct making *m, struct loc at, vec3 n)
{
    *(vec3 *)push(m, &m->normal, sizeof n) = unit_normal(m, at, n);
    return (uint32_t)(m->normal.n - 1);
}

/* Meshes mention few textures, mostly the one mentioned last. */
static uint32_t texture_number(struct making *m, const struct texture *t)
{
    const struct texture **list = m->texture.item;

    for (size_t i = m->texture.n; i > 0; i--)
        if (list[i - 1] == t)
            return (uint32_t)(i - 1);
    *(const struct texture **)push(m, &m->texture, sizeof t) = t;
    return (uint32_t)(m->texture.n - 1);
}

static uint32_t declared_texture(struct making *m, struct reader *r)
{
    const struct texture *t = build_start(r, VALUE_TEXTURE);

    if (t)
        return texture_number(m, t);
    diag_error(m->lang->diag, reader_at(r), "only a declared texture can stand here; found %s",
               item_describe(m->lang, reader_peek(r)));
    while (reader_peek(r)->kind != ITEM_END && reader_peek(r)->kind != ITEM_COMMA)
        reader_next(r);
    return MESH_NONE;
}

static void read_face_texture(struct making *m, const struct item *i)
{
    uint32_t *texture = three_at(m, &m->face_texture, m->face.n)->of;
    bool list = item_is(i, "texture_list");
    struct reader r;

    reader_open(&r, m->lang, i->body);
    texture[0] = texture[1] = texture[2] = declared_texture(m, &r);
    for (int k = 1; list && k < 3; k++) {
        reader_skip_comma(&r);
        texture[k] = declared_texture(m, &r);
    }
    if (reader_peek(&r)->kind != ITEM_END)
        build_unknown(m->lang, reader_peek(&r), i->text, NULL);
    reader_close(&r);
}

static void read_face_uv(struct making *m, struct reader *r)
{
    uint32_t *number = three_at(m, &m->face_uv, m->face.n)->of;

    for (int k = 0; k < 3; k++) {
        vec2 uv = { 0, 0 };
        reader_vector(r, k > 0, 2, (double *)&uv, "uv_vectors");
        number[k] = (uint32_t)m->uv.n;
        *(vec2 *)push(m, &m->uv, sizeof uv) = uv;
    }
}

static void read_corners(struct making *m, struct reader *r, struct three *f, bool smooth)
{
    for (int k = 0; k < 3; k++) {
        f->of[k] = add_vertex(m, build_vector(r, k > 0, "corner of triangle"));
        if (!smooth)
            continue;
        vec3 n = build_vector(r, true, "normal of triangle");
        three_at(m, &m->face_normal, m->face.n)->of[k] = add_normal(m, reader_at(r), n);
    }
}

static void read_triangle(struct making *m, const struct item *i)
{
    const struct field *const tables[] = { mesh_fields, NULL };
    struct three f = no_three;
    struct reader r;

    reader_open(&r, m->lang, i->body);
    read_corners(m, &r, &f, item_is(i, "smooth_triangle"));
    for (struct item w = reader_next(&r); w.kind != ITEM_END; w = reader_next(&r)) {
        if (w.kind == ITEM_WORD && item_is(&w, "uv_vectors"))
            read_face_uv(m, &r);
        else if (item_is_block(&w, "texture") || item_is_block(&w, "texture_list"))
            read_face_texture(m, &w);
        else
            build_unknown(m->lang, &w, i->text, tables);
    }
    reader_close(&r);
    *(struct three *)push(m, &m->face, sizeof f) = f;
    if (!m->said && is_degenerate(m->vertex.item, &f)) {
        diag_warning(m->lang->diag, i->at, "triangle: degenerate triangle; it is left out");
        m->said = true;
    }
}

static bool read_mesh_item(struct reader *r, const struct item *i, void *arg)
{
    struct making *m = arg;

    if (item_is_block(i, "triangle") || item_is_block(i, "smooth_triangle"))
        read_triangle(m, i);
    else if (i->kind == ITEM_WORD && item_is(i, "inside_vector"))
        m->mesh->inside_vector = vec_unit(build_vector(r, false, "inside_vector"));
    else
        return false;
    return true;
}

/* Transforms come after the triangles, which are in the mesh's own space. */
static struct object *make_mesh(struct lang *l, struct reader *r, const struct item *block)
{
    const struct field *const tables[] = { mesh_fields, NULL };
    struct making m = start(l, block);

    while (item_is_block(reader_peek(r), "triangle") || item_is_block(reader_peek(r), "smooth_triangle")) {
        struct item i = reader_next(r);
        read_triangle(&m, &i);
    }
    if (m.face.n == 0)
        build_wrong(l, block, "this mesh has no triangles");
    complete(&m);
    build_modifiers(r, m.object, block, read_mesh_item, &m, tables);
    return m.object;
}

/* --- the lists of mesh2 { } -------------------------------------------------------------------- */

enum { MOST_AT_ONCE = 4096 };           /* vectors asked of the reader in one go */

static size_t read_count(struct making *m, struct reader *r, const char *what)
{
    struct loc at = reader_at(r);
    double n = reader_number(r, false, what);

    if (n >= 0 && n < 4294967295.0)
        return (size_t)n;
    diag_error(m->lang->diag, at, "%s cannot have %g entries", what, n);
    return 0;
}

/* n vectors of that many doubles each, commas where they please. */
static void read_vectors(struct making *m, const struct item *block, int components,
                         struct list *list)
{
    size_t size = (size_t)components * sizeof(double);
    double bulk[3 * MOST_AT_ONCE];
    struct reader r;

    reader_open(&r, m->lang, block->body);
    size_t n = read_count(m, &r, block->text);
    reader_skip_comma(&r);
    *list = (struct list) { 0 };
    reserve(m, list, run_length(&r), n, size);
    unsigned errors = m->lang->diag->errors;
    while (list->n < n && m->lang->diag->errors == errors) {
        size_t most = n - list->n < MOST_AT_ONCE ? n - list->n : MOST_AT_ONCE;
        size_t got = reader_bulk(&r, components, most, bulk);
        if (got == 0) {
            if (!reader_vector(&r, false, components, bulk, block->text))
                break;
            reader_skip_comma(&r);
            got = 1;
        }
        if (list->n + got <= list->room) {
            memcpy((char *)list->item + list->n * size, bulk, got * size);
            list->n += got;
            continue;
        }
        for (size_t i = 0; i < got; i++)
            memcpy(push(m, list, size), bulk + i * (size_t)components, size);
    }
    if (m->lang->diag->errors == errors && reader_peek(&r)->kind != ITEM_END)
        diag_error(m->lang->diag, reader_at(&r), "%s has more than the %zu entries it announces",
                   block->text, n);
    reader_close(&r);
}

static uint32_t index_in(struct making *m, struct loc at, const char *what, double x, size_t n)
{
    if (x >= 0 && x < (double)n)
        return (uint32_t)x;
    if (m->lang->diag->errors == m->errors)
        diag_error(m->lang->diag, at, "%s: index %g is not in 0 to %zu", what, x, n > 0 ? n - 1 : 0);
    return 0;
}

static bool single_number(struct reader *r)
{
    const struct item *i = reader_peek(r);

    return i->kind == ITEM_VALUE && i->value.type == VALUE_NUMBER && i->value.n == 1;
}

/* [, t [, t, t]] behind a face's corners. */
static void read_texture_indices(struct making *m, struct reader *r, uint32_t texture[3])
{
    size_t n = m->texture.n;

    for (int k = 0; k < 3; k++) {
        if (!single_number(r)) {
            for (; k > 0 && k < 3; k++)
                texture[k] = texture[0];
            return;
        }
        struct loc at = reader_at(r);
        texture[k] = index_in(m, at, "texture of face_indices", reader_number(r, false, "texture"), n);
        reader_skip_comma(r);
    }
}

/* Three indices a face, of n things: straight from the constants where they
 * stand in a run. */
struct indices {
    struct making *m;
    struct reader *r;
    const char *what;
    size_t n_things;
    double bulk[3 * MOST_AT_ONCE];
    size_t have, used;
    struct loc at;
};

/* Without making an item of a run's first constant, which would end the run. */
static struct loc next_at(struct reader *r)
{
    const struct ast *a = r->has_item ? NULL : reader_look(r);

    return a ? a->at : reader_at(r);
}

static void next_three(struct indices *x, size_t most, uint32_t out[3])
{
    double v[3] = { 0, 0, 0 };

    if (x->used == x->have) {
        x->used = 0;
        x->at = next_at(x->r);
        x->have = reader_bulk(x->r, 3, most < MOST_AT_ONCE ? most : MOST_AT_ONCE, x->bulk);
    }
    if (x->used < x->have)
        memcpy(v, x->bulk + 3 * x->used++, sizeof v);
    else {
        reader_vector(x->r, false, 3, v, x->what);
        reader_skip_comma(x->r);
    }
    for (int k = 0; k < 3; k++)
        out[k] = index_in(x->m, x->at, x->what, v[k], x->n_things);
}

static void read_faces(struct making *m, const struct item *block)
{
    struct reader r;
    struct indices x = { .m = m, .r = &r, .what = block->text, .n_things = m->vertex.n };

    reader_open(&r, m->lang, block->body);
    size_t n = read_count(m, &r, block->text);
    reader_skip_comma(&r);
    reserve(m, &m->face, run_length(&r), n, sizeof(struct three));
    unsigned errors = m->lang->diag->errors;
    for (size_t i = 0; i < n && m->lang->diag->errors == errors; i++) {
        struct three *f = push(m, &m->face, sizeof *f);
        next_three(&x, m->texture.n > 0 ? 1 : n - i, f->of);
        if (m->texture.n > 0)
            read_texture_indices(m, &r, three_at(m, &m->face_texture, i)->of);
    }
    if (m->lang->diag->errors == errors && reader_peek(&r)->kind != ITEM_END)
        diag_error(m->lang->diag, reader_at(&r), "face_indices has more than the %zu faces it announces", n);
    reader_close(&r);
    if (m->face.n == 0)
        build_wrong(m->lang, block, "face_indices needs a face");
}

/* uv_indices and normal_indices: the first `used` faces get theirs. */
static void read_more_indices(struct making *m, const struct item *block, size_t n_things,
                              bool is_uv)
{
    struct reader r;
    struct indices x = { .m = m, .r = &r, .what = block->text, .n_things = n_things };
    struct list *list = is_uv ? &m->face_uv : &m->face_normal;

    reader_open(&r, m->lang, block->body);
    struct loc at = reader_at(&r);
    size_t n = read_count(m, &r, block->text);
    reader_skip_comma(&r);
    if (n > m->face.n || (is_uv && n != m->face.n))
        diag_error(m->lang->diag, at, "%s has %zu entries for %zu faces", block->text, n, m->face.n);
    reserve(m, list, run_length(&r), m->face.n, sizeof(struct three));
    unsigned errors = m->lang->diag->errors;
    for (size_t i = 0; i < n && i < m->face.n && m->lang->diag->errors == errors; i++)
        next_three(&x, n - i, three_at(m, list, i)->of);
    reader_close(&r);
}

static void read_textures(struct making *m, const struct item *block)
{
    struct reader r;

    reader_open(&r, m->lang, block->body);
    size_t n = read_count(m, &r, block->text);
    for (size_t i = 0; i < n; i++) {
        reader_skip_comma(&r);
        if (!item_is_block(reader_peek(&r), "texture")) {
            diag_error(m->lang->diag, reader_at(&r), "expected texture { } number %zu of %zu", i + 1, n);
            break;
        }
        struct item t = reader_next(&r);
        *(const struct texture **)push(m, &m->texture, sizeof(void *)) = build_texture(m->lang, &t);
    }
    reader_skip_comma(&r);
    if (reader_peek(&r)->kind != ITEM_END)
        build_unknown(m->lang, reader_peek(&r), block->text, NULL);
    reader_close(&r);
}

/* Faces without indices of their own use the corners' numbers. */
static void reuse_vertices(struct making *m, bool is_uv, size_t n_things)
{
    const struct three *f = m->face.item;

    for (size_t i = 0; i < m->face.n; i++) {
        uint32_t *number = three_at(m, is_uv ? &m->face_uv : &m->face_normal, i)->of;
        for (int k = 0; k < 3; k++)
            number[k] = n_things == 1 ? 0 : f[i].of[k];
    }
}

static void fill_missing(struct making *m, const struct item *block)
{
    if (!m->has_uv_indices && m->uv.n > 0) {
        if (m->uv.n != m->vertex.n && m->uv.n != 1)
            build_wrong(m->lang, block, "uv_indices are missing: %zu uv_vectors for %zu vertices",
                        m->uv.n, m->vertex.n);
        else
            reuse_vertices(m, true, m->uv.n);
    }
    if (!m->has_normal_indices && m->normal.n > 0) {
        if (m->normal.n != m->vertex.n && m->normal.n != 1)
            build_wrong(m->lang, block, "normal_indices are missing: %zu normals for %zu vertices",
                        m->normal.n, m->vertex.n);
        else
            reuse_vertices(m, false, m->normal.n);
    }
}

static void unit_normals(struct making *m, struct loc at)
{
    vec3 *n = m->normal.item;

    for (size_t i = 0; i < m->normal.n; i++)
        n[i] = unit_normal(m, at, n[i]);
}

static void warn_again(struct making *m, const struct item *i, bool *given)
{
    if (*given)
        diag_warning(m->lang->diag, i->at, "%s again: it replaces the first", i->text);
    *given = true;
}

/* Group 1, in any order; texture_list ends it. */
static bool read_group_1(struct making *m, const struct item *i)
{
    if (item_is_block(i, "vertex_vectors")) {
        warn_again(m, i, &m->has_vertices);
        read_vectors(m, i, 3, &m->vertex);
    } else if (item_is_block(i, "normal_vectors")) {
        warn_again(m, i, &m->has_normals);
        read_vectors(m, i, 3, &m->normal);
        unit_normals(m, i->at);
    } else if (item_is_block(i, "uv_vectors")) {
        warn_again(m, i, &m->has_uvs);
        read_vectors(m, i, 2, &m->uv);
    } else
        return false;
    return true;
}

static bool take_block(struct reader *r, const char *word, struct item *i)
{
    if (!item_is_block(reader_peek(r), word))
        return false;
    *i = reader_next(r);
    return true;
}

static void read_sections(struct making *m, struct reader *r, const struct item *block)
{
    struct item i = { 0 };

    while (reader_peek(r)->kind == ITEM_BLOCK && read_group_1(m, reader_peek(r)))
        reader_next(r);
    if (m->vertex.n == 0)
        build_wrong(m->lang, block, "mesh2 needs vertex_vectors first");
    if (take_block(r, "texture_list", &i))
        read_textures(m, &i);
    if (!take_block(r, "face_indices", &i)) {
        if (m->lang->diag->errors != m->errors)
            return;
        diag_error(m->lang->diag, reader_at(r), "expected face_indices in mesh2; found %s",
                   item_describe(m->lang, reader_peek(r)));
        return;
    }
    read_faces(m, &i);
    for (bool more = true; more;) {     /* in either order */
        more = false;
        if (take_block(r, "uv_indices", &i)) {
            read_more_indices(m, &i, m->uv.n, true);
            more = m->has_uv_indices = true;
        }
        if (take_block(r, "normal_indices", &i)) {
            read_more_indices(m, &i, m->normal.n, false);
            more = m->has_normal_indices = true;
        }
    }
    if (reader_takes_word(r, "inside_vector"))
        m->mesh->inside_vector = vec_unit(build_vector(r, false, "inside_vector"));
}

static bool out_of_order(struct reader *r, const struct item *i, void *arg)
{
    (void)arg;
    if (i->kind != ITEM_BLOCK || !field_find(mesh_fields, i->word->text))
        return false;
    diag_error(r->lang->diag, i->at, "%s stands in the wrong place in mesh2", i->text);
    diag_note(r->lang->diag, i->at, "the order is vertex_vectors, normal_vectors, uv_vectors, texture_list, "
              "face_indices, uv_indices, normal_indices, inside_vector");
    return true;
}

static struct object *make_mesh2(struct lang *l, struct reader *r, const struct item *block)
{
    struct making m = start(l, block);
    unsigned errors = m.errors = l->diag->errors;

    read_sections(&m, r, block);
    if (l->diag->errors == errors)
        fill_missing(&m, block);
    if (l->diag->errors != errors)      /* lists that do not fit together are not looked into */
        m.face.n = 0;
    complete(&m);
    build_modifiers(r, m.object, block, out_of_order, NULL, NULL);
    return m.object;
}

const struct special_shape mesh_shapes[] = {
    { "mesh", make_mesh, false },
    { "mesh2", make_mesh2, false },
    { .word = NULL },
};
