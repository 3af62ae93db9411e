/* words.c: the reserved words, gathered from the tables that give them meaning. */
#include "lang/words.h"

#include <stdlib.h>
#include <string.h>

#include "lang/build.h"
#include "lang/call.h"
#include "lang/state.h"

enum { MOST_WORDS = 1024 };

static const struct { const char *text; enum directive directive; const char *help; }
directives[] = {
    { "break", DIRECTIVE_BREAK, "leaves a loop, #switch or macro" },
    { "case", DIRECTIVE_CASE, "a value of #switch" },
    { "debug", DIRECTIVE_DEBUG, "shows a text" },
    { "declare", DIRECTIVE_DECLARE, "gives a name a value" },
    { "default", DIRECTIVE_DEFAULT, "changes the textures and camera that others start from" },
    { "else", DIRECTIVE_ELSE, "when no condition before it held" },
    { "elseif", DIRECTIVE_ELSEIF, "another condition of #if" },
    { "end", DIRECTIVE_END, "the end of #if, a loop, #switch or #macro" },
    { "error", DIRECTIVE_ERROR, "shows a text and ends the run" },
    { "fclose", DIRECTIVE_FCLOSE, "closes a file" },
    { "fopen", DIRECTIVE_FOPEN, "opens a file to read, write or append" },
    { "for", DIRECTIVE_FOR, "a loop over numbers" },
    { "if", DIRECTIVE_IF, "what follows counts if the condition holds" },
    { "ifdef", DIRECTIVE_IFDEF, "what follows counts if the name is declared" },
    { "ifndef", DIRECTIVE_IFNDEF, "what follows counts if the name is not declared" },
    { "include", DIRECTIVE_INCLUDE, "another file as part of the scene" },
    { "local", DIRECTIVE_LOCAL, "gives a name a value until the macro or file ends" },
    { "macro", DIRECTIVE_MACRO, "gives a piece of scene a name and parameters" },
    { "range", DIRECTIVE_RANGE, "values of #switch from one to another" },
    { "read", DIRECTIVE_READ, "reads values from a file" },
    { "render", DIRECTIVE_RENDER, "shows a text" },
    { "statistics", DIRECTIVE_STATISTICS, "shows a text" },
    { "switch", DIRECTIVE_SWITCH, "one of several pieces, by a number" },
    { "undef", DIRECTIVE_UNDEF, "makes a name undeclared" },
    { "version", DIRECTIVE_VERSION, "the version of the language that the scene is written in" },
    { "warning", DIRECTIVE_WARNING, "shows a warning" },
    { "while", DIRECTIVE_WHILE, "a loop while a condition holds" },
    { "write", DIRECTIVE_WRITE, "writes values to a file" },
};

static const char *const colours[] = {
    "alpha", "blue", "color", "colour", "filter", "green", "red", "transmit", NULL };
static const char *const rgbs[] = {
    "rgb", "rgbf", "rgbft", "rgbt", "srgb", "srgbf", "srgbft", "srgbt", NULL };
