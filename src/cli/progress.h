/* progress.h: one line at a terminal: share, rays a second, time left. */
#ifndef RTC_PROGRESS_H
#define RTC_PROGRESS_H

#include <stdbool.h>
#include <stdio.h>

struct progress {
    FILE *out;                          /* NULL: nothing is shown */
    double start, shown;                /* seconds */
};

void progress_start(struct progress *p, FILE *out, bool wanted);
void progress_show(struct progress *p, double share, double rays);
void progress_end(struct progress *p);  /* clears the line */
double progress_now(void);              /* seconds of a clock that never jumps */

#endif
