/* area.c: area lights: a grid of samples, looked at where they differ (facts
 * shading.md 4.3).
 *
 * Rays are quick when many go together.  So a point does not wait for one
 * sample after the other: first all points look at the samples that each grid
 * is asked for in any case; where these differ, the grids are gone through as
 * far as the known samples lead, what is missing is asked for, all rays go at
 * once, and so on until nothing is missing.  Grids that are divided to the end
 * in any case are not gone through at all: what a sample counts for is then
 * the same everywhere. */
#include "trace/area.h"

#include <string.h>

#include "trace/grain.h"

/* Of a sample seen from a point. */
enum { UNKNOWN, ASKED, DARK, OPEN, COLOURED };

enum {
    TOGETHER = 1 << 16,                 /* samples that are kept for points looked at together */
    WORD = 64,
};

/* Samples of one lamp: its grid, and where they lie if that is so for all points. */
struct area_spot {
    double u, v;                        /* along the axes */
    vec3 at;
    float weight;                       /* where all are seen: their sum is 1 */
    bool always;                        /* looked at whatever the others show */
};

void area_room_init(struct area_room *r, int n_sample, struct arena *mem)
{
    size_t n = (size_t)n_sample, together = n > TOGETHER ? n : TOGETHER;

    if (n == 0)
        return;
    r->spot = arena_array(mem, n, sizeof *r->spot);
    r->wanted = arena_array(mem, n, sizeof *r->wanted);
    r->state = arena_array(mem, together, sizeof *r->state);
    r->colour = arena_array(mem, together, sizeof *r->colour);
}

/* Where rays begin: the points that are looked at together. */
struct starts { double x[BATCH], y[BATCH], z[BATCH], nx[BATCH], ny[BATCH], nz[BATCH], slack[BATCH]; };

struct area {
    struct worker *w;
    const struct batch *b;
    const struct lamp *lamp;
    uint32_t number;                    /* the lamp's */
    int n_sample;
    struct area_spot *spot;
    struct starts at_point;
    const uint16_t *at;                 /* the same points in the batch */
    vec3 (*axis)[2];                    /* where they differ from point to point; else NULL: ... */
    vec3 all[2];                        /* ... these */
    /* Rays to be sent, of any of the points to any sample. */
    int n_ray;
    uint16_t from[BATCH], point[BATCH]; /* number of the point; of the same in the batch */
    int sample[BATCH];
    struct starts ray;
};

/* ---- the lamp's grid ---- */

static struct area_spot *spot_at(const struct area *a, int i, int j)
{
    return &a->spot[i * a->lamp->area.n2 + j];
}

struct patch { int u1, v1, u2, v2; };

static bool is_fine(struct patch p) { return p.u2 - p.u1 <= 1 && p.v2 - p.v1 <= 1; }

static void quarters_of(struct patch p, struct patch quarter[4])
{
    int ulow = (p.u1 + p.u2) / 2, uhigh = (p.u1 + p.u2 + 1) / 2;
    int vlow = (p.v1 + p.v2) / 2, vhigh = (p.v1 + p.v2 + 1) / 2;

    quarter[0] = (struct patch) { p.u1, p.v1, ulow, vlow };
    quarter[1] = (struct patch) { uhigh, p.v1, p.u2, vlow };
    quarter[2] = (struct patch) { uhigh, vhigh, p.u2, p.v2 };
    quarter[3] = (struct patch) { p.u1, vhigh, ulow, p.v2 };
}

static struct patch whole_grid(const struct lamp *l)
{
    return (struct patch) { 0, 0, l->area.n1 - 1, l->area.n2 - 1 };
}

/* What the samples count for in a patch that is divided to the end; returns
 * how many times it is. */
