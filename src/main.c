/* main.c: bytes -> tokens -> AST -> values -> scene -> plan -> pixels -> file. */
#include <config.h>

#include <errno.h>
#include <sched.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include "base/arena.h"
#include "base/diag.h"
#include "base/source.h"
#include "cli/engines.h"
#include "cli/frames.h"
#include "cli/options.h"
#include "cli/picture.h"
#include "cli/places.h"
#include "cli/progress.h"
#include "cli/stats.h"
#include "cli/stop.h"
#include "image/image.h"
#include "lang/lang.h"

/* One picture's way through the program. */
struct run {
    const struct options *o;
    const struct engine *engine;
    struct budget budget;
    struct arena text, tree, scene_mem, plan_mem;       /* each stage's own */
    struct sources sources;
    struct diag diag;
    FILE *debug;
    int frame;                          /* < 0: no animation */
    struct lang *lang;
    bool limit_reached;
    struct stats stats;
};

/* --- the world ----------------------------------------------------------- */

/* Called wherever memory runs out, from any thread; 0: the system's own. */
static void out_of_memory(size_t limit)
{
    static const char text[] =
        "rtc: error: the scene needs more than %.6g MiB of memory; --max-memory allows more\n";

    if (limit)
        fprintf(stderr, text, (double)limit / (1 << 20));
    else
        fputs("rtc: error: the scene needs more memory than the system gives\n", stderr);
    fflush(NULL);
    stop_now(EXIT_LIMIT);
}

static unsigned all_processors(void)
{
    cpu_set_t set;

    if (sched_getaffinity(0, sizeof set, &set) == 0)
        return (unsigned)CPU_COUNT(&set);
    long n = sysconf(_SC_NPROCESSORS_ONLN);
    return n > 0 ? (unsigned)n : 1;
}

static unsigned threads(const struct options *o)
{
    return o->threads ? o->threads : all_processors();
}

static bool load_image(struct arena *mem, const char *path, const char *type, struct bitmap *out,
                       const char **error)
{
    *error = "only PNG pictures can be read yet";
    return strcmp(type, "png") == 0 && image_read_png(mem, path, 0, out, error);
}

static bool is_later(const struct options *o, int frame)
{
    return o->animation.is_on && frame > frames_of(&o->animation).first;
}

/* #debug goes to standard error, or to the file of +GD. */
static bool open_debug(const struct options *o, int frame, FILE **debug)
{
    *debug = o->no_debug ? NULL : stderr;
    if (!o->debug_file)
        return true;
    *debug = fopen(o->debug_file, is_later(o, frame) ? "a" : "w");
    return *debug || option_error("+GD: %s: %s", o->debug_file, strerror(errno));
}

static void close_debug(FILE *debug)
{
    if (debug && debug != stderr)
        fclose(debug);
}

/* --- the stages ---------------------------------------------------------- */

static struct lang_setup setup_of(struct run *r)
{
    const struct options *o = r->o;
    const struct animation *a = &o->animation;
    struct lang_setup s = {
        .mem = &r->tree, .scene_mem = &r->scene_mem, .sources = &r->sources, .diag = &r->diag,
        .limits = &o->limits, .library = o->library.item, .n_library = o->library.n,
        .allow_read = o->allow_read.item, .n_allow_read = o->allow_read.n,
        .allow_write = o->allow_write.item, .n_allow_write = o->allow_write.n,
        .declare = o->declare.item, .n_declare = o->declare.n, .header = o->header,
        .width = o->width, .height = o->height, .version = o->version,
        .checks = o->task == TASK_CHECK,
        .clock = o->clock, .clock_on = o->has_clock, .debug = r->debug, .load_image = load_image };

    if (r->frame >= 0) {
        s.clock = frames_clock(a, r->frame);
        s.clock_on = true;
        s.clock_delta = frames_clock_delta(a);
        s.initial_clock = a->initial_clock, s.final_clock = a->final_clock;
        s.frame_number = r->frame;
        s.initial_frame = a->initial_frame;
        s.final_frame = a->final_frame + a->cyclic;     /* what POV-Ray's scenes see */
    }
    return s;
}

struct watch { double wall, cpu; };

static struct watch watch_now(void)
{
    struct timespec t;

    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return (struct watch) { progress_now(), (double)t.tv_sec + (double)t.tv_nsec / 1e9 };
}

