/* internal.c: surfaces, curves and noises as functions of space.
 *
 * Each is the formula of patterns.md 8.1; p[0], p[1] ... are what follows
 * x, y, z in a call. */
#include "math/internal.h"

#include <math.h>
#include <stddef.h>

#include "math/noise.h"
#include "math/vec.h"

#define F(name) \
    static double name(double x, double y, double z, const double *p, \
                       const struct internal_setting *s)

static const double sqrt2 = 1.41421356237309504880, sqrt3 = 1.73205080756887729353;

static double sq(double v) { return v * v; }
static double cube(double v) { return v * v * v; }
static double norm(double x, double y, double z) { return sqrt(x * x + y * y + z * z); }
static double least(double a, double b) { return b < a ? b : a; }
static double most(double a, double b) { return b > a ? b : a; }

/* The value of most surfaces: a strength, and limits of both sides. */
static double field(double strength, double g)
{
    return most(-10, least(10, strength * g));
}

/* Curves of the plane may be turned about an axis: p is switch, distance, angle. */
static void revolve(double *x, double *y, double z, const double *p)
{
    if (!(p[0] > 0))
        return;
    double d = sqrt(*x * *x + z * z) - p[1], angle = p[2] * M_PI / 180, h = *y;
    *x = d;
    if (angle == 0)
        return;
    *x = d * cos(angle) - h * sin(angle);
    *y = d * sin(angle) + h * cos(angle);
}

/* A superellipse's radius: exponent 1 is round, 0 square. */
static double super_radius(double u, double v, double exponent)
{
    if (exponent == 1)
        return sqrt(u * u + v * v);
    if (exponent == 0)
        return most(fabs(u), fabs(v));
    double e = 2 / exponent;
    return pow(pow(fabs(u), e) + pow(fabs(v), e), exponent / 2);
}

static double positive_turn(double angle)
{
    angle = fmod(angle, 2 * M_PI);
    return angle < 0 ? angle + 2 * M_PI : angle;
}

/* --- algebraic curves and surfaces ------------------------------------------ */

F(algbr_cyl1)
{
    (void)s;
    revolve(&x, &y, z, p + 2);
    return -least(p[1], most(-p[0] * (x * x * fabs(x) - x * x + y * y), -p[1]));
}

static double algebraic_cylinder(double g, const double *p)
{
    return least(p[1], most(-p[0] * g, -p[1]));
}

F(algbr_cyl2)
{
    (void)s;
    revolve(&x, &y, z, p + 2);
    return algebraic_cylinder(2 * sq(sq(x)) - 3 * x * x * y + y * y - 2 * cube(y) + sq(sq(y)), p);
}

F(algbr_cyl3)
{
    (void)s;
    revolve(&x, &y, z, p + 2);
    return algebraic_cylinder(sq(sq(x)) + sq(x * y) - 2 * x * x * y - x * y * y + y * y, p);
}

F(algbr_cyl4)
{
    (void)s;
    revolve(&x, &y, z, p + 2);
    return algebraic_cylinder(sq(sq(x)) + sq(sq(y)) + 2 * sq(x * y) + 3 * x * x * y - cube(y), p);
}

F(bicorn)
{
    double r = x * x + z * z, a = p[1];

    (void)s;
    return field(p[0], y * y * (a * a - r) - sq(r + 2 * a * y - a * a));
}

F(bifolia)
{
    (void)s;
    return field(p[0], -(sq(x * x + y * y + z * z) - p[1] * (x * x + z * z) * y));
}

F(blob)
{
    double r = y * y + z * z;
    double a = least(1, (sq(x + p[0] / 2) + r) * sq(p[2]));
    double b = least(1, (sq(x - p[0] / 2) + r) * sq(p[4]));

    (void)s;
    return -(p[1] * sq(1 - a) + p[3] * sq(1 - b));
}

F(blob2)
{
    double r = y * y + z * z;

    (void)s;
    return p[3] - p[2] * (exp(-(x * x + r) * p[1]) + exp(-(sq(x - p[0]) + r) * p[1]));
}