/* Words that several blocks, or none of the tables, know. */
static const struct { const char *text, *help; } more_help[] = {
    { "alpha", "old word for filter" }, { "append", "#fopen: writes behind what is there" },
    { "array", "values by number: array[N] { ... }" }, { "autostop", "of photons" },
    { "blue", "the third component of a colour" }, { "color", "begins a colour" },
    { "colour", "begins a colour" }, { "count", "of photons, radiosity" },
    { "deprecated", "#declare: each use of the name warns" },
    { "expand_thresholds", "of photons" }, { "gather", "of photons" },
    { "gray", ".gray: the brightness of a colour" }, { "green", "the second component of a colour" },
    { "natural_spline", "of spline { }: a curve with loose ends" },
    { "red", "the first component of a colour" },
    { "rgb", "a colour: red, green, blue" }, { "rgbf", "a colour: rgb and filter" },
    { "rgbft", "a colour: rgb, filter and transmit" }, { "rgbt", "a colour: rgb and transmit" },
    { "samples", "of media, subsurface" }, { "spacing", "of photons" },
    { "spline", "a curve through points, called as a function" }, { "steps", "old word for count" },
    { "srgb", "a colour as the screen shows it; gamma, assumed_gamma: the screen's curve" },
    { "srgbf", "srgb and filter" }, { "srgbft", "srgb, filter and transmit" },
    { "srgbt", "srgb and transmit" },
    { "sint8", "#write: a byte, -128 to 127" }, { "uint8", "#write: a byte, 0 to 255" },
    { "sint16be", "#write: two bytes, signed, high byte first" },
    { "sint16le", "#write: two bytes, signed, low byte first" },
    { "uint16be", "#write: two bytes, high byte first" },
    { "uint16le", "#write: two bytes, low byte first" },
    { "sint32be", "#write: four bytes, signed, high byte first" },
    { "sint32le", "#write: four bytes, signed, low byte first" },
    { "always_sample", "of radiosity" }, { "brightness", "of radiosity" },
    { "error_bound", "of radiosity" }, { "gray_threshold", "of radiosity" },
    { "importance", "of radiosity" }, { "load_file", "of photons" },
    { "low_error_factor", "of radiosity" }, { "max_sample", "of radiosity" },
    { "maximum_reuse", "of radiosity" }, { "minimum_reuse", "of radiosity" },
    { "nearest_count", "of radiosity" }, { "pretrace_end", "of radiosity" },
    { "pretrace_start", "of radiosity" }, { "recursion_limit", "of radiosity" },
    { "save_file", "of photons" },
};

static const char *const file_words[] = {
    "bmp", "df3", "dtag", "exr", "gif", "hdr", "iff", "include", "jpeg", "load_file", "pgm", "png",
    "pot", "ppm", "save_file", "sys", "tga", "tiff", "ttf", NULL };

/* The words of version 3.7 that no table of ours has yet: they are reserved
 * all the same, so that a scene that declares one is refused as POV-Ray does. */
