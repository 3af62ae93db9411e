/* jobs.h: work shared among threads. */
#ifndef RTC_JOBS_H
#define RTC_JOBS_H

#include <stddef.h>

/* Calls job(arg, i, worker) once for each i below n, in no particular order;
 * worker is below threads and belongs to one thread at a time.  Returns when
 * all are done.  What a job does must depend on i alone. */
void jobs_run(unsigned threads, size_t n, void (*job)(void *arg, size_t i, unsigned worker),
              void *arg);

#endif
