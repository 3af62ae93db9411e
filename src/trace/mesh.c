/* mesh.c: rays against the triangles of one mesh. */
#include "trace/mesh.h"

#include <stdlib.h>
#include <string.h>

#include "shape/triangle.h"

enum { FACES_A_LEAF = 8 };

static const vec3 *nth_corner(const void *of, uint32_t face, int i)
{
    return mesh_corner(of, face, i);
}

static struct bounds face_bounds(const struct mesh *m, uint32_t face)
{
    struct bounds b = BOUNDS_EMPTY;

    for (int i = 0; i < 3; i++)
        b = bounds_join(b, (struct bounds) { *mesh_corner(m, face, i), *mesh_corner(m, face, i) });
    return b;
}

/* The faces that are finite: nearly always all of them. */
struct kept {
    const struct mesh *mesh;
    uint32_t *face;                     /* NULL: all */
    size_t n;
    struct bounds whole;                /* of them */
};

static uint32_t kept_face(const struct kept *k, size_t i)
{
    return k->face ? k->face[i] : (uint32_t)i;
}

static struct bounds kept_bounds(const void *of, size_t i)
{
    const struct kept *k = of;
    return face_bounds(k->mesh, kept_face(k, i));
}

static bool is_finite(const struct mesh *m, uint32_t face)
{
    return vec_is_finite(*mesh_corner(m, face, 0)) && vec_is_finite(*mesh_corner(m, face, 1))
           && vec_is_finite(*mesh_corner(m, face, 2));
}

static bool keeps(struct kept *k, uint32_t face)
{
    if (!is_finite(k->mesh, face))
        return false;
    k->whole = bounds_join(k->whole, face_bounds(k->mesh, face));
    return true;
}

static struct kept keep_finite(const struct mesh *m, struct arena *mem)
{
    struct kept k = { m, NULL, 0, BOUNDS_EMPTY };

    while (k.n < m->n_face && keeps(&k, (uint32_t)k.n))
        k.n++;
    if (k.n == m->n_face)
        return k;
    k.face = arena_array(mem, m->n_face, sizeof *k.face);
    for (size_t i = k.n = 0; i < m->n_face; i++)
        if (keeps(&k, (uint32_t)i))
            k.face[k.n++] = (uint32_t)i;
    return k;
}

/* Edges by the places of their ends: meshes made by macros seldom share
 * vertices. */
struct edge { vec3 low, high; };

static int vec_order(const vec3 *a, const vec3 *b)
{
    return a->x != b->x ? (a->x < b->x ? -1 : 1) : a->y != b->y ? (a->y < b->y ? -1 : 1)
           : a->z != b->z ? (a->z < b->z ? -1 : 1) : 0;
}

static int edge_order(const void *a, const void *b)
{
    const struct edge *p = a, *q = b;
    int order = vec_order(&p->low, &q->low);

    return order ? order : vec_order(&p->high, &q->high);
}

/* Closed: each edge belongs to an even number of faces.  Then a line crosses
 * an even number of faces, whatever way they are turned. */
static bool is_closed(const struct kept *k, struct arena *mem)
{
    struct edge *edge = arena_array(mem, 3 * k->n + 1, sizeof *edge);
    size_t n = 0;

    for (size_t i = 0; i < k->n; i++)
        for (int side = 0; side < 3; side++) {
            const vec3 *a = mesh_corner(k->mesh, kept_face(k, i), side);
            const vec3 *b = mesh_corner(k->mesh, kept_face(k, i), (side + 1) % 3);
            int order = vec_order(a, b);
            if (order != 0)
                edge[n++] = order < 0 ? (struct edge) { *a, *b } : (struct edge) { *b, *a };
        }
    qsort(edge, n, sizeof *edge, edge_order);
    for (size_t i = 0; i < n; i += 2)
        if (i + 1 == n || edge_order(&edge[i], &edge[i + 1]) != 0)
            return false;
    return true;
}

bool mesh_has_inside(const struct mesh_tree *t) { return vec_largest(t->mesh->inside_vector) > 0; }

const struct mesh_tree *mesh_tree_new(const struct mesh *m, unsigned threads, struct arena *mem)
{
    struct arena scrap;

    arena_init(&scrap, mem->budget);
    struct kept k = keep_finite(m, &scrap);
    if (k.n == 0) {
        arena_free(&scrap);
        return NULL;
    }
    struct mesh_tree *t = arena_alloc(mem, sizeof *t);
    t->mesh = m;
    bvh_build(&t->tree, k.n, kept_bounds, &k, &k.whole, FACES_A_LEAF, FACES_A_LEAF, threads, mem);
    t->bounds = t->tree.bounds;
    for (size_t i = 0; k.face && i < k.n; i++)
        t->tree.item[i] = k.face[t->tree.item[i]];
    sieve_init(&t->sieve, &t->tree, nth_corner, m, mem);
    t->is_closed = mesh_has_inside(t) && is_closed(&k, &scrap);
    arena_free(&scrap);
    return t;
}

