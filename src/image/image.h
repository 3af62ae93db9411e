/* image.h: picture files in and out. */
#ifndef RTC_IMAGE_H
#define RTC_IMAGE_H

#include <stdbool.h>
#include <stddef.h>

#include "base/arena.h"
#include "base/bitmap.h"

/* Reads a picture file whole.  false: *error says why, for a person, without
 * the file's name ("not a PNG file", "truncated").  Nothing in the file may
 * crash, hang or take more memory than width * height asks for; limit_pixels
 * (0: 2^28) bounds that too. */
bool image_read_png(struct arena *mem, const char *path, size_t limit_pixels, struct bitmap *out,
                    const char **error);

/* How linear or working-space floats become file values: facts shading.md 5.2. */
struct tone {
    enum { TONE_RAW, TONE_LINEAR, TONE_POWER, TONE_SRGB } working;     /* as the scene's space */
    double gamma;                       /* of TONE_POWER */
};

/* A PNG that is written from top to bottom while the picture is made:
 * beside its target (PATH.XXXXXX), renamed when closed, so that an older
 * picture is there until the new one is whole.  "-": standard output. */
struct png_writer;
struct png_writer *png_open(const char *path, unsigned width, unsigned height, unsigned bits,
                            bool alpha, struct tone tone, const char **error);
/* Rows of width * 4 floats: red, green, blue, transmit. */
bool png_rows(struct png_writer *w, unsigned count, const float *pixels, const char **error);
const char *png_temporary(const struct png_writer *w);  /* what is being written; NULL: the target itself */
/* keep: finish and rename (missing rows are black); else remove what was written. */
bool png_close(struct png_writer *w, bool keep, const char **error);

#endif
