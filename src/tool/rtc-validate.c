/* rtc-validate.c: renders scenes with rtc and with POV-Ray, and compares.
 *
 * Exit status: 0 all alike, 1 some are not, 2 usage, 3 the report cannot be
 * written, 77 (skipped, to automake) when POV-Ray is not installed. */
#include <errno.h>
#include <fcntl.h>
#include <getopt.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "base/limits.h"
#include "image/image.h"
#include "tool/compare.h"
#include "tool/report.h"

enum { SOME_DIFFER = 1, NO_POVRAY = 77, NOT_STARTED = 127 };
static const double amplify = 16;

struct request {
    unsigned width, height;
    double most_differ, threshold;
    const char *html, *keep, *rtc, *povray;
    struct arena *mem;
    const char *folder;                 /* for the pictures */
    FILE *page;
};

static const char usage[] =
    "usage: rtc-validate [options] SCENE...\n"
    "Renders each scene with rtc and with POV-Ray and compares the pictures.\n"
    "  -W N, -H N             size in pixels (default 320 x 240)\n"
    "  --max-differ PERCENT   of pixels that may differ (default 0.1)\n"
    "  --threshold LEVELS     a pixel differs beyond this in a channel (default 2 of 255)\n"
    "  --html FILE            write a page with the pictures, differences and times\n"
    "  --keep FOLDER          keep the pictures there\n"
    "  --rtc PROGRAM          default: rtc beside this program, then on the path\n"
    "  --povray PROGRAM       default: povray\n"
    "  --help                 this text\n";

static bool number(const char *text, const char *option, double low, double high, double *out)
{
    char *end;

    *out = strtod(text, &end);
    if (end != text && !*end && *out >= low && *out <= high)
        return true;
    fprintf(stderr, "rtc-validate: error: %s: not a number from %g to %g: '%s'\n", option, low, high,
            text);
    return false;
}

static bool size(const char *text, const char *option, unsigned *out)
{
    double n = 0;
    bool good = number(text, option, 1, 10000, &n);

    *out = (unsigned)n;
    return good;
}

static bool read_option(int c, struct request *r)
{
    switch (c) {
    case 'W': return size(optarg, "-W", &r->width);
    case 'H': return size(optarg, "-H", &r->height);
    case 'm': return number(optarg, "--max-differ", 0, 100, &r->most_differ);
    case 't': return number(optarg, "--threshold", 0, 255, &r->threshold);
    case 'o': r->html = optarg; return true;
    case 'k': r->keep = optarg; return true;
    case 'r': r->rtc = optarg; return true;
    case 'p': r->povray = optarg; return true;
    case 'h': fputs(usage, stdout); exit(EXIT_OK);
    default: return false;
    }
}

static bool read_arguments(int argc, char **argv, struct request *r)
{
    static const struct option options[] = {
        { "max-differ", required_argument, NULL, 'm' },
        { "threshold", required_argument, NULL, 't' },
        { "html", required_argument, NULL, 'o' },
        { "keep", required_argument, NULL, 'k' },
        { "rtc", required_argument, NULL, 'r' },
        { "povray", required_argument, NULL, 'p' },
        { "help", no_argument, NULL, 'h' },
        { NULL, 0, NULL, 0 },
    };

    for (int c; (c = getopt_long(argc, argv, "W:H:h", options, NULL)) != -1;)
        if (!read_option(c, r))
            return false;
    if (optind == argc)
        fputs(usage, stderr);
    return optind < argc;
}

/* The rtc that was built or installed with this program. */
static const char *find_rtc(struct arena *mem)
{
    char self[PATH_MAX];
    ssize_t n = readlink("/proc/self/exe", self, sizeof self - 1);

    if (n <= 0)
        return "rtc";
    self[n] = '\0';
    char *beside = arena_format(mem, "%.*s/rtc", (int)(strrchr(self, '/') - self), self);
    return access(beside, X_OK) == 0 ? beside : "rtc";
}

static double seconds(struct timeval t)
{
    return (double)t.tv_sec + (double)t.tv_usec / 1e6;
}

static double now(void)
{
    struct timespec t;

    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + (double)t.tv_nsec / 1e9;
}

