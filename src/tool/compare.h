/* compare.h: how far two pictures are apart. */
#ifndef RTC_COMPARE_H
#define RTC_COMPARE_H

#include <stdbool.h>

#include "base/arena.h"
#include "base/bitmap.h"

struct comparison {
    unsigned width, height;
    double differ;                      /* percent of pixels beyond the threshold in any channel */
    double rmse;                        /* levels of 255, over all channels */
    double psnr;                        /* decibels; infinite when equal */
    double ssim;                        /* of the grey pictures: 1 when equal */
    double largest;                     /* levels of 255 */
    unsigned largest_x, largest_y;
};

/* Pictures of one size.  Grey is taken as equal red, green and blue; alpha
 * counts when both have it. */
void compare(struct arena *mem, const struct bitmap *a, const struct bitmap *b, double threshold,
             struct comparison *out);

/* What two pictures of the same noise have in common, however it falls: the
 * mean, and the spread (of neighbours in a row: the root of the mean square of
 * their difference), of the grey pictures in levels of 255. */
struct likeness { double mean[2], spread[2]; };
void compare_noise(const struct bitmap *a, const struct bitmap *b, struct likeness *out);
double likeness_apart(const struct likeness *l);     /* percent, the larger of both */
const char *likeness_text(struct arena *mem, const struct likeness *l);

/* Writes |a - b| * amplify as a picture. */
bool compare_write_difference(struct arena *mem, const struct bitmap *a, const struct bitmap *b,
                              double amplify, const char *path, const char **error);

/* One line: "0.013% differ, RMSE 0.42, PSNR 55.7 dB, SSIM 0.9998, largest 31 at 12,40". */
const char *compare_text(struct arena *mem, const struct comparison *c);

#endif
