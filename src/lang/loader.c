/* loader.c: picture files as images in the scene's working space: facts
 * shading.md 5.4, patterns.md 6.3 and 6.4. */
#include <string.h>
#include <strings.h>

#include "lang/build.h"
#include "lang/colour.h"

struct cached_image {
    const char *path;
    double gamma;
    bool premultiplied;
    struct settings settings;           /* of the moment it was read */
    const struct image *image;
    struct cached_image *next;
};

/* --- files ---------------------------------------------------------------------------- */

static const struct { const char *type, *extension; } endings[] = {
    { "png", "png" }, { "jpeg", "jpg" }, { "jpeg", "jpeg" }, { "gif", "gif" }, { "tga", "tga" },
    { "bmp", "bmp" }, { "ppm", "ppm" }, { "pgm", "pgm" }, { "tiff", "tiff" }, { "tiff", "tif" },
    { "exr", "exr" }, { "hdr", "hdr" }, { "iff", "iff" }, { "pot", "pot" },
};

static const char *type_by_ending(const char *name)
{
    const char *dot = strrchr(name, '.');

    if (!dot || strchr(dot, '/'))
        return "png";                   /* the kind of picture that rtc writes */
    for (size_t i = 0; i < sizeof endings / sizeof *endings; i++)
        if (strcasecmp(endings[i].extension, dot + 1) == 0)
            return endings[i].type;
    return NULL;
}

static const char *const *extensions_of(const char *type)
{
    static const char *const png[] = { "png", "PNG", NULL }, *const gif[] = { "gif", "GIF", NULL };
    static const char *const jpeg[] = { "jpg", "JPG", "jpeg", "JPEG", NULL };
    static const char *const tga[] = { "tga", "TGA", NULL }, *const bmp[] = { "bmp", "BMP", NULL };
    static const char *const ppm[] = { "ppm", "PPM", NULL }, *const pgm[] = { "pgm", "PGM", NULL };
    static const char *const tiff[] = { "tiff", "TIFF", "tif", "TIF", NULL };
    static const char *const exr[] = { "exr", "EXR", NULL }, *const hdr[] = { "hdr", "HDR", NULL };
    static const struct { const char *type; const char *const *list; } lists[] = {
        { "png", png }, { "gif", gif }, { "jpeg", jpeg }, { "tga", tga }, { "bmp", bmp },
        { "ppm", ppm }, { "pgm", pgm }, { "tiff", tiff }, { "exr", exr }, { "hdr", hdr },
    };

    for (size_t i = 0; i < sizeof lists / sizeof *lists; i++)
        if (strcmp(lists[i].type, type) == 0)
            return lists[i].list;
    return NULL;
}

/* --- curves ---------------------------------------------------------------------------- */

/* How a file value becomes a working-space value. */
struct curve {
    enum { CURVE_RAW, CURVE_SRGB, CURVE_POWER, CURVE_LINEAR } kind;
    double power;
};

static struct curve by_power(double gamma)
{
    if (fabs(gamma - 1) < 0.01)
        return (struct curve) { CURVE_LINEAR, 1 };
    return (struct curve) { CURVE_POWER, gamma };
}

static struct curve by_file(const struct bitmap *b, struct curve otherwise)
{
    if (b->format != BITMAP_PNG || (!b->has_srgb && !b->has_gamma))
        return otherwise;
    if (b->has_srgb || !(b->gamma > 0))
        return (struct curve) { CURVE_SRGB, 0 };
    return by_power(1 / b->gamma);
}

static struct curve curve_of(const struct bitmap *b, const struct settings *s, double gamma)
{
    const struct curve raw = { CURVE_RAW, 0 }, srgb = { CURVE_SRGB, 0 }, linear = { CURVE_LINEAR, 1 };
    bool modern = s->effective_version >= 370;

    if (gamma < 0)
        return srgb;
    if (gamma > 0)
        return by_power(gamma);
    if (!modern && !s->has_assumed_gamma)
        return raw;
    if (b->is_linear || b->format == BITMAP_HDR || b->format == BITMAP_EXR)
        return linear;
    switch (b->format) {
    case BITMAP_PPM: case BITMAP_PGM: case BITMAP_TIFF:
        return raw;
    default:
        return by_file(b, modern ? srgb : raw);
    }
}

