/* progress.c: one line at a terminal: share, rays a second, time left. */
#include "cli/progress.h"

#include <math.h>
#include <time.h>
#include <unistd.h>

static const double patience = 0.5, interval = 0.1;    /* seconds: short renders stay silent */

double progress_now(void)
{
    struct timespec t;

    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + (double)t.tv_nsec / 1e9;
}

void progress_start(struct progress *p, FILE *out, bool wanted)
{
    *p = (struct progress) { .out = wanted && isatty(fileno(out)) ? out : NULL,
                             .start = progress_now() };
}

static void show_time(FILE *out, double seconds)
{
    long s = lround(seconds);

    if (s < 60)
        fprintf(out, "%ld s", s);
    else if (s < 3600)
        fprintf(out, "%ld:%02ld min", s / 60, s % 60);
    else
        fprintf(out, "%ld:%02ld h", s / 3600, s % 3600 / 60);
}

void progress_show(struct progress *p, double share, double rays)
{
    double now = progress_now(), spent = now - p->start;

    if (!p->out || spent < patience || now - p->shown < interval)
        return;
    p->shown = now;
    fprintf(p->out, "\r%5.1f%%  %.2f M rays/s  ", 100 * share, rays / spent / 1e6);
    if (share > 0) {
        show_time(p->out, spent * (1 - share) / share);
        fputs(" left", p->out);
    }
    fputs("\033[K", p->out);
    fflush(p->out);
}

void progress_end(struct progress *p)
{
    if (p->out && p->shown > 0) {
        fputs("\r\033[K", p->out);
        fflush(p->out);
    }
}
