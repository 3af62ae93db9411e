/* places.c: where files are: the library, the picture. */
#include "cli/places.h"

#include <config.h>
#include <limits.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>
#include <unistd.h>

/* POV-Ray's own files first: they have more in them than ours. */
static const char *const installed[] = {
    "/usr/share/povray-3.7/include",
    "/usr/local/share/povray-3.7/include",
    "/usr/share/povray/include",
    "/usr/local/share/povray/include",
    "/opt/homebrew/share/povray-3.7/include",
    "/opt/local/share/povray-3.7/include",
    PKGDATADIR "/include",
};
enum { N_INSTALLED = sizeof installed / sizeof *installed };

static bool is_folder(const char *path)
{
    struct stat st;

    return stat(path, &st) == 0 && S_ISDIR(st.st_mode);
}

const char *places_installed(unsigned n)
{
    for (int i = 0; i < N_INSTALLED; i++)
        if (is_folder(installed[i]) && n-- == 0)
            return installed[i];
    return NULL;
}

const char *places_folder(struct arena *mem, const char *path)
{
    const char *slash = strrchr(path, '/');

    if (!slash)
        return ".";
    return arena_text(mem, path, slash == path ? 1 : (size_t)(slash - path));
}

/* Of a program that was not installed: build/rtc has ../include. */
static const char *beside_program(struct arena *mem)
{
    char self[PATH_MAX];
    ssize_t n = readlink("/proc/self/exe", self, sizeof self - 1);

    if (n <= 0)
        return NULL;
    self[n] = '\0';
    const char *folder = arena_format(mem, "%s/../include", places_folder(mem, self));
    return access(arena_format(mem, "%s/colors.inc", folder), R_OK) == 0 ? folder : NULL;
}

void places_library(struct options *o)
{
    const char *own = beside_program(o->mem);

    for (unsigned n = 0; places_installed(n); n++)
        list_add(o, &o->library, places_installed(n));
    if (own)
        list_add(o, &o->library, own);
}

/* The scene's name without folder and extension. */
static const char *base_name(const struct options *o)
{
    const char *slash = strrchr(o->scene, '/'), *name = slash ? slash + 1 : o->scene;
    const char *dot = strrchr(name, '.');

    if (strcmp(name, "-") == 0)
        return "stdin";
    return arena_text(o->mem, name, dot && dot > name ? (size_t)(dot - name) : strlen(name));
}

static bool ends_in_png(const char *path)
{
    size_t n = strlen(path);

    return n >= 4 && strcasecmp(path + n - 4, ".png") == 0;
}

static const char *plain_output(const struct options *o)
{
    if (!o->output)
        return arena_format(o->mem, "%s.png", base_name(o));
    if (o->output[0] && o->output[strlen(o->output) - 1] == '/')
        return arena_format(o->mem, "%s%s.png", o->output, base_name(o));
    if (o->povray_name && !ends_in_png(o->output) && strcmp(o->output, "-") != 0)
        return arena_format(o->mem, "%s.png", o->output);
    return o->output;
}

const char *places_output(const struct options *o, int frame)
{
    const char *path = plain_output(o), *slash = strrchr(path, '/'), *dot = strrchr(path, '.');

    if (frame < 0 || strcmp(path, "-") == 0)
        return path;
    size_t stem = dot && (!slash || dot > slash) ? (size_t)(dot - path) : strlen(path);
    int wide = snprintf(NULL, 0, "%d", o->animation.final_frame);
    return arena_format(o->mem, "%.*s%0*d%s", (int)stem, path, wide, frame, path + stem);
}
