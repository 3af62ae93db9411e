/* stop.c: SIGINT and SIGTERM.  A handler has no argument to find its state
 * by: these are the only variables of file scope in the program. */
#include "cli/stop.h"

#include <limits.h>
#include <string.h>
#include <unistd.h>

#include "base/limits.h"

/* Seconds.  Who traces looks for a stop often, but a scene's function may take for ever at
 * one point. */
enum { PATIENCE = 6 };

static volatile sig_atomic_t stopping, has_rows, has_temporary, is_tracing;
static char temporary_path[PATH_MAX];
const volatile sig_atomic_t *const stop_flag = &stopping;

void stop_now(int status)
{
    if (has_temporary)
        unlink(temporary_path);
    _exit(status);
}

static void on_signal(int number)
{
    if (number == SIGALRM || !has_rows || stopping)
        stop_now(EXIT_INTERRUPTED);
    stopping = 1;
    if (is_tracing)
        alarm(PATIENCE);
}

/* A reader that went away is a write error like any other. */
void stop_install(void)
{
    struct sigaction action = { .sa_handler = on_signal };

    sigaction(SIGINT, &action, NULL);
    sigaction(SIGTERM, &action, NULL);
    sigaction(SIGALRM, &action, NULL);
    signal(SIGPIPE, SIG_IGN);
}

void stop_begin_rows(const char *temporary)
{
    has_temporary = 0;
    if (temporary && strlen(temporary) < sizeof temporary_path) {
        strcpy(temporary_path, temporary);
        has_temporary = 1;
    }
    has_rows = 1;
}

void stop_while_tracing(bool traces)
{
    is_tracing = traces;
    if (!traces)
        alarm(0);
}

void stop_end_rows(void)
{
    has_rows = 0;
    has_temporary = 0;
}
