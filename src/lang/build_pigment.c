/* build_pigment.c: pigment { }, normal { }, density { }: a patterned body as a
 * struct of the scene. */
#include <string.h>

#include "lang/build.h"
#include "lang/colour.h"

static struct patterned from_said(const void *said, enum value_type of)
{
    return said ? *(const struct patterned *)said : patterned_new(of);
}

/* Plain colours share what was said but for the colour: to_pigment. */
static struct patterned from_pigment(const struct pigment *from, enum value_type of)
{
    struct patterned p = from_said(from ? from->said : NULL, of);

    if (p.kind == PATTERNED_COLOUR && !p.unsupported)
        p.colour = from->colour;
    return p;
}

static colour mix(colour a, colour b, float share)
{
    return (colour) { a.r + b.r * share, a.g + b.g * share, a.b + b.b * share,
                      a.f + b.f * share, a.t + b.t * share };
}

/* What stands for a pigment whose pattern cannot be shown: its mean colour. */
static colour mean_colour(const struct map *m)
{
    colour mean = { 0 };

    for (size_t i = 0; i < m->n; i++) {
        const struct map_entry *e = &m->entry[i];
        mean = mix(mean, e->pigment ? e->pigment->colour : e->colour, 1 / (float)m->n);
    }
    return mean;
}

static enum pigment_kind kind_of(const struct patterned *p)
{
    if (p->kind == PATTERNED_IMAGE)
        return PIGMENT_IMAGE;
    if (p->kind == PATTERNED_AVERAGE)
        return PIGMENT_AVERAGE;
    if (p->kind == PATTERNED_MAP || p->kind == PATTERNED_LIST)
        return p->map.type == VALUE_COLOUR_MAP ? PIGMENT_COLOUR_MAP : PIGMENT_PIGMENT_MAP;
    return PIGMENT_COLOUR;
}

/* What a pigment has no map for is not asked for its pattern. */
static const struct pattern_use *use_of(struct lang *l, enum pigment_kind kind,
                                        const struct patterned *said)
{
    bool has_map = kind == PIGMENT_COLOUR_MAP || kind == PIGMENT_PIGMENT_MAP;

    if (has_map || !said->use.ops)
        return &said->use;
    struct pattern_use *use = arena_copy(l->scene_mem, &said->use, sizeof *use);
    use->ops = NULL;
    return use;
}

static struct nest nest_of(const struct patterned *p)
{
    struct nest nest = p->nest;

    for (size_t i = 0; i < p->map.n; i++)
        if (p->map.entry[i].pigment)
            nest_add(&nest, p->map.entry[i].pigment->nest);
    return nest;
}

/* said: what is kept of p for good. */
static const struct pigment *new_pigment(struct lang *l, const struct patterned *p,
                                         const struct patterned *said)
{
    struct pigment *pigment = arena_copy(l->scene_mem, &pigment_default, sizeof *pigment);

    pigment->kind = kind_of(p);
    pigment->colour = p->colour;
    pigment->quick_colour = p->quick_colour;
    pigment->has_quick_colour = p->has_quick_colour;
    pigment->pattern = use_of(l, pigment->kind, said);
    pigment->entry = (struct map_entry *)p->map.entry;
    pigment->n_entry = p->map.n;
    pigment->image = &said->image;
    pigment->place = &said->place;
    pigment->uv_mapping = p->uv_mapping;
    pigment->nest = nest_of(p);
    pigment->said = said;
    pigment->unsupported = p->unsupported;
    bool shown = !p->unsupported && (pigment->kind != PIGMENT_IMAGE || p->image.image)
                 && (pigment->kind != PIGMENT_AVERAGE || p->map.n > 0);
    if (!shown) {
        pigment->kind = PIGMENT_COLOUR;
        pigment->colour = mean_colour(&p->map);
    }
    return pigment;
}

/* What was said of a plain colour, without the colour: as it was the last time,
 * of nearly all pigments of a scene. */
