/* camera_rays.h: where each point of the picture looks. */
#ifndef RTC_CAMERA_RAYS_H
#define RTC_CAMERA_RAYS_H

#include "scene/camera.h"
#include "shape/shape.h"

/* The camera with what its kind needs worked out once. */
struct lens {
    enum camera_kind kind;
    vec3 location, direction, right, up;    /* unit vectors for the kinds that want them */
    double width, height;               /* |right|, |up| */
    double angle, h_angle, v_angle;     /* radians */
    bool fixed_origin;                  /* all rays start at location */
};

struct lens lens_of(const struct camera *c);

/* The ray, its direction of unit length, through u, v: 0..1 from the left and from
 * the top.  False: nothing is seen there (outside the circle of a fisheye). */
bool lens_ray(const struct lens *l, double u, double v, struct ray *ray);

/* The same for n points of a perspective: the directions, all from location. */
void lens_fan(const struct lens *l, int n, const double *u, const double *v, double *dx,
              double *dy, double *dz);

#endif
