/* frustum.c: a piece of a cone between two discs. */
#include "shape/frustum.h"

/* Two axes at right angles to z; exact axes if z is one. */
static void complete_axes(struct frustum *s)
{
    vec3 z = s->z;
    double x = fabs(z.x), y = fabs(z.y), w = fabs(z.z);
    vec3 least = x <= y && x <= w ? vec(1, 0, 0) : y <= w ? vec(0, 1, 0) : vec(0, 0, 1);

    s->x = direction_of(vec_cross(least, z));
    s->y = vec_cross(z, s->x);
}

const char *frustum_prepare(struct frustum *s, vec3 base, double base_radius, vec3 cap,
                            double cap_radius, bool is_open)
{
    double wide = fmax(base_radius, cap_radius);
    vec3 axis = vec_sub(cap, base);
    double height = length_of(axis);

    if (!vec_is_finite(base) || !isfinite(height) || !isfinite(base_radius + cap_radius))
        return "not finite";
    if (!(height > 0))
        return "zero length";
    if (!(wide > 0))
        return "zero radius";
    s->base = base;
    s->z = direction_of(axis);
    complete_axes(s);
    s->unit = unit_for(wide);
    s->size = 1 / s->unit;
    s->r = base_radius * s->unit;
    s->height = height * s->unit;
    s->slope = (cap_radius - base_radius) * s->unit / s->height;
    s->reach = height + wide;
    s->is_open = is_open;
    return NULL;
}

/* A disc reaches r sin(angle between axis and coordinate) along each. */
static struct bounds disc_bounds(vec3 centre, vec3 axis, double r)
{
    vec3 by = vec(r * sqrt((1 - fabs(axis.x)) * (1 + fabs(axis.x))),
                  r * sqrt((1 - fabs(axis.y)) * (1 + fabs(axis.y))),
                  r * sqrt((1 - fabs(axis.z)) * (1 + fabs(axis.z))));

    return (struct bounds) { vec_sub(centre, by), vec_add(centre, by) };
}

struct bounds frustum_bounds(const void *self)
{
    const struct frustum *s = self;
    vec3 cap = vec_fma(s->base, s->height * s->size, s->z);
    double cap_radius = larger(fma(s->slope, s->height, s->r), 0) * s->size;

    return bounds_pad(bounds_join(disc_bounds(s->base, s->z, s->r * s->size),
                                  disc_bounds(cap, s->z, cap_radius)));
}

void frustum_hold(const void *self, vec3 *centre, vec3 edge[3])
{
    const struct frustum *s = self;
    double radius = larger(fma(s->slope, s->height, s->r), s->r) * s->size;

    edge[0] = vec_scale(s->x, radius);
    edge[1] = vec_scale(s->y, radius);
    edge[2] = vec_scale(s->z, s->height * s->size / 2);
    *centre = vec_add(s->base, edge[2]);
}

INLINE vec3 turn(const struct frustum *s, vec3 v)
{
    return vec(vec_dot(v, s->x), vec_dot(v, s->y), vec_dot(v, s->z));
}

INLINE vec3 to_own(const struct frustum *s, vec3 p)
{
    return turn(s, vec_scale(vec_sub(p, s->base), s->unit));
}

/* A ray as the frustum sees it, re-centred at the closest approach to the
 * base's centre. */
struct line { vec3 p, d; double mid; };

INLINE struct line line_of(const struct frustum *s, struct ray ray)
{
    vec3 from = to_own(s, ray.origin), d = turn(s, ray.dir);
    double mid = -vec_dot(from, d) / vec_dot(d, d);

    return (struct line) { vec_fma(from, mid, d), d, mid };
}

/* Where the line is inside of the infinite cone's nappe of positive radius.
 * With rho the radius at the line's height, that is x^2 + y^2 - rho^2 < 0, a
 * quadratic form whose discriminant is the Gram determinant of p and d: three
 * 2x2 determinants, each right to 1.5 ulp. */