F(boy_surface)
{
    double k = 1 - z, m = x * x + y * y, w = z * z;
    double first = 64 * cube(k) * cube(z) - 48 * k * k * w * (3 * m + 2 * w);
    double second = 12 * k * z * (27 * m * m - 24 * w * m
                                  + 36 * sqrt2 * y * z * (y * y - 3 * x * x) + 4 * w * w);
    double third = (9 * m - 2 * w) * (-81 * m * m - 72 * w * m
                                      + 108 * sqrt2 * x * z * (x * x - 3 * y * y) + 4 * w * w);

    (void)s;
    return field(p[0], p[1] * (first + second + third));
}

F(comma)
{
    (void)s;
    if (x == 0 && z == 0)
        x = 1e-4;
    double angle = atan2(z, x), r = sqrt(sq(x + p[0] / 4) + z * z);
    double tail = least(z, cos(angle / 2) * p[0] / 2 - sqrt(sq(r - 3 * p[0] / 4) + y * y));
    double head = p[0] / 2 - norm(x - p[0] / 2, y, z);
    return -most(tail, head);
}

/* Three ellipsoids, each stretched along one axis. */
struct three { double a, b, c; };

static struct three ellipsoids(double x, double y, double z, double eccentricity, double sharpness)
{
    double e = eccentricity;

    return (struct three) { exp(-(e * x * x + e * y * y + z * z) * sharpness),
                            exp(-(e * x * x + y * y + e * z * z) * sharpness),
                            exp(-(x * x + e * y * y + e * z * z) * sharpness) };
}

F(cross_ellipsoids)
{
    struct three e = ellipsoids(x, y, z, p[0], p[1]);

    (void)s;
    return p[3] - p[2] * most(e.a, most(e.b, e.c));
}

F(flange_cover)
{
    struct three e = ellipsoids(x, y, z, p[0], p[1]);

    (void)s;
    return p[3] - p[2] * (e.a + e.b + e.c);
}

F(isect_ellipsoids)
{
    struct three e = ellipsoids(x, y, z, p[0], p[1]);

    (void)s;
    return p[3] - p[2] * least(e.a, least(e.b, e.c));
}

F(spikes)
{
    struct three e = ellipsoids(x, y, z, p[0], p[1]);

    (void)s;
    return -p[2] * (p[4] * exp(-(x * x + y * y + z * z) * p[3]) - e.a - e.b - e.c);
}

F(crossed_trough) { (void)s; return field(p[0], sq(x * z) - y); }
F(cubic_saddle) { (void)s; return field(p[0], -(cube(x) - cube(y) - z)); }

F(cushion)
{
    double x2 = x * x, y2 = y * y, z2 = z * z;

    (void)s;
    return field(p[0], z2 * x2 - z2 * z2 - 2 * z * x2 + 2 * z2 * z + x2 - z2 - sq(x2 - z)
                 - y2 * y2 - 2 * x2 * y2 - y2 * z2 + 2 * y2 * z + y2);
}

F(devils_curve)
{
    double x2 = x * x, y2 = y * y, z2 = z * z;

    (void)s;
    return field(p[0], -(x2 * x2 + 2 * x2 * z2 - 0.36 * x2 - y2 * y2 + 0.25 * y2 + z2 * z2));
}

F(devils_curve_2d)
{
    (void)s;
    revolve(&x, &y, z, p + 3);
    return field(p[0], -(x * x * (x * x - p[1] * p[1]) - y * y * (y * y - p[2] * p[2])));
}

F(dupin_cyclid)
{
    double R = p[1], r = p[2], X = p[3], Y = p[4], I = p[5], I2 = I * I, q = x * x + y * y + z * z;
    double a = r * r - Y * Y - sq(X + R), b = r * r - Y * Y - sq(X - R);
    double c = (r * r + R * R - Y * Y - X * X) * (2 * x * X + 2 * y * Y - I2) - 4 * Y * r * r * y;
    double d = (X * x + Y * y) * (Y * y + X * x - I2);

    (void)s;
    return field(p[0], -(a * b * q * q + 2 * I2 * c * q + 4 * I2 * I2 * d
                         + 4 * I2 * I2 * R * R * y * y + sq(I2 * I2)));
}

