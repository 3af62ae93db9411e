/* replay.c: feeds the targets with inputs that once hurt, and with those they
 * grew from.
 *
 *     check_fuzz [FOLDER]            tests/fuzz/corpus: scene/ and png/ below it
 *     check_fuzz --dictionary        the language's words, as libFuzzer wants them */
#include <dirent.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "fuzz/target.h"
#include "lang/lang.h"

enum { LARGEST = 1 << 20 };

static void print_entry(const char *text)
{
    putchar('"');
    for (; *text; text++)
        printf(*text == '"' || *text == '\\' ? "\\%c" : "%c", *text);
    puts("\"");
}

static int print_dictionary(void)
{
    static const char *const more[] = { "//", "/*", "*/", "<=", "!=", ">=", "{", "}", "(1)", "[1]",
                                        "<1,2,3>", "\"a\"", "1e400", "#", NULL };
    char *text = NULL;
    size_t size;
    FILE *f = open_memstream(&text, &size);

    lang_list_words(f);
    fclose(f);
    for (char *line = strtok(text, "\n"); line; line = strtok(NULL, "\n")) {
        line[strcspn(line, "\t")] = '\0';
        print_entry(line);
    }
    for (int i = 0; more[i]; i++)
        print_entry(more[i]);
    free(text);
    return 0;
}

static bool read_file(const char *path, uint8_t **bytes, size_t *size)
{
    FILE *f = fopen(path, "rb");

    if (!f)
        return false;
    *bytes = malloc(LARGEST);
    *size = fread(*bytes, 1, LARGEST, f);
    fclose(f);
    return true;
}

/* The name is told first: a crash says nothing. */
static void feed(const char *path, bool is_scene)
{
    uint8_t *bytes;
    size_t size;

    puts(path);
    fflush(stdout);
    if (!read_file(path, &bytes, &size))
        return;
    if (is_scene) {
        fuzz_parse(bytes, size);
        fuzz_build(bytes, size);
    } else
        fuzz_png(bytes, size);
    free(bytes);
}

static int replay(const char *folder, const char *kind)
{
    char path[4096];
    int n = 0;

    snprintf(path, sizeof path, "%s/%s", folder, kind);
    DIR *d = opendir(path);
    for (struct dirent *e; d && (e = readdir(d));) {
        if (e->d_name[0] == '.')
            continue;
        snprintf(path, sizeof path, "%s/%s/%s", folder, kind, e->d_name);
        feed(path, strcmp(kind, "scene") == 0);
        n++;
    }
    if (d)
        closedir(d);
    return n;
}

int main(int argc, char **argv)
{
    char path[4096];
    const char *srcdir = getenv("srcdir");

    if (argc > 1 && strcmp(argv[1], "--dictionary") == 0)
        return print_dictionary();
    snprintf(path, sizeof path, "%s/tests/fuzz/corpus", srcdir ? srcdir : ".");
    const char *folder = argc > 1 ? argv[1] : path;
    int scenes = replay(folder, "scene"), pictures = replay(folder, "png");
    printf("%d scenes, %d pictures\n", scenes, pictures);
    return scenes && pictures ? 0 : 1;
}