static int weigh(const struct area *a, struct patch p, float weight)
{
    struct patch quarter[4];
    int depth = 0;

    if (is_fine(p)) {
        spot_at(a, p.u1, p.v1)->weight += weight / 4;
        spot_at(a, p.u2, p.v1)->weight += weight / 4;
        spot_at(a, p.u2, p.v2)->weight += weight / 4;
        spot_at(a, p.u1, p.v2)->weight += weight / 4;
        return 0;
    }
    quarters_of(p, quarter);
    for (int k = 0; k < 4; k++) {
        int one = weigh(a, quarter[k], weight / 4);
        depth = one > depth ? one : depth;
    }
    return depth + 1;
}

/* Along axes: those of all points, or of one. */
static vec3 place_of(const struct lamp *l, double u, double v, const vec3 axis[2])
{
    return vec_fma(vec_fma(l->centre, u, axis[0]), v, axis[1]);
}

/* The corners that are asked for first. */
static void mark_always(const struct area *a, struct patch p, int level)
{
    struct patch quarter[4];

    if (is_fine(p) || level >= a->lamp->area.adaptive) {
        spot_at(a, p.u1, p.v1)->always = spot_at(a, p.u2, p.v1)->always = true;
        spot_at(a, p.u2, p.v2)->always = spot_at(a, p.u1, p.v2)->always = true;
        return;
    }
    quarters_of(p, quarter);
    for (int k = 0; k < 4; k++)
        mark_always(a, quarter[k], level + 1);
}

/* Returns whether every grid is divided to the end. */
static bool lay_out(struct area *a)
{
    const struct lamp *l = a->lamp;

    lamp_area_axes(l, vec(0, 0, 1), a->all);
    for (int i = 0; i < l->area.n1; i++)
        for (int j = 0; j < l->area.n2; j++) {
            struct area_spot *s = spot_at(a, i, j);
            lamp_area_spot(l, i, j, &s->u, &s->v);
            s->at = place_of(l, s->u, s->v, a->all);
            s->weight = 0;
            s->always = false;
        }
    mark_always(a, whole_grid(l), 0);
    return weigh(a, whole_grid(l), 1) <= l->area.adaptive;
}

/* ---- rays ---- */

/* From points (x, y, z) to samples (dx, dy, dz). */
KERNEL static void aim_at_samples(int n, struct shadow_rays *restrict r)
{
    for (int i = 0; i < whole(n); i++) {
        double ax = r->dx[i] - r->x[i], ay = r->dy[i] - r->y[i], az = r->dz[i] - r->z[i];
        double length = sqrt(ax * ax + ay * ay + az * az), k = length > 0 ? 1 / length : 0;
        r->dx[i] = ax * k;
        r->dy[i] = ay * k;
        r->dz[i] = az * k;
        r->far[i] = length * shadow_nearly;
    }
}

/* All as the samples are seen from the target, and as far as the sample's plane. */
KERNEL static void aim_from_target(int n, vec3 target, struct shadow_rays *restrict r)
{
    for (int i = 0; i < whole(n); i++) {
        double ax = r->dx[i] - target.x, ay = r->dy[i] - target.y, az = r->dz[i] - target.z;
        double length = sqrt(ax * ax + ay * ay + az * az), k = length > 0 ? 1 / length : 0;
        double far = ((r->dx[i] - r->x[i]) * ax + (r->dy[i] - r->y[i]) * ay + (r->dz[i] - r->z[i]) * az) * k;
        r->dx[i] = ax * k;
        r->dy[i] = ay * k;
        r->dz[i] = az * k;
        r->far[i] = far > 0 ? far * shadow_nearly : 0;
    }
}

/* Out of the surfaces, on the side that the light is on. */
KERNEL static void leave(int n, const double *restrict nx, const double *restrict ny, const double *restrict nz,
                         const double *restrict slack, struct shadow_rays *restrict r)
{
    for (int i = 0; i < whole(n); i++) {
        double off = copysign(slack[i], nx[i] * r->dx[i] + ny[i] * r->dy[i] + nz[i] * r->dz[i]);
        r->x[i] = fma(off, nx[i], r->x[i]);
        r->y[i] = fma(off, ny[i], r->y[i]);
        r->z[i] = fma(off, nz[i], r->z[i]);
    }
}

