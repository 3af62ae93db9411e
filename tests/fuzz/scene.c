/* scene.c: the targets that read scenes. */
#include <setjmp.h>
#include <stdio.h>
#include <string.h>

#include "fuzz/target.h"
#include "lang/lang.h"
#include "lang/parsing.h"

static const struct limits small = {
    .memory = (size_t)64 << 20, .source_bytes = 1 << 20, .nesting = 200, .include_depth = 4,
    .call_depth = 40, .csg_depth = 100, .iterations = 500, .array_items = 10000,
    .string_bytes = 1 << 16, .trace_depth = 16, .image_side = 1000 };

struct reading {
    struct budget budget;
    struct arena tree, scene;
    struct sources sources;
    struct diag diag;
    struct lang_setup setup;
    struct lang *lang;
    FILE *nowhere;
};

/* The budget's callback takes nothing that could lead to its run. */
static jmp_buf out_of_memory;

static void exceeded(size_t limit)
{
    (void)limit;
    longjmp(out_of_memory, 1);
}

static bool no_image(struct arena *mem, const char *path, const char *type, struct bitmap *out,
                     const char **error)
{
    (void)mem, (void)path, (void)type, (void)out;
    *error = "no pictures here";
    return false;
}

/* No folder is called so: nothing can be read, nothing written. */
static void start(struct reading *r)
{
    r->budget = (struct budget) { .limit = small.memory, .exceeded = exceeded };
    arena_init(&r->tree, &r->budget);
    arena_init(&r->scene, &r->budget);
    sources_init(&r->sources, &r->tree);
    r->nowhere = fopen("/dev/null", "w");
    diag_init(&r->diag, &r->sources, r->nowhere);
    r->setup = (struct lang_setup) {
        .mem = &r->tree, .scene_mem = &r->scene, .sources = &r->sources, .diag = &r->diag,
        .limits = &small, .width = 8, .height = 6, .clock = 0.5, .clock_on = true,
        .debug = r->nowhere, .load_image = no_image };
    r->lang = lang_new(&r->setup);
    r->lang->folder = "/no/such/folder/";
}

static void end(struct reading *r)
{
    if (r->lang)
        lang_free(r->lang);
    diag_end(&r->diag);
    arena_free(&r->scene);
    arena_free(&r->tree);
    fclose(r->nowhere);
}

static uint32_t add_text(struct reading *r, const uint8_t *bytes, size_t size)
{
    char *text = arena_alloc(&r->tree, size + 2);

    if (size)
        memcpy(text, bytes, size);
    return source_add(&r->sources, "fuzz.rt", text, size, (struct loc) { 0 });
}

int fuzz_parse(const uint8_t *bytes, size_t size)
{
    struct reading r = { 0 };

    if (setjmp(out_of_memory) == 0) {
        start(&r);
        const struct ast *tree = parse_source(r.lang, add_text(&r, bytes, size));
        lang_dump_ast(r.lang, tree, r.nowhere);
        scanner_dump(r.lang, add_text(&r, bytes, size), r.nowhere);
    }
    end(&r);
    return 0;
}

int fuzz_build(const uint8_t *bytes, size_t size)
{
    struct reading r = { 0 };

    if (setjmp(out_of_memory) == 0) {
        start(&r);
        const struct ast *tree = parse_source(r.lang, add_text(&r, bytes, size));
        const struct scene *scene = lang_build(r.lang, tree);
        if (scene && !r.diag.errors)
            scene_dump(scene, r.nowhere);
    }
    end(&r);
    return 0;
}
