/* stop.h: SIGINT and SIGTERM.
 *
 * The first one lets the rows under way end, so that the picture so far is
 * written; before the first row there is nothing to keep and it ends the
 * program at once, as the second one does. */
#ifndef RTC_STOP_H
#define RTC_STOP_H

#include <signal.h>
#include <stdbool.h>

void stop_install(void);
extern const volatile sig_atomic_t *const stop_flag;    /* not 0: end soon */

/* What must be removed when the program ends at once; NULL: nothing.  The
 * text is copied. */
void stop_begin_rows(const char *temporary);
/* Between these the end is waited for, but not for ever. */
void stop_while_tracing(bool traces);
void stop_end_rows(void);
void stop_now(int status) __attribute__((noreturn));    /* removes it and ends */

#endif