/* Anywhere in the sample's cell. */
static void jitter(const struct area *a, vec3 p, int sample, double *u, double *v)
{
    uint64_t salt = 2 * ((uint64_t)a->number << 32 | (uint32_t)sample);
    int n2 = a->lamp->area.n2;

    lamp_area_spot(a->lamp, sample / n2 + grain_at(p, salt) - 0.5, sample % n2 + grain_at(p, salt + 1) - 0.5, u, v);
}

static vec3 sample_seen_from(const struct area *a, vec3 p, int from, int sample)
{
    const struct area_spot *s = &a->spot[sample];
    double u = s->u, v = s->v;

    if (!a->axis && !a->lamp->area.jitter)
        return s->at;
    if (a->lamp->area.jitter)
        jitter(a, p, sample, &u, &v);
    return place_of(a->lamp, u, v, a->axis ? a->axis[from] : a->all);
}

static void set_start(struct starts *s, int k, const struct starts *from, int i)
{
    s->x[k] = from->x[i];
    s->y[k] = from->y[i];
    s->z[k] = from->z[i];
    s->nx[k] = from->nx[i];
    s->ny[k] = from->ny[i];
    s->nz[k] = from->nz[i];
    s->slack[k] = from->slack[i];
}

static void aim_ray(struct area *a, int k, int from, int sample)
{
    struct shadow_rays *r = &a->w->shadow_rays;
    const struct starts *p = &a->at_point;
    vec3 to = sample_seen_from(a, vec(p->x[from], p->y[from], p->z[from]), from, sample);

    r->dx[k] = to.x;
    r->dy[k] = to.y;
    r->dz[k] = to.z;
}

static void add_ray(struct area *a, int from, int sample)
{
    int k = a->n_ray++;

    a->from[k] = (uint16_t)from;
    a->point[k] = a->at[from];
    a->sample[k] = sample;
    set_start(&a->ray, k, &a->at_point, from);
    aim_ray(a, k, from, sample);
}

/* From starts to the samples that are in the rays' directions. */
static void send(struct area *a, int n, const struct starts *s, const uint16_t point[], struct lit *through)
{
    struct shadow_rays *r = &a->w->shadow_rays;
    size_t size = (size_t)whole(n) * sizeof *s->x;

    memcpy(r->x, s->x, size);
    memcpy(r->y, s->y, size);
    memcpy(r->z, s->z, size);
    if (a->lamp->parallel)
        aim_from_target(n, a->lamp->target, r);
    else
        aim_at_samples(n, r);
    leave(n, s->nx, s->ny, s->nz, s->slack, r);
    shadow_rays_pass(a->w, a->b, a->number, n, point, through);
}

static void send_from_all(struct area *a, int n, int sample, struct lit *through)
{
    for (int k = 0; k < n; k++)
        aim_ray(a, k, k, sample);
    send(a, n, &a->at_point, a->at, through);
}

/* ---- all samples of all points ---- */

static void add_weighed(struct lit *sum, int n, float weight, const struct lit *through)
{
    for (int k = 0; k < n; k++) {
        sum->r[k] += weight * through->r[k];
        sum->g[k] += weight * through->g[k];
        sum->b[k] += weight * through->b[k];
    }
}

static void all_through(struct area *a, int n, struct lit *out)
{
    struct lit through, sum;

    for (int k = 0; k < n; k++)
        lit_put(&sum, k, rgb_of(0, 0, 0));
    for (int s = 0; s < a->n_sample; s++) {
        send_from_all(a, n, s, &through);
        add_weighed(&sum, n, a->spot[s].weight, &through);
    }
    for (int k = 0; k < n; k++)
        lit_put(out, a->at[k], rgb_of(sum.r[k], sum.g[k], sum.b[k]));
}

/* ---- where samples differ ---- */

/* The grid of one point. */
struct grid {
    struct area *a;
    int from;
    size_t first;                       /* its first sample among those that are kept */
    bool lacks;                         /* a sample is not known yet */
};