struct wall { double rho, grow, left, a, b, c; };

INLINE struct wall wall_of(const struct frustum *s, vec3 p, vec3 d)
{
    double rho = fma(s->slope, p.z, s->r), grow = s->slope * d.z;
    double u = difference_of_products(p.x, grow, rho, d.x);
    double v = difference_of_products(p.y, grow, rho, d.y);
    double w = difference_of_products(p.x, d.y, p.y, d.x);

    return (struct wall) { rho, grow, u * u + v * v - w * w,
                           d.x * d.x + d.y * d.y - grow * grow,
                           p.x * d.x + p.y * d.y - rho * grow,
                           p.x * p.x + p.y * p.y - rho * rho };
}

struct chord { double near, far; };

/* One nappe is cut twice, or each once.  False: not this one. */
INLINE bool cut_wall(const struct wall *w, struct chord *out)
{
    double root = sqrt(larger(w->left, 0)), q = -(w->b + copysign(root, w->b));
    double t = w->a != 0 ? q / w->a : w->b < 0 ? -INFINITY : INFINITY;
    double o = q != 0 ? w->c / q : t;
    double first = smaller(t, o), last = larger(t, o);
    bool is_one = w->a > 0;

    out->near = is_one ? first : w->grow > 0 ? last : -INFINITY;
    out->far = is_one ? last : w->grow > 0 ? INFINITY : first;
    return !is_one || (w->left > 0 && w->rho * w->a - w->grow * w->b >= 0);
}

INLINE bool is_along_tube(const struct wall *w) { return w->a == 0 && w->grow == 0; }

static __attribute__((noinline)) bool cut_along_tube(vec3 p, double rho, struct chord *out)
{
    out->near = -INFINITY;
    out->far = INFINITY;
    return dd_sub(dd_add(dd_product(p.x, p.x), dd_product(p.y, p.y)), dd_product(rho, rho)).hi < 0;
}

/* Between the two discs; NaN in a disc's plane. */
INLINE struct chord discs_of(const struct frustum *s, double z, double dz)
{
    double a = (0 - z) / dz, b = (s->height - z) / dz;
    bool down = copysign(1, dz) < 0;

    return (struct chord) { down ? b : a, down ? a : b };
}

/* Wall and slab are cut with each other, so a rim is crossed once, and the
 * other nappe, which the slab excludes, never. */
INLINE bool cut(const void *self, struct ray ray, struct span *out)
{
    const struct frustum *s = self;
    struct line line = line_of(s, ray);
    struct wall w = wall_of(s, line.p, line.d);
    struct chord wall;

    if (UNLIKELY(is_along_tube(&w))) {
        struct chord tube;              /* so that wall need not live in memory */
        if (!cut_along_tube(line.p, w.rho, &tube))
            return false;
        wall = tube;
    } else if ((w.a > 0 && !(w.left > 0)) || !cut_wall(&w, &wall)) {
        return false;
    }
    struct chord discs = discs_of(s, line.p.z, line.d.z);
    bool by_disc = discs.near > wall.near, to_disc = discs.far < wall.far;
    double near = by_disc ? discs.near : wall.near, far = to_disc ? discs.far : wall.far;
    if (!(near <= far))
        return false;
    bool down = signbit(line.d.z);
    out->near = (line.mid + near) * s->size;
    out->far = (line.mid + far) * s->size;
    out->near_part = !by_disc ? FRUSTUM_WALL : down ? FRUSTUM_CAP : FRUSTUM_BASE;
    out->far_part = !to_disc ? FRUSTUM_WALL : down ? FRUSTUM_BASE : FRUSTUM_CAP;
    return true;
}