/* In the child: the scene's folder is the working one, messages go to a file. */
static void become(const char *const word[], const char *folder, const char *messages)
{
    int fd = open(messages, O_WRONLY | O_CREAT | O_TRUNC, 0666);

    if (fd >= 0) {
        dup2(fd, STDOUT_FILENO);
        dup2(fd, STDERR_FILENO);
    }
    if (chdir(folder) == 0)
        execvp(word[0], (char *const *)word);
    _exit(NOT_STARTED);
}

/* The exit status, or -1 when it was killed. */
static int run_program(const char *const word[], const char *folder, const char *messages,
                       struct run *run)
{
    double start = now();
    struct rusage used;
    int status = 0;

    fflush(NULL);
    pid_t child = fork();
    if (child == 0)
        become(word, folder, messages);
    if (child < 0 || wait4(child, &status, 0, &used) < 0)
        return -1;
    run->wall = now() - start;
    run->cpu = seconds(used.ru_utime) + seconds(used.ru_stime);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

static bool has_povray(const struct request *r)
{
    const char *const word[] = { r->povray, "--version", NULL };
    struct run run;

    return run_program(word, ".", "/dev/null", &run) != NOT_STARTED;
}

static int run_rtc(const struct request *r, const char *scene, const char *folder, struct run *run)
{
    struct arena *mem = r->mem;
    const char *const word[] = {
        r->rtc, "-q", "-t", "1", "--samples", "1", "-W", arena_format(mem, "%u", r->width),
        "-H", arena_format(mem, "%u", r->height), "-o", run->picture, "--", scene, NULL };

    return run_program(word, folder, arena_format(mem, "%s/rtc.txt", r->folder), run);
}

static int run_povray(const struct request *r, const char *scene, const char *folder,
                      struct run *run)
{
    struct arena *mem = r->mem;
    const char *const word[] = {
        r->povray, arena_format(mem, "+I%s", scene), arena_format(mem, "+O%s", run->picture),
        arena_format(mem, "+W%u", r->width), arena_format(mem, "+H%u", r->height), "+FN", "+WT1",
        "-A", "-D", "-P", "-V", "+L.", NULL };

