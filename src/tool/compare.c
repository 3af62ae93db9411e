/* compare.c: how far two pictures are apart. */
#include "tool/compare.h"

#include <math.h>

#include "image/image.h"

enum { WINDOW = 8 };                    /* pixels a side, of SSIM */

/* Red, green and blue of any picture. */
static unsigned channel_of(const struct bitmap *b, unsigned channel)
{
    if (channel == 3)
        return b->channels - 1;
    return b->channels < 3 ? 0 : channel;
}

static double level(const struct bitmap *b, unsigned x, unsigned y, unsigned channel)
{
    return 255.0 * bitmap_sample(b, x, y, channel_of(b, channel));
}

static bool has_alpha(const struct bitmap *b)
{
    return b->channels % 2 == 0;
}

static double grey(const struct bitmap *b, unsigned x, unsigned y)
{
    return 0.299 * level(b, x, y, 0) + 0.587 * level(b, x, y, 1) + 0.114 * level(b, x, y, 2);
}

static void compare_levels(const struct bitmap *a, const struct bitmap *b, double threshold,
                           struct comparison *c)
{
    unsigned channels = has_alpha(a) && has_alpha(b) ? 4 : 3;
    double squares = 0, n_differ = 0, n = (double)c->width * c->height;

    for (unsigned y = 0; y < c->height; y++)
        for (unsigned x = 0; x < c->width; x++) {
            double most = 0;
            for (unsigned i = 0; i < channels; i++) {
                double d = fabs(level(a, x, y, i) - level(b, x, y, i));
                squares += d * d;
                most = fmax(most, d);
            }
            n_differ += most > threshold + 1e-4;    /* 16-bit values are not exact in float */
            if (most > c->largest)
                c->largest = most, c->largest_x = x, c->largest_y = y;
        }
    c->differ = 100 * n_differ / n;
    c->rmse = sqrt(squares / (n * channels));
    c->psnr = c->rmse > 0 ? 20 * log10(255 / c->rmse) : INFINITY;
}

/* Sums over all pixels above and left, so that any window costs four reads. */
struct sums { double a, b, aa, bb, ab; };

static struct sums sums_add(struct sums s, struct sums t, double sign)
{
    return (struct sums) { s.a + sign * t.a, s.b + sign * t.b, s.aa + sign * t.aa,
                           s.bb + sign * t.bb, s.ab + sign * t.ab };
}

static struct sums *sum_up(struct arena *mem, const struct bitmap *a, const struct bitmap *b)
{
    size_t row = a->width + (size_t)1;
    struct sums *table = arena_array(mem, row * (a->height + (size_t)1), sizeof *table);

    for (unsigned y = 0; y < a->height; y++) {
        struct sums line = { 0 };
        for (unsigned x = 0; x < a->width; x++) {
            double p = grey(a, x, y), q = grey(b, x, y);
            line = sums_add(line, (struct sums) { p, q, p * p, q * q, p * q }, 1);
            table[(y + 1) * row + x + 1] = sums_add(table[y * row + x + 1], line, 1);
        }
    }
    return table;
}

/* Wang, Bovik, Sheikh and Simoncelli (2004), with square windows. */
static double window_ssim(struct sums s, double n)
{
    const double c1 = 0.01 * 255 * 0.01 * 255, c2 = 0.03 * 255 * 0.03 * 255;
    double a = s.a / n, b = s.b / n;
    double va = s.aa / n - a * a, vb = s.bb / n - b * b, cov = s.ab / n - a * b;

    return (2 * a * b + c1) * (2 * cov + c2) / ((a * a + b * b + c1) * (va + vb + c2));
}

static double compare_ssim(struct arena *mem, const struct bitmap *a, const struct bitmap *b)
{
    unsigned w = a->width < WINDOW ? a->width : WINDOW, h = a->height < WINDOW ? a->height : WINDOW;
    const struct sums *table = sum_up(mem, a, b);
    size_t row = a->width + (size_t)1;
    double total = 0, n = 0;

    for (unsigned y = h; y <= a->height; y++)
        for (unsigned x = w; x <= a->width; x++, n++) {
            struct sums s = sums_add(table[y * row + x], table[(y - h) * row + x], -1);
            s = sums_add(s, table[y * row + x - w], -1);
            s = sums_add(s, table[(y - h) * row + x - w], 1);
            total += window_ssim(s, (double)w * h);
        }
    return total / n;
}

void compare(struct arena *mem, const struct bitmap *a, const struct bitmap *b, double threshold,
             struct comparison *out)
{
    *out = (struct comparison) { .width = a->width, .height = a->height };
    compare_levels(a, b, threshold, out);
    out->ssim = out->largest > 0 ? compare_ssim(mem, a, b) : 1;
}

/* ---- noise ---- */

static double mean_of(const struct bitmap *b)
{
    double sum = 0;

    for (unsigned y = 0; y < b->height; y++)
        for (unsigned x = 0; x < b->width; x++)
            sum += grey(b, x, y);
    return sum / ((double)b->width * b->height);
}

static double spread_of(const struct bitmap *b)
{
    double squares = 0;

    for (unsigned y = 0; y < b->height; y++)
        for (unsigned x = 1; x < b->width; x++) {
            double d = grey(b, x, y) - grey(b, x - 1, y);
            squares += d * d;
        }
    return b->width > 1 ? sqrt(squares / ((b->width - 1.0) * b->height)) : 0;
}

void compare_noise(const struct bitmap *a, const struct bitmap *b, struct likeness *out)
{
    *out = (struct likeness) { { mean_of(a), mean_of(b) }, { spread_of(a), spread_of(b) } };
}

static double apart(const double v[2])
{
    return v[0] == v[1] ? 0 : 100 * fabs(v[0] - v[1]) / fmax(v[0], v[1]);
}

double likeness_apart(const struct likeness *l) { return fmax(apart(l->mean), apart(l->spread)); }

const char *likeness_text(struct arena *mem, const struct likeness *l)
{
    return arena_format(mem, "mean %.2f and %.2f, %.2g%% apart; spread %.3f and %.3f, %.2g%% apart", l->mean[0],
                        l->mean[1], apart(l->mean), l->spread[0], l->spread[1], apart(l->spread));
}

bool compare_write_difference(struct arena *mem, const struct bitmap *a, const struct bitmap *b,
                              double amplify, const char *path, const char **error)
{
    struct png_writer *w = png_open(path, a->width, a->height, 8, false,
                                    (struct tone) { .working = TONE_RAW }, error);
    float *row = arena_array(mem, a->width, 4 * sizeof *row);
    bool done = w != NULL;

    for (unsigned y = 0; done && y < a->height; y++) {
        for (unsigned x = 0; x < a->width; x++)
            for (unsigned i = 0; i < 3; i++)
                row[4 * x + i] = (float)(fabs(level(a, x, y, i) - level(b, x, y, i)) * amplify / 255);
        done = png_rows(w, 1, row, error);
    }
    if (!done && w)
        png_close(w, false, &(const char *) { NULL });
    return done && png_close(w, true, error);
}

const char *compare_text(struct arena *mem, const struct comparison *c)
{
    if (c->largest == 0)
        return "equal";
    return arena_format(mem, "%.4g%% differ, RMSE %.3g, PSNR %.4g dB, SSIM %.5f, largest %.3g at %u,%u",
                        c->differ, c->rmse, c->psnr, c->ssim, c->largest, c->largest_x,
                        c->largest_y);
}