static const struct patterned *colourless(struct lang *l, const struct patterned *p)
{
    struct build *b = build_of(l);
    struct patterned said;

    memcpy(&said, p, sizeof said);              /* padding too */
    memset(&said.colour, 0, sizeof said.colour);
    memcpy(&said.place, &transform_identity, sizeof said.place);
    if (!b->said || memcmp(b->said, &said, sizeof said))
        b->said = arena_copy(l->scene_mem, &said, sizeof said);
    return b->said;
}

/* One that is no more than a colour may be said of thousands of objects, and
 * thousands may have one of their own. */
static const struct pigment *to_pigment(struct lang *l, struct patterned *p)
{
    struct { const struct patterned *said; colour colour; } key;

    if (p->kind != PATTERNED_COLOUR || !p->place.is_identity || p->unsupported)
        return new_pigment(l, p, arena_copy(l->scene_mem, p, sizeof *p));
    memset(&key, 0, sizeof key);
    key.said = colourless(l, p);
    key.colour = p->colour;
    const void **one = intern_at(&build_of(l)->plain, l->scene_mem, &key, sizeof key);
    if (!*one)
        *one = new_pigment(l, p, key.said);
    return *one;
}

static const struct pigment *read_pigment(struct reader *r, const struct item *block,
                                          const struct pigment *from, enum value_type type)
{
    const struct pigment *declared = build_start(r, type);

    if (declared)
        from = declared;
    struct patterned p = from_pigment(from, type);
    bool fresh = p.kind == PATTERNED_NONE;
    unsigned errors = r->lang->diag->errors;
    build_patterned(r, &p, block);
    if (fresh && errors == r->lang->diag->errors && p.kind == PATTERNED_NONE && type == VALUE_PIGMENT && block && !p.has_quick_colour)
        diag_warning(r->lang->diag, block->at, "this pigment has no colour or pattern: it is black");
    const struct pigment *made = to_pigment(r->lang, &p);
    lang_may_nest(r->lang, block ? block->at : r->brace, &made->nest);
    return made;
}

const struct pigment *build_pigment_body(struct reader *r, const struct item *block,
                                         const struct pigment *from)
{
    return read_pigment(r, block, from, VALUE_PIGMENT);
}

const struct pigment *build_density_body(struct reader *r, const struct item *block,
                                         const struct pigment *from)
{
    return read_pigment(r, block, from, VALUE_DENSITY);
}

const struct pigment *build_pigment(struct lang *l, const struct item *block,
                                    const struct pigment *from)
{
    struct reader r;

    reader_open(&r, l, block->body);
    const struct pigment *made = build_pigment_body(&r, block, from);
    reader_close(&r);
    return made;
}

bool make_pigment(struct lang *l, const struct item *block, struct value *out)
{
    *out = value_thing(VALUE_PIGMENT, build_pigment(l, block, build_of(l)->texture->pigment));
    return true;
}

bool make_density(struct lang *l, const struct item *block, struct value *out)
{
    struct reader r;

    reader_open(&r, l, block->body);
    *out = value_thing(VALUE_DENSITY, build_density_body(&r, block, NULL));
    reader_close(&r);
    return true;
}

/* --- normals -------------------------------------------------------------------- */

const struct normal *build_normal_body(struct reader *r, const struct item *block,
                                       const struct normal *from)
{
    const struct normal *declared = build_start(r, VALUE_NORMAL);

    if (declared)
        from = declared;
    struct patterned p = from_said(from ? from->said : NULL, VALUE_NORMAL);
    build_patterned(r, &p, block);
    struct normal *n = arena_alloc(r->lang->scene_mem, sizeof *n);
    *n = (struct normal) {
        .pattern = p.use, .amount = p.amount, .accuracy = p.accuracy, .place = p.place,
        .no_bump_scale = p.no_bump_scale, .word = p.word,
        .said = arena_copy(r->lang->scene_mem, &p, sizeof p),
    };
    return n;
}

const struct normal *build_normal(struct lang *l, const struct item *block,
                                  const struct normal *from)
{
    struct reader r;

    reader_open(&r, l, block->body);
    const struct normal *made = build_normal_body(&r, block, from);
    reader_close(&r);
    return made;
}

bool make_normal(struct lang *l, const struct item *block, struct value *out)
{
    *out = value_thing(VALUE_NORMAL, build_normal(l, block, build_of(l)->texture->normal));
    return true;
}