static const char *const others[] = {
    "aa_level", "aa_threshold", "absorption", "accuracy", "adaptive", "adc_bailout", "agate",
    "agate_turb", "albedo", "all", "all_intersections", "altitude", "always_sample", "ambient",
    "ambient_light", "angle", "anisotropy", "aoi", "aperture", "append", "arc_angle",
    "area_illumination", "area_light", "array", "ascii", "assumed_gamma", "autostop", "average",
    "b_spline", "background", "bezier_spline", "bicubic_patch", "black_hole", "blob",
    "blur_samples", "bmp", "bokeh", "bounded_by", "box", "boxed", "bozo", "brick", "brick_size",
    "brightness", "brilliance", "bump_map", "bump_size", "bumps", "camera", "caustics", "cells",
    "charset", "checker", "circular", "clipped_by", "collect", "color_map", "colour_map",
    "component", "composite", "cone", "confidence", "conic_sweep", "conserve_energy",
    "contained_by", "control0", "control1", "coords", "count", "crackle", "crand", "cube",
    "cubic", "cubic_spline", "cubic_wave", "cutaway_textures", "cylinder", "cylindrical",
    "density", "density_file", "density_map", "dents", "deprecated", "df3", "difference",
    "diffuse", "direction", "disc", "dispersion", "dispersion_samples", "dist_exp", "distance",
    "double_illuminate", "dtag", "eccentricity", "emission", "error_bound", "evaluate",
    "expand_thresholds", "exponent", "exr", "exterior", "extinction", "face_indices", "facets",
    "fade_color", "fade_colour", "fade_distance", "fade_power", "falloff", "falloff_angle",
    "finish", "fisheye", "flatness", "flip", "focal_point", "fog", "fog_alt", "fog_offset",
    "fog_type", "form", "frequency", "fresnel", "function", "gamma", "gather", "gif",
    "global_lights", "global_settings", "gradient", "granite", "gray", "gray_threshold", "hdr",
    "height_field", "hexagon", "hf_gray_16", "hierarchy", "hollow", "hypercomplex", "iff",
    "image_map", "image_pattern", "importance", "inside_vector", "interior", "interior_texture",
    "interpolate", "intersection", "intervals", "inverse", "ior", "irid", "irid_wavelength",
    "isosurface", "jitter", "jpeg", "julia", "julia_fractal", "lambda", "lathe", "leopard",
    "light_group", "light_source", "linear_spline", "linear_sweep", "load_file", "location",
    "look_at", "looks_like", "low_error_factor", "magnet", "major_radius", "mandel", "map_type",
    "marble", "material", "material_map", "matrix", "max_gradient", "max_intersections",
    "max_iteration", "max_sample", "max_trace", "max_trace_level", "maximum_reuse", "media",
    "media_attenuation", "media_interaction", "merge", "mesh", "mesh2", "mesh_camera", "metallic",
    "method", "metric", "minimum_reuse", "mm_per_unit", "mortar", "natural_spline",
    "nearest_count", "no_bump_scale", "no_image", "no_radiosity", "no_reflection", "no_shadow",
    "noise_generator", "normal", "normal_indices", "normal_map", "normal_vectors",
    "number_of_sides", "number_of_tiles", "number_of_waves", "object", "octaves", "offset",
    "omega", "omnimax", "once", "onion", "open", "orient", "orientation", "orthographic", "ovus",
    "panoramic", "parallel", "parametric", "pass_through", "pattern", "pavement", "perspective",
    "pgm", "phase", "phong", "phong_size", "photons", "pigment", "pigment_map",
    "pigment_pattern", "planar", "plane", "png", "point_at", "poly", "poly_wave", "polygon",
    "polynomial", "pot", "ppm", "precision", "precompute", "premultiplied", "pretrace_end",
    "pretrace_start", "prism", "projected_through", "pwr", "quadratic_spline", "quadric",
    "quartic", "quaternion", "quick_color", "quick_colour", "quilted", "radial", "radiosity",
    "radius", "rainbow", "ramp_wave", "ratio", "reciprocal", "recursion_limit", "reflection",
    "reflection_exponent", "refraction", "repeat", "right", "ripples", "rotate", "roughness",
    "samples", "save_file", "scale", "scallop_wave", "scattering", "shadowless", "sine_wave",
    "sint16be", "sint16le", "sint32be", "sint32le", "sint8", "size", "sky", "sky_sphere", "slice",
    "slope", "slope_map", "smooth", "smooth_triangle", "solid", "sor", "spacing", "specular",
    "sphere", "sphere_sweep", "spherical", "spiral1", "spiral2", "spline", "split_union",
    "spotlight", "spotted", "sqr", "square", "steps", "strength", "sturm", "subsurface",
    "superellipsoid", "sys", "target", "text", "texture", "texture_list", "texture_map", "tga",
    "thickness", "threshold", "tiff", "tightness", "tile2", "tiles", "tiling", "tolerance",
    "toroidal", "torus", "transform", "translate", "translucency", "triangle", "triangle_wave",
    "triangular", "ttf", "turb_depth", "turbulence", "type", "u_steps", "uint16be", "uint16le",
    "uint8", "ultra_wide_angle", "union", "up", "use_alpha", "use_color", "use_colour",
    "use_index", "utf8", "uv_indices", "uv_mapping", "uv_vectors", "v_steps", "variance",
    "vertex_vectors", "vturbulence", "warp", "water_level", "waves", "width", "wood", "wrinkles",
    "xyz", NULL,
};

/* --- gathering --------------------------------------------------------------------- */

static struct word *add(struct lang *l, const char *text, const char *help)
{
    struct name *name = name_intern(&l->names, text, strlen(text));
    struct word *w = (struct word *)name->word;

    if (!w) {
        if (l->n_word == MOST_WORDS)
            abort();            /* the tables have outgrown the list */
        w = &l->word[l->n_word++];
        w->text = name->text;
        name->word = w;
    }
    if (!w->help || !*w->help)
        w->help = help;
    return w;
}

static void add_list(struct lang *l, const char *const *list, enum word_class class)
{
    for (; *list; list++) {
        struct word *w = add(l, *list, NULL);
        if (class != WORD_PLAIN)
            w->class = class;
    }
}

static void add_directives(struct lang *l)
{
    for (size_t i = 0; i < sizeof directives / sizeof *directives; i++)
        add(l, directives[i].text, directives[i].help)->directive = directives[i].directive;
}

static bool takes_one_number(const struct call *c)
{
    return strcmp(c->takes, "F") == 0;
}

