/* plan.c: from the scene to how it is rendered, and what the plan says of
 * itself. */
#include "trace/plan.h"

#include <stdarg.h>
#include <string.h>

#include "trace/surface.h"
#include "trace/world.h"

struct plan *plan_new(struct scene *s, struct arena *mem, unsigned threads)
{
    struct plan *p = arena_alloc(mem, sizeof *p);

    p->mem = mem;
    p->scene = s;
    p->camera = s->camera;
    p->light = s->light;
    p->n_light = s->n_light;
    geometry_build(p, s, threads);
    shader_build(p);
    return p;
}

void plan_note(struct plan *p, const char *format, ...)
{
    enum { MOST = sizeof p->note / sizeof *p->note };
    char text[256];
    va_list args;

    if (p->n_note == MOST)
        return;
    va_start(args, format);
    int n = vsnprintf(text, sizeof text, format, args);
    va_end(args);
    if (n < 0)
        return;
    size_t length = (size_t)n < sizeof text ? (size_t)n : sizeof text - 1;
    for (size_t i = 0; i < p->n_note; i++)
        if (strcmp(p->note[i], text) == 0)
            return;
    p->note[p->n_note++] = arena_text(p->mem, text, length);
}

/* --- --explain ------------------------------------------------------------- */

static const char *leaf_name(const struct leaf *l) { return l->ops ? l->ops->name : "mesh"; }

static void explain_shapes(const struct plan *p, FILE *out)
{
    for (const struct shape_ops *const *row = shapes; *row; row++) {
        size_t n = 0;
        for (size_t i = 0; i < p->n_leaf; i++)
            n += p->leaf[i].ops && strcmp(p->leaf[i].ops->name, (*row)->name) == 0;
        if (n)
            fprintf(out, "  %-16s %zu\n", (*row)->name, n);
    }
}

static void explain_meshes(const struct plan *p, FILE *out)
{
    size_t n = 0, faces = 0;

    for (size_t i = 0; i < p->n_leaf; i++)
        if (!p->leaf[i].ops) {
            n++;
            faces += p->leaf[i].mesh->tree.n_item;
        }
    if (n)
        fprintf(out, "  %-16s %zu, of %zu triangles as placed\n", "mesh", n, faces);
}

static void explain_csg(const struct plan *p, FILE *out)
{
    const struct geometry *g = p->geometry;
    size_t parts = 0, asked = 0;

    for (size_t i = 0; i < g->n_csg; i++) {
        parts += g->csg[i].n_part;
        asked += g->csg[i].n_asked;
    }
    if (g->n_csg)
        fprintf(out, "constructive geometry: %zu roots of %zu parts by spans\n", g->n_csg, parts);
    if (asked)
        fprintf(out, "  %zu open parts are asked point by point\n", asked);
}

static void explain_trees(const struct plan *p, FILE *out)
{
    const struct geometry *g = p->geometry;
    size_t bytes = 0, nodes = 0;

    for (size_t i = 0; i < g->n_space; i++) {
        nodes += g->space[i].tree.n_node;
        bytes += g->space[i].tree.n_item * sizeof(uint32_t);
    }
    bytes += nodes * sizeof(struct bvh_node);
    fprintf(out, "tree: %zu items in %zu nodes of 8, %.1f MB; %zu unbounded\n",
            g->space[0].tree.n_item, nodes, (double)bytes / 1e6, g->space[0].n_unbounded);
    if (p->n_instance)
        fprintf(out, "instances: %zu placements of %zu stored groups\n", p->n_instance,
                g->n_space - 1);
}

static void explain_rays(const struct plan *p, FILE *out)
{
    fprintf(out, "rays: primary%s%s%s\n", p->has_shadows ? ", shadow" : "",
            p->has_reflection ? ", reflected" : "", p->has_refraction ? ", refracted" : "");
    if (p->has_shadows)
        fprintf(out, "shadows: %s\n", p->has_transparency ? "filtered by what lets light through"
                                                         : "the first opaque thing decides");
}

void plan_explain(const struct plan *p, FILE *out)
{
    fprintf(out, "shapes: %zu\n", p->n_leaf);
    explain_shapes(p, out);
    explain_meshes(p, out);
    explain_csg(p, out);
    explain_trees(p, out);
    fprintf(out, "surfaces: %zu\nlights: %zu\n", p->n_surface, p->n_light);
    explain_rays(p, out);
    for (size_t i = 0; i < p->n_note; i++)
        fprintf(out, "note: %s\n", p->note[i]);
}

/* --- --dump=plan ----------------------------------------------------------- */

static void dump_bounds(struct bounds b, FILE *out)
{
    fprintf(out, "<%g, %g, %g>..<%g, %g, %g>", b.low.x, b.low.y, b.low.z, b.high.x, b.high.y,
            b.high.z);
}

