/* build.h: from evaluated items to the scene's structs.
 *
 * The first part is for the evaluator, the second is shared by the builders,
 * build_NAME.c.  A builder gets a block's item, opens a reader on its body and
 * takes items until the end; what it does not know is an error, never skipped. */
#ifndef RTC_BUILD_H
#define RTC_BUILD_H

#include <string.h>

#include "base/intern.h"
#include "lang/state.h"
#include "scene/atmosphere.h"

/* --- for the evaluator ----------------------------------------------------- */

/* A word with a block: what it makes and how.  One row makes a word reserved,
 * declarable and, with a statement, usable at the top level. */
struct block {
    const char *word;                   /* NULL ends a table */
    enum value_type makes;
    bool (*make)(struct lang *l, const struct item *block, struct value *out);
    void (*use)(struct lang *l, struct loc at, const struct value *made);  /* at the top level */
    const char *help;
};

extern const struct block blocks[];
extern const struct field *const block_fields[];    /* every table of words; NULL ends */

bool build_value(struct lang *l, const struct word *word, const struct item *block,
                 struct value *out);
bool build_word_value(struct lang *l, struct reader *r, const struct item *word,
                      struct value *out);
void build_statement(struct lang *l, struct reader *r, struct item item);
void build_default(struct lang *l, struct reader *r);
void build_version(struct lang *l);
void build_end(struct lang *l);

/* --- the builders' own state ------------------------------------------------ */

struct cached_image;

struct build {
    struct intern plain, look;          /* pigments of one colour, textures of one layer */
    struct intern finish;
    const struct patterned *said;       /* of the last plain pigment */
    const struct texture *texture;      /* #default { } */
    struct camera_words camera;
    struct camera solved;               /* of the last camera statement */
    bool has_camera, has_sky, has_light, glows;     /* glows: a finish shows without light */
    struct loc first;                   /* the first solid that was added */
    const struct texture *declared;     /* layers so far of a `#declare T = texture { } texture { }` */
    struct cached_image *image;         /* read already */
    const struct texture *reported;     /* looked at last for what cannot be shown */
    struct object *spare;               /* free to become the next object; NULL: none */
};

struct build *build_of(struct lang *l);     /* made at the first call */

/* --- blocks in general: build_block.c ---------------------------------------- */

/* What stands there is not known: an error at its place.  tables: of the words
 * that would be, NULL ends. */
void build_unknown(struct lang *l, const struct item *i, const char *block,
                   const struct field *const *tables);

const struct field *field_find(const struct field *table, const char *word);   /* table may be NULL */

/* Reads what follows a field's word into its member of thing; false: the
 * field is FIELD_CUSTOM and nothing was read. */
bool build_field(struct reader *r, const struct field *f, const char *word, struct loc at,
                 void *thing);

/* The word i is in the table and not custom: taken, with its values. */
bool build_from_table(struct reader *r, const struct field *table, const struct item *i,
                      void *thing);

/* Takes a whole block of nothing but a table's words. */
void build_table_block(struct lang *l, const struct item *block, const char *name,
                       const struct field *table, void *thing);

/* That word, with or without a block.  Most are told apart by their first letter. */
static inline bool item_is(const struct item *i, const char *word)
{
    return (i->kind == ITEM_WORD || i->kind == ITEM_BLOCK) && i->word->text[0] == word[0]
           && strcmp(i->word->text, word) == 0;
}

static inline bool item_is_block(const struct item *i, const char *word)
{
    return i->kind == ITEM_BLOCK && item_is(i, word);
}

bool item_is_thing(const struct item *i, enum value_type type);    /* a declared thing */
bool build_flag(struct reader *r);      /* an optional number behind a flag: on unless 0 or less */
vec3 build_vector(struct reader *r, bool comma, const char *what);

/* translate, rotate, scale, matrix, transform: taken into *t.  i was taken. */
bool build_transform(struct reader *r, const struct item *i, struct transform *t);
bool make_transform(struct lang *l, const struct item *block, struct value *out);
extern const struct field transform_fields[];

