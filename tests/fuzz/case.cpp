// libFuzzer target: whatever a case file holds, it is read or refused with an InputError.

#include <sys/mman.h>
#include <unistd.h>

#include <cstdint>
#include <cstdlib>
#include <string>

#include "case/resolved_case.hpp"
#include "wire/errors.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static const int file = memfd_create("case.toml", 0);
    static const std::string path = "/proc/self/fd/" + std::to_string(file);
    if (ftruncate(file, 0) != 0 || pwrite(file, data, size, 0) != ssize_t(size)) std::abort();
    try {
        const undertow::ResolvedCase resolved = undertow::resolve_case(path);
        if (resolved.values.time.end <= 0) std::abort();  // the reader promised
        for (const std::string& level : resolved.levels)
            (void)undertow::resolve_case(path, {.level = level});
    } catch (const undertow::InputError&) {
    }
    return 0;
}