INLINE rgb grid_sample(struct grid *g, int i, int j)
{
    struct area_room *room = &g->a->w->area;
    int sample = i * g->a->lamp->area.n2 + j;
    uint8_t *state = &room->state[g->first + (size_t)sample];

    if (*state == UNKNOWN) {
        *state = ASKED;
        room->wanted[sample].by[g->from / WORD] |= (uint64_t)1 << g->from % WORD;
    }
    g->lacks |= *state == ASKED;
    if (*state == COLOURED)
        return room->colour[g->first + (size_t)sample];
    float open = *state == OPEN ? 1 : 0;
    return rgb_of(open, open, open);
}

static bool differ(const struct grid *g, rgb a, rgb b)
{
    rgb c = g->a->lamp->colour;

    return fabsf((a.r - b.r) * c.r) + fabsf((a.g - b.g) * c.g) + fabsf((a.b - b.b) * c.b) > 0.1f;
}

static rgb mean(const rgb c[4])
{
    return rgb_scale(rgb_add(rgb_add(c[0], c[1]), rgb_add(c[2], c[3])), 0.25f);
}

static rgb patch_light(struct grid *g, struct patch p, int level);

static rgb quarters_light(struct grid *g, struct patch p, int level)
{
    struct patch quarter[4];
    rgb c[4];

    quarters_of(p, quarter);
    for (int k = 0; k < 4; k++)
        c[k] = patch_light(g, quarter[k], level);
    return mean(c);
}

/* Of no meaning while the grid lacks samples. */
static rgb patch_light(struct grid *g, struct patch p, int level)
{
    bool fine = is_fine(p), lacked = g->lacks;

    if (!fine && level < g->a->lamp->area.adaptive)
        return quarters_light(g, p, level + 1);
    g->lacks = false;
    rgb c[4] = { grid_sample(g, p.u1, p.v1), grid_sample(g, p.u2, p.v1),
                 grid_sample(g, p.u2, p.v2), grid_sample(g, p.u1, p.v2) };
    bool divided = !fine && !g->lacks && (differ(g, c[0], c[1]) || differ(g, c[1], c[2])
                                          || differ(g, c[2], c[3]) || differ(g, c[3], c[0]));
    g->lacks |= lacked;
    return divided ? quarters_light(g, p, level + 1) : mean(c);
}

/* Goes through the grids of n points; those that lack samples come to the
 * front, and how many they are is returned. */
static int go_through(struct area *a, int n, uint16_t from[], struct lit *out)
{
    int left = 0;

    for (int k = 0; k < n; k++) {
        struct grid g = { a, from[k], (size_t)from[k] * (size_t)a->n_sample, false };
        rgb light = patch_light(&g, whole_grid(a->lamp), 0);
        lit_put(out, a->at[from[k]], light);
        if (g.lacks)
            from[left++] = from[k];
    }
    return left;
}

static void learn(struct area *a, int from, int sample, rgb c)
{
    struct area_room *room = &a->w->area;
    size_t one = (size_t)from * (size_t)a->n_sample + (size_t)sample;
    bool is_grey = c.r == c.g && c.g == c.b;

    room->state[one] = is_grey && c.r == 0 ? DARK : is_grey && c.r == 1 ? OPEN : COLOURED;
    if (room->state[one] == COLOURED)
        room->colour[one] = c;
}

static void learn_rays(struct area *a)
{
    struct lit through;

    if (a->n_ray == 0)
        return;
    send(a, a->n_ray, &a->ray, a->point, &through);
    for (int k = 0; k < a->n_ray; k++)
        learn(a, a->from[k], a->sample[k], rgb_of(through.r[k], through.g[k], through.b[k]));
    a->n_ray = 0;
}

