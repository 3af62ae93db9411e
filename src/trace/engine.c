/* engine.c: the tracer's entry; compiled once for each instruction set. */
#include "trace/engine.h"

#ifndef ENGINE
#define ENGINE engine_baseline
#endif

const struct engine ENGINE = {
    .plan_new = plan_new,
    .plan_explain = plan_explain,
    .plan_dump = plan_dump,
    .render = render,
};
