/* build_shape.c: shapes that are a header of values and some words: all rows of
 * shapes[]. */
#include <string.h>

#include "lang/build.h"

/* Most shapes without a surface are only left out, as POV-Ray draws nothing
 * either; these end its run (facts sdl.md 6.4, 8.2). */
static bool is_fatal(const char *shape, const char *wrong)
{
    static const struct { const char *shape, *wrong; } rows[] = {
        { "cylinder", "zero length" }, { "cone", "zero length" }, { "plane", "zero normal" },
        { "ovus", "negative radius" },
    };

    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++)
        if (strcmp(shape, rows[i].shape) == 0 && strcmp(wrong, rows[i].wrong) == 0)
            return true;
    return false;
}

static void read_header(struct reader *r, const struct shape_ops *ops, void *self)
{
    size_t n = 0;

    for (const struct field *f = ops->args; f && f->name; f++, n++) {
        if (n > 0)
            reader_skip_comma(r);
        if (n >= ops->n_required && !reader_is_number(r))
            return;
        build_field(r, f, f->help ? f->help : ops->name, reader_at(r), self);
    }
}

struct shape_body { const struct shape_ops *ops; void *self; };

static bool read_shape_word(struct reader *r, const struct item *i, void *arg)
{
    const struct shape_body *b = arg;

    return build_from_table(r, b->ops->words, i, b->self);
}

/* said: a mistake in the block was told already; it explains the shape. */
static void prepare(struct lang *l, struct object *o, const struct item *block, void *self,
                    bool said)
{
    const char *wrong = o->ops->prepare ? o->ops->prepare(self, l->scene_mem) : NULL;

    if (!wrong)
        return;
    if (!said && is_fatal(o->ops->name, wrong) && !l->guessed)
        build_wrong(l, block, "%s: %s", o->ops->name, wrong);
    else if (!said)
        diag_warning(l->diag, block->at, "%s: %s; it is left out", o->ops->name, wrong);
    o->kind = OBJECT_UNION;             /* of nothing */
    o->ops = NULL;
    o->shape = NULL;
}

/* Small ones stand within a line of the cache where their size lets them. */
static void *new_shape(struct arena *mem, const struct shape_ops *ops)
{
    void *self = arena_alloc_aligned(mem, ops->size, ops->size % 32 ? 16 : 32);

    return memcpy(self, ops->defaults, ops->size);
}

struct object *build_plain_shape(struct lang *l, struct reader *r, const struct item *block,
                                 const struct shape_ops *ops, unsigned errors)
{
    struct object *o = object_start(l, OBJECT_SHAPE, block->at);
    void *self = new_shape(l->scene_mem, ops);
    struct shape_body body = { ops, self };
    const struct field *const tables[] = { ops->words, NULL };

    o->ops = ops;
    read_header(r, ops, self);
    build_modifiers(r, o, block, read_shape_word, &body, tables);
    prepare(l, o, block, self, l->diag->errors != errors);
    if (o->ops)
        o->shape = self;
    return o;
}
