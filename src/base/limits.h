/* limits.h: what a scene may ask for; every recursion over input is counted. */
#ifndef RTC_LIMITS_H
#define RTC_LIMITS_H

#include <stddef.h>

struct limits {
    size_t memory;                      /* bytes in all arenas */
    size_t source_bytes;                /* one source file */
    unsigned nesting;                   /* blocks, brackets, parentheses in each other */
    unsigned include_depth;
    unsigned call_depth;                /* macros and included files in each other */
    unsigned csg_depth;                 /* objects in each other */
    double iterations;                  /* rounds of all loops together */
    unsigned pattern_levels;            /* pigments, textures and functions in each other, ... */
    double pattern_parts;               /* ... and all that one of them holds */
    size_t array_items;
    size_t string_bytes;
    unsigned trace_depth;               /* the highest max_trace_level */
    unsigned image_side;                /* pixels; PNG allows 2^31 - 1 */
};

#define LIMITS_DEFAULT { \
    .memory = (size_t)8 << 30, .source_bytes = (size_t)1 << 30, .nesting = 1000, \
    .include_depth = 32, .call_depth = 98, .csg_depth = 1000, .iterations = 1e9, \
    .pattern_levels = 400, .pattern_parts = 1e6, \
    .array_items = (size_t)1 << 28, .string_bytes = (size_t)1 << 26, .trace_depth = 256, \
    .image_side = 1000000 }

/* Exit codes of the program. */
enum { EXIT_OK = 0, EXIT_SCENE = 1, EXIT_USAGE = 2, EXIT_OUTPUT = 3, EXIT_LIMIT = 4,
       EXIT_INTERRUPTED = 130 };

#endif