F(ellipsoid) { (void)s; return norm(p[0] * x, p[1] * y, p[2] * z); }

F(enneper)
{
    double w = fabs(z) < 0.2 ? 0.2 : z, d = y * y - x * x;
    double a = d / (2 * w) + 2 * z * z / 9, b = d / (4 * w);

    (void)s;
    return field(p[0], -(cube(a) - 6 * b * b));
}

F(folium_surface)
{
    (void)s;
    return field(p[0], (y * y + z * z) * (1 + (p[2] - 4 * p[1]) * x) + x * x * (1 + p[2]));
}

F(folium_surface_2d)
{
    (void)s;
    revolve(&x, &y, z, p + 3);
    return field(p[0], -(y * y * (1 + (p[2] - 4 * p[1]) * x) + x * x * (1 + p[2])));
}

F(glob)
{
    (void)s;
    return field(p[0], cube(x) * x * x / 2 + sq(x * x) / 2 - (y * y + z * z));
}

F(heart)
{
    double z3 = cube(z);

    (void)s;
    return field(p[0], -(cube(2 * x * x + y * y + z * z - 1) - 0.1 * x * x * z3 - y * y * z3));
}

F(hunt_surface)
{
    double q = x * x + y * y + z * z;

    (void)s;
    return field(p[0], -(4 * cube(q - 13) + 27 * sq(3 * x * x + y * y - 4 * z * z - 12)));
}

F(hyperbolic_torus)
{
    double A = p[1] * p[1] + p[2] * p[2], B = p[1] * p[1] - p[2] * p[2];
    double a = x * x, b = y * y, c = z * z;

    (void)s;
    return field(p[0], -(a * a + 2 * a * b - 2 * a * c - 2 * A * a + b * b - 2 * b * c + 2 * B * b
                         + c * c + 2 * A * c + B * B));
}

F(parabolic_torus)
{
    double A = p[1] * p[1] + p[2] * p[2], B = p[1] * p[1] - p[2] * p[2];
    double a = x * x, b = y * y;

    (void)s;
    return field(p[0], -(a * a + 2 * a * b - 2 * a * z - A * a + b * b - 2 * b * z + B * b + z * z
                         + A * z + B * B));
}

F(torus2)
{
    double A = p[1] * p[1] + p[2] * p[2], B = p[1] * p[1] - p[2] * p[2];
    double a = x * x, b = y * y, c = z * z;

    (void)s;
    return field(p[0], -(sq(a + b + c) - 2 * A * a + 2 * B * b - 2 * A * c + B * B));
}

F(kampyle_of_eudoxus)
{
    double c = p[2] * p[2];

    (void)s;
    return field(p[0], -(y * y + z * z - c * sq(x * x) + c * p[1] * p[1] * x * x));
}

F(kampyle_of_eudoxus_2d)
{
    double c = p[2] * p[2];

    (void)s;
    revolve(&x, &y, z, p + 3);
    return field(p[0], -(y * y - c * sq(x * x) + c * p[2] * p[1] * x * x));
}

F(klein_bottle)
{
    double q = x * x + y * y + z * z, a = q + 2 * y - 1, b = q - 2 * y - 1;

    (void)s;
    return field(p[0], -(a * (b * b - 8 * z * z) + 16 * x * z * b));
}

F(kummer_surface_v1)
{
    double a = x * x, b = y * y, c = z * z;

    (void)s;
    return field(p[0], -(a * a + b * b + c * c - (a + b + c) - a * b - a * c - b * c + 1));
}

F(kummer_surface_v2)
{
    double a = x * x, b = y * y, c = z * z;

    (void)s;
    return field(p[0], -(a * a + b * b + c * c + p[1] * (a + b + c)
                         + p[2] * (a * b + a * c + b * c) + p[3] * x * y * z - 1));
}

