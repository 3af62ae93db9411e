/* frames.c: which frames an animation has, and their clocks (facts sdl.md 9.4). */
#include "cli/frames.h"

#include <math.h>

/* A share p of the frames below 1 starts at int(count * p); a frame may lie behind the
 * last one. */
static int subset(const struct animation *a, double said, int otherwise)
{
    if (said < 0)
        return otherwise;
    if (said < 1)
        said = floor(said * (a->final_frame - a->initial_frame + 1 + a->cyclic));
    return (int)fmax(said, a->initial_frame);
}

struct frames frames_of(const struct animation *a)
{
    int first = subset(a, a->subset_start, a->initial_frame);
    int last = subset(a, a->subset_end, a->final_frame);

    return (struct frames) { first, last > first ? last : first, a->step };
}

/* POV-Ray divides by zero when there is one frame only; the initial clock
 * is what is meant. */
double frames_clock_delta(const struct animation *a)
{
    int steps = a->final_frame - a->initial_frame + (a->cyclic ? 1 : 0);

    return steps > 0 ? (a->final_clock - a->initial_clock) / steps : 0;
}

double frames_clock(const struct animation *a, int frame)
{
    return a->initial_clock + (frame - a->initial_frame) * frames_clock_delta(a);
}
