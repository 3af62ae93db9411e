/* pigment.c: pigments and patterns at single points, as the language's
 * functions ask for them; the tracer has its own way, for many points. */
#include "scene/picture.h"
#include "scene/tune.h"

/* Where a point lies for the pattern; entries of a map see the same point. */
static vec3 pattern_point(const struct pattern_use *use, const struct transform *place, vec3 p)
{
    p = mat_point(&place->from, p);
    if (vec_largest(use->turbulence.amount) > 0 && !(use->ops && use->ops->keeps_point))
        stir(&use->turbulence, &p.x, &p.y, &p.z);
    return p;
}

static double pattern_value(const struct pattern_use *use, vec3 p)
{
    double value;

    use->ops->values(use->self, 1, &p.x, &p.y, &p.z, &value);
    return tune(use, value);
}

double pattern_at(const struct pattern_use *use, const struct transform *place, vec3 p)
{
    return pattern_value(use, pattern_point(use, place, p));
}

/* As look_up, with the keys where the scene has them. */
static struct map_place place_in_map(const struct pigment *p, double v)
{
    const struct map_entry *e = p->entry;
    int n = (int)p->n_entry, c = 0;

    if (v >= (double)(float)e[n - 1].value)
        return (struct map_place) { n - 1, n - 1, 0 };
    while ((double)(float)e[c].value < v)
        c++;
    float key[2] = { (float)e[c ? c - 1 : 0].value, (float)e[c].value };
    struct map_place at = look_up(key, 2, v);
    int first = c ? c - 1 : 0;
    return (struct map_place) { at.before ? c : first, at.after ? c : first, at.share };
}

static colour entry_at(const struct pigment *p, int i, vec3 at)
{
    return p->kind == PIGMENT_COLOUR_MAP ? p->entry[i].colour : pigment_at(p->entry[i].pigment, at);
}

static colour map_at(const struct pigment *p, vec3 at)
{
    struct map_place m = place_in_map(p, pattern_value(p->pattern, at));
    colour c = entry_at(p, m.before, at);

    return m.share == 0 ? c : colour_between(c, entry_at(p, m.after, at), m.share);
}

static colour average_at(const struct pigment *p, vec3 at)
{
    double sum[5] = { 0 }, total = 0;

    for (size_t i = 0; i < p->n_entry; i++) {
        double weight = (float)p->entry[i].value;
        colour c = pigment_at(p->entry[i].pigment, at);
        sum[0] += weight * c.r;
        sum[1] += weight * c.g;
        sum[2] += weight * c.b;
        sum[3] += weight * c.f;
        sum[4] += weight * c.t;
        total += weight;
    }
    return (colour) { (float)(sum[0] / total), (float)(sum[1] / total), (float)(sum[2] / total),
                      (float)(sum[3] / total), (float)(sum[4] / total) };
}

colour pigment_at(const struct pigment *p, vec3 at)
{
    if (p->kind == PIGMENT_COLOUR)
        return p->colour;
    at = pattern_point(p->pattern, p->place, at);
    switch (p->kind) {
    case PIGMENT_IMAGE: return picture_colour(p->image, at);
    case PIGMENT_AVERAGE: return average_at(p, at);
    default: return map_at(p, at);
    }
}

const char *pigment_unsupported(const struct pigment *p)
{
    const char *what = p->unsupported;

    if (!what && (p->kind == PIGMENT_PIGMENT_MAP || p->kind == PIGMENT_AVERAGE))
        for (size_t i = 0; !what && i < p->n_entry; i++)
            what = pigment_unsupported(p->entry[i].pigment);
    return what ? what : p->uv_mapping ? "uv_mapping without a surface" : NULL;
}