static float decode(struct curve c, const struct settings *s, float x)
{
    switch (c.kind) {
    case CURVE_RAW:
        return x;
    case CURVE_SRGB:
        return s->space == SPACE_SRGB ? x : (float)working_encode(s, srgb_decode((double)x));
    case CURVE_POWER:
        return (float)working_encode(s, pow(fmax((double)x, 0), c.power));
    case CURVE_LINEAR:
        break;
    }
    return (float)working_encode(s, (double)x);
}

/* --- pixels ---------------------------------------------------------------------------- */

/* A grey file of 8 bits is kept in 8 bits after decoding: patterns.md 6.3. */
static float quantised_grey(float v)
{
    float g = (0.297f * v + 0.589f * v) + 0.114f * v;

    return truncf(255 * g) / 255;
}

static colour decode_pixel(const struct bitmap *b, struct curve c, const struct settings *s,
                           unsigned x, unsigned y, bool premultiplied)
{
    bool grey = b->channels < 3, has_alpha = b->channels == 2 || b->channels == 4;
    float v[3], alpha = has_alpha ? bitmap_sample(b, x, y, b->channels - 1) : 1;

    for (unsigned k = 0; k < 3; k++) {
        v[k] = bitmap_sample(b, x, y, grey ? 0 : k);
        if (premultiplied && has_alpha && alpha > 0)
            v[k] /= alpha;
        v[k] = decode(c, s, v[k]);
        if (b->channels == 1 && b->bits == 8 && !b->pixel_float && !b->is_indexed)
            v[k] = quantised_grey(v[k]);
    }
    return (colour) { v[0], v[1], v[2], 0, 1 - alpha };
}

static colour decode_entry(const struct bitmap *b, struct curve c, const struct settings *s,
                           unsigned entry)
{
    const uint8_t *p = b->palette[entry];

    return (colour) { decode(c, s, (float)p[0] / 255), decode(c, s, (float)p[1] / 255),
                      decode(c, s, (float)p[2] / 255), 0, 1 - (float)p[3] / 255 };
}

/* Of a palette picture, `all` replaces; of others it is added. */
static void change_palette(colour *palette, unsigned n, const struct image_palette *p)
{
    for (unsigned i = 0; i < n; i++) {
        if (p->entry >= 0 && p->entry != (int)i)
            continue;
        if (p->filter >= 0)
            palette[i].f = p->filter;
        if (p->transmit >= 0)
            palette[i].t = p->transmit;
    }
}

static void fill_indexed(struct lang *l, struct image *to, const struct bitmap *b, struct curve c,
                         const struct image_palette *change, size_t n_change)
{
    colour *palette = arena_array(l->scene_mem, 256, sizeof *palette);

    for (unsigned i = 0; i < b->n_palette && i < 256; i++)
        palette[i] = decode_entry(b, c, &l->scene->settings, i);
    for (size_t i = 0; i < n_change; i++)
        change_palette(palette, b->n_palette, &change[i]);
    for (unsigned i = b->n_palette; i < 256; i++)       /* a bad index shows the first colour */
        palette[i] = palette[0];
    to->palette = palette;
    to->index = b->index;
}

static void fill_bytes(struct lang *l, struct image *to, const struct bitmap *b, struct curve c)
{
    float *level = arena_array(l->scene_mem, 256, sizeof *level);

    for (unsigned i = 0; i < 256; i++)
        level[i] = decode(c, &l->scene->settings, (float)i / 255.0f);
    to->level = level;
    to->bytes = b->pixel8;
}

static void fill_direct(struct lang *l, struct image *to, const struct bitmap *b, struct curve c,
                        bool premultiplied, const struct image_palette *change, size_t n_change)
{
    float filter = 0, transmit = 0;

    to->pixel = arena_array(l->scene_mem, (size_t)b->width * b->height, sizeof *to->pixel);
    for (size_t i = 0; i < n_change; i++) {
        if (change[i].filter >= 0)
            filter = change[i].filter;
        if (change[i].transmit >= 0)
            transmit = change[i].transmit;
    }
    for (unsigned y = 0; y < b->height; y++)
        for (unsigned x = 0; x < b->width; x++) {
            colour p = decode_pixel(b, c, &l->scene->settings, x, y, premultiplied);
            p.f += filter;
            p.t += transmit;
            to->pixel[(size_t)y * b->width + x] = p;
        }
}

