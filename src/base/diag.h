/* diag.h: what went wrong, and where. */
#ifndef RTC_DIAG_H
#define RTC_DIAG_H

#include <stdbool.h>
#include <stdio.h>

#include "base/source.h"

enum severity { SEVERITY_NOTE, SEVERITY_WARNING, SEVERITY_ERROR };
enum diag_style { DIAG_FULL, DIAG_SHORT, DIAG_JSON };

struct diag {
    struct sources *sources;
    FILE *out;                          /* stderr */
    enum diag_style style;
    bool colour;                        /* a terminal, and no NO_COLOR */
    bool quiet;                         /* warnings are counted, not shown */
    bool strict;                        /* what is not supported is an error */
    bool lint;                          /* warn of what is legal but seldom meant, too */
    unsigned most_errors;               /* then the run ends; 20 */
    unsigned most_warnings;             /* that are shown; 100 */
    unsigned errors, warnings;
    unsigned shown_errors, shown_warnings;
    struct said *said;                  /* what was shown: the same at the same place is shown once */
    size_t n_said, room_said;
    bool muted;                         /* the last message was not shown: nor are its notes */
    bool full;                          /* most_errors was reached: nothing more is shown */
    void (*context)(struct diag *d, void *arg);     /* adds notes: macro calls, includes */
    void *context_arg;
    const char **once;                  /* features that were named already */
    size_t n_once, room_once;
    int open_json;                      /* a JSON object is being written */
};

void diag_init(struct diag *d, struct sources *sources, FILE *out);

/* Columns count characters; a byte that is not UTF-8 is one, taken as Latin-1.
 *
 * A message without a final stop: "unknown word 'phnog' in finish".  After
 * an error or warning, diag_note adds the other end.  An error whose source
 * is 0 has no line: it is about the command line or the scene as a whole. */
void diag_error(struct diag *d, struct loc at, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
void diag_warning(struct diag *d, struct loc at, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
void diag_note(struct diag *d, struct loc at, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* A mistake that was said before has its effects again: it counts, and is not shown. */
void diag_repeat(struct diag *d);

/* A warning that the scene itself wants shown, as often as it says so. */
void diag_remark(struct diag *d, struct loc at, const char *text);

/* A feature that the language knows and the renderer lacks: one warning per
 * feature and run ("media is not supported yet; ignored"); with strict, an error. */
void diag_unsupported(struct diag *d, struct loc at, const char *feature);

void diag_end(struct diag *d);          /* closes the last message; before the program ends */
struct loc loc_join(struct loc first, struct loc last);

#endif
