#include "results/atomic_file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>

#include "wire/errors.hpp"

namespace undertow {

namespace {

enum class Until { in_kernel, on_disk };

void write_aside(const std::string& path, std::string_view text, Until until) {
    const std::string aside = path + ".tmp";
    std::FILE* file = std::fopen(aside.c_str(), "w");
    bool written =
        file != nullptr && std::fwrite(text.data(), 1, text.size(), file) == text.size();
    if (written && until == Until::on_disk)
        written = std::fflush(file) == 0 && ::fsync(::fileno(file)) == 0;
    const bool closed = file != nullptr && std::fclose(file) == 0;
    if (!written || !closed || std::rename(aside.c_str(), path.c_str()) != 0)
        throw FileError(path + " could not be written: " + std::strerror(errno) +
                         "; check that its folder exists, can be written and is not full.");
    if (until == Until::in_kernel) return;
    const std::size_t slash = path.find_last_of('/');  // the name must be on the disk, too
    const std::string folder = slash == std::string::npos ? "." : path.substr(0, slash);
    if (const int fd = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY); fd >= 0) {
        ::fsync(fd);
        ::close(fd);
    }
}

}  // namespace

void write_file_atomically(const std::string& path, std::string_view text) {
    write_aside(path, text, Until::in_kernel);
}

void write_file_durably(const std::string& path, std::string_view text) {
    write_aside(path, text, Until::on_disk);
}

}  // namespace undertow
