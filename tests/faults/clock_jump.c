// Preloaded into a program: its wall clock jumps between an hour ahead and an hour behind every 5 ms,
// as when somebody sets it, so that the shortest run meets some jumps. The monotonic clock stays what it is.
#define _GNU_SOURCE
#include <dlfcn.h>
#include <sys/time.h>
#include <time.h>

static time_t jump(time_t seconds, long fraction, long whole) {
    return seconds + (fraction % (whole / 100) < whole / 200 ? 3600 : -3600);
}

int clock_gettime(clockid_t clock, struct timespec* now) {
    static int (*real)(clockid_t, struct timespec*);
    if (!real) real = (int (*)(clockid_t, struct timespec*))dlsym(RTLD_NEXT, "clock_gettime");
    const int result = real(clock, now);
    if (clock == CLOCK_REALTIME) now->tv_sec = jump(now->tv_sec, now->tv_nsec, 1000000000);
    return result;
}

int gettimeofday(struct timeval* now, void* zone) {
    static int (*real)(struct timeval*, void*);
    if (!real) real = (int (*)(struct timeval*, void*))dlsym(RTLD_NEXT, "gettimeofday");
    const int result = real(now, zone);
    now->tv_sec = jump(now->tv_sec, now->tv_usec, 1000000);
    return result;
}

time_t time(time_t* where) {
    struct timespec now;
    clock_gettime(CLOCK_REALTIME, &now);
    if (where) *where = now.tv_sec;
    return now.tv_sec;
}
