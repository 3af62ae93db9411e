/* embree.c: what Embree needs for the rays of mesh.rt.
 *
 *     embree SCENE.rt MESH.inc WIDTH HEIGHT
 *
 * Reads the mesh and the camera that rtc and POV-Ray read, and sends one ray
 * through each pixel's centre with rtcIntersect1, then one from each hit to
 * the light with rtcOccluded1: one thread, single precision, no picture.
 * Built by bench/run where libembree-dev is. */
#include <embree3/rtcore.h>
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

struct vec { double x, y, z; };
struct camera { struct vec eye, at, light; double degrees; };

enum { ROUNDS = 5 };                    /* the best of these counts */

static double now(void)
{
    struct timespec t;

    clock_gettime(CLOCK_MONOTONIC, &t);
    return t.tv_sec + t.tv_nsec * 1e-9;
}

static void die(const char *why, const char *what)
{
    fprintf(stderr, "embree: %s: %s\n", what, why);
    exit(1);
}

static struct vec sum(struct vec a, double k, struct vec b)
{
    return (struct vec) { a.x + k * b.x, a.y + k * b.y, a.z + k * b.z };
}

static struct vec cross(struct vec a, struct vec b)
{
    return (struct vec) { a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x };
}

static struct vec unit(struct vec a)
{
    return sum((struct vec) { 0 }, 1 / sqrt(a.x * a.x + a.y * a.y + a.z * a.z), a);
}

static char *file_text(const char *path)
{
    FILE *in = fopen(path, "rb");
    long size;

    if (!in || fseek(in, 0, SEEK_END) || (size = ftell(in)) < 0)
        die("cannot be read", path);
    rewind(in);
    char *text = malloc(size + 1);
    if (!text || fread(text, 1, size, in) != (size_t)size)
        die("cannot be read", path);
    text[size] = 0;
    fclose(in);
    return text;
}

/* What stands behind the first of these words. */
static const char *after(const char *text, const char *word)
{
    const char *found = strstr(text, word);

    if (!found)
        die("not in the scene", word);
    return found + strlen(word);
}

static double number(const char **at)
{
    *at += strcspn(*at, "0123456789-.");
    return strtod(*at, (char **)at);
}

static struct vec vector(const char *at)
{
    double x = number(&at), y = number(&at), z = number(&at);

    return (struct vec) { x, y, z };
}

static struct camera read_camera(const char *path)
{
    char *text = file_text(path);
    const char *angle = after(text, " angle ");
    struct camera c = { .eye = vector(after(text, "location ")), .at = vector(after(text, "look_at ")),
                        .light = vector(after(text, "light_source ")), .degrees = number(&angle) };

    free(text);
    return c;
}

static RTCScene read_mesh(RTCDevice device, const char *path, size_t *n_face)
{
    char *text = file_text(path);
    RTCScene scene = rtcNewScene(device);
    RTCGeometry mesh = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    const char *at = after(text, "vertex_vectors {");
    size_t n = number(&at);
    float *v = rtcSetNewGeometryBuffer(mesh, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                       3 * sizeof *v, n);
    for (size_t i = 0; i < 3 * n; i++)
        v[i] = number(&at);

    at = after(at, "face_indices {");
    *n_face = number(&at);
    unsigned *f = rtcSetNewGeometryBuffer(mesh, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                          3 * sizeof *f, *n_face);
    for (size_t i = 0; i < 3 * *n_face; i++)
        f[i] = number(&at);
    free(text);
    rtcCommitGeometry(mesh);
    rtcAttachGeometry(scene, mesh);
    rtcReleaseGeometry(mesh);
    return scene;
}