static void add_calls(struct lang *l)
{
    for (const struct call *c = calls; c->name; c++) {
        struct word *w = add(l, c->name, c->help);
        w->call = c;
        w->class = takes_one_number(c) ? WORD_FUNC1 : WORD_FUNC;
    }
    for (const struct constant *c = constants; c->name; c++) {
        struct word *w = add(l, c->name, c->help);
        w->constant = c;
        w->class = WORD_CONSTANT;
    }
}

static void add_special(struct lang *l, const struct special_shape *s)
{
    for (; s->word; s++)
        add(l, s->word, "")->special = s;
}

static void add_things(struct lang *l)
{
    for (const struct shape_ops *const *s = shapes; *s; s++)
        add(l, (*s)->name, (*s)->help)->shape = *s;
    for (const struct pattern_ops *const *p = patterns; *p; p++) {
        struct word *w = add(l, (*p)->name, (*p)->help);
        w->pattern = *p;
        w->begins_pattern = true;
    }
    for (size_t i = 0; patterned_word(i); i++)
        add(l, patterned_word(i), NULL)->begins_pattern = true;
    for (const struct block *b = blocks; b->word; b++)
        add(l, b->word, b->help)->block = b;
    add_special(l, special_shapes);
    add_special(l, mesh_shapes);
    add_special(l, csg_shapes);
}

static void add_fields(struct lang *l)
{
    for (const struct field *const *table = block_fields; *table; table++)
        for (const struct field *f = *table; f->name; f++) {
            if (!*f->name)
                continue;
            struct word *w = add(l, f->name, f->help);
            if (!w->field)
                w->field = f;
        }
}

void words_init(struct lang *l)
{
    l->word = arena_array(l->mem, MOST_WORDS, sizeof *l->word);
    add_directives(l);
    add_calls(l);
    add_things(l);
    add_fields(l);
    add_list(l, colours, WORD_COLOUR);
    add_list(l, rgbs, WORD_RGB);
    add_list(l, others, WORD_PLAIN);
    add(l, "texture", NULL)->class = WORD_TEXTURE;
    add(l, "function", NULL)->class = WORD_FUNCTION;
    add(l, "array", NULL)->class = WORD_ARRAY;
    for (const char *const *f = file_words; *f; f++)
        add(l, *f, NULL)->names_file = true;
    for (size_t i = 0; i < sizeof more_help / sizeof *more_help; i++)
        add(l, more_help[i].text, more_help[i].help);
}

const struct word *word_find(const struct lang *l, const char *text)
{
    struct name *name = name_find(&l->names, text, strlen(text));

    return name ? name->word : NULL;
}

bool word_is(const struct word *w, const char *text)
{
    return w && strcmp(w->text, text) == 0;
}

/* Solids in which others may stand, too. */
static bool is_group(const struct word *w)
{
    static const char *const groups[] = {
        "mesh", "union", "difference", "intersection", "merge", "blob", "mesh2",
        "composite", "light_group", NULL,
    };

    for (const char *const *g = groups; *g; g++)
        if (word_is(w, *g))
            return true;
    return false;
}

static bool is_part_of_look(const struct word *w)
{
    return word_is(w, "texture") || word_is(w, "pigment") || word_is(w, "normal")
        || word_is(w, "finish") || word_is(w, "interior") || word_is(w, "material");
}

bool word_shuts_out(const struct word *around, const struct word *next)
{
    if (!around || !around->block || !next->block)
        return false;
    bool statement = next->block->use || next->block->makes == VALUE_NONE;
    switch (around->block->makes) {
    case VALUE_OBJECT: return statement && !is_group(around);
    case VALUE_TEXTURE: case VALUE_NORMAL: case VALUE_DENSITY:
        return statement && !word_is(next, "object");
    case VALUE_PIGMENT:
        return (statement && !word_is(next, "object"))
            || (is_part_of_look(next) && !word_is(next, "pigment"));
    case VALUE_INTERIOR: return statement && !word_is(next, "media");
    case VALUE_FINISH: case VALUE_CAMERA: case VALUE_NONE:
        return statement || (is_part_of_look(next) && !word_is(next, "normal"));
    default: return statement;
    }
}

void words_each(const struct lang *l, void (*see)(void *arg, const struct word *w), void *arg)
{
    for (size_t i = 0; i < l->n_word; i++)
        see(arg, &l->word[i]);
}
