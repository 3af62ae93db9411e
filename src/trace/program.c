/* program.c: textures as short programs. */
#include "trace/program.h"

static rgb times(rgb a, rgb b) { return rgb_mul(a, b); }

static bool is_dark(rgb c) { return c.r == 0 && c.g == 0 && c.b == 0; }

/* POV-Ray keeps the reciprocals of roughness and exponent, in floats. */
const struct gloss *gloss_new(struct arena *mem, const struct settings *settings,
                              const struct finish *f)
{
    struct gloss *g = arena_alloc(mem, sizeof *g);

    g->ambient = times(f->ambient, settings->ambient_light);
    g->emission = f->emission;
    g->diffuse = (float)f->diffuse;
    g->diffuse_back = (float)f->diffuse_back;
    g->brilliance = (float)f->brilliance;
    g->phong = (float)f->phong;
    g->phong_size = (float)f->phong_size;
    g->specular = (float)f->specular;
    g->shininess = f->roughness > 0 ? (float)(1 / f->roughness) : 0;
    g->metallic = (float)f->metallic;
    g->crand = (float)f->crand;
    g->irid = (float)f->irid;
    g->irid_thickness = (float)f->irid_thickness;
    g->mirror.low = f->reflection.low;
    g->mirror.high = f->reflection.high;
    g->mirror.falloff = (float)f->reflection.falloff;
    g->mirror.metallic = (float)f->reflection.metallic;
    g->mirror.power = f->reflection.exponent > 0 ? (float)(1 / f->reflection.exponent) : 1;
    g->mirror.fresnel = f->reflection.fresnel;
    g->has_mirror = !is_dark(g->mirror.low) || !is_dark(g->mirror.high);
    g->has_highlight = g->phong != 0 || g->specular != 0;
    g->conserve_energy = f->conserve_energy;
    return g;
}

static void add_layers(struct program *p, struct arena *mem, const struct settings *settings,
                       const struct texture *bottom, const struct transform *outer)
{
    int n = 0;

    for (const struct texture *t = bottom; t; t = t->above)
        n++;
    struct layer *layer = arena_array(mem, (size_t)n, sizeof *layer);
    p->layer = layer;
    p->n_layer = n;
    p->can_transmit = true;
    for (const struct texture *t = bottom; t; t = t->above) {
        struct transform place = t->uv_mapping ? *t->place : transform_compose(outer, t->place);
        struct pigment pigment = *t->pigment;
        pigment.uv_mapping |= t->uv_mapping;
        if (t->uv_mapping)
            pigment.place = transform_moved(mem, &place, pigment.place);
        struct layer *l = &layer[--n];
        l->paint = paint_new(mem, &pigment, &place);
        l->gloss = gloss_new(mem, settings, t->finish);
        l->can_transmit = l->paint->can_transmit;
        p->can_transmit &= l->can_transmit;
        p->has_mirror |= l->gloss->has_mirror;
        p->wants_uv |= l->paint->wants_uv;
    }
    p->is_plain = p->n_layer == 1 && layer[0].paint->kind == PIGMENT_COLOUR;
    p->colour = layer[0].paint->colour;
}

struct program *program_plain(struct arena *mem, const struct pigment *p, const struct gloss *gloss)
{
    struct program *made = arena_alloc(mem, sizeof *made);
    const struct paint *paint = paint_new(mem, p, &transform_identity);
    const struct layer layer = { paint, gloss, paint->can_transmit };

    made->is_plain = true;
    made->colour = p->colour;
    made->can_transmit = paint->can_transmit;
    made->has_mirror = gloss->has_mirror;
    made->wants_uv = paint->wants_uv;
    made->layer = arena_copy(mem, &layer, sizeof layer);
    made->n_layer = 1;
    return made;
}

static void add_entries(struct program *p, struct arena *mem, const struct settings *settings,
                        const struct texture *t)
{
    const struct program **entry = arena_array(mem, t->n_entry, sizeof *entry);
    float *weight = arena_array(mem, t->n_entry, sizeof *weight);
    double total = 0;

    for (size_t i = 0; i < t->n_entry; i++) {
        entry[i] = program_new(mem, settings, t->entry[i].texture, &transform_identity);
        p->can_transmit |= entry[i]->can_transmit;
        p->has_mirror |= entry[i]->has_mirror;
        p->wants_uv |= entry[i]->wants_uv;
        total += (float)t->entry[i].value;
    }
    for (size_t i = 0; i < t->n_entry; i++)
        weight[i] = (float)(total != 0 ? (float)t->entry[i].value / total
                                       : 1.0 / (double)t->n_entry);
    p->entry = entry;
    p->weight = weight;
}

struct program *program_new(struct arena *mem, const struct settings *settings,
                            const struct texture *texture, const struct transform *outer)
{
    struct program *p = arena_alloc(mem, sizeof *p);

    if (texture->kind == TEXTURE_PLAIN) {
        p->kind = PROGRAM_LAYERS;
        add_layers(p, mem, settings, texture, outer);
        return p;
    }
    p->kind = texture->kind == TEXTURE_MAP ? PROGRAM_MAP : PROGRAM_AVERAGE;
    p->wants_uv = texture->uv_mapping;
    add_entries(p, mem, settings, texture);
    struct chain chain = chain_of(outer, texture->place, texture->uv_mapping,
                                  &texture->pattern->turbulence);
    p->gauge = gauge_new(mem, &chain, texture->pattern, texture->entry, texture->n_entry);
    return p;
}

/* ---- shadows ---- */

static rgb through(colour c)
{
    return rgb_of(c.r * c.f + c.t, c.g * c.f + c.t, c.b * c.f + c.t);
}

static void filter_layers(const struct program *p, const struct spots *s, rgb out[])
{
    struct colours c;

    for (int i = 0; i < s->n; i++)
        out[i] = rgb_of(1, 1, 1);
    for (int k = 0; k < p->n_layer; k++) {
        paint_colours(p->layer[k].paint, s, &c);
        for (int i = 0; i < s->n; i++)
            out[i] = rgb_mul(out[i], through((colour) { c.r[i], c.g[i], c.b[i], c.f[i], c.t[i] }));
    }
}

static float share_of(const struct program *p, int entry, struct map_place where)
{
    if (p->kind == PROGRAM_AVERAGE)
        return p->weight[entry];
    return where.before == entry ? 1 - where.share : where.after == entry ? where.share : 0;
}

/* Every entry at every point: shadows through texture maps are rare. */
static void filter_map(const struct program *p, const struct spots *s, rgb out[])
{
    double x[BATCH], y[BATCH], z[BATCH];
    struct map_place where[BATCH] = { { 0, 0, 0 } };
    rgb part[BATCH];

    if (p->kind == PROGRAM_MAP)
        gauge_read(p->gauge, s, x, y, z, where);
    else
        chain_walk(&p->gauge->chain, s, x, y, z);
    struct spots inner = { s->n, x, y, z, s->u, s->v };
    for (int i = 0; i < s->n; i++)
        out[i] = rgb_of(0, 0, 0);
    for (int e = 0; e < p->gauge->n_key; e++) {
        program_filter(p->entry[e], &inner, part);
        for (int i = 0; i < s->n; i++)
            out[i] = rgb_add(out[i], rgb_scale(part[i], share_of(p, e, where[i])));
    }
}

void program_filter(const struct program *p, const struct spots *s, rgb out[])
{
    if (p->kind == PROGRAM_LAYERS)
        filter_layers(p, s, out);
    else
        filter_map(p, s, out);
}