F(lemniscate_of_gerono)
{
    (void)s;
    return field(p[0], -(sq(x * x) - x * x + y * y + z * z));
}

F(lemniscate_of_gerono_2d)
{
    double c = p[2] * p[2];

    (void)s;
    revolve(&x, &y, z, p + 3);
    return field(p[0], -(y * y - c * p[1] * p[1] * x * x + c * sq(x * x)));
}

F(mitre)
{
    double r = y * y + z * z;

    (void)s;
    return field(p[0], -(4 * x * x * (x * x + r) - y * y * (1 - r)));
}

F(nodal_cubic) { (void)s, (void)x; return field(p[0], -(cube(y) + cube(z) - 6 * y * z)); }

F(ovals_of_cassini)
{
    double a = p[1] * p[1], q = x * x + y * y + z * z;

    (void)s;
    return field(p[0], -(sq(q + a) - p[3] * a * (x * x + z * z) - p[2] * p[2]));
}

F(paraboloid) { (void)s; return field(p[0], -(x * x - y + z * z)); }

F(pillow)
{
    double a = x * x, b = y * y, c = z * z;

    (void)s;
    return field(p[0], a * a + b * b + c * c - (a + b + c));
}

F(piriform)
{
    (void)s;
    return -field(p[0], -(sq(x * x) - cube(x) + y * y + z * z));
}

F(piriform_2d)
{
    double c = p[3] * p[3];

    (void)s;
    revolve(&x, &y, z, p + 4);
    return field(p[0], -(y * y - p[1] * c * cube(x) - p[2] * c * sq(x * x)));
}

static double polynomial(const double *c, double t)
{
    return c[0] + t * (c[1] + t * (c[2] + t * (c[3] + t * c[4])));
}

F(poly4) { (void)s; return sqrt(x * x + z * z) - most(-5, polynomial(p, y)); }

F(polytubes)
{
    double r = polynomial(p + 1, y), nearest = 10000;

    (void)s;
    for (int i = 0; i < p[0] && i < 1000000; i++) {
        double angle = 2 * M_PI * i / p[0];
        nearest = least(nearest, norm(x - r * sin(angle), z - r * cos(angle), 0));
    }
    return nearest;
}

F(quantum)
{
    (void)p, (void)s;
    double rho = sqrt(x * x + z * z);
    if (rho == 0)
        rho = 1e-6;
    double c = cos(atan2(rho, y)), r = 2 * norm(x, y, z);
    double t = r * r * exp(-0.33333333 * r) * (3 * c * c - 1);
    return -0.1 * (t * t - 12);
}

F(quartic_paraboloid) { (void)s; return field(p[0], -(sq(x * x) + sq(z * z) - y)); }
F(quartic_saddle) { (void)s; return field(p[0], -(sq(x * x) - sq(z * z) - y)); }

F(quartic_cylinder)
{
    double r = x * x + z * z, c = p[2] * p[2];

    (void)s;
    return field(p[0], -(r * y * y + c * r - c * p[1] * p[1]));
}

F(steiners_roman)
{
    (void)s;
    return field(p[0], -(sq(x * y) + sq(x * z) + sq(y * z) + x * y * z));
}

F(strophoid)
{
    double c = p[3] * p[3];

    (void)s;
    return field(p[0], -((p[2] - x) * (y * y + z * z) - c * p[1] * x * x - c * cube(x)));
}

F(strophoid_2d)
{
    double c = p[3] * p[3];

    (void)s;
    revolve(&x, &y, z, p + 4);
    return field(p[0], -((p[2] - x) * y * y - c * p[1] * x * x - c * cube(x)));
}

F(torus_gumdrop)
{
    double r = y * y + z * z, q = x * x + r;

    (void)s;
    return field(p[0], -(4 * (sq(x * x) + r * r) + 17 * x * x * r - 20 * q + 17));
}

F(umbrella) { (void)s; return field(p[0], -(x * x - y * z * z)); }

F(witch_of_agnesi)
{
    (void)s;
    return field(p[0], -(p[1] * (y - 1) + (x * x + z * z) * y));
}

