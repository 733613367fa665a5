/* Preloaded into rtapi_app: its monotonic clock runs SERVO_SPEEDUP times faster than the real one, and a sleep until a
   time on it is as much shorter. The servo thread then runs a program in a fraction of its time; its period stays. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <stdint.h>
#include <stdlib.h>
#include <time.h>

#define SECOND 1000000000LL

typedef int (*clock_function)(clockid_t, struct timespec *);
typedef int (*sleep_function)(clockid_t, int, const struct timespec *, struct timespec *);

static clock_function real_clock;
static sleep_function real_sleep;
static int64_t origin;
static double factor = 1.0;

static int64_t count(const struct timespec *time) { return time->tv_sec * SECOND + time->tv_nsec; }

static struct timespec timespec_of(int64_t nanoseconds)
{
    struct timespec time = {.tv_sec = nanoseconds / SECOND, .tv_nsec = nanoseconds % SECOND};
    return time;
}

__attribute__((constructor)) static void begin(void)
{
    const char *given = getenv("SERVO_SPEEDUP");
    struct timespec now;
    real_clock = (clock_function)dlsym(RTLD_NEXT, "clock_gettime");
    real_sleep = (sleep_function)dlsym(RTLD_NEXT, "clock_nanosleep");
    real_clock(CLOCK_MONOTONIC, &now);
    origin = count(&now);
    if (given)
        factor = atof(given);
}

int clock_gettime(clockid_t which, struct timespec *time)
{
    int failed = real_clock(which, time);
    if (!failed && which == CLOCK_MONOTONIC)
        *time = timespec_of(origin + (int64_t)((count(time) - origin) * factor));
    return failed;
}

int clock_nanosleep(clockid_t which, int flags, const struct timespec *until, struct timespec *left)
{
    struct timespec real = *until;
    if (which == CLOCK_MONOTONIC && (flags & TIMER_ABSTIME))
        real = timespec_of(origin + (int64_t)((count(until) - origin) / factor));
    else if (which == CLOCK_MONOTONIC)
        real = timespec_of((int64_t)(count(until) / factor));
    return real_sleep(which, flags, &real, left);
}