/* POV-Ray's camera: angle is the picture's whole width. */
static void aim(struct RTCRayHit *ray, const struct camera *c, unsigned w, unsigned h)
{
    struct vec ahead = unit(sum(c->at, -1, c->eye));
    struct vec right = unit(cross((struct vec) { 0, 1, 0 }, ahead)), up = cross(ahead, right);
    double side = 2 * tan(c->degrees * M_PI / 360);

    for (unsigned j = 0; j < h; j++)
        for (unsigned i = 0; i < w; i++) {
            struct vec d = sum(sum(ahead, side * ((i + 0.5) / w - 0.5), right),
                               side * h / w * (0.5 - (j + 0.5) / h), up);
            *ray++ = (struct RTCRayHit) {
                .ray = { .org_x = c->eye.x, .org_y = c->eye.y, .org_z = c->eye.z, .dir_x = d.x,
                         .dir_y = d.y, .dir_z = d.z, .tfar = INFINITY, .mask = -1 },
                .hit = { .geomID = RTC_INVALID_GEOMETRY_ID, .instID = { RTC_INVALID_GEOMETRY_ID } } };
        }
}

/* From each hit towards the light; t runs from 0 there to 1 at the light. */
static size_t aim_at_light(struct RTCRay *shadow, const struct RTCRayHit *ray, size_t n, struct vec light)
{
    size_t n_shadow = 0;

    for (size_t i = 0; i < n; i++) {
        const struct RTCRay *r = &ray[i].ray;
        if (ray[i].hit.geomID == RTC_INVALID_GEOMETRY_ID)
            continue;
        struct vec p = { r->org_x + r->tfar * r->dir_x, r->org_y + r->tfar * r->dir_y,
                         r->org_z + r->tfar * r->dir_z };
        struct vec d = sum(light, -1, p);
        shadow[n_shadow++] = (struct RTCRay) { .org_x = p.x, .org_y = p.y, .org_z = p.z,
            .dir_x = d.x, .dir_y = d.y, .dir_z = d.z, .tnear = 1e-5f, .tfar = 1, .mask = -1 };
    }
    return n_shadow;
}

static double time_intersect(RTCScene scene, struct RTCRayHit *ray, size_t n)
{
    struct RTCIntersectContext context;
    double start = now();

    rtcInitIntersectContext(&context);
    for (size_t i = 0; i < n; i++)
        rtcIntersect1(scene, &context, &ray[i]);
    return now() - start;
}

static double time_occluded(RTCScene scene, struct RTCRay *ray, size_t n)
{
    struct RTCIntersectContext context;
    double start = now();

    rtcInitIntersectContext(&context);
    for (size_t i = 0; i < n; i++)
        rtcOccluded1(scene, &context, &ray[i]);
    return now() - start;
}

int main(int argc, char **argv)
{
    size_t n_face, n_shadow = 0, n_dark = 0;

    if (argc != 5)
        die("usage: embree SCENE.rt MESH.inc WIDTH HEIGHT", "wrong arguments");
    unsigned w = atoi(argv[3]), h = atoi(argv[4]);
    struct camera c = read_camera(argv[1]);
    RTCDevice device = rtcNewDevice("threads=1");
    RTCScene scene = read_mesh(device, argv[2], &n_face);
    double start = now();
    rtcCommitScene(scene);
    double build = now() - start, eye = INFINITY, light = INFINITY;

    size_t n = (size_t)w * h;
    struct RTCRayHit *ray = aligned_alloc(64, n * sizeof *ray);
    struct RTCRay *shadow = aligned_alloc(64, n * sizeof *shadow);
    if (!ray || !shadow)
        die("out of memory", "rays");
    for (int i = 0; i < ROUNDS; i++) {
        aim(ray, &c, w, h);
        eye = fmin(eye, time_intersect(scene, ray, n));
        n_shadow = aim_at_light(shadow, ray, n, c.light);
        light = fmin(light, time_occluded(scene, shadow, n_shadow));
    }
    for (size_t i = 0; i < n_shadow; i++)
        n_dark += shadow[i].tfar < 0;
    printf("Embree %d.%d.%d: %zu triangles built in %.3f s; rtcIntersect1 %.0f ns a ray (%zu rays, %zu hit); "
           "rtcOccluded1 %.0f ns (%zu rays, %zu dark)\n", RTC_VERSION_MAJOR, RTC_VERSION_MINOR,
           RTC_VERSION_PATCH, n_face, build, 1e9 * eye / n, n, n_shadow, 1e9 * light / n_shadow, n_shadow,
           n_dark);
    free(ray);
    free(shadow);
    rtcReleaseScene(scene);
    rtcReleaseDevice(device);
    return 0;
}
