/* colour.c: colour specifications. */
#include "lang/colour.h"

#include <string.h>

#include "lang/state.h"

enum { RED, GREEN, BLUE, FILTER, TRANSMIT };

/* Where the components of an expression go, and how many a lone number fills. */
struct base {
    const char *word;
    int n;
    bool is_srgb, is_transmit;          /* the fourth component is transmit, not filter */
};

static const struct base bases[] = {
    { "rgb", 3, false, false },  { "rgbf", 4, false, false },
    { "rgbt", 4, false, true },  { "rgbft", 5, false, false },
    { "srgb", 3, true, false },  { "srgbf", 4, true, false },
    { "srgbt", 4, true, true },  { "srgbft", 5, true, false },
};

static const struct { const char *word; int index; } parts[] = {
    { "red", RED }, { "green", GREEN }, { "blue", BLUE }, { "filter", FILTER },
    { "transmit", TRANSMIT }, { "alpha", FILTER },
};

const char *const colour_words[] = {
    "color", "colour", "rgb", "rgbf", "rgbt", "rgbft", "srgb", "srgbf", "srgbt", "srgbft",
    "red", "green", "blue", "filter", "transmit", "alpha", NULL,
};

#define COUNT(table) (sizeof (table) / sizeof *(table))

static const struct base *find_base(const struct item *i)
{
    if (i->kind != ITEM_WORD || i->word->class != WORD_RGB)
        return NULL;
    for (size_t b = 0; b < COUNT(bases); b++)
        if (strcmp(bases[b].word, i->word->text) == 0)
            return &bases[b];
    return NULL;
}

static int find_part(const struct item *i)
{
    if (i->kind == ITEM_WORD && i->word->class == WORD_COLOUR)
        for (size_t p = 0; p < COUNT(parts); p++)
            if (strcmp(parts[p].word, i->word->text) == 0)
                return (int)p;
    return -1;
}

static bool is_colour_word(const struct item *i)
{
    return i->kind == ITEM_WORD
           && (strcmp(i->word->text, "color") == 0 || strcmp(i->word->text, "colour") == 0);
}

bool item_is_colour(const struct item *i)
{
    if (i->kind == ITEM_VALUE)
        return i->value.type == VALUE_COLOUR;
    return is_colour_word(i) || find_base(i) || find_part(i) >= 0;
}

bool colour_is_next(struct reader *r) { return item_is_colour(reader_peek(r)); }

double srgb_decode(double x)
{
    return x < 0.04045 ? x / 12.92 : pow((x + 0.055) / 1.055, 2.4);
}

static double srgb_encode(double x)
{
    return x <= 0.0031308 ? 12.92 * x : 1.055 * pow(x, 1 / 2.4) - 0.055;
}

double working_encode(const struct settings *s, double linear)
{
    switch (s->space) {
    case SPACE_POWER:
        return pow(fmax(linear, 0), 1 / s->gamma);
    case SPACE_SRGB:
        return srgb_encode(linear);
    case SPACE_RAW: case SPACE_LINEAR:
        break;
    }
    return linear;
}

/* A scene's colours are decoded in single precision, as POV-Ray does it. */
static double srgb_decode_single(double v)
{
    float x = (float)v;

    return (double)(x < 0.04045f ? x / 12.92f : powf((x + 0.055f) / 1.055f, 2.4f));
}

static void decode_srgb(struct reader *r, struct loc at, double c[5])
{
    const struct settings *s = &r->lang->scene->settings;

    if (!s->has_assumed_gamma) {
        diag_error(r->lang->diag, at, "srgb colours need assumed_gamma to be set before");
        diag_note(r->lang->diag, at, "write global_settings { assumed_gamma 1.0 } above");
        return;
    }
    if (s->space != SPACE_SRGB)
        for (int i = 0; i < 3; i++)
            c[i] = working_encode(s, srgb_decode_single(c[i]));
}

/* A lone number fills what the word promises; too many components warn and
 * are kept. */
