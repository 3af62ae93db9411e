/* picture.h: rows on their way from the renderer to the file. */
#ifndef RTC_PICTURE_FILE_H
#define RTC_PICTURE_FILE_H

#include "cli/options.h"
#include "cli/progress.h"
#include "image/image.h"
#include "scene/scene.h"
#include "trace/render.h"

struct picture {
    struct png_writer *png;             /* NULL: -F, nothing is written */
    const char *path, *error;           /* error: why a write failed */
    char message[256];
    unsigned width, height;             /* of the file */
    unsigned x, y;                      /* where the rendered part begins in it */
    unsigned part_width;
    float *row;                         /* one whole row, when the part is narrower */
    struct progress progress;
    double write_seconds;
};

/* The part to render and the file for it; false: it cannot be written. */
bool picture_open(struct picture *p, const struct options *o, const struct settings *s,
                  const char *path, struct arena *mem, struct render_options *r);
/* keep: the rows so far become the picture. */
bool picture_close(struct picture *p, bool keep);

#endif