F(witch_of_agnesi_2d)
{
    (void)s;
    revolve(&x, &y, z, p + 3);
    return field(p[0], -(p[1] * p[1] * y + x * x * y - p[2]));
}

/* --- distances and shapes ----------------------------------------------------- */

F(helical_torus)
{
    double off = sqrt(x * x + z * z) - p[0], around = atan2(x == 0 && z == 0 ? 1e-6 : x, z);
    double r = sqrt(off * off + y * y);
    double twist = positive_turn(around * p[1] + atan2(off, y) * p[2]);
    double u = twist - M_PI, w = r - p[5];
    double t = cos(atan2(u * p[8], w) * p[7] + around * p[9]) * p[3] + p[4];
    double inner = p[4] + p[5] - p[0] - (off + p[0]);

    (void)s;
    t -= least(sqrt(w * w + u * u * p[6]), r + p[5]);
    return -most(inner, t);
}

/* p: strands, turns, small radius, large radius, roundness, exponent, rotation. */
F(helix1)
{
    (void)s;
    double r = sqrt(x * x + z * z);
    if (r == 0)
        x = 1e-6;
    double angle = positive_turn(p[0] * atan2(z, x) + p[0] * p[1] * y);
    double v = (angle - M_PI) / (p[4] * p[1] * p[0]), u = r - p[3];
    if (p[5] != 1 && p[6] != 0) {
        double c = cos(p[6] * M_PI / 180), d = sin(p[6] * M_PI / 180), t = u;
        u = u * c - v * d;
        v = t * d + v * c;
    }
    return -p[2] + least(p[3] + r, super_radius(u, v, p[5]));
}

F(helix2)
{
    double c = cos(p[1] * y), d = sin(p[1] * y);

    (void)s;
    x -= p[3] * c;
    z -= p[3] * d;
    return super_radius(x * c + z * d, -x * d + z * c, p[5]) - p[2];
}

/* Where a point lies in its cell of a grid of hexagons: a, b from the centre. */
static double hexagon(double x, double y, double *a, double *b)
{
    double h = sqrt3 / 2;
    double a1 = fabs(fmod(fabs(x), sqrt3) - h), b1 = fabs(fmod(fabs(y), 3) - 1.5);
    double a2 = h - a1, b2 = 1.5 - b1;
    bool first = sq(a1) + sq(b1) < sq(a2) + sq(b2);

    *a = first ? a1 : a2;
    *b = first ? b1 : b2;
    return atan2(*b, *a);
}

F(hex_x)
{
    double a, b, angle = hexagon(x, y, &a, &b);

    (void)z, (void)p, (void)s;
    return angle < M_PI / 6 ? a : a / 2 + sqrt3 / 2 * b;
}

F(hex_y)
{
    double a, b, angle = hexagon(x, y, &a, &b);

    (void)z, (void)p, (void)s;
    return angle < M_PI / 6 ? b : fabs(-sqrt3 / 2 * a + b / 2);
}

/* Distance from the middle of a thread's period. */
static double thread(double v, double width, double thickness)
{
    double m = v - 2 * width * floor(v / (2 * width));

    return fabs(m - width) * thickness;
}

F(mesh1)
{
    double rise_x = p[3] * cos(M_PI * z / p[1]), rise_z = p[3] * cos(M_PI * x / p[0]);
    double a = norm((y - rise_x) * p[4], thread(x, p[0], p[2]), 0);
    double b = norm((y + rise_x) * p[4], thread(x - p[0], p[0], p[2]), 0);
    double c = norm((y + rise_z) * p[4], thread(z, p[1], p[2]), 0);
    double d = norm((y - rise_z) * p[4], thread(z - p[1], p[1], p[2]), 0);

    (void)s;
    return least(least(a, b), least(c, d));
}

F(ph) { (void)p, (void)s; return atan2(sqrt(x * x + z * z), y); }
F(th) { (void)y, (void)p, (void)s; return atan2(x, z); }
F(r) { (void)p, (void)s; return norm(x, y, z); }