KERNEL static void chords(const struct frustum *s, int n, const double *restrict x,
                          const double *restrict y, const double *restrict z,
                          const double *restrict dx, const double *restrict dy,
                          const double *restrict dz, double *restrict near, double *restrict far)
{
    const struct frustum own = *s;

    for (int i = 0; i < n; i++) {
        struct ray ray = { { x[i], y[i], z[i] }, { dx[i], dy[i], dz[i] } };
        struct line line = line_of(&own, ray);
        struct wall w = wall_of(&own, line.p, line.d);
        struct chord wall;
        bool meets = cut_wall(&w, &wall);
        bool is_left = (int)is_along_tube(&w) | (int)!ray_is_tame(ray);
        struct chord discs = discs_of(&own, line.p.z, line.d.z);
        double first = larger(discs.near, wall.near), last = smaller(discs.far, wall.far);
        meets &= first <= last;
        first = meets ? (line.mid + first) * own.size : INFINITY;
        last = meets ? (line.mid + last) * own.size : -INFINITY;
        near[i] = is_left ? NAN : first;
        far[i] = is_left ? NAN : last;
    }
}

void frustum_spans(const void *self, const struct rays *r, double near[], double far[])
{
    chords(self, r->n, r->x, r->y, r->z, r->dx, r->dy, r->dz, near, far);
}

int frustum_hits(const void *self, struct ray ray, struct hit out[])
{
    const struct frustum *s = self;
    int n = span_hits(cut, s, s->reach, ray, out), kept = 0;

    if (!s->is_open)
        return n;
    for (int i = 0; i < n; i++)
        if (out[i].part == FRUSTUM_WALL)
            out[kept++] = out[i];
    return kept;
}

bool frustum_nearest(const void *self, const struct ray *along, double near, double far,
                     struct hit *out)
{
    const struct frustum *s = self;
    struct ray ray = *along;

    if (LIKELY(!s->is_open))
        return span_nearest(cut, s, s->reach, ray, near, far, out);

    struct hit h[2];
    int n = frustum_hits(s, ray, h);
    for (int i = 0; i < n; i++)
        if (h[i].t > near && h[i].t < far) {
            *out = h[i];
            return true;
        }
    return false;
}

/* ---- the same for a register of rays ---- */

INLINE struct wide3 turn_many(const struct frustum *s, struct wide3 v)
{
    return (struct wide3) { wide_dot_vec(v, s->x), wide_dot_vec(v, s->y), wide_dot_vec(v, s->z) };
}

/* As cut_wall, but that lines along a cylinder's axis and such are unsure. */
INLINE wide_mask cut_wall_many(const struct frustum *s, struct wide3 p, struct wide3 d, wide *near,
                               wide *far, wide_mask *unsure)
{
    const wide none = wide_of(0), endless = wide_of(INFINITY);
    wide rho = wide_fma(wide_of(s->slope), p.z, wide_of(s->r)), grow = s->slope * d.z;
    wide u = wide_difference_of_products(p.x, grow, rho, d.x);
    wide v = wide_difference_of_products(p.y, grow, rho, d.y);
    wide w = wide_difference_of_products(p.x, d.y, p.y, d.x);
    wide left = u * u + v * v - w * w;
    wide a = d.x * d.x + d.y * d.y - grow * grow;
    wide_mask twice = wide_below(none, a);      /* one nappe; else each nappe once */

    *unsure |= wide_equal(a, none);
    wide_mask met = wide_not(twice) | wide_below(none, left);
    if (!wide_bits(met | *unsure))
        return met;
    wide b = p.x * d.x + p.y * d.y - rho * grow;
    wide c = p.x * p.x + p.y * p.y - rho * rho;
    wide root = wide_sqrt(wide_max(left, none)), q = -(b + wide_copysign(root, b));
    wide t = q / a, o = wide_pick(wide_equal(q, none), t, c / q);
    wide first = wide_min(t, o), last = wide_max(t, o);
    wide_mask grows = wide_below(none, grow);

    *unsure |= wide_not(wide_equal(t, t) & wide_equal(o, o));
    *near = wide_pick(twice, first, wide_pick(grows, last, -endless));
    *far = wide_pick(twice, last, wide_pick(grows, endless, first));
    return met & (wide_not(twice) | wide_at_most(none, rho * a - grow * b));
}