/* What has passed since start, which begins anew. */
static void lap(struct watch *start, double *wall, double *cpu)
{
    struct watch now = watch_now();

    *wall = now.wall - start->wall;
    *cpu = now.cpu - start->cpu;
    *start = now;
}

static int fail(const struct run *r)
{
    return r->limit_reached ? EXIT_LIMIT : EXIT_SCENE;
}

static bool dump_text(struct run *r)
{
    const struct ast *tree;

    if (r->o->task == TASK_DUMP_TOKENS)
        lang_dump_tokens(r->lang, r->o->scene, stdout);
    else if (r->o->task != TASK_DUMP_AST)
        return false;
    else if ((tree = lang_parse(r->lang, r->o->scene)))
        lang_dump_ast(r->lang, tree, stdout);
    return true;
}

/* bytes -> tokens -> AST -> values -> scene; NULL: there is none, or the
 * dump that was asked for is done. */
static struct scene *read_scene(struct run *r)
{
    if (dump_text(r))
        return NULL;
    struct scene *scene = lang_read(r->lang, r->o->scene);
    if (r->o->task == TASK_DUMP_SCENE && scene && !r->diag.errors)
        scene_dump(scene, stdout);
    return scene;
}

/* scene -> plan */
static struct plan *make_plan(struct run *r, struct scene *scene)
{
    struct plan *plan = r->engine->plan_new(scene, &r->plan_mem, threads(r->o));

    if (r->o->task == TASK_DUMP_PLAN)
        r->engine->plan_dump(plan, stdout);
    if (r->o->task == TASK_EXPLAIN)
        r->engine->plan_explain(plan, stdout);
    return plan;
}

static int cannot_write(const struct picture *p)
{
    fprintf(stderr, "rtc: error: cannot write %s: %s\n",
            strcmp(p->path, "-") == 0 ? "to standard output" : p->path, p->error);
    return EXIT_OUTPUT;
}

/* plan -> pixels -> file */
static int render_rows(struct run *r, const struct plan *plan, struct picture *p,
                       struct render_options *ro)
{
    double side = 1;

    while (side * side < r->o->samples)
        side++;
    ro->samples_side = (unsigned)side;
    ro->threads = threads(r->o);
    ro->stop = stop_flag;
    progress_start(&p->progress, stderr, !r->o->quiet);
    stop_while_tracing(true);
    bool whole = r->engine->render(plan, ro, &r->stats.render);
    stop_while_tracing(false);
    progress_end(&p->progress);
    r->stats.write = p->write_seconds;
    /* A frame that lacks rows would be taken for a whole one by --resume. */
    if (!picture_close(p, !p->error && (whole || r->frame < 0)) || p->error)
        return cannot_write(p);
    return whole ? EXIT_OK : EXIT_INTERRUPTED;
}

static void count_scene(struct run *r, const struct scene *scene)
{
    r->stats.objects = scene->n_object;
    r->stats.lights = scene->n_light;
    r->stats.scene_bytes = arena_size(&r->scene_mem);
}

/* The output is opened before the plan is made: whoever gave a wrong name
 * need not wait for that. */
static int make_picture(struct run *r, struct scene *scene)
{
    struct picture picture;
    struct render_options ro = { 0 };
    struct watch start = watch_now();

    if (r->o->task != TASK_RENDER) {
        make_plan(r, scene);
        return EXIT_OK;
    }
    const char *path = places_output(r->o, r->frame);
    if (!picture_open(&picture, r->o, &scene->settings, path, &r->plan_mem, &ro)) {
        picture_close(&picture, false);
        return cannot_write(&picture);
    }
    const struct plan *plan = make_plan(r, scene);
    lap(&start, &r->stats.build, &r->stats.build_cpu);
    int status = render_rows(r, plan, &picture, &ro);
    lap(&start, &r->stats.trace, &r->stats.trace_cpu);
    r->stats.plan_bytes = arena_size(&r->plan_mem);
    return status;
}

/* All that could be said about them was said; they may be larger than the scene. */
static void forget_texts(struct run *r)
{
    arena_free(&r->text);
    sources_init(&r->sources, &r->text);
}

