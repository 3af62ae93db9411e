/* guess.c: "did you mean". */
#include "lang/guess.h"

#include <string.h>

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
    return g->best ? arena_format(l->mem, "; did you mean '%s'?", g->best) : "";
}
