/* report.h: a page that shows two renderers' pictures side by side. */
#ifndef RTC_REPORT_H
#define RTC_REPORT_H

#include <stdbool.h>
#include <stdio.h>

#include "tool/compare.h"

struct run {                            /* one renderer's work on one scene */
    const char *picture;                /* path of its PNG */
    double wall, cpu;                   /* seconds */
};

void report_begin(FILE *out, unsigned width, unsigned height);
/* difference: path of a PNG; verdict: the line that the terminal shows. */
void report_scene(FILE *out, const char *scene, const char *verdict, bool passed,
                  const struct run *ours, const struct run *theirs, const char *difference);
/* A scene that could not be compared. */
void report_failure(FILE *out, const char *scene, const char *verdict);
void report_end(FILE *out);

#endif
