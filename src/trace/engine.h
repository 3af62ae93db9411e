/* engine.h: all that others call of the tracer, as one table, so that it can
 * be compiled for several instruction sets and picked when the program
 * starts (Makefile.am: engine variants). */
#ifndef RTC_ENGINE_H
#define RTC_ENGINE_H

#include "trace/plan.h"
#include "trace/render.h"

struct engine {
    struct plan *(*plan_new)(struct scene *s, struct arena *mem, unsigned threads);
    void (*plan_explain)(const struct plan *p, FILE *out);
    void (*plan_dump)(const struct plan *p, FILE *out);
    bool (*render)(const struct plan *p, const struct render_options *o,
                   struct render_stats *stats);
};

extern const struct engine engine_baseline, engine_v3, engine_v4;

#endif
