/* parked.h: rays of a wave that must wait, so that waves stay small. */
#ifndef RTC_PARKED_H
#define RTC_PARKED_H

#include "trace/film.h"
#include "trace/insides.h"
#include "trace/wave.h"

/* A stack: what is parked last is followed first, so that memory grows with
 * the depth of the rays and not with their number. */
struct parked {
    struct parking {
        struct wave wave;
        uint32_t n_inside, n_film;      /* what existed then; the rays know no more */
    } *item;
    int n, room;
};

/* Takes rays out of a wave of more than `most`: those of some pixels or, if
 * there is one pixel only, all behind the first `most`.  So the order of a
 * pixel's rays depends on that pixel alone, whatever is rendered beside it. */
void parked_push(struct parked *p, struct wave *w, int most, const struct insides *in,
                 const struct film *f);

/* The last ones back, into a wave that is empty; what came after them is
 * over and its lists and hidden pixels go.  False: there are none. */
bool parked_pop(struct parked *p, struct wave *w, struct insides *in, struct film *f);
void parked_clear(struct parked *p);                    /* their rays are given up */
void parked_release(struct parked *p);

#endif
