/* picture.c: colours from an image (facts patterns.md 6.1, 6.2). */
#include "scene/picture.h"

#include <math.h>

static const double nudge = 1e-10;      /* POV-Ray's: a point on an edge belongs to the next pixel */

const colour picture_outside = { 1, 1, 1, 0, 1 };

/* Around the y axis from +x through +z, as a share of the whole turn. */
static double turn(double x, double z)
{
    double length = sqrt(x * x + z * z);

    if (length == 0)
        return 0;
    if (z == 0)
        return x > 0 ? 0 : 0.5;
    double theta = acos(x / length) / (2 * M_PI);
    return z < 0 ? 1 - theta : theta;
}

/* Where on the picture a point falls: 0..1 from the left and from the
 * bottom.  False: nowhere. */
static bool project(const struct image_use *use, vec3 p, double *u, double *v)
{
    double around = sqrt(p.x * p.x + p.z * p.z);
    bool beyond_v = p.y < 0 || p.y > 1;

    switch (use->map_type) {
    case MAP_SPHERICAL: {
        double r = vec_length(p);
        if (r == 0)
            return false;
        *u = turn(p.x, p.z);
        *v = 0.5 + asin(p.y / r) / M_PI;
        return true;
    }
    case MAP_CYLINDRICAL:
        if (around == 0 || (use->once && beyond_v))
            return false;
        *u = turn(p.x, p.z);
        *v = p.y - trunc(p.y);
        return true;
    case MAP_TOROIDAL: {
        double off = around - 1, l = sqrt(off * off + p.y * p.y);
        if (around == 0)
            return false;
        double phi = l > 0 ? acos(-off / l) / (2 * M_PI) : 0;
        *u = turn(p.x, p.z);
        *v = p.y > 0 ? 1 - phi : phi;
        return true;
    }
    default:
        if (use->once && (beyond_v || p.x < 0 || p.x > 1))
            return false;
        *u = p.x - trunc(p.x);
        *v = p.y - trunc(p.y);
        return true;
    }
}

static double wrap(double a, double size)
{
    if (!(fabs(a) < size))              /* fmod takes long */
        a = fmod(a, size);
    return a < 0 ? a + size : a;
}

static int neighbour(int i, int size, bool once)
{
    if (i >= 0 && i < size)
        return i;
    if (once)
        return i < 0 ? 0 : i >= size ? size - 1 : i;
    i %= size;
    return i < 0 ? i + size : i;
}

static colour pixel(const struct image_use *use, int x, int y)
{
    const struct image *m = use->image;
    colour c = image_pixel(m, (size_t)neighbour(y, (int)m->height, use->once) * m->width
                              + (size_t)neighbour(x, (int)m->width, use->once));

    c.f += (float)use->filter_all;
    c.t += (float)use->transmit_all;
    return c;
}

/* Weights of the pixels i-2 .. i+1 (cubic) or i-1, i (linear) at fraction t. */
static int weights(int interpolate, double t, double w[4])
{
    double s = 1 - t;

    if (interpolate == INTERPOLATE_BICUBIC) {
        w[0] = -t * s * s / 2;
        w[1] = s * (s * (3 * t + 1) + 1) / 2;
        w[2] = t * (t * (3 * s + 1) + 1) / 2;
        w[3] = -s * t * t / 2;
        return 4;
    }
    w[0] = s;
    w[1] = t;
    return 2;
}

struct sums { double r, g, b, f, t, weight; };

static void add(struct sums *s, colour c, double w)
{
    s->r += w * c.r;
    s->g += w * c.g;
    s->b += w * c.b;
    s->f += w * c.f;
    s->t += w * c.t;
    s->weight += w;
}

static colour between(const struct image_use *use, double x, double y)
{
    int i = (int)(x += 0.5), j = (int)(y += 0.5);
    double p = x - i, q = y - j, wx[4], wy[4];
    int n = weights(use->interpolate, p, wx);
    struct sums sum = { 0 };

    weights(use->interpolate, q, wy);
    for (int b = 0; b < n; b++)
        for (int a = 0; a < n; a++) {
            double w = wx[a] * wy[b];
            if (use->interpolate == INTERPOLATE_DISTANCE) {
                double dx = a ? 1 - p : p, dy = b ? 1 - q : q;
                w = 1 / fmax(dx * dx + dy * dy, 1e-300);
            }
            add(&sum, pixel(use, i - n / 2 + a, j - n / 2 + b), w);
        }
    double k = use->interpolate == INTERPOLATE_DISTANCE ? 1 / sum.weight : 1;
    return (colour) { (float)(sum.r * k), (float)(sum.g * k), (float)(sum.b * k),
                      (float)(sum.f * k), (float)(sum.t * k) };
}

/* Pixels from the left and from the top; false: nowhere. */
static bool find(const struct image_use *use, vec3 p, struct picture_place *at)
{
    double width = use->image->width, height = use->image->height, u, v;

    if (!project(use, p, &u, &v))
        return false;
    double x = u * width + nudge, y = v * height + nudge;
    if (use->once && (x >= width || y >= height || x < 0 || y < 0))
        return false;
    *at = (struct picture_place) { wrap(x, width), wrap(-y, height) };
    return true;
}

bool picture_find(const struct image_use *use, vec3 p, struct picture_place *at)
{
    bool is_there = find(use, p, at);

    if (is_there)
        __builtin_prefetch(image_address(use->image, (size_t)at->y * use->image->width
                                                         + (size_t)at->x));
    return is_there;
}

colour picture_at(const struct image_use *use, const struct picture_place *at)
{
    if (use->interpolate != INTERPOLATE_NONE)
        return between(use, at->x, at->y);
    return pixel(use, (int)at->x, (int)at->y);
}

colour picture_colour(const struct image_use *use, vec3 p)
{
    struct picture_place at;

    return find(use, p, &at) ? picture_at(use, &at) : picture_outside;
}