struct search {
    const struct mesh *mesh;
    const struct sieve *sieve;
    struct sieve_ray coarse;
    struct triangle_ray ray;
    double near, far;
    struct hit *out;
    int n, room;
};

/* Member by member: the rays are filled in when they are known. */
INLINE void search_init(struct search *s, const struct mesh *m, double near, double far)
{
    s->mesh = m;
    s->near = near;
    s->far = far;
    s->n = 0;
}

static struct hit hit_of(const struct search *s, const struct triangle_hit *h, uint32_t face)
{
    return (struct hit) { .t = h->t, .u = (float)h->u, .v = (float)h->v, .part = face,
                          .slack = triangle_slack(&s->ray, *mesh_corner(s->mesh, face, 0),
                                                  *mesh_corner(s->mesh, face, 1),
                                                  *mesh_corner(s->mesh, face, 2)) };
}

static bool crosses(const struct search *s, uint32_t face, struct triangle_hit *h)
{
    return triangle_cross(&s->ray, *mesh_corner(s->mesh, face, 0), *mesh_corner(s->mesh, face, 1),
                          *mesh_corner(s->mesh, face, 2), h);
}

INLINE uint32_t sift(void *arg, const struct bvh_ray *r, uint32_t first, uint32_t count, float limit)
{
    struct search *s = arg;

    (void)r;
    return ((1u << count) - 1) & sieve_test(s->sieve, &s->coarse, first, count, limit);
}

typedef bool visitor(void *arg, const uint32_t item[], uint32_t bits, double *far);

INLINE void walk(const struct mesh_tree *t, struct ray ray, double near, double far, visitor *visit,
                 struct search *s, unsigned long long *box_tests)
{
    struct bvh_ray r;

    if (!bvh_aim(&t->tree, ray, near, far, &r))
        return;
    s->sieve = &t->sieve;
    s->ray = triangle_ray(ray);
    sieve_aim(&s->coarse, &r);
    bvh_walk_aimed(&t->tree, &r, far, (struct bvh_visitor) { sift, visit }, s, box_tests);
}

INLINE bool visit_nearest(void *arg, const uint32_t item[], uint32_t bits, double *far)
{
    struct search *s = arg;
    struct triangle_hit h;

    for (; bits; bits &= bits - 1) {
        uint32_t face = item[__builtin_ctz(bits)];
        if (!crosses(s, face, &h) || !(h.t > s->near) || !(h.t <= s->far))
            continue;
        if (h.t < s->far || (s->n && face < s->out->part)) {
            *s->out = hit_of(s, &h, face);
            *far = s->far = h.t;
            s->n = 1;
        }
    }
    return false;
}

enum { FEW_FACES = 6 };

INLINE bool is_tiny(const struct mesh_tree *t) { return t->tree.n_item <= FEW_FACES; }
bool mesh_is_tiny(const struct mesh_tree *t) { return is_tiny(t); }

INLINE uint32_t all_faces(const struct mesh_tree *t) { return (1u << t->tree.n_item) - 1; }

bool mesh_nearest(const struct mesh_tree *t, struct ray ray, double near, double far,
                  struct hit *out, unsigned long long *box_tests)
{
    struct search s;

    search_init(&s, t->mesh, near, far);
    s.out = out;
    if (is_tiny(t)) {
        s.ray = triangle_ray(ray);
        visit_nearest(&s, t->tree.item, all_faces(t), &far);
    } else
        walk(t, ray, near, far, visit_nearest, &s, box_tests);
    return s.n > 0;
}

/* The nearest of one register of rays. */
struct wide_nearest { wide t, u, v, slack; wide_ints face; };

INLINE void try_face(const struct mesh *m, uint32_t face, const struct wide_triangle_ray *r,
                     struct wide_nearest *best, wide_mask *unsure)
{
    const vec3 a = *mesh_corner(m, face, 0), b = *mesh_corner(m, face, 1), c = *mesh_corner(m, face, 2);
    struct wide_triangle_hit h;
    wide_mask met = wide_triangle_cross(r, a, b, c, &h, unsure) & wide_below(wide_of(0), h.t);

    met &= wide_below(h.t, best->t)
           | (wide_equal(h.t, best->t) & wide_ints_below(wide_ints_of(face), best->face));
    if (!wide_bits(met))
        return;
    best->t = wide_pick(met, h.t, best->t);
    best->u = wide_pick(met, h.u, best->u);
    best->v = wide_pick(met, h.v, best->v);
    best->slack = wide_pick(met, wide_triangle_slack(r, a, b, c), best->slack);
    best->face = wide_pick_ints(met, wide_ints_of(face), best->face);
}