static void note_transparency(struct image *i)
{
    size_t n = (size_t)i->width * i->height;

    for (size_t k = 0; !i->bytes && k < n && !i->has_transparency; k++) {
        colour c = image_pixel(i, k);
        i->has_transparency = c.f != 0 || c.t != 0;
    }
}

static const struct image *convert(struct lang *l, struct loc at, const struct bitmap *b,
                                   double gamma, bool premultiplied,
                                   const struct image_palette *change, size_t n_change)
{
    struct image *to = arena_alloc(l->scene_mem, sizeof *to);
    struct curve c = curve_of(b, &l->scene->settings, gamma);
    bool indexed = b->is_indexed && b->index && b->palette;

    to->width = b->width;
    to->height = b->height;
    for (size_t i = 0; i < n_change; i++)
        if (!indexed && change[i].entry >= 0)
            diag_error(l->diag, at, "filter and transmit of one palette colour: the picture has no palette");
    if (indexed)
        fill_indexed(l, to, b, c, change, n_change);
    else if (b->pixel8 && b->channels == 3 && n_change == 0)
        fill_bytes(l, to, b, c);
    else
        fill_direct(l, to, b, c, premultiplied, change, n_change);
    note_transparency(to);
    return to;
}

/* --- the cache -------------------------------------------------------------------------- */

static bool same_meaning(const struct settings *a, const struct settings *b)
{
    return a->effective_version == b->effective_version && a->space == b->space
           && a->gamma == b->gamma && a->has_assumed_gamma == b->has_assumed_gamma;
}

static const struct image *find_cached(const struct build *b, const char *path, double gamma,
                                       bool premultiplied, const struct settings *s)
{
    for (const struct cached_image *c = b->image; c; c = c->next)
        if (strcmp(c->path, path) == 0 && c->gamma == gamma && c->premultiplied == premultiplied
            && same_meaning(&c->settings, s))
            return c->image;
    return NULL;
}

static void cache(struct lang *l, const char *path, double gamma, bool premultiplied,
                  const struct image *image)
{
    struct cached_image *c = arena_alloc(l->mem, sizeof *c);

    *c = (struct cached_image) { path, gamma, premultiplied, l->scene->settings, image,
                                 l->build->image };
    l->build->image = c;
}

static const struct image *read_file(struct lang *l, struct loc at, const char *path,
                                     const char *type, double gamma, bool premultiplied,
                                     const struct image_palette *change, size_t n_change)
{
    const char *error = "the program cannot read pictures";
    struct bitmap b = { 0 };

    if (!l->setup.load_image || !l->setup.load_image(l->scene_mem, path, type, &b, &error)) {
        diag_error(l->diag, at, "picture '%s': %s", path, error);
        return NULL;
    }
    return convert(l, at, &b, gamma, premultiplied, change, n_change);
}

const struct image *load_image(struct lang *l, struct loc at, const char *name, const char *type,
                               double gamma, bool premultiplied,
                               const struct image_palette *change, size_t n_change)
{
    if (!type && !(type = type_by_ending(name))) {
        diag_error(l->diag, at, "picture '%s': its ending names no kind of picture", name);
        diag_note(l->diag, at, "write the kind before the name: png \"%s\"", name);
        return NULL;
    }
    const char *path = lang_find_file(l, at, name, extensions_of(type), "picture");
    if (!path)
        return NULL;
    const struct image *image = n_change > 0 ? NULL
        : find_cached(build_of(l), path, gamma, premultiplied, &l->scene->settings);
    if (image)
        return image;
    image = read_file(l, at, path, type, gamma, premultiplied, change, n_change);
    if (image && n_change == 0)
        cache(l, path, gamma, premultiplied, image);
    return image;
}