static int make_frame(struct run *r)
{
    struct lang_setup setup = setup_of(r);
    struct watch start = watch_now();

    r->lang = lang_new(&setup);
    struct scene *scene = read_scene(r);
    r->limit_reached = lang_limit_reached(r->lang);
    lang_free(r->lang);
    arena_free(&r->tree);
    forget_texts(r);
    lap(&start, &r->stats.parse, &r->stats.parse_cpu);
    if (r->diag.errors || r->limit_reached)
        return fail(r);
    if (scene)
        count_scene(r, scene);
    if (!scene || r->o->task == TASK_CHECK || r->o->task == TASK_DUMP_SCENE)
        return EXIT_OK;
    return make_picture(r, scene);
}

/* --- around them --------------------------------------------------------- */

/* no-color.org: present, and not empty. */
static bool is_set(const char *variable)
{
    const char *value = getenv(variable);

    return value && *value;
}

static bool is_dumb(const char *terminal)
{
    return terminal && strcmp(terminal, "dumb") == 0;
}

static void start_diag(struct run *r)
{
    const struct options *o = r->o;
    struct diag *d = &r->diag;

    diag_init(d, &r->sources, stderr);
    d->style = o->diagnostics;
    d->colour = isatty(STDERR_FILENO) && !is_set("NO_COLOR") && !is_dumb(getenv("TERM"));
    d->quiet = o->quiet;
    d->strict = o->strict;
    d->lint = o->lint;
}

static void print_stats(struct run *r)
{
    bool to_picture = r->o->output && strcmp(r->o->output, "-") == 0;

    if (r->o->stats != STATS_NONE)
        stats_print(&r->stats, r->o, to_picture ? stderr : stdout);
}

static int run_frame(const struct options *o, const struct engine *engine, int frame)
{
    struct run r = { .o = o, .engine = engine, .frame = frame,
                     .budget = { .limit = o->limits.memory, .exceeded = out_of_memory },
                     .stats = { .start = progress_now() } };

    if (!open_debug(o, frame, &r.debug))
        return EXIT_OUTPUT;
    arena_init(&r.text, &r.budget);
    arena_init(&r.tree, &r.budget);
    arena_init(&r.scene_mem, &r.budget);
    arena_init(&r.plan_mem, &r.budget);
    sources_init(&r.sources, &r.text);
    start_diag(&r);
    int status = make_frame(&r);
    diag_end(&r.diag);
    if (status == EXIT_OK && (o->task == TASK_RENDER || o->task == TASK_CHECK))
        print_stats(&r);
    close_debug(r.debug);
    arena_free(&r.plan_mem);
    arena_free(&r.scene_mem);
    arena_free(&r.text);
    return status;
}

/* A picture gets its name when it is whole. */
static bool is_made(const struct options *o, int frame)
{
    struct stat st;

    return o->resume && o->task == TASK_RENDER && !o->no_file &&
           stat(places_output(o, frame), &st) == 0 && S_ISREG(st.st_mode);
}

static int run_all(const struct options *o, const struct engine *engine)
{
    struct frames f = frames_of(&o->animation);

    if (!o->animation.is_on)
        return run_frame(o, engine, -1);
    for (int frame = f.first; frame <= f.last; frame += f.step) {
        int status = is_made(o, frame) ? EXIT_OK : run_frame(o, engine, frame);
        if (status != EXIT_OK)
            return status;
    }
    return EXIT_OK;
}

static int run(struct options *o)
{
    const struct engine *engine = engine_find(o->isa);

    if (!engine) {
        option_error("--isa: '%s' is not in this program or not on this machine", o->isa);
        return EXIT_USAGE;
    }
    places_library(o);
    stop_install();
    return run_all(o, engine);
}

/* What was printed may wait in a buffer. */
static int finished(int status)
{
    if ((fflush(stdout) == 0 && !ferror(stdout)) || status != EXIT_OK)
        return status;
    fprintf(stderr, "rtc: error: cannot write to standard output: %s\n", strerror(errno));
    return EXIT_OUTPUT;
}

int main(int argc, char **argv)
{
    struct arena mem;
    struct options o;
    int status = EXIT_OK;

    arena_init(&mem, NULL);
    if (!options_read(&o, argc, argv, &mem))
        status = EXIT_USAGE;
    else if (o.task != TASK_NOTHING)
        status = run(&o);
    arena_free(&mem);
    return finished(status);
}
