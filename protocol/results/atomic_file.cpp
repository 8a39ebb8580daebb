#include "results/atomic_file.hpp"

#include <cerrno>
#include <cstdio>
#include <cstring>

#include "wire/errors.hpp"

namespace undertow {

void write_file_atomically(const std::string& path, std::string_view text) {
    const std::string aside = path + ".tmp";
    std::FILE* file = std::fopen(aside.c_str(), "w");
    const bool written =
        file != nullptr && std::fwrite(text.data(), 1, text.size(), file) == text.size();
    const bool closed = file != nullptr && std::fclose(file) == 0;
    if (!written || !closed || std::rename(aside.c_str(), path.c_str()) != 0)
        throw FileError(path + " could not be written: " + std::strerror(errno) +
                         "; check that its folder exists, can be written and is not full.");
}

}  // namespace undertow
