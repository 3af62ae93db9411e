/* rtc-compare.c: compares two pictures.
 *
 * Exit status: 0 alike enough, 1 over the limit, 2 usage or a file that
 * cannot be read, 3 the difference cannot be written. */
#include <getopt.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/limits.h"
#include "image/image.h"
#include "tool/compare.h"

enum { OVER_LIMIT = 1 };
static const double amplify = 16;       /* a level that the eye would miss is seen */

struct request {
    const char *a, *b, *difference;
    double most_differ, threshold;
    double most_apart;                  /* percent, of noise; below 0: pixels are compared */
};

static const char usage[] =
    "usage: rtc-compare [options] A.png B.png\n"
    "  --max-differ PERCENT   exit 1 when more pixels differ (default 0)\n"
    "  --threshold LEVELS     a pixel differs beyond this in a channel (default 2 of 255)\n"
    "  --noise PERCENT        compare mean and spread instead; exit 1 when further apart\n"
    "  --diff FILE.png        write the difference, 16 times amplified\n"
    "  --help                 this text\n";

static bool number(const char *text, const char *option, double high, double *out)
{
    char *end;

    *out = strtod(text, &end);
    if (end != text && !*end && *out >= 0 && *out <= high)
        return true;
    fprintf(stderr, "rtc-compare: error: %s: not a number from 0 to %g: '%s'\n", option, high, text);
    return false;
}

static bool read_arguments(int argc, char **argv, struct request *r)
{
    static const struct option options[] = {
        { "diff", required_argument, NULL, 'd' },
        { "max-differ", required_argument, NULL, 'm' },
        { "noise", required_argument, NULL, 'n' },
        { "threshold", required_argument, NULL, 't' },
        { "help", no_argument, NULL, 'h' },
        { NULL, 0, NULL, 0 },
    };

    for (int c; (c = getopt_long(argc, argv, "h", options, NULL)) != -1;) {
        bool good = true;
        if (c == 'd')
            r->difference = optarg;
        else if (c == 'm')
            good = number(optarg, "--max-differ", 100, &r->most_differ);
        else if (c == 'n')
            good = number(optarg, "--noise", 100, &r->most_apart);
        else if (c == 't')
            good = number(optarg, "--threshold", 255, &r->threshold);
        else if (c == 'h') {
            fputs(usage, stdout);
            exit(EXIT_OK);
        } else
            good = false;
        if (!good)
            return false;
    }
    if (argc - optind == 2) {
        r->a = argv[optind];
        r->b = argv[optind + 1];
    } else
        fputs(usage, stderr);
    return r->b != NULL;
}

static bool read_picture(struct arena *mem, const char *path, struct bitmap *out)
{
    const char *error;

    if (image_read_png(mem, path, 0, out, &error))
        return true;
    fprintf(stderr, "rtc-compare: error: %s: %s\n", path, error);
    return false;
}

static int print_noise(struct arena *mem, const struct bitmap *a, const struct bitmap *b, double most)
{
    struct likeness l;

    compare_noise(a, b, &l);
    printf("%s\n", likeness_text(mem, &l));
    return likeness_apart(&l) > most ? OVER_LIMIT : EXIT_OK;
}

static int compare_files(struct arena *mem, const struct request *r)
{
    struct bitmap a, b;
    struct comparison c;
    const char *error;

    if (!read_picture(mem, r->a, &a) || !read_picture(mem, r->b, &b))
        return EXIT_USAGE;
    if (a.width != b.width || a.height != b.height) {
        fprintf(stderr, "rtc-compare: error: %s is %u x %u, %s is %u x %u\n", r->a, a.width, a.height,
                r->b, b.width, b.height);
        return EXIT_USAGE;
    }
    if (r->most_apart >= 0)
        return print_noise(mem, &a, &b, r->most_apart);
    compare(mem, &a, &b, r->threshold, &c);
    printf("%s\n", compare_text(mem, &c));
    if (r->difference && !compare_write_difference(mem, &a, &b, amplify, r->difference, &error)) {
        fprintf(stderr, "rtc-compare: error: %s: %s\n", r->difference, error);
        return EXIT_OUTPUT;
    }
    return c.differ > r->most_differ ? OVER_LIMIT : EXIT_OK;
}

int main(int argc, char **argv)
{
    struct request r = { .most_differ = 0, .threshold = 2, .most_apart = -1 };
    struct arena mem;

    if (!read_arguments(argc, argv, &r))
        return EXIT_USAGE;
    arena_init(&mem, NULL);
    int status = compare_files(&mem, &r);
    arena_free(&mem);
    return status;
}
