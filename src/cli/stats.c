/* stats.c: what a run cost (--stats). */
#include "cli/stats.h"

#include <sys/resource.h>

#include "cli/progress.h"

static double seconds(struct timeval t)
{
    return (double)t.tv_sec + (double)t.tv_usec / 1e6;
}

struct row { const char *key, *text, *unit; double value; int decimals; };

static void print_text(const struct row *row, FILE *out)
{
    for (; row->key; row++)
        fprintf(out, "%-19s %14.*f %s\n", row->text, row->decimals, row->value, row->unit);
}

static void print_json(const struct row *row, FILE *out)
{
    fputc('{', out);
    for (; row->key; row++)
        fprintf(out, "\"%s\":%.*f%s", row->key, row->decimals, row->value, row[1].key ? "," : "}\n");
}

void stats_print(const struct stats *s, const struct options *o, FILE *out)
{
    const struct render_stats *r = &s->render;
    struct rusage used;

    getrusage(RUSAGE_SELF, &used);
    const struct row rows[] = {
        { "parse", "reading", "s", s->parse, 6 },
        { "build", "planning", "s", s->build, 6 },
        { "trace", "tracing", "s", s->trace, 6 },
        { "write", "of it, writing", "s", s->write, 6 },
        { "total", "all", "s", progress_now() - s->start, 6 },
        { "parse_cpu", "processor, reading", "s", s->parse_cpu, 6 },
        { "build_cpu", "processor, planning", "s", s->build_cpu, 6 },
        { "trace_cpu", "processor, tracing", "s", s->trace_cpu, 6 },
        { "cpu", "processor, all", "s", seconds(used.ru_utime) + seconds(used.ru_stime), 6 },
        { "objects", "objects", "", (double)s->objects, 0 },
        { "lights", "lights", "", (double)s->lights, 0 },
        { "rays", "rays", "", r->rays, 0 },
        { "primary_rays", "from the camera", "", r->primary_rays, 0 },
        { "reflected_rays", "reflected", "", r->reflected_rays, 0 },
        { "refracted_rays", "refracted", "", r->refracted_rays, 0 },
        { "shadow_rays", "shadow rays", "", r->shadow_rays, 0 },
        { "scene_bytes", "scene", "bytes", (double)s->scene_bytes, 0 },
        { "plan_bytes", "plan", "bytes", (double)s->plan_bytes, 0 },
        { "peak_bytes", "peak memory", "bytes", (double)used.ru_maxrss * 1024, 0 },
        { NULL, NULL, NULL, 0, 0 },
    };
    if (o->stats == STATS_JSON)
        print_json(rows, out);
    else
        print_text(rows, out);
}
