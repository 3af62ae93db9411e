/* mat.c: affine transforms. */
#include "math/mat.h"

#define IDENTITY { { { 1, 0, 0, 0 }, { 0, 1, 0, 0 }, { 0, 0, 1, 0 } } }

const mat34 mat_identity = IDENTITY;
const struct transform transform_identity = { IDENTITY, IDENTITY, true, TRANSFORM_ANY };

mat34 mat_compose(const mat34 *a, const mat34 *b)
{
    mat34 c;

    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 4; j++)
            c.m[i][j] = a->m[i][0] * b->m[0][j] + a->m[i][1] * b->m[1][j]
                        + a->m[i][2] * b->m[2][j] + (j == 3 ? a->m[i][3] : 0);
    return c;
}

static vec3 row(const mat34 *a, int i) { return vec(a->m[i][0], a->m[i][1], a->m[i][2]); }

bool mat_invert(const mat34 *a, mat34 *inverse)
{
    vec3 r0 = row(a, 0), r1 = row(a, 1), r2 = row(a, 2);
    vec3 c[3] = { vec_cross(r1, r2), vec_cross(r2, r0), vec_cross(r0, r1) };
    double det = vec_dot(r0, c[0]);
    vec3 offset = vec(a->m[0][3], a->m[1][3], a->m[2][3]);

    if (det == 0 || !isfinite(det))
        return false;
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++)
            inverse->m[i][j] = vec_get(c[j], i) / det;
        inverse->m[i][3] = -(inverse->m[i][0] * offset.x + inverse->m[i][1] * offset.y
                             + inverse->m[i][2] * offset.z);
        if (!vec_is_finite(row(inverse, i)) || !isfinite(inverse->m[i][3]))
            return false;
    }
    return true;
}

/* Frobenius: never below the largest stretch, at most sqrt(3) above. */
double mat_norm(const mat34 *a)
{
    double sum = 0;

    for (int i = 0; i < 3; i++)
        sum += vec_dot(row(a, i), row(a, i));
    return sqrt(sum);
}

/* What mat_compose would give, less the products with 0 and 1. */
static struct transform moved(const struct transform *a, const struct transform *b)
{
    struct transform c = *b;
    const double x = a->from.m[0][3], y = a->from.m[1][3], z = a->from.m[2][3];

    for (int i = 0; i < 3; i++) {
        const double *f = b->from.m[i];
        c.to.m[i][3] += a->to.m[i][3];
        c.from.m[i][3] = f[0] * x + f[1] * y + f[2] * z + f[3];
    }
    c.form = b->form == TRANSFORM_MOVE ? TRANSFORM_MOVE : TRANSFORM_ANY;
    return c;
}

static struct transform stretched(const struct transform *a, const struct transform *b)
{
    struct transform c = *b;

    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 4; j++)
            c.to.m[i][j] *= a->to.m[i][i];
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            c.from.m[i][j] *= a->from.m[j][j];
    c.form = b->form == TRANSFORM_STRETCH ? TRANSFORM_STRETCH : TRANSFORM_ANY;
    return c;
}

struct transform transform_compose(const struct transform *a, const struct transform *b)
{
    if (a->is_identity)
        return *b;
    if (b->is_identity)
        return *a;
    if (a->form == TRANSFORM_MOVE)
        return moved(a, b);
    if (a->form == TRANSFORM_STRETCH)
        return stretched(a, b);
    return (struct transform) { mat_compose(&a->to, &b->to), mat_compose(&b->from, &a->from),
                                false, TRANSFORM_ANY };
}

struct transform transform_inverse(const struct transform *a)
{
    return (struct transform) { a->from, a->to, a->is_identity, a->form };
}

struct transform transform_translate(vec3 by)
{
    struct transform t = transform_identity;

    t.is_identity = by.x == 0 && by.y == 0 && by.z == 0;
    t.form = TRANSFORM_MOVE;
    t.to.m[0][3] = by.x;
    t.to.m[1][3] = by.y;
    t.to.m[2][3] = by.z;
    for (int i = 0; i < 3; i++)
        t.from.m[i][3] = 0 - t.to.m[i][3];
    return t;
}

struct transform transform_scale(vec3 by)
{
    struct transform t = transform_identity;

    t.is_identity = by.x == 1 && by.y == 1 && by.z == 1;
    t.form = TRANSFORM_STRETCH;
    for (int i = 0; i < 3; i++) {
        t.to.m[i][i] = vec_get(by, i);
        t.from.m[i][i] = 1 / vec_get(by, i);
    }
    return t;
}

/* A rotation's inverse is its transpose. */
static struct transform orthogonal(const mat34 *to)
{
    struct transform t = { *to, mat_identity, false, TRANSFORM_ANY };

    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            t.from.m[i][j] = to->m[j][i];
    return t;
}

/* Quarter turns are exact: sin(pi) is not 0 in floating point. */
static void sine_cosine(double degrees, double *s, double *c)
{
    static const double sines[] = { 0, 1, 0, -1 };
    double quarters = degrees / 90;

    if (quarters == floor(quarters) && fabs(quarters) < 1e9) {
        int q = (int)(((long long)quarters % 4 + 4) % 4);
        *s = sines[q];
        *c = sines[(q + 1) % 4];
        return;
    }
    *s = sin(degrees * (M_PI / 180));
    *c = cos(degrees * (M_PI / 180));
}

/* Turns the rows of a rotation in the plane of the axes i and j. */
static void turn_rows(mat34 *to, int i, int j, double degrees)
{
    double s, c;

    sine_cosine(degrees, &s, &c);
    for (int k = 0; k < 3; k++) {
        double a = to->m[i][k], b = to->m[j][k];
        to->m[i][k] = c * a - s * b;
        to->m[j][k] = s * a + c * b;
    }
}

struct transform transform_rotate(vec3 degrees)
{
    mat34 to = mat_identity;

    if (degrees.x == 0 && degrees.y == 0 && degrees.z == 0)
        return transform_identity;
    if (degrees.x != 0)
        turn_rows(&to, 1, 2, degrees.x);
    if (degrees.y != 0)
        turn_rows(&to, 2, 0, degrees.y);
    if (degrees.z != 0)
        turn_rows(&to, 0, 1, degrees.z);
    return orthogonal(&to);
}

/* Rodrigues' formula. */
struct transform transform_axis_rotate(vec3 axis, double degrees)
{
    vec3 a = vec_unit(axis);
    double s, c;

    sine_cosine(degrees, &s, &c);
    double k = 1 - c;
    mat34 to = { { { c + k * a.x * a.x, k * a.x * a.y - s * a.z, k * a.x * a.z + s * a.y, 0 },
                   { k * a.x * a.y + s * a.z, c + k * a.y * a.y, k * a.y * a.z - s * a.x, 0 },
                   { k * a.x * a.z - s * a.y, k * a.y * a.z + s * a.x, c + k * a.z * a.z, 0 } } };
    return orthogonal(&to);
}

bool transform_matrix(const double v[12], struct transform *t)
{
    for (int row = 0; row < 3; row++)
        for (int column = 0; column < 4; column++)
            t->to.m[row][column] = v[column * 3 + row];
    t->is_identity = false;
    return mat_invert(&t->to, &t->from);
}