F(rounded_box)
{
    double a = most(0, fabs(x) - (p[1] - p[0])), b = most(0, fabs(y) - (p[2] - p[0]));
    double c = most(0, fabs(z) - (p[3] - p[0]));

    (void)s;
    return norm(a, b, c) - p[0] - 1e-6;
}

F(sphere) { (void)s; return norm(x, y, z) - p[0]; }

F(spikes_2d)
{
    (void)s;
    return y - p[0] * cos(p[1] * x) * cos(p[2] * z) * exp(-p[3] * (x * x + z * z));
}

F(spiral)
{
    (void)s;
    if (x == 0 && z == 0)
        x = 1e-6;
    double q = norm(x, y, z), r = sqrt(x * x + z * z) + p[0] * atan2(z, x) / (2 * M_PI);
    double w = super_radius(fmod(r, p[0]) - p[0] / 2, y, p[5]);
    return -least(p[2] - q, p[1] - least(w, q));
}

F(superellipsoid)
{
    double a = pow(pow(fabs(x), 2 / p[0]) + pow(fabs(y), 2 / p[0]), p[0] / p[1]);

    (void)s;
    return 1 - pow(a + pow(fabs(z), 2 / p[1]), p[1] / 2);
}

F(torus) { (void)s; return norm(sqrt(x * x + z * z) - p[0], y, 0) - p[1]; }

/* --- noise -------------------------------------------------------------------- */

/* 0 is the original generator here, as bits of a number are taken (8.1). */
static int generator(double number)
{
    int g = number > -2147483649.0 && number < 2147483648.0 ? (int)number & 3 : 0;

    return g == 0 ? 1 : g;
}

F(noise3d) { (void)p; return noise_at(s->noise_generator, vec(x, y, z)); }
F(noise_generator) { (void)s; return noise_at(generator(p[0]), vec(x, y, z)); }

/* p: H, lacunarity, octaves, offset, heterogeneity, generator. */
F(hetero_mf)
{
    int g = generator(p[5]), i = 1;
    double sum = 2 * noise_at(g, vec(x, y, z)) - 1 + p[3], part = p[2] - floor(p[2]);
    vec3 v = vec_scale(vec(x, y, z), p[1]);

    (void)s;
    for (; i < p[2] && i < INTERNAL_MOST_OCTAVES; i++) {
        double more = (2 * noise_at(g, v) - 1 + p[3]) * pow(p[1], -p[0] * i);
        sum += more * pow(sum, trunc(p[4]));
        v = vec_scale(v, p[1]);
    }
    if (part > 0)
        sum += part * (2 * noise_at(g, v) - 1 + p[3]) * pow(p[1], -p[0] * i) * sum;
    return sum;
}

/* p: lambda, octaves, omega, offset, ridge, generator. */
F(ridge)
{
    int g = generator(p[5]), n = (int)p[1];
    double top = most(p[4], 1 - p[4]), sum = 0, total = 0, weight = 1, scale = 1;

    (void)s;
    for (int i = 1; i <= n + 1 && i <= INTERNAL_MOST_OCTAVES; i++) {
        double share = i <= n || n < 1 ? 1 : p[1] - n;
        double u = fabs(noise_at(g, vec_scale(vec(x, y, z), scale)) - p[4]) / top - p[3];
        sum += share * weight * u;
        total += share * weight;
        if (n < 1)
            break;
        weight *= p[2];
        scale *= p[0];
    }
    return sum / (total * most(p[3], 1 - p[3]));
}

/* p: H, lacunarity, octaves, offset, gain, generator. */
F(ridged_mf)
{
    struct octave_weights own = { .known = false };
    struct octave_weights *w = s->weights ? s->weights : &own;
    vec3 v = vec(x, y, z);
    int g = generator(p[5]);

    if (!w->known)
        for (int i = 0; i < INTERNAL_MOST_OCTAVES; i++)
            w->weight[i] = pow(p[1], -p[0] * i);
    w->known = true;
    double signal = sq(p[3] - fabs(2 * noise_at(g, v) - 1)), sum = signal;
    for (int i = 1; i < p[2] && i < INTERNAL_MOST_OCTAVES; i++) {
        v = vec_scale(v, p[1]);
        double part = most(0, least(1, signal * p[4]));
        signal = part * sq(p[3] - fabs(2 * noise_at(g, v) - 1));
        sum += signal * w->weight[i];
    }
    return sum;
}

