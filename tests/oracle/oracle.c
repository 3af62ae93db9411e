/* oracle.c: the primitives in 113 bits. */
#include "oracle/oracle.h"

quad quad_sqrt(quad a)
{
    if (!(a > 0))
        return 0;
    int e = 0;
    while (a > 0x1p100Q) { a *= 0x1p-100Q; e += 50; }
    while (a < 0x1p-100Q) { a *= 0x1p100Q; e -= 50; }
    quad x = sqrt((double)a);
    for (int i = 0; i < 3; i++)
        x = (x + a / x) / 2;
    for (; e > 0; e -= 50) x *= 0x1p50Q;
    for (; e < 0; e += 50) x *= 0x1p-50Q;
    return x;
}

static quad at(int degree, const quad c[], quad x)
{
    quad y = c[degree];

    for (int i = degree - 1; i >= 0; i--)
        y = y * x + c[i];
    return y;
}

static quad bisect(int degree, const quad c[], quad a, quad b, bool rising)
{
    for (int i = 0; i < 400; i++) {
        quad x = a + (b - a) / 2;
        if (x <= a || x >= b)
            break;
        if ((at(degree, c, x) > 0) == rising)
            b = x;
        else
            a = x;
    }
    return a;
}

int oracle_roots(int degree, const quad c[], quad root[])
{
    quad slope[8], turn[8], reach = 1;
    int n = 0;

    while (degree > 0 && c[degree] == 0)
        degree--;
    if (degree <= 0)
        return 0;
    for (int i = 0; i < degree; i++)
        if (1 + quad_abs(c[i] / c[degree]) > reach)
            reach = 1 + quad_abs(c[i] / c[degree]);
    for (int i = 1; i <= degree; i++)
        slope[i - 1] = i * c[i];
    int n_turn = degree > 1 ? oracle_roots(degree - 1, slope, turn) : 0;
    turn[n_turn++] = reach;

    quad from = -reach, before = at(degree, c, -reach);
    for (int i = 0; i < n_turn; i++) {
        quad after = at(degree, c, turn[i]);
        if ((before < 0 && after > 0) || (before > 0 && after < 0))
            root[n++] = bisect(degree, c, from, turn[i], after > 0);
        if (after != 0) {
            before = after;
            from = turn[i];
        }
    }
    return n;
}

int oracle_sphere(vec3 centre, double r, struct ray ray, quad t[2])
{
    quad3 f = quad_sub(quad_of(ray.origin), quad_of(centre)), d = quad_of(ray.dir);
    quad a = quad_dot(d, d), mid = -quad_dot(f, d) / a;
    quad3 p = quad_along(f, mid, d);
    quad left = (quad)r * r - quad_dot(p, p);

    if (!(left > 0))
        return 0;
    quad half = quad_sqrt(left / a);
    t[0] = mid - half;
    t[1] = mid + half;
    return 2;
}

int oracle_torus(double major, double minor, struct ray ray, quad t[4])
{
    quad3 f = quad_of(ray.origin), d = quad_of(ray.dir);
    quad a = quad_dot(d, d), length = quad_sqrt(a), mid = -quad_dot(f, d) / a;
    quad3 p = quad_along(f, mid, d);
    quad scale = (quad)major + minor;
    quad3 e = { d.x / length, d.y / length, d.z / length };
    p = (quad3) { p.x / scale, p.y / scale, p.z / scale };
    quad rr = major / scale, r = minor / scale;
    rr *= rr;
    quad k = quad_dot(p, p) + rr - r * r, b = quad_dot(p, e);
    quad c[5] = { k * k - 4 * rr * (p.x * p.x + p.z * p.z),
                  4 * b * k - 8 * rr * (p.x * e.x + p.z * e.z),
                  4 * b * b + 2 * k - 4 * rr * (e.x * e.x + e.z * e.z), 4 * b, 1 };
    int n = oracle_roots(4, c, t);
    for (int i = 0; i < n; i++)
        t[i] = mid + t[i] * scale / length;
    return n;
}

/* Between all crossings of the wall's double cone and of the two planes, a
 * piece is inside or outside as its middle is; the frustum is convex. */
int oracle_cone(double base_radius, double cap_radius, double height, struct ray ray, quad t[2])
{
    quad3 o = quad_of(ray.origin), d = quad_of(ray.dir);
    quad mid = -quad_dot(o, d) / quad_dot(d, d);
    o = quad_along(o, mid, d);
    quad slope = ((quad)cap_radius - base_radius) / height;
    quad rho = base_radius + slope * o.y, grow = slope * d.y, cut[6];
    quad c[3] = { o.x * o.x + o.z * o.z - rho * rho, 2 * (o.x * d.x + o.z * d.z - rho * grow),
                  d.x * d.x + d.z * d.z - grow * grow };
    quad left = c[1] * c[1] - 4 * c[2] * c[0];
    int n = 0, pieces = 0;

    if (left >= 0) {
        quad root = quad_sqrt(left), q = -(c[1] + (c[1] < 0 ? -root : root)) / 2;
        if (c[2] != 0)
            cut[n++] = q / c[2];
        if (q != 0)
            cut[n++] = c[0] / q;
    }
    if (d.y != 0) {
        cut[n++] = -o.y / d.y;
        cut[n++] = (height - o.y) / d.y;
    }
    for (int i = 0; i < n; i++)
        for (int j = i + 1; j < n; j++)
            if (cut[j] < cut[i]) {
                quad swap = cut[i];
                cut[i] = cut[j];
                cut[j] = swap;
            }
    for (int i = 0; i + 1 < n; i++) {
        quad3 p = quad_along(o, (cut[i] + cut[i + 1]) / 2, d);
        quad r = base_radius + slope * p.y;
        if (!(p.y > 0 && p.y < height && p.x * p.x + p.z * p.z < r * r))
            continue;
        if (pieces++ == 0)
            t[0] = mid + cut[i];
        t[1] = mid + cut[i + 1];
    }
    return pieces ? 2 : 0;
}