void mesh_nearest_many(const struct mesh_tree *t, const struct packet *p, const uint8_t may[],
                       struct crossings *out)
{
    out->most = 1;
    out->has_weights = true;
    for (int at = 0, k = 0; at < p->n; at += WIDE, k++) {
        out->met[k] = out->unsure[k] = 0;
        if (!may[k])
            continue;
        struct wide_ray ray = packet_rays(p, at);
        struct wide_triangle_ray r = wide_triangle_ray(&ray);
        struct wide_nearest best = { .t = wide_of(INFINITY) };
        wide_mask unsure = wide_mask_of(0);
        for (size_t i = 0; i < t->tree.n_item; i++)
            try_face(t->mesh, t->tree.item[i], &r, &best, &unsure);
        out->unsure[k] = (uint8_t)(wide_bits(unsure) & may[k]);
        out->met[k] = (uint8_t)(wide_bits(wide_is_finite(best.t) & wide_not(unsure)) & may[k]);
        crossings_put(out, 0, at, best.t, best.slack, best.face);
        wide_store(out->u + at, best.u);
        wide_store(out->v + at, best.v);
    }
}

static bool is_after(const struct hit *a, const struct hit *b)
{
    return a->t != b->t ? a->t > b->t : a->part > b->part;
}

/* When there is no room for all, the nearest are kept. */
static void keep(struct search *s, struct hit h)
{
    if (s->n == s->room && is_after(&h, &s->out[s->n - 1]))
        return;
    int at = s->n < s->room ? s->n++ : s->n - 1;
    for (; at > 0 && is_after(&s->out[at - 1], &h); at--)
        s->out[at] = s->out[at - 1];
    s->out[at] = h;
}

INLINE bool visit_all(void *arg, const uint32_t item[], uint32_t bits, double *far)
{
    struct search *s = arg;
    struct triangle_hit h;

    (void)far;
    for (; bits; bits &= bits - 1) {
        uint32_t face = item[__builtin_ctz(bits)];
        if (crosses(s, face, &h) && h.t > s->near && h.t < s->far)
            keep(s, hit_of(s, &h, face));
    }
    return false;
}

int mesh_hits(const struct mesh_tree *t, struct ray ray, double near, double far,
              struct hit out[], int room, unsigned long long *box_tests)
{
    struct search s;

    search_init(&s, t->mesh, near, far);
    s.out = out;
    s.room = room;
    if (is_tiny(t)) {
        s.ray = triangle_ray(ray);
        visit_all(&s, t->tree.item, all_faces(t), &far);
    } else
        walk(t, ray, near, far, visit_all, &s, box_tests);
    return s.n;
}

INLINE bool visit_count(void *arg, const uint32_t item[], uint32_t bits, double *far)
{
    struct search *s = arg;
    struct triangle_hit h;

    (void)far;
    for (; bits; bits &= bits - 1)
        s->n += crosses(s, item[__builtin_ctz(bits)], &h) && h.t > 0;
    return false;
}

bool mesh_inside(const struct mesh_tree *t, vec3 p)
{
    struct ray ray = { p, t->mesh->inside_vector };
    unsigned long long unused = 0;

    if (!mesh_has_inside(t))
        return false;
    struct search s;
    search_init(&s, t->mesh, 0, INFINITY);
    walk(t, ray, 0, INFINITY, visit_count, &s, &unused);
    return s.n & 1;
}

/* (c - a) x (b - a), by the edges' own unit: those of tiny faces would
 * underflow. */
static vec3 flat_normal(const struct mesh *m, uint32_t face)
{
    vec3 ab = vec_sub(*mesh_corner(m, face, 1), *mesh_corner(m, face, 0));
    vec3 ac = vec_sub(*mesh_corner(m, face, 2), *mesh_corner(m, face, 0));

    return vec_cross(vec_unit(ac), vec_unit(ab));
}

/* The normals of a face's corners; NULL: it has one for all of it. */
static const uint32_t *smooth_normals(const struct mesh *m, uint32_t face)
{
    const uint32_t *k = m->face_normal ? m->face_normal[face].of : NULL;

    return k && k[0] != MESH_NONE && !(k[0] == k[1] && k[0] == k[2]) ? k : NULL;
}

bool mesh_is_flat(const struct mesh_tree *t, uint32_t face)
{
    return !smooth_normals(t->mesh, face);
}

vec3 mesh_normal(const struct mesh_tree *t, const struct hit *h)
{
    const struct mesh *m = t->mesh;
    const uint32_t *k = smooth_normals(m, h->part);
    double u = (double)h->u, v = (double)h->v;

    if (!k)
        return flat_normal(m, h->part);
    vec3 n = vec_scale(m->normal[k[0]], 1 - u - v);
    n = vec_fma(vec_fma(n, u, m->normal[k[1]]), v, m->normal[k[2]]);
    return vec_largest(n) > 0 ? n : flat_normal(m, h->part);
}

vec2 mesh_uv(const struct mesh_tree *t, const struct hit *h, vec2 otherwise)
{
    const struct mesh *m = t->mesh;
    const uint32_t *k = m->face_uv ? m->face_uv[h->part].of : NULL;
    double u = (double)h->u, v = (double)h->v, w = 1 - u - v;

    if (!m->uv || !k || k[0] == MESH_NONE)
        return otherwise;
    vec2 a = m->uv[k[0]], b = m->uv[k[1]], c = m->uv[k[2]];
    return (vec2) { w * a.u + u * b.u + v * c.u, w * a.v + u * b.v + v * c.v };
}
