/* build_settings.c: global_settings { }, and what the scene's numbers mean. */
#include <float.h>
#include <math.h>
#include <string.h>

#include "lang/build.h"
#include "lang/colour.h"

/* Read, checked, then dropped with one warning: rows of blocks not rendered yet. */
struct unkept { double number; bool flag; const char *text; };
#define NUMBER(word) { word, FIELD_NUM, offsetof(struct unkept, number), ANY, "" }
#define RANGE(word, ...) { word, FIELD_NUM, offsetof(struct unkept, number), __VA_ARGS__, "" }
#define ABOVE_0 DBL_MIN, INFINITY
#define FLAG(word) { word, FIELD_FLAG, offsetof(struct unkept, flag), ANY, "" }
#define TEXT(word) { word, FIELD_TEXT, offsetof(struct unkept, text), ANY, "" }
#define NUMBERS(word, n) { word, FIELD_CUSTOM, n, ANY, "" }    /* the first must be there */

const struct field radiosity_fields[] = {
    RANGE("pretrace_start", DBL_MIN, 1), NUMBER("pretrace_end"), NUMBERS("count", 2),
    NUMBERS("nearest_count", 2), RANGE("error_bound", ABOVE_0), RANGE("low_error_factor", ABOVE_0),
    NUMBER("minimum_reuse"), RANGE("maximum_reuse", ABOVE_0), RANGE("recursion_limit", 1, 20),
    RANGE("gray_threshold", 0, 1), RANGE("brightness", ABOVE_0), RANGE("adc_bailout", ABOVE_0),
    NUMBER("max_sample"),
    FLAG("normal"), FLAG("media"), FLAG("subsurface"), FLAG("always_sample"), NUMBER("importance"),
    TEXT("load_file"), TEXT("save_file"), FIELD_END,
};

const struct field photons_fields[] = {
    NUMBER("spacing"), NUMBER("count"), NUMBERS("gather", 2), NUMBERS("media", 2),
    NUMBER("jitter"), NUMBER("autostop"), NUMBER("max_trace_level"), NUMBER("adc_bailout"),
    NUMBERS("expand_thresholds", 2), NUMBERS("radius", 4), TEXT("load_file"), TEXT("save_file"),
    FIELD_END,
};

const struct field subsurface_fields[] = { NUMBERS("samples", 2), FLAG("radiosity"), FIELD_END };

const struct field settings_more_fields[] = {
    { "ascii", FIELD_CUSTOM, 0, ANY, "texts are plain" },
    { "utf8", FIELD_CUSTOM, 0, ANY, "texts are UTF-8" },
    { "sys", FIELD_CUSTOM, 0, ANY, "texts are as the system has them" },
    FIELD_END,
};

static void skip_block(struct lang *l, const struct item *block, const struct field *table)
{
    const struct field *const tables[] = { table, NULL };
    struct unkept unkept;
    struct reader r;

    reader_open(&r, l, block->body);
    for (struct item i = reader_next(&r); i.kind != ITEM_END; i = reader_next(&r)) {
        const struct field *f = i.kind == ITEM_WORD ? field_find(table, i.word->text) : NULL;
        if (!f)
            build_unknown(l, &i, block->text, tables);
        else if (!build_field(&r, f, f->name, i.at, &unkept))
            for (size_t n = 0; n < f->offset; n++)
                if (n == 0 || (reader_skip_comma(&r), reader_is_number(&r)))
                    reader_number(&r, false, f->name);
    }
    reader_close(&r);
    diag_unsupported(l->diag, block->at, block->text);
}

/* --- gamma: facts shading.md 5.2 ------------------------------------------------ */

static enum working_space space_of(double gamma)
{
    return fabs(gamma - 1) < 0.01 ? SPACE_LINEAR : SPACE_POWER;
}

static void read_gamma(struct reader *r)
{
    struct settings *s = &r->lang->scene->settings;
    struct loc at = reader_at(r);
    bool srgb = reader_takes_word(r, "srgb");
    double gamma = srgb ? 2.2 : reader_number(r, false, "assumed_gamma");

    if (!(gamma > 0)) {
        diag_error(r->lang->diag, at, "assumed_gamma must be above 0");
        gamma = 1;
    }
    if (s->has_assumed_gamma) {
        diag_warning(r->lang->diag, at, "a second assumed_gamma: the first one counts");
        return;
    }
    s->has_assumed_gamma = true;
    s->gamma = gamma;
    s->space = srgb ? SPACE_SRGB : space_of(gamma);
}

void build_version(struct lang *l)
{
    struct settings *s = &l->scene->settings;

    s->version = l->version;
    s->effective_version = l->version_given ? l->version : 362;
    build_space(l);
}

void build_space(struct lang *l)
{
    struct settings *s = &l->scene->settings;

    if (!s->has_assumed_gamma)
        s->space = s->effective_version >= 370 ? SPACE_LINEAR : SPACE_RAW;
}

/* --- the block ------------------------------------------------------------------- */

static void read_trace_level(struct reader *r)
{
    struct lang *l = r->lang;
    struct loc at = reader_at(r);
    double n = reader_number(r, false, "max_trace_level");
    double most = l->limits && l->limits->trace_depth > 0 ? l->limits->trace_depth : 256;

    if (n > most || n < 1)
        diag_warning(l->diag, at, "max_trace_level is at least 1 and at most %g: taken as %g", most,
                     n < 1 ? 1 : most);
    l->scene->settings.max_trace_level = (int)fmin(fmax(n, 1), most);
}

static void read_charset(struct reader *r)
{
    struct item i = reader_next(r);

    r->lang->charset_utf8 = item_is(&i, "utf8");
    if (i.kind != ITEM_WORD || !(item_is(&i, "utf8") || item_is(&i, "ascii") || item_is(&i, "sys")))
        diag_error(r->lang->diag, i.at, "charset is ascii, utf8 or sys, not %s",
                   item_describe(r->lang, &i));
}

static bool read_special(struct reader *r, const struct item *i)
{
    if (item_is_block(i, "radiosity")) {
        build_of(r->lang)->glows = true;        /* the sky may light it */
        skip_block(r->lang, i, radiosity_fields);
    } else if (item_is_block(i, "photons"))
        skip_block(r->lang, i, photons_fields);
    else if (item_is_block(i, "subsurface"))
        skip_block(r->lang, i, subsurface_fields);
    else if (i->kind != ITEM_WORD)
        return false;
    else if (item_is(i, "assumed_gamma"))
        read_gamma(r);
    else if (item_is(i, "max_trace_level"))
        read_trace_level(r);
    else if (item_is(i, "charset"))
        read_charset(r);
    else
        return false;
    return true;
}

bool build_settings(struct lang *l, const struct item *block, struct value *out)
{
    const struct field *const tables[] = { settings_fields, NULL };
    struct reader r;

    *out = (struct value) { .type = VALUE_NONE };
    reader_open(&r, l, block->body);
    for (struct item i = reader_next(&r); i.kind != ITEM_END; i = reader_next(&r))
        if (!read_special(&r, &i)
            && !build_from_table(&r, settings_fields, &i, &l->scene->settings))
            build_unknown(l, &i, "global_settings", tables);
    reader_close(&r);
    return true;
}
