/* png.c: the target that reads pictures. */
#define _GNU_SOURCE
#include <stdio.h>
#include <sys/mman.h>
#include <unistd.h>

#include "fuzz/target.h"
#include "image/image.h"

/* A file of memory: the reader asks for a name. */
int fuzz_png(const uint8_t *bytes, size_t size)
{
    char path[64];
    struct arena mem;
    struct bitmap picture;
    const char *error;
    int file = memfd_create("picture", 0);

    if (file < 0 || write(file, bytes, size) != (ssize_t)size)
        return 0;
    snprintf(path, sizeof path, "/proc/self/fd/%d", file);
    arena_init(&mem, NULL);
    if (image_read_png(&mem, path, 1 << 18, &picture, &error))
        for (unsigned c = 0; c < picture.channels; c++)
            bitmap_sample(&picture, picture.width - 1, picture.height - 1, c);
    arena_free(&mem);
    close(file);
    return 0;
}