double oracle_sphere_distance(vec3 centre, double r, vec3 p)
{
    quad3 f = quad_sub(quad_of(p), quad_of(centre));
    return (double)quad_abs(quad_sqrt(quad_dot(f, f)) - quad_abs(r));
}

double oracle_torus_distance(double major, double minor, vec3 p)
{
    quad3 q = quad_of(p);
    quad rho = quad_sqrt(q.x * q.x + q.z * q.z);
    quad near = quad_sqrt((rho - major) * (rho - major) + q.y * q.y) - minor;
    quad far = quad_sqrt((rho + major) * (rho + major) + q.y * q.y) - minor;

    near = quad_abs(near);
    far = quad_abs(far);
    return (double)(major < minor && far < near ? far : near);
}

double oracle_box_distance(vec3 low, vec3 high, vec3 p)
{
    double out = 0, in = INFINITY;

    for (int i = 0; i < 3; i++) {
        quad a = (quad)vec_get(low, i) - vec_get(p, i), b = (quad)vec_get(p, i) - vec_get(high, i);
        double beyond = (double)(a > b ? a : b);
        out = fmax(out, beyond);
        in = fmin(in, -beyond);
    }
    return out > 0 ? out : in;
}

/* In the half plane of height and radius: distance from a to b. */
static quad segment_distance(quad px, quad py, quad ax, quad ay, quad bx, quad by)
{
    quad ex = bx - ax, ey = by - ay, qx = px - ax, qy = py - ay, ee = ex * ex + ey * ey;
    quad s = ee > 0 ? (qx * ex + qy * ey) / ee : 0;

    s = s < 0 ? 0 : s > 1 ? 1 : s;
    qx -= s * ex;
    qy -= s * ey;
    return quad_sqrt(qx * qx + qy * qy);
}

double oracle_cone_distance(vec3 base, double base_radius, vec3 cap, double cap_radius,
                            bool is_open, vec3 p)
{
    quad3 q = quad_sub(quad_of(p), quad_of(base)), axis = quad_sub(quad_of(cap), quad_of(base));
    quad height = quad_sqrt(quad_dot(axis, axis)), y = quad_dot(q, axis) / height;
    quad3 off = quad_along(q, -y / height, axis);
    quad r = quad_sqrt(quad_dot(off, off));
    quad best = segment_distance(y, r, 0, base_radius, height, cap_radius);

    for (int i = 0; i < 2 && !is_open; i++) {
        quad h = i ? height : 0;
        quad d = segment_distance(y, r, h, 0, h, i ? cap_radius : base_radius);
        if (d < best)
            best = d;
    }
    return (double)best;
}

double oracle_plane_distance(vec3 normal, double distance, vec3 p)
{
    quad3 n = quad_of(normal);
    quad length = quad_sqrt(quad_dot(n, n));
    return (double)quad_abs(quad_dot(n, quad_of(p)) / length - distance);
}

double oracle_disc_distance(vec3 centre, vec3 normal, double r, double hole, vec3 p)
{
    quad3 n = quad_of(normal), q = quad_sub(quad_of(p), quad_of(centre));
    quad length = quad_sqrt(quad_dot(n, n)), y = quad_dot(n, q) / length;
    quad3 off = quad_along(q, -y / length, n);
    quad rho = quad_sqrt(quad_dot(off, off));

    return (double)segment_distance(y, rho, 0, hole, 0, r);
}

static quad3 quad_cross(quad3 a, quad3 b)
{
    return (quad3) { a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x };
}

/* From the plane where the foot is inside, else from the nearest edge. */
double oracle_triangle_distance(vec3 a, vec3 b, vec3 c, vec3 p)
{
    quad3 v[3] = { quad_of(a), quad_of(b), quad_of(c) }, q = quad_of(p);
    quad3 n = quad_cross(quad_sub(v[1], v[0]), quad_sub(v[2], v[0]));
    bool in = true;
    quad best = -1;

    for (int i = 0; i < 3; i++) {
        quad3 e = quad_sub(v[(i + 1) % 3], v[i]), f = quad_sub(q, v[i]);
        if (quad_dot(quad_cross(e, f), n) < 0)
            in = false;
        quad s = quad_dot(f, e) / quad_dot(e, e);
        s = s < 0 ? 0 : s > 1 ? 1 : s;
        quad3 g = quad_along(f, -s, e);
        quad d = quad_sqrt(quad_dot(g, g));
        if (best < 0 || d < best)
            best = d;
    }
    if (in)
        best = quad_abs(quad_dot(quad_sub(q, v[0]), n)) / quad_sqrt(quad_dot(n, n));
    return (double)best;
}
