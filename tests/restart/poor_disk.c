// Preloaded into a program: a disk that is slow or full for the files whose path holds the text
// UNDERTOW_POOR_DISK.
//
//     UNDERTOW_POOR_DISK=step_000000094/sph.h5  UNDERTOW_DISK_FULL=20000   room for so many bytes
//     UNDERTOW_POOR_DISK=/checkpoints/          UNDERTOW_DISK_SLOW=0.01    each takes 10 ms more
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/types.h>
#include <time.h>
#include <unistd.h>

static int is_poor(int fd) {
    const char* which = getenv("UNDERTOW_POOR_DISK");
    char link[64], path[4096];
    if (!which) return 0;
    snprintf(link, sizeof link, "/proc/self/fd/%d", fd);
    const ssize_t length = readlink(link, path, sizeof path - 1);
    if (length < 0) return 0;
    path[length] = 0;
    return strstr(path, which) != NULL;
}

// 0, or what a write up to the byte `end` of the file fails with.
static int trouble(int fd, off_t end) {
    if (!is_poor(fd)) return 0;
    const char* text = getenv("UNDERTOW_DISK_SLOW");
    const double seconds = text ? atof(text) : 0;
    struct timespec span = {(time_t)seconds, (long)((seconds - (double)(time_t)seconds) * 1e9)};
    nanosleep(&span, NULL);
    const char* room = getenv("UNDERTOW_DISK_FULL");
    return room && end > atol(room) ? ENOSPC : 0;
}

typedef ssize_t pwrite_of(int, const void*, size_t, off_t);

static ssize_t write_at(const char* name, int fd, const void* data, size_t bytes, off_t at) {
    if ((errno = trouble(fd, at + (off_t)bytes)) != 0) return -1;
    pwrite_of* real = (pwrite_of*)dlsym(RTLD_NEXT, name);
    return real(fd, data, bytes, at);
}

ssize_t pwrite(int fd, const void* data, size_t bytes, off_t at) {
    return write_at("pwrite", fd, data, bytes, at);
}

ssize_t pwrite64(int fd, const void* data, size_t bytes, off_t at) {
    return write_at("pwrite64", fd, data, bytes, at);
}
