/* jobs.c: work shared among threads. */
#include "base/jobs.h"

#include <pthread.h>
#include <stdatomic.h>

enum { MOST_THREADS = 256 };

struct queue {
    void (*job)(void *arg, size_t i, unsigned worker);
    void *arg;
    size_t n;
    _Atomic size_t next;
};

struct worker {
    struct queue *queue;
    unsigned number;
    pthread_t thread;
};

static void *work(void *arg)
{
    struct worker *w = arg;
    struct queue *q = w->queue;

    for (size_t i; (i = atomic_fetch_add(&q->next, 1)) < q->n;)
        q->job(q->arg, i, w->number);
    return NULL;
}

/* The caller is worker 0, so a thread that cannot be had is only slower. */
void jobs_run(unsigned threads, size_t n, void (*job)(void *arg, size_t i, unsigned worker),
              void *arg)
{
    struct queue q = { .job = job, .arg = arg, .n = n };
    struct worker worker[MOST_THREADS];
    unsigned started = 1;

    if (threads > MOST_THREADS)
        threads = MOST_THREADS;
    worker[0] = (struct worker) { .queue = &q };
    for (; started < threads && started < n; started++) {
        worker[started] = (struct worker) { .queue = &q, .number = started };
        if (pthread_create(&worker[started].thread, NULL, work, &worker[started]) != 0)
            break;
    }
    work(&worker[0]);
    for (unsigned i = 1; i < started; i++)
        pthread_join(worker[i].thread, NULL);
}
