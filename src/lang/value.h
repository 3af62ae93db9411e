/* value.h: what an expression or a declaration evaluates to. */
#ifndef RTC_VALUE_H
#define RTC_VALUE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/source.h"

enum value_type {
    VALUE_NONE,                         /* an array element that was never set */
    VALUE_NUMBER,                       /* n = 1 number, 2..4 vector; doubles */
    VALUE_COLOUR,                       /* n = 5: red green blue filter transmit */
    VALUE_TEXT,
    VALUE_ARRAY, VALUE_FUNCTION, VALUE_SPLINE, VALUE_MACRO, VALUE_FILE,
    VALUE_TRANSFORM,                    /* struct transform */
    VALUE_OBJECT,                       /* struct object, lights too */
    VALUE_TEXTURE, VALUE_PIGMENT, VALUE_NORMAL, VALUE_FINISH, VALUE_INTERIOR, VALUE_MATERIAL,
    VALUE_MEDIA, VALUE_DENSITY, VALUE_COLOUR_MAP, VALUE_PIGMENT_MAP, VALUE_NORMAL_MAP,
    VALUE_SLOPE_MAP, VALUE_TEXTURE_MAP, VALUE_DENSITY_MAP, VALUE_CAMERA, VALUE_FOG,
    VALUE_RAINBOW, VALUE_SKY_SPHERE,
};

struct text {                           /* UTF-8 */
    const char *bytes;                  /* with a final NUL */
    size_t size;
};

/* POV-Ray knows how many components a place wants while it reads what stands there, and
 * its arithmetic leaves the others as they were.  What would be found in them goes along,
 * until a name or an element of an array takes the value. */
enum value_rest {
    REST_NONE,                          /* a number stands in all; a vector has zeros behind */
    REST_KEPT,                          /* v holds all five: what a component was taken from */
    REST_WIDE,                          /* v holds all five: as many as wanted count */
};

enum { MOST_COMPONENTS = 5 };

struct value {
    enum value_type type;
    int16_t n;                          /* components of a number or colour */
    uint16_t rest;                      /* enum value_rest; of those behind */
    union {
        double v[5];
        struct text text;
        const void *thing;              /* of the other types; never changed once made, so
                                           copying a value is copying it deeply */
    };
};

const char *value_type_name(enum value_type type);      /* "pigment", "number" */
struct lang;
const char *value_describe(struct lang *l, const struct value *v);    /* "a vector of 4 components" */
const char *value_name(const struct value *v);          /* "vector" for several numbers */
bool value_is_number(const struct value *v);            /* or colour: of any size */
double value_component(const struct value *v, int i);   /* where more are wanted than there are */

#endif
