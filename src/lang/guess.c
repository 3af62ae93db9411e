/* guess.c: "did you mean". */
#include "lang/guess.h"

#include <ctype.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

/* Further than this is another word; short words must be nearer. */
static unsigned furthest(const char *word)
{
    size_t n = strlen(word);

    return n < 3 ? 0 : n < 5 ? 1 : n < 9 ? 2 : 3;
}

struct guess guess_start(const char *wrong)
{
    return (struct guess) { .wrong = wrong, .distance = furthest(wrong) + 1 };
}

void guess_try(struct guess *g, const char *word)
{
    if (g->distance == 0 || strcmp(word, g->wrong) == 0)
        return;
    unsigned d = name_distance(g->wrong, word, g->distance - 1);
    if (d < g->distance) {
        g->distance = d;
        g->best = word;
    }
}

void guess_fields(struct guess *g, const struct field *fields)
{
    for (; fields && fields->name; fields++)
        if (*fields->name)
            guess_try(g, fields->name);
}

void guess_names(struct guess *g, const struct lang *l)
{
    for (size_t i = 0; i < l->names.room; i++)
        if (l->names.slot[i] && l->names.slot[i]->slot)
            guess_try(g, l->names.slot[i]->text);
}

void guess_words(struct guess *g, const struct lang *l)
{
    for (size_t i = 0; i < l->n_word; i++)
        guess_try(g, l->word[i].text);
}

const char *guess_text(const struct guess *g, const struct lang *l)
{
    if (!g->best)
        return "";
    bool capital = strcasecmp(g->best, g->wrong) == 0 && word_find(l, g->best);
    return arena_format(l->mem, capital ? "; the language's words are in small letters: '%s'"
                        : "; did you mean '%s'?", g->best);
}

void note_declared(struct lang *l, const char *name)
{
    const struct binding *b = lang_binding(l, name);

    if (b && b->at.source)
        diag_note(l->diag, b->at, "'%s' is declared here", name);
}

void guess_note(const struct guess *g, struct lang *l)
{
    if (g->best)
        note_declared(l, g->best);
}

/* Does a line say `#declare NAME` or `#macro NAME`? */
static bool declares(const char *line, const char *name)
{
    size_t n = strlen(name);

    line += strspn(line, " \t");
    if (*line++ != '#')
        return false;
    line += strspn(line, " \t");
    line += strncmp(line, "declare", 7) == 0 ? 7 : strncmp(line, "macro", 5) == 0 ? 5 : 0;
    if (*line != ' ' && *line != '\t')
        return false;
    line += strspn(line, " \t");
    return strncmp(line, name, n) == 0 && !isalnum((unsigned char)line[n]) && line[n] != '_';
}

static bool file_declares(const char *path, const char *name)
{
    char line[256];
    FILE *f = fopen(path, "r");
    bool found = false;

    while (f && !found && fgets(line, sizeof line, f))
        found = declares(line, name);
    if (f)
        fclose(f);
    return found;
}

/* The files that scenes take their names from, the commonest first. */
static const char *const common_files[] = {
    "colors.inc", "textures.inc", "metals.inc", "golds.inc", "glass.inc", "woods.inc",
    "stones1.inc", "stones2.inc", "finish.inc", "skies.inc", "stars.inc", "shapes.inc",
    "shapes2.inc", "functions.inc", "math.inc", "transforms.inc", "consts.inc", "rand.inc",
    "arrays.inc", "strings.inc", "glass_old.inc", NULL,
};

const char *guess_include(const struct lang *l, const char *name)
{
    for (const char *const *file = common_files; *file; file++)
        for (size_t i = 0; i < l->setup.n_library; i++)
            if (file_declares(arena_format(l->mem, "%s/%s", l->setup.library[i], *file), name))
                return *file;
    return NULL;
}
