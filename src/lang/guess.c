/* guess.c: "did you mean". */
#include "lang/guess.h"

#include <ctype.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

#include "lang/scope.h"

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

/* What a line that says `#declare NAME` or `#macro NAME` declares, or NULL; cut in place. */
static char *declared_by(char *line)
{
    line += strspn(line, " \t");
    if (*line++ != '#')
        return NULL;
    line += strspn(line, " \t");
    line += strncmp(line, "declare", 7) == 0 ? 7 : strncmp(line, "macro", 5) == 0 ? 5 : 0;
    if (*line != ' ' && *line != '\t')
        return NULL;
    char *name = line + strspn(line, " \t"), *end = name;
    while (isalnum((unsigned char)*end) || *end == '_')
        end++;
    *end = '\0';
    return name;
}

/* The files that scenes take their names from, the commonest first. */
static const char *const common_files[] = {
    "colors.inc", "textures.inc", "metals.inc", "golds.inc", "glass.inc", "woods.inc",
    "stones1.inc", "stones2.inc", "finish.inc", "skies.inc", "stars.inc", "shapes.inc",
    "shapes2.inc", "functions.inc", "math.inc", "transforms.inc", "consts.inc", "rand.inc",
    "arrays.inc", "strings.inc", "glass_old.inc", NULL,
};

struct library_guess {
    struct guess guess;
    const char *file;           /* that declares the guess, or exactly the name */
    bool is_exact;
};

static void look_into(struct lang *l, struct library_guess *g, const char *folder, const char *file)
{
    FILE *f = fopen(arena_format(l->mem, "%s/%s", folder, file), "r");
    char line[256], *name;

    while (f && !g->is_exact && fgets(line, sizeof line, f)) {
        const char *before = g->guess.best;
        if (!(name = declared_by(line)) || !*name)
            continue;
        g->is_exact = strcmp(name, g->guess.wrong) == 0;
        guess_try(&g->guess, name);
        if (g->guess.best != before)
            g->guess.best = arena_text(l->mem, name, strlen(name));
        if (g->is_exact || g->guess.best != before)
            g->file = file;
    }
    if (f)
        fclose(f);
}

static struct library_guess look_in_library(struct lang *l, const char *name)
{
    struct library_guess g = { .guess = guess_start(name) };

    for (const char *const *file = common_files; !g.is_exact && *file; file++)
        for (size_t i = 0; !g.is_exact && i < l->setup.n_library; i++)
            look_into(l, &g, l->setup.library[i], *file);
    return g;
}

static const char *library_text(struct lang *l, const struct library_guess *g)
{
    if (g->is_exact)
        return arena_format(l->mem, "; #include \"%s\" declares it", g->file);
    return arena_format(l->mem, "; did you mean '%s', which #include \"%s\" declares?",
                        g->guess.best, g->file);
}

void say_undeclared(struct lang *l, struct loc at, const char *name, const char *where)
{
    struct library_guess library = look_in_library(l, name);
    struct guess g = guess_start(name);
    const char *text = "";

    if (!where && !library.is_exact)    /* Rad is no Red where a number is wanted */
        library.file = NULL;
    guess_names(&g, l);
    bool is_near = g.best && !library.is_exact && !(library.file && library.guess.distance < g.distance);
    for (size_t i = 0; !is_near && !library.file && i < l->n_word; i++)
        if (where || l->word[i].class == WORD_CONSTANT)
            guess_try(&g, l->word[i].text);
    if (library.file && !is_near)
        text = library_text(l, &library);
    else
        text = guess_text(&g, l);
    diag_error(l->diag, at, "undeclared name '%s'%s%s", name, where ? where : "", text);
    if (is_near)
        guess_note(&g, l);
    scope_declare_broken(l, name_intern(&l->names, name, strlen(name)), at);
}
