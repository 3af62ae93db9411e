/* stats.h: what a run cost (--stats). */
#ifndef RTC_STATS_H
#define RTC_STATS_H

#include <stdio.h>

#include "cli/options.h"
#include "scene/scene.h"
#include "trace/render.h"

struct stats {
    double start;                       /* progress_now() */
    double parse, build, trace, write;  /* seconds: bytes to scene, scene to plan, pixels, file */
    double parse_cpu, build_cpu, trace_cpu;     /* the same, of all processors */
    struct render_stats render;
    size_t scene_bytes, plan_bytes;
    size_t objects, lights;
};

void stats_print(const struct stats *s, const struct options *o, FILE *out);

#endif