/* --- the table ------------------------------------------------------------------ */

#define ROW(number, name, parameters) [number] = { "f_" #name, parameters, name }

static const struct internal rows[] = {
    ROW(0, algbr_cyl1, 8), ROW(1, algbr_cyl2, 8), ROW(2, algbr_cyl3, 8), ROW(3, algbr_cyl4, 8),
    ROW(4, bicorn, 5), ROW(5, bifolia, 5), ROW(6, blob, 8), ROW(7, blob2, 7),
    ROW(8, boy_surface, 5), ROW(9, comma, 4), ROW(10, cross_ellipsoids, 7),
    ROW(11, crossed_trough, 4), ROW(12, cubic_saddle, 4), ROW(13, cushion, 4),
    ROW(14, devils_curve, 4), ROW(15, devils_curve_2d, 9), ROW(16, dupin_cyclid, 9),
    ROW(17, ellipsoid, 6), ROW(18, enneper, 4), ROW(19, flange_cover, 7),
    ROW(20, folium_surface, 6), ROW(21, folium_surface_2d, 9), ROW(22, glob, 4),
    ROW(23, heart, 4), ROW(24, helical_torus, 13), ROW(25, helix1, 10), ROW(26, helix2, 10),
    ROW(27, hex_x, 4), ROW(28, hex_y, 4), ROW(29, hetero_mf, 9), ROW(30, hunt_surface, 4),
    ROW(31, hyperbolic_torus, 6), ROW(32, isect_ellipsoids, 7), ROW(33, kampyle_of_eudoxus, 6),
    ROW(34, kampyle_of_eudoxus_2d, 9), ROW(35, klein_bottle, 4), ROW(36, kummer_surface_v1, 4),
    ROW(37, kummer_surface_v2, 7), ROW(38, lemniscate_of_gerono, 4),
    ROW(39, lemniscate_of_gerono_2d, 9), ROW(40, mesh1, 8), ROW(41, mitre, 4),
    ROW(42, nodal_cubic, 4), [43] = { "f_odd", 4, cushion }, ROW(44, ovals_of_cassini, 7),
    ROW(45, paraboloid, 4), ROW(46, parabolic_torus, 6), ROW(47, ph, 3), ROW(48, pillow, 4),
    ROW(49, piriform, 4), ROW(50, piriform_2d, 10), ROW(51, poly4, 8), ROW(52, polytubes, 9),
    ROW(53, quantum, 4), ROW(54, quartic_paraboloid, 4), ROW(55, quartic_saddle, 4),
    ROW(56, quartic_cylinder, 6), ROW(57, r, 3), ROW(58, ridge, 9), ROW(59, ridged_mf, 9),
    ROW(60, rounded_box, 7), ROW(61, sphere, 4), ROW(62, spikes, 8), ROW(63, spikes_2d, 7),
    ROW(64, spiral, 9), ROW(65, steiners_roman, 4), ROW(66, strophoid, 7),
    ROW(67, strophoid_2d, 10), ROW(68, superellipsoid, 5), ROW(69, th, 3), ROW(70, torus, 5),
    ROW(71, torus2, 6), ROW(72, torus_gumdrop, 4), ROW(73, umbrella, 4),
    ROW(74, witch_of_agnesi, 5), ROW(75, witch_of_agnesi_2d, 9), ROW(76, noise3d, 3),
    ROW(78, noise_generator, 4),
};

const struct internal *internal_find(double number)
{
    if (!(number >= 0 && number < (double)(sizeof rows / sizeof *rows)))
        return NULL;
    const struct internal *row = &rows[(int)number];
    return row->name ? row : NULL;
}