static void answer(struct area *a)
{
    for (int s = 0; s < a->n_sample; s++) {
        struct area_wanted *wanted = &a->w->area.wanted[s];
        for (int word = 0; word < BATCH / WORD; word++)
            for (; wanted->by[word]; wanted->by[word] &= wanted->by[word] - 1) {
                add_ray(a, word * WORD + __builtin_ctzll(wanted->by[word]), s);
                if (a->n_ray == BATCH)
                    learn_rays(a);
            }
    }
    learn_rays(a);
}

/* Keeps what all samples so far have in common: their least and most. */
static void join_range(int n, const struct lit *through, float *restrict least, float *restrict most)
{
    for (int k = 0; k < n; k++) {
        float low = smallerf(through->r[k], smallerf(through->g[k], through->b[k]));
        float high = largerf(through->r[k], largerf(through->g[k], through->b[k]));
        least[k] = smallerf(low, least[k]);
        most[k] = largerf(high, most[k]);
    }
}

/* Of all points, the samples that are always looked at; returns how many points
 * see some more and some less.  What is the same for all samples is the light. */
static int look_first(struct area *a, int n, uint16_t from[], struct lit *out)
{
    float least[BATCH], most[BATCH];
    struct lit through;
    int left = 0;

    for (int k = 0; k < n; k++)
        least[k] = INFINITY, most[k] = 0;
    for (int s = 0; s < a->n_sample; s++) {
        if (!a->spot[s].always)
            continue;
        send_from_all(a, n, s, &through);
        join_range(n, &through, least, most);
        for (int k = 0; k < n; k++)
            learn(a, k, s, rgb_of(through.r[k], through.g[k], through.b[k]));
    }
    for (int k = 0; k < n; k++) {
        if (least[k] < most[k])
            from[left++] = (uint16_t)k;
        else
            lit_put(out, a->at[k], rgb_of(most[k], most[k], most[k]));
    }
    return left;
}

static void some_through(struct area *a, int n, struct lit *out)
{
    uint16_t from[BATCH];

    memset(a->w->area.state, UNKNOWN, (size_t)n * (size_t)a->n_sample);
    n = look_first(a, n, from, out);
    while ((n = go_through(a, n, from, out)) > 0)
        answer(a);
}

/* ---- a batch ---- */

static void gather(struct area *a, int n)
{
    const struct points *p = &a->b->at;
    struct starts *s = &a->at_point;

    for (int k = 0; k < n; k++) {
        int i = a->at[k];
        s->x[k] = p->x[i];
        s->y[k] = p->y[i];
        s->z[k] = p->z[i];
        s->nx[k] = p->nx[i];
        s->ny[k] = p->ny[i];
        s->nz[k] = p->nz[i];
        s->slack[k] = p->slack[i];
    }
}

static void turn_axes(struct area *a, int n, const struct beams *to, vec3 axis[][2])
{
    a->axis = a->lamp->area.orient ? axis : NULL;
    for (int k = 0; a->axis && k < n; k++) {
        int i = a->at[k];
        lamp_area_axes(a->lamp, vec(to->dx[i], to->dy[i], to->dz[i]), axis[k]);
    }
}

void area_through(struct worker *w, const struct batch *b, const struct beams *beam, uint32_t lamp, int n,
                  const uint16_t at[], struct lit *out)
{
    struct area a;                      /* large: what is not used stays as it is */
    vec3 axis[BATCH][2];

    a.w = w;
    a.b = b;
    a.lamp = &w->shader->lamp[lamp];
    a.number = lamp;
    a.n_sample = a.lamp->area.n1 * a.lamp->area.n2;
    a.spot = w->area.spot;
    a.n_ray = 0;
    bool is_whole = lay_out(&a);
    int step = is_whole ? BATCH : TOGETHER / a.n_sample;
    step = step < 1 ? 1 : step;
    for (int k = 0; k < n; k += step) {
        int some = n - k < step ? n - k : step;
        a.at = at + k;
        gather(&a, some);
        turn_axes(&a, some, beam, axis);
        if (is_whole)
            all_through(&a, some, out);
        else
            some_through(&a, some, out);
    }
}
