/* value.c: what an expression or a declaration evaluates to. */
#include "lang/value.h"

#include <string.h>

#include "lang/state.h"

static const char *const type_names[] = {
    [VALUE_NONE] = "nothing", [VALUE_NUMBER] = "number", [VALUE_COLOUR] = "colour",
    [VALUE_TEXT] = "text", [VALUE_ARRAY] = "array", [VALUE_FUNCTION] = "function",
    [VALUE_SPLINE] = "spline", [VALUE_MACRO] = "macro", [VALUE_FILE] = "file",
    [VALUE_TRANSFORM] = "transform", [VALUE_OBJECT] = "object", [VALUE_TEXTURE] = "texture",
    [VALUE_PIGMENT] = "pigment", [VALUE_NORMAL] = "normal", [VALUE_FINISH] = "finish",
    [VALUE_INTERIOR] = "interior", [VALUE_MATERIAL] = "material", [VALUE_MEDIA] = "media",
    [VALUE_DENSITY] = "density", [VALUE_COLOUR_MAP] = "color_map",
    [VALUE_PIGMENT_MAP] = "pigment_map", [VALUE_NORMAL_MAP] = "normal_map",
    [VALUE_SLOPE_MAP] = "slope_map", [VALUE_TEXTURE_MAP] = "texture_map",
    [VALUE_DENSITY_MAP] = "density_map", [VALUE_CAMERA] = "camera", [VALUE_FOG] = "fog",
    [VALUE_RAINBOW] = "rainbow", [VALUE_SKY_SPHERE] = "sky_sphere",
};

const char *value_type_name(enum value_type type)
{
    return type_names[type];
}

const char *value_name(const struct value *v)
{
    if (v->type == VALUE_NUMBER && v->n > 1)
        return "vector";
    return type_names[v->type];
}

const char *value_describe(struct lang *l, const struct value *v)
{
    const char *name = value_name(v);

    if (v->type == VALUE_NUMBER && v->n > 1)
        return arena_format(l->mem, "a vector of %d components", v->n);
    return arena_format(l->mem, "a%s %s", strchr("aeio", *name) ? "n" : "", name);
}

bool value_is_number(const struct value *v)
{
    return v->type == VALUE_NUMBER || v->type == VALUE_COLOUR;
}

double value_component(const struct value *v, int i)
{
    if (i < v->n || v->rest != REST_NONE)
        return v->v[i];
    return v->n == 1 ? v->v[0] : 0;
}

bool value_components(const struct value *v, int n, double *out)
{
    if (!value_is_number(v) || v->n > n)
        return false;
    for (int i = 0; i < n; i++)
        out[i] = value_component(v, i);
    return true;
}

struct value value_number(double x)
{
    return (struct value) { .type = VALUE_NUMBER, .n = 1, .v = { x } };
}

int value_whole(double x)
{
    if (!(x > -2147483648.0))
        return -2147483647 - 1;
    return x < 2147483647.0 ? (int)x : 2147483647;
}

struct value value_vector(int n, const double *v)
{
    struct value value = { .type = VALUE_NUMBER, .n = (int16_t)n };

    for (int i = 0; i < n; i++)
        value.v[i] = v[i];
    return value;
}

struct value value_text(struct lang *l, const char *bytes, size_t size)
{
    return (struct value) { .type = VALUE_TEXT,
                            .text = { arena_text(l->mem, bytes, size), size } };
}

struct value value_thing(enum value_type type, const void *thing)
{
    return (struct value) { .type = type, .thing = thing };
}