/* An identifier at the start of a block: `pigment { P ... }`. */
const void *build_start(struct reader *r, enum value_type type);

/* Of `texture { T }`, which stands in most objects of a large scene: what is
 * declared; no reader is needed.  NULL: there is more to the block. */
const void *build_named(const struct item *block, enum value_type type);

/* An error about a whole block; its opening brace is noted. */
void build_wrong(struct lang *l, const struct item *block, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* --- looks ------------------------------------------------------------------- */

/* A map or list: entries of one kind. */
struct map {
    enum value_type type;               /* VALUE_COLOUR_MAP, VALUE_PIGMENT_MAP ... */
    const struct map_entry *entry;
    size_t n;
};

bool make_colour_map(struct lang *l, const struct item *block, struct value *out);
bool make_pigment_map(struct lang *l, const struct item *block, struct value *out);
bool make_normal_map(struct lang *l, const struct item *block, struct value *out);
bool make_slope_map(struct lang *l, const struct item *block, struct value *out);
bool make_texture_map(struct lang *l, const struct item *block, struct value *out);
bool make_density_map(struct lang *l, const struct item *block, struct value *out);

/* What the pattern scheme of facts sdl.md 6.10 yields, whatever it is for. */
struct patterned {
    enum value_type of;                 /* VALUE_PIGMENT, _NORMAL, _TEXTURE, _DENSITY; _FUNCTION: the number alone */
    enum { PATTERNED_NONE, PATTERNED_COLOUR, PATTERNED_MAP, PATTERNED_LIST, PATTERNED_IMAGE,
           PATTERNED_AVERAGE, PATTERNED_UV } kind;
    colour colour, quick_colour;
    bool has_quick_colour;
    struct pattern_use use;
    struct map map;
    struct image_use image;
    struct transform place;
    double amount, accuracy;            /* of normals */
    bool no_bump_scale, uv_mapping;
    const char *word;                   /* the pattern's */
    struct nest nest;                   /* of the pattern's function */
    const char *unsupported;            /* NULL, or what the picture cannot show yet */
};

struct patterned patterned_new(enum value_type of);

/* The body after an identifier, to the end of the reader. */
void build_patterned(struct reader *r, struct patterned *p, const struct item *block);
bool patterned_starts(const struct item *i);    /* a pattern's word? */
const char *patterned_word(size_t i);           /* of such words those that are no row's; NULL ends */
extern const struct field pattern_fields[];     /* the modifiers */

bool make_pigment(struct lang *l, const struct item *block, struct value *out);
bool make_normal(struct lang *l, const struct item *block, struct value *out);
bool make_density(struct lang *l, const struct item *block, struct value *out);
bool make_finish(struct lang *l, const struct item *block, struct value *out);
bool make_texture(struct lang *l, const struct item *block, struct value *out);
bool make_interior(struct lang *l, const struct item *block, struct value *out);
bool make_material(struct lang *l, const struct item *block, struct value *out);
bool make_media(struct lang *l, const struct item *block, struct value *out);

/* Blocks that change what is there already. */
const struct pigment *build_pigment(struct lang *l, const struct item *block,
                                    const struct pigment *from);
const struct pigment *build_pigment_body(struct reader *r, const struct item *block,
                                         const struct pigment *from);
const struct normal *build_normal(struct lang *l, const struct item *block,
                                  const struct normal *from);
const struct normal *build_normal_body(struct reader *r, const struct item *block,
                                       const struct normal *from);
const struct pigment *build_density_body(struct reader *r, const struct item *block,
                                         const struct pigment *from);
const struct finish *build_finish(struct lang *l, const struct item *block,
                                  const struct finish *from);
const struct interior *build_interior(struct lang *l, const struct item *block,
                                      const struct interior *from);

const struct texture *build_texture(struct lang *l, const struct item *block);   /* one block's layers */
const struct texture *build_texture_body(struct reader *r, const struct item *block);
/* pigment, normal or finish { } given to layers (NULL: the default's copy): the
 * topmost is changed.  False: the item is none of them. */
bool build_look(struct lang *l, const struct item *i, const struct texture **layers);
const struct texture *texture_over(struct lang *l, struct loc at, const struct texture *below,
                                   const struct texture *above);

struct material {
    const struct texture *texture, *interior_texture;
    const struct interior *interior;
};
extern const struct field finish_parts[], image_fields[], warp_fields[];

/* function W, H { } instead of a picture file; false: it does not stand next. */
struct drawn { unsigned width, height; const struct function *function; };
bool build_drawn(struct reader *r, struct drawn *d);

/* image_map's braces: the file or function, then its words. */
void build_image(struct lang *l, const struct item *block, struct image_use *use, bool *unsupported);

/* loader.c: a picture in the scene's working space.  gamma: 0 as the file says,
 * -1 srgb, else the power.  NULL: reported. */
struct image_palette { int entry; float filter, transmit; };    /* entry -1: all; a value < 0: not said */
const struct image *load_image(struct lang *l, struct loc at, const char *name, const char *type,
                               double gamma, bool premultiplied,
                               const struct image_palette *palette, size_t n_palette);

/* --- objects ----------------------------------------------------------------- */

bool make_object(struct lang *l, const struct item *block, struct value *out);     /* any solid, light */
bool make_light(struct lang *l, const struct item *block, struct value *out);

/* The object that an item stands for: a block, or a declared name; NULL: the
 * item is none (nothing was reported). */
struct object *build_object(struct lang *l, const struct item *i);
bool item_is_object(const struct item *i);

struct object *object_start(struct lang *l, enum object_kind kind, struct loc at);

/* The rest of an object's body: its modifiers.  extra: false for what it does
 * not know; NULL: nothing more.  Closes the object. */
void build_modifiers(struct reader *r, struct object *o, const struct item *block,
                     bool (*extra)(struct reader *r, const struct item *i, void *arg), void *arg,
                     const struct field *const *tables);
bool build_modifier(struct reader *r, struct object *o, const struct item *i,
                    const struct item *block);
void build_importance(struct lang *l, const struct item *block);    /* radiosity { importance F } */
void object_close(struct lang *l, struct object *o, const struct item *block);

/* Shapes whose bodies are more than a header of values. */
struct special_shape {
    const char *word;
    struct object *(*make)(struct lang *l, struct reader *r, const struct item *block);
    bool until_row;                     /* only as long as shapes[] has no such row */
};
extern const struct special_shape special_shapes[], mesh_shapes[], csg_shapes[];
/* errors: how many there were before the block. */
struct object *build_plain_shape(struct lang *l, struct reader *r, const struct item *block,
                                 const struct shape_ops *ops, unsigned errors);

/* Adds to the scene, with a message for each part that cannot be shown yet. */
void build_add(struct lang *l, struct object *o);

/* --- the rest ---------------------------------------------------------------- */

bool make_camera(struct lang *l, const struct item *block, struct value *out);
void build_default_camera(struct lang *l, const struct item *block);
void use_camera(struct lang *l, struct loc at, const struct value *made);
bool make_fog(struct lang *l, const struct item *block, struct value *out);
bool make_rainbow(struct lang *l, const struct item *block, struct value *out);
bool make_sky_sphere(struct lang *l, const struct item *block, struct value *out);
void use_atmosphere(struct lang *l, struct loc at, const struct value *made);
void use_sky_sphere(struct lang *l, struct loc at, const struct value *made);
bool build_settings(struct lang *l, const struct item *block, struct value *out);
bool build_background(struct lang *l, const struct item *block, struct value *out);
void build_space(struct lang *l);       /* works out settings.space from what is known now */

extern const struct field camera_kinds[], object_fields[], radiosity_fields[], photons_fields[],
    settings_more_fields[], csg_fields[], shape_more_fields[], mesh_fields[], material_fields[],
    subsurface_fields[], image_types[], pattern_more_fields[];

#endif
