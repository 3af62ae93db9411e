/* mesh_stream.c: many rays go down the tree of one mesh together. */
#include "shape/triangle.h"
#include "trace/mesh.h"

struct flight {
    const struct mesh_tree *tree;
    struct stream *stream;
    bool is_any;
    struct sieve_line line[STREAM];
    struct triangle_ray ray[STREAM];
    double far[STREAM];                 /* of the ray, then of the best */
    struct triangle_hit best[STREAM];
    uint32_t face[STREAM];              /* NO_FACE: none is met yet */
};

#define NO_FACE UINT32_MAX

/* Only rays that reach the tree's box. */
static void prepare(struct flight *f, const struct packet *p)
{
    const struct stream *s = f->stream;

    for (int i = 0; i < s->n; i++) {
        f->face[i] = NO_FACE;
        if (s->limit[i] < 0)
            continue;
        const float at[] = { s->at[0][i], s->at[1][i], s->at[2][i] };
        const float dir[] = { s->dir[0][i], s->dir[1][i], s->dir[2][i] };
        sieve_line(&f->line[i], at, dir);
        f->ray[i] = triangle_ray(packet_ray(p, i));
    }
}

/* As one ray's search takes it (mesh.c): of equal t, the first face. */
static void try_face(struct flight *f, int i, uint32_t face)
{
    const struct mesh *m = f->tree->mesh;
    struct triangle_hit h;

    if (!triangle_cross(&f->ray[i], *mesh_corner(m, face, 0), *mesh_corner(m, face, 1),
                        *mesh_corner(m, face, 2), &h) || !(h.t > 0))
        return;
    if (!(h.t < f->far[i]) && !(h.t == f->far[i] && face < f->face[i] && f->face[i] != NO_FACE))
        return;
    f->best[i] = h;
    f->face[i] = face;
    f->far[i] = h.t;
    if (f->is_any)
        stream_end(f->stream, i);
    else
        stream_set_far(f->stream, i, h.t);
}

static void visit(void *arg, uint32_t first, const uint8_t ray[], uint8_t bits[], int n)
{
    struct flight *f = arg;
    const struct stream *s = f->stream;
    const uint32_t *item = f->tree->tree.item + first;
    uint32_t count = (uint32_t)__builtin_popcount(bits[0]);     /* no leaf of a mesh is sifted before */

    for (int k = 0; k < n; k++) {
        int i = ray[k];
        struct sieve_ray coarse;
        sieve_spread(&coarse, &f->line[i], s->ball_apart);
        unsigned may = bits[k] & sieve_test(&f->tree->sieve, &coarse, first, count, s->limit[i]);
        for (; may; may &= may - 1)
            try_face(f, i, item[__builtin_ctz(may)]);
    }
}

static void put(const struct flight *f, int i, struct crossings *out)
{
    const struct mesh *m = f->tree->mesh;
    uint32_t face = f->face[i];

    out->t[0][i] = f->best[i].t;
    out->u[i] = f->best[i].u;
    out->v[i] = f->best[i].v;
    out->part[0][i] = face;
    out->slack[0][i] = triangle_slack(&f->ray[i], *mesh_corner(m, face, 0),
                                      *mesh_corner(m, face, 1), *mesh_corner(m, face, 2));
    out->met[i / WIDE] |= (uint8_t)(1 << i % WIDE);
}

void mesh_nearest_stream(const struct mesh_tree *t, struct stream *s, const struct packet *p,
                         const double far[], bool is_any, struct crossings *out,
                         unsigned long long *box_tests)
{
    const struct rays r = { .n = p->n, .x = p->o[0], .y = p->o[1], .z = p->o[2],
                            .dx = p->d[0], .dy = p->d[1], .dz = p->d[2] };
    struct flight f;

    f.tree = t;
    f.stream = s;
    f.is_any = is_any;
    memcpy(f.far, far, (size_t)p->n * sizeof *far);
    stream_aim(s, &t->tree, &r, far);
    prepare(&f, p);
    stream_walk(s, &t->tree, !is_any, visit, &f, box_tests);
    out->most = 1;
    out->has_weights = true;
    memset(out->met, 0, sizeof out->met);
    memset(out->unsure, 0, sizeof out->unsure);
    for (int i = 0; i < p->n; i++)
        if (f.face[i] != NO_FACE)
            put(&f, i, out);
}
