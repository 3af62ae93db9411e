/* version.c: what this program is and what it was built with. */
#include "cli/version.h"

#include <config.h>
#include <png.h>

#include "cli/engines.h"
#include "cli/places.h"

void version_print(FILE *out)
{
    const char *include = places_installed(0);

    fprintf(out, "rtc %s\n", PACKAGE_VERSION);
    fprintf(out, "  libpng         %s\n", png_get_libpng_ver(NULL));
    fprintf(out, "  engines        ");
    for (const struct engine_row *row = engine_rows; row->name; row++)
        fprintf(out, "%s%s", row->name, row->is_there() ? " " : " (not on this machine) ");
    fprintf(out, "\n  include files  %s\n", include ? include : "none of POV-Ray's found");
}
