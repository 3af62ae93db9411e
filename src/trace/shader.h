/* shader.h: what all of a plan's surfaces share. */
#ifndef RTC_SHADER_H
#define RTC_SHADER_H

#include "base/intern.h"
#include "trace/light.h"
#include "trace/plan.h"
#include "trace/program.h"

struct shader {
    const struct lamp *lamp;
    size_t n_lamp;
    const struct sky *sky;
    uint32_t n_group;                   /* of programs */
    bool has_face_textures;             /* some mesh has its own */
    bool has_interior;                  /* some surface has one that was given */
    bool has_fading;                    /* some interior dims light on its way */
    bool has_double;                    /* some surface is lit on both sides */
    size_t room_surface;
    struct intern finish;               /* its address to its gloss */
    struct intern gloss, plain, program, group, surface;    /* content to the one copy of it */
    size_t n_program;
};

#endif
