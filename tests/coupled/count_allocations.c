// Preloaded into a program: counts what it asks of malloc, in 8 bytes at the start of the file
// UNDERTOW_ALLOCATIONS/NAME, which who watches may map or read while the program runs.
#define _GNU_SOURCE
#include <errno.h>
#include <fcntl.h>
#include <stdatomic.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <unistd.h>

extern void* __libc_malloc(size_t);
extern void* __libc_calloc(size_t, size_t);
extern void* __libc_realloc(void*, size_t);
extern void* __libc_memalign(size_t, size_t);

static _Atomic uint64_t before_the_file;
static _Atomic uint64_t* count = &before_the_file;

__attribute__((constructor)) static void open_count(void) {
    const char* folder = getenv("UNDERTOW_ALLOCATIONS");
    char path[4096];
    if (!folder) return;
    snprintf(path, sizeof path, "%s/%s", folder, program_invocation_short_name);
    const int fd = open(path, O_RDWR | O_CREAT, 0600);
    if (fd < 0 || ftruncate(fd, sizeof *count) != 0) return;
    void* memory = mmap(NULL, sizeof *count, PROT_READ | PROT_WRITE, MAP_SHARED, fd, 0);
    close(fd);
    if (memory != MAP_FAILED) count = memory;
}

void* malloc(size_t bytes) {
    atomic_fetch_add(count, 1);
    return __libc_malloc(bytes);
}

void* calloc(size_t items, size_t bytes) {
    atomic_fetch_add(count, 1);
    return __libc_calloc(items, bytes);
}

void* realloc(void* old, size_t bytes) {
    atomic_fetch_add(count, 1);
    return __libc_realloc(old, bytes);
}

void* aligned_alloc(size_t alignment, size_t bytes) {
    atomic_fetch_add(count, 1);
    return __libc_memalign(alignment, bytes);
}

int posix_memalign(void** result, size_t alignment, size_t bytes) {
    atomic_fetch_add(count, 1);
    *result = __libc_memalign(alignment, bytes);
    return *result ? 0 : ENOMEM;
}