    return run_program(word, folder, arena_format(mem, "%s/povray.txt", r->folder), run);
}

/* The first line of what a program said that tells of an error. */
static const char *complaint(const struct request *r, const char *name)
{
    FILE *f = fopen(arena_format(r->mem, "%s/%s.txt", r->folder, name), "r");
    char line[512], found[512] = "no message";

    while (f && fgets(line, sizeof line, f))
        if (strstr(line, "rror")) {
            line[strcspn(line, "\n")] = '\0';
            strcpy(found, line);
            break;
        }
    if (f)
        fclose(f);
    return arena_text(r->mem, found, strlen(found));
}

static bool failed(const struct request *r, const char *scene, const char *verdict)
{
    printf("FAIL %s: %s\n", scene, verdict);
    if (r->page)
        report_failure(r->page, scene, verdict);
    return false;
}

static bool compare_runs(const struct request *r, const char *scene, const struct run *ours,
                         const struct run *theirs)
{
    struct arena *mem = r->mem;
    struct bitmap a, b;
    struct comparison c;
    const char *error, *difference = arena_format(mem, "%s-diff.png", ours->picture);

    if (!image_read_png(mem, ours->picture, 0, &a, &error) ||
        !image_read_png(mem, theirs->picture, 0, &b, &error))
        return failed(r, scene, error);
    if (a.width != b.width || a.height != b.height)
        return failed(r, scene, "the pictures are of different sizes");
    compare(mem, &a, &b, r->threshold, &c);
    bool passed = c.differ <= r->most_differ;
    char *verdict = arena_format(mem, "%s; CPU %.3f s, POV-Ray %.3f s", compare_text(mem, &c),
                                 ours->cpu, theirs->cpu);
    printf("%s %s: %s\n", passed ? "ok  " : "FAIL", scene, verdict);
    if (!compare_write_difference(mem, &a, &b, amplify, difference, &error))
        return failed(r, scene, error);
    if (r->page)
        report_scene(r->page, scene, verdict, passed, ours, theirs, difference);
    return passed;
}

static bool validate(const struct request *r, const char *scene, int number)
{
    struct arena *mem = r->mem;
    const char *slash = strrchr(scene, '/'), *name = slash ? slash + 1 : scene;
    const char *folder = slash ? arena_format(mem, "%.*s/", (int)(slash - scene), scene) : ".";
    struct run ours = { .picture = arena_format(mem, "%s/%d-%s-rtc.png", r->folder, number, name) };
    struct run theirs = {
        .picture = arena_format(mem, "%s/%d-%s-povray.png", r->folder, number, name) };

    int status = run_rtc(r, name, folder, &ours);
    if (status != 0)
        return failed(r, scene, arena_format(mem, "rtc ends with %d: %s", status,
                                             complaint(r, "rtc")));
    status = run_povray(r, name, folder, &theirs);
    if (status != 0)
        return failed(r, scene, arena_format(mem, "POV-Ray ends with %d: %s", status,
                                             complaint(r, "povray")));
    return compare_runs(r, scene, &ours, &theirs);
}

static const char *absolute(struct arena *mem, const char *path)
{
    char here[PATH_MAX];

    if (path[0] == '/' || !strchr(path, '/') || !getcwd(here, sizeof here))
        return path;                    /* a plain name is looked for on the path */
    return arena_format(mem, "%s/%s", here, path);
}

/* Debian's POV-Ray writes below /tmp and the scene's folder only. */
static const char *picture_folder(struct arena *mem)
{
    char temporary[] = "/tmp/rtc-validate.XXXXXX";

    return mkdtemp(temporary) ? arena_text(mem, temporary, strlen(temporary)) : NULL;
}

static bool run_tool(const char *const word[])
{
    struct run run;

    return run_program(word, ".", "/dev/null", &run) == 0;
}

static bool keep_pictures(const struct request *r)
{
    const char *const copy[] = { "cp", "-R", "--", arena_format(r->mem, "%s/.", r->folder), r->keep,
                                 NULL };

    if (!r->keep || run_tool(copy))
        return true;
    fprintf(stderr, "rtc-validate: error: %s: the pictures cannot be copied there\n", r->keep);
    return false;
}

static void remove_pictures(const struct request *r)
{
    const char *const word[] = { "rm", "-rf", "--", r->folder, NULL };

    run_tool(word);
}

static bool validate_all(struct request *r, int n, char **scene)
{
    struct arena *outer = r->mem, mem;
    int passed = 0;

    arena_init(&mem, NULL);
    r->mem = &mem;
    for (int i = 0; i < n; i++) {
        passed += validate(r, scene[i], i + 1);
        arena_free(&mem);
    }
    r->mem = outer;
    printf("%d of %d alike\n", passed, n);
    return passed == n;
}

static int open_all(struct request *r)
{
    r->folder = picture_folder(r->mem);
    if (!r->folder) {
        fprintf(stderr, "rtc-validate: error: /tmp: %s\n", strerror(errno));
        return EXIT_OUTPUT;
    }
    r->page = r->html ? fopen(r->html, "w") : NULL;
    if (r->html && !r->page) {
        fprintf(stderr, "rtc-validate: error: %s: %s\n", r->html, strerror(errno));
        return EXIT_OUTPUT;
    }
    return EXIT_OK;
}

static int work(struct request *r, int n, char **scene)
{
    int status = open_all(r);

    if (status != EXIT_OK)
        return status;
    if (r->page)
        report_begin(r->page, r->width, r->height);
    status = validate_all(r, n, scene) ? EXIT_OK : SOME_DIFFER;
    if (r->page) {
        report_end(r->page);
        if (fclose(r->page) != 0) {
            fprintf(stderr, "rtc-validate: error: %s: %s\n", r->html, strerror(errno));
            status = EXIT_OUTPUT;
        }
    }
    if (!keep_pictures(r))
        status = EXIT_OUTPUT;
    remove_pictures(r);
    return status;
}

int main(int argc, char **argv)
{
    struct arena mem;
    struct request r = { .width = 320, .height = 240, .most_differ = 0.1, .threshold = 2,
                         .povray = "povray", .mem = &mem };

    if (!read_arguments(argc, argv, &r))
        return EXIT_USAGE;
    if (!has_povray(&r)) {
        fprintf(stderr, "rtc-validate: POV-Ray is not installed (apt install povray)\n");
        return NO_POVRAY;
    }
    arena_init(&mem, NULL);
    r.rtc = r.rtc ? absolute(&mem, r.rtc) : find_rtc(&mem);
    r.povray = absolute(&mem, r.povray);
    int status = work(&r, argc - optind, argv + optind);
    arena_free(&mem);
    return status;
}