static void dump_mask(uint8_t mask, FILE *out)
{
    fprintf(out, "%s%s%s", mask & RAY_PRIMARY ? "" : " no_image",
            mask & RAY_REFLECTED ? "" : " no_reflection", mask & RAY_SHADOW ? "" : " no_shadow");
}

static void dump_leaf(const struct plan *p, uint32_t number, FILE *out)
{
    const struct leaf *l = &p->leaf[number];

    fprintf(out, "leaf %u %s ", number, leaf_name(l));
    dump_bounds(leaf_bounds(l), out);
    if (l->surface == NO_LEAF)
        fputs(" surface of the instance", out);
    else
        fprintf(out, " surface %u", l->surface);
    fputs(l->inverse ? " inverse" : "", out);
    dump_mask(l->mask, out);
    fputc('\n', out);
}

static void dump_csg(const struct plan *p, const struct csg *c, FILE *out)
{
    static const char *const names[] = { "union", "merge", "intersection" };

    dump_bounds(c->bounds, out);
    dump_mask(c->mask, out);
    fputc('\n', out);
    for (size_t i = 0; i < c->n_node; i++)
        fprintf(out, "    node %zu %s in %d, %u of %u inside far away\n", i,
                names[c->node[i].kind], (int)c->node[i].parent, c->at_rest[i], c->node[i].n_child);
    for (size_t i = 0; i < c->n_part; i++) {
        fprintf(out, "    in %u%s%s: ", c->part[i].parent, c->part[i].is_silent ? " silent" : "",
                c->part[i].is_asked ? " asked" : "");
        dump_leaf(p, c->part[i].leaf, out);
    }
}

static void dump_instance(const struct instance *i, FILE *out)
{
    fprintf(out, "of space %u", i->root);
    if (i->surface != NO_LEAF)
        fprintf(out, " surface %u", i->surface);
    dump_mask(i->mask, out);
    for (int row = 0; row < 3; row++)
        fprintf(out, "%s%g %g %g %g", row ? "; " : " matrix ", i->place.to.m[row][0],
                i->place.to.m[row][1], i->place.to.m[row][2], i->place.to.m[row][3]);
    fputc('\n', out);
}

static void dump_item(const struct plan *p, uint32_t item, FILE *out)
{
    uint32_t number = item_number(item);

    fputs("  ", out);
    switch (item_kind(item)) {
    case ITEM_LEAF:
        dump_leaf(p, number, out);
        break;
    case ITEM_CSG:
        fprintf(out, "csg %u ", number);
        dump_csg(p, &p->geometry->csg[number], out);
        break;
    case ITEM_INSTANCE:
        fprintf(out, "instance %u ", number);
        dump_instance(&p->instance[number], out);
        break;
    }
}

static const char *pigment_word(const struct pigment *g)
{
    switch (g->kind) {
    case PIGMENT_COLOUR:  return "plain";
    case PIGMENT_IMAGE:   return "image_map";
    case PIGMENT_AVERAGE: return "average";
    default:              return g->pattern->ops->name;
    }
}

static bool is_bright(rgb c) { return c.r > 0 || c.g > 0 || c.b > 0; }

static void dump_layer(const struct texture *t, FILE *out)
{
    if (t->kind != TEXTURE_PLAIN) {
        fprintf(out, " %s of %zu textures", t->pattern->ops ? t->pattern->ops->name : "average",
                t->n_entry);
        return;
    }
    const struct finish *f = t->finish;
    fprintf(out, " %s%s%s%s", pigment_word(t->pigment), f->phong > 0 ? ", phong" : "",
            f->specular > 0 ? ", specular" : "", is_bright(f->reflection.high) ? ", reflection" : "");
}

static void dump_surface(const struct surface *s, FILE *out)
{
    for (const struct texture *t = s->texture; t; t = t->above) {
        fputs(t == s->texture ? "" : "; above it", out);
        dump_layer(t, out);
    }
    fputs(s->is_opaque ? ", opaque" : ", lets light through", out);
    if (s->interior && s->interior->ior > 0)
        fprintf(out, ", ior %g", s->interior->ior);
    fputc('\n', out);
}

void plan_dump(const struct plan *p, FILE *out)
{
    for (size_t i = 0; i < p->geometry->n_space; i++) {
        const struct space *s = &p->geometry->space[i];
        if (i == 0)
            fputs("world\n", out);
        else
            fprintf(out, "space %zu\n", i);
        for (size_t k = 0; k < s->n_unbounded; k++)
            dump_item(p, s->unbounded[k], out);
        for (size_t k = 0; k < s->tree.n_item; k++)
            dump_item(p, s->tree.item[k], out);
    }
    for (size_t i = 0; i < p->n_surface; i++) {
        fprintf(out, "surface %zu:", i);
        dump_surface(&p->surface[i], out);
    }
    for (size_t i = 0; i < p->n_note; i++)
        fprintf(out, "note: %s\n", p->note[i]);
}
