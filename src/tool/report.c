/* report.c: a page that shows two renderers' pictures side by side; pictures
 * are inside the page, so that it opens from disk and can be sent. */
#include "tool/report.h"

#include <stdint.h>

static const char style[] =
    "body { font: 15px/1.4 sans-serif; margin: 2em auto; max-width: 80em; color: #222; }\n"
    "h2 { font-size: 1.1em; margin: 2em 0 .3em; } .bad { color: #b00020; } .good { color: #0a6b2d; }\n"
    "figure { display: inline-block; margin: 0 1em 0 0; } figcaption { color: #555; }\n"
    "img { image-rendering: pixelated; border: 1px solid #ccc; max-width: 100%; }\n";

static void text(FILE *out, const char *s)
{
    for (; *s; s++)
        switch (*s) {
        case '<': fputs("&lt;", out); break;
        case '>': fputs("&gt;", out); break;
        case '&': fputs("&amp;", out); break;
        case '"': fputs("&quot;", out); break;
        default: fputc(*s, out);
        }
}

static void base64(FILE *out, FILE *in)
{
    static const char digit[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    uint8_t b[3];

    for (size_t n; (n = fread(b, 1, 3, in)) > 0;) {
        uint32_t bits = (uint32_t)b[0] << 16 | (n > 1 ? (uint32_t)b[1] << 8 : 0) | (n > 2 ? b[2] : 0);
        fputc(digit[bits >> 18], out);
        fputc(digit[bits >> 12 & 63], out);
        fputc(n > 1 ? digit[bits >> 6 & 63] : '=', out);
        fputc(n > 2 ? digit[bits & 63] : '=', out);
    }
}

static void picture(FILE *out, const char *path, const char *alternative)
{
    FILE *in = fopen(path, "rb");

    fputs("<img src=\"data:image/png;base64,", out);
    if (in) {
        base64(out, in);
        fclose(in);
    }
    fputs("\" alt=\"", out);
    text(out, alternative);
    fputs("\">", out);
}

static void figure(FILE *out, const struct run *run, const char *name)
{
    fputs("<figure>", out);
    picture(out, run->picture, name);
    fprintf(out, "<figcaption>%s: %.3f s CPU, %.3f s wall</figcaption></figure>\n", name, run->cpu,
            run->wall);
}

void report_begin(FILE *out, unsigned width, unsigned height)
{
    fprintf(out, "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">"
            "<title>rtc and POV-Ray</title>\n<style>%s</style></head><body>\n"
            "<h1>rtc and POV-Ray</h1>\n<p>%u &times; %u pixels, one ray a pixel, one thread. "
            "Differences are 16 times amplified.</p>\n", style, width, height);
}

static void heading(FILE *out, const char *scene, const char *verdict, bool passed)
{
    fputs("<h2>", out);
    text(out, scene);
    fprintf(out, "</h2>\n<p class=\"%s\">", passed ? "good" : "bad");
    text(out, verdict);
    fputs("</p>\n", out);
}

void report_scene(FILE *out, const char *scene, const char *verdict, bool passed,
                  const struct run *ours, const struct run *theirs, const char *difference)
{
    heading(out, scene, verdict, passed);
    figure(out, ours, "rtc");
    figure(out, theirs, "POV-Ray");
    fputs("<figure>", out);
    picture(out, difference, "difference");
    fputs("<figcaption>difference</figcaption></figure>\n", out);
}

void report_failure(FILE *out, const char *scene, const char *verdict)
{
    heading(out, scene, verdict, false);
}

void report_end(FILE *out)
{
    fputs("</body></html>\n", out);
}