INLINE wide_ints part_of(wide_mask is_wall, wide_mask is_base)
{
    return wide_pick_ints(is_wall, wide_ints_of(FRUSTUM_WALL),
                          wide_pick_ints(is_base, wide_ints_of(FRUSTUM_BASE),
                                         wide_ints_of(FRUSTUM_CAP)));
}

INLINE wide_mask cut_many(const void *self, const struct wide_ray *r, struct wide_span *out,
                          wide_mask *unsure)
{
    const struct frustum *s = self;
    struct wide3 d = turn_many(s, r->d);
    struct wide3 from = turn_many(s, wide3_scale(wide3_sub_vec(r->o, s->base), s->unit));
    wide mid = -wide_dot(from, d) / wide_dot(d, d);
    struct wide3 p = wide3_fma(from, mid, d);
    wide near = wide_of(0), far = near;
    wide_mask met = cut_wall_many(s, p, d, &near, &far, unsure);

    if (!wide_bits(met))
        return met;
    wide a = (0 - p.z) / d.z, b = (s->height - p.z) / d.z;
    wide_mask down = wide_signs(d.z);
    wide enter = wide_pick(down, b, a), leave = wide_pick(down, a, b);
    wide_mask by_disc = wide_below(near, enter), to_disc = wide_below(leave, far);

    near = wide_pick(by_disc, enter, near);
    far = wide_pick(to_disc, leave, far);
    out->near = (mid + near) * s->size;
    out->far = (mid + far) * s->size;
    out->near_part = part_of(wide_not(by_disc), wide_not(down));
    out->far_part = part_of(wide_not(to_disc), down);
    return met & wide_at_most(near, far);
}

/* Nothing is met by crossing a disc that is not there. */
static void leave_out_discs(const struct packet *p, struct crossings *c)
{
    for (int at = 0, k = 0; at < p->n; at += WIDE, k++) {
        wide_mask any = wide_mask_of(0);
        for (int i = 0; c->met[k] && i < 2; i++) {
            wide_mask is_disc = wide_ints_below(wide_ints_of(FRUSTUM_WALL),
                                                wide_load_ints(c->part[i] + at));
            wide_store(c->t[i] + at, wide_pick(is_disc, wide_of(NAN), wide_load(c->t[i] + at)));
            any |= wide_not(is_disc);
        }
        c->met[k] &= (uint8_t)wide_bits(any);
    }
}

void frustum_hits_many(const void *self, const struct packet *p, const uint8_t may[],
                       struct crossings *out)
{
    const struct frustum *s = self;

    packet_spans(cut_many, s, s->reach, p, may, out);
    if (s->is_open)
        leave_out_discs(p, out);
}

bool frustum_is_leaky(const void *self) { return ((const struct frustum *)self)->is_open; }

bool frustum_inside(const void *self, vec3 p)
{
    const struct frustum *s = self;
    vec3 q = to_own(s, p);
    double rho = fma(s->slope, q.z, s->r);

    /* As in POV-Ray, an end is outside of what it closes. */
    bool between = s->is_open ? q.z >= 0 && q.z <= s->height : q.z > 0 && q.z < s->height;
    return between && q.x * q.x + q.y * q.y < rho * rho;
}

/* Of the wall: the gradient of (x^2 + y^2 - rho^2) / 2; the apex has none. */
vec3 frustum_normal(const void *self, vec3 p, const struct hit *h)
{
    const struct frustum *s = self;

    if (h->part != FRUSTUM_WALL)
        return h->part == FRUSTUM_CAP ? s->z : vec_neg(s->z);

    vec3 q = to_own(s, p);
    double across = sqrt(q.x * q.x + q.y * q.y);
    if (across == 0)
        return s->slope < 0 ? s->z : vec_neg(s->z);
    return vec_add(vec_add(vec_scale(s->x, q.x), vec_scale(s->y, q.y)),
                   vec_scale(s->z, -s->slope * across));
}