static void spread(struct reader *r, const struct base *b, const struct item *i, double c[5])
{
    const struct value *v = &i->value;

    for (int k = 0; k < 5; k++)
        c[k] = k < v->n ? v->v[k] : v->n == 1 && k < b->n ? v->v[0] : 0;
    if (v->n > b->n)
        diag_warning(r->lang->diag, i->at, "%s has %d components, not %d", b->word, v->n, b->n);
    if (b->is_transmit) {
        c[TRANSMIT] = c[FILTER];
        c[FILTER] = 0;
    }
}

static bool is_numeric(const struct item *i)
{
    return i->kind == ITEM_VALUE
           && (i->value.type == VALUE_NUMBER || i->value.type == VALUE_COLOUR);
}

static bool read_base(struct reader *r, double c[5])
{
    const struct base *b = find_base(reader_peek(r));
    struct loc at = reader_at(r);

    if (b) {
        reader_next(r);
        if (!is_numeric(reader_peek(r))) {
            if (reader_explains(r))
                return false;
            diag_error(r->lang->diag, reader_at(r), "%s needs a vector or a number; found %s",
                       b->word, item_describe(r->lang, reader_peek(r)));
            return false;
        }
        struct item i = reader_next(r);
        spread(r, b, &i, c);
        if (b->is_srgb)
            decode_srgb(r, at, c);
        return true;
    }
    if (is_numeric(reader_peek(r))) {
        struct item i = reader_next(r);
        for (int k = 0; k < 5; k++)
            c[k] = i.value.n == 1 ? i.value.v[0] : k < i.value.n ? i.value.v[k] : 0;
    }
    return true;
}

/* `color red` is what Red of colors.inc was meant to be. */
static bool needs_number(struct reader *r, const struct item *word)
{
    if (reader_peek(r)->kind != ITEM_END && reader_peek(r)->kind != ITEM_WORD)
        return true;
    diag_error(r->lang->diag, word->at, "'%s' is a component and needs a number, as in %s 1",
               word->text, word->text);
    diag_note(r->lang->diag, word->at, "the colours of colors.inc begin with a capital: Red, Green");
    return false;
}

static void read_parts(struct reader *r, double c[5])
{
    for (int p = find_part(reader_peek(r)); p >= 0; p = find_part(reader_peek(r))) {
        struct item word = reader_next(r);
        if (strcmp(parts[p].word, "alpha") == 0)
            diag_warning(r->lang->diag, word.at, "'alpha' means 'filter' here");
        if (!needs_number(r, &word))
            return;
        c[parts[p].index] = reader_number(r, false, parts[p].word);
    }
}

static bool read_components(struct reader *r, double c[5])
{
    memset(c, 0, 5 * sizeof *c);
    if (is_colour_word(reader_peek(r)))
        reader_next(r);
    bool good = read_base(r, c);
    read_parts(r, c);
    return good;
}

/* Colours are single precision, as POV-Ray's (facts sdl.md 2.1). */
bool colour_read(struct reader *r, struct value *out)
{
    double c[5];
    bool good = read_components(r, c);

    *out = (struct value) { .type = VALUE_COLOUR, .n = 5 };
    for (int k = 0; k < 5; k++)
        out->v[k] = (double)(float)c[k];
    return good;
}

static bool may_start(struct reader *r)
{
    return colour_is_next(r) || is_numeric(reader_peek(r));
}

colour colour_take(struct reader *r, bool comma, const char *what)
{
    struct value v;

    if (comma)
        reader_skip_comma(r);
    if (!may_start(r)) {
        if (!reader_explains(r))
            diag_error(r->lang->diag, reader_at(r), "expected a colour for %s; found %s", what,
                       item_describe(r->lang, reader_peek(r)));
        return (colour) { 0 };
    }
    colour_read(r, &v);
    return (colour) { (float)v.v[0], (float)v.v[1], (float)v.v[2], (float)v.v[3], (float)v.v[4] };
}

rgb colour_take_rgb(struct reader *r, bool comma, const char *what)
{
    if (comma)
        reader_skip_comma(r);
    const struct item *i = reader_peek(r);
    bool plain = i->kind == ITEM_VALUE && i->value.type == VALUE_NUMBER && i->value.n == 1;
    struct loc at = i->at;
    colour c = colour_take(r, false, what);
    if ((c.f != 0 || c.t != 0) && !plain)
        diag_warning(r->lang->diag, at, "filter and transmit have no meaning for %s", what);
    return colour_rgb(c);
}
