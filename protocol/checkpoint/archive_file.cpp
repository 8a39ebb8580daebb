#include "checkpoint/archive_file.hpp"

#include <fcntl.h>
#include <hdf5.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>

#include "checkpoint/sha256.hpp"
#include "results/hdf5.hpp"
#include "wire/errors.hpp"

namespace undertow {

namespace {

using hdf5::Handle;

hid_t in_memory(Archive::Number number) {
    switch (number) {
        case Archive::Number::f8:
            return H5T_NATIVE_DOUBLE;
        case Archive::Number::f4:
            return H5T_NATIVE_FLOAT;
        case Archive::Number::i8:
            return H5T_NATIVE_INT64;
        case Archive::Number::i4:
            return H5T_NATIVE_INT32;
        case Archive::Number::u8:
            return H5T_NATIVE_UINT64;
        case Archive::Number::u4:
            return H5T_NATIVE_UINT32;
        case Archive::Number::i1:
            return H5T_NATIVE_INT8;
        case Archive::Number::u1:
            break;
    }
    return H5T_NATIVE_UINT8;
}

Handle access() {
    Handle list = hdf5::access_without_locks();
    H5Pset_fclose_degree(list, H5F_CLOSE_STRONG);
    return list;
}

std::string name_of(const std::string& path) {
    return path.substr(path.find_last_of('/') + 1);
}

std::string folder_of(const std::string& path) {
    const std::size_t slash = path.find_last_of('/');
    return slash == std::string::npos ? "." : path.substr(0, slash);
}

constexpr std::size_t piece = 32 << 20;  // [byte] written between two beats
constexpr int tables_at_once = 16;

/// On the disk, piece by piece: one fsync() of all could take longer than others wait.
bool sync_in_pieces(int fd, off_t size, const Pulse& pulse) {
    for (off_t at = 0; at < size; at += off_t(piece)) {
        const bool refused = ::sync_file_range(fd, at, off_t(piece),
                                               SYNC_FILE_RANGE_WAIT_BEFORE | SYNC_FILE_RANGE_WRITE |
                                                   SYNC_FILE_RANGE_WAIT_AFTER) != 0;
        // elsewhere than on a disk of this machine there is no such call: fsync() alone decides
        if (refused && errno != ENOSYS && errno != EINVAL && errno != ESPIPE) return false;
        if (pulse) pulse();
    }
    return ::fsync(fd) == 0;
}

/// The name, too, must be on the disk.
bool sync_folder(const std::string& folder) {
    const int fd = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY);
    if (fd < 0) return false;
    const bool synced = ::fsync(fd) == 0;
    ::close(fd);
    return synced;
}

}  // namespace

struct ArchiveWriter::Impl {
    std::string path, aside;
    hid_t file = -1;
    Pulse pulse;
    int stored = 0;
};

ArchiveWriter::ArchiveWriter(const std::string& path, Pulse pulse)
    : impl_(std::make_unique<Impl>()) {
    impl_->path = path;
    impl_->pulse = std::move(pulse);
    impl_->aside = path + ".tmp";
    const Handle list = access();
    impl_->file = H5Fcreate(impl_->aside.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, list);
    if (impl_->file < 0) fail("could not be created");
}

ArchiveWriter::~ArchiveWriter() {
    if (impl_->file >= 0) H5Fclose(impl_->file);
    if (!impl_->aside.empty()) ::unlink(impl_->aside.c_str());
}

void ArchiveWriter::fail(const std::string& what) const {
    const std::string why = errno ? std::string(": ") + std::strerror(errno) : "";
    throw std::runtime_error("E_IO: the checkpoint " + impl_->path + " " + what + why +
                             "; the sets before it are whole. Make room, or see that its folder "
                             "can be written, and resume from the last one.");
}

void ArchiveWriter::beat() const {
    if (impl_->pulse) impl_->pulse();
}

void ArchiveWriter::reject(const std::string& path, std::size_t, std::size_t) {
    throw std::logic_error(path + " is only written");
}

void ArchiveWriter::store(const std::string& path, Number number, std::size_t rows,
                          std::size_t columns, const void* values) {
    const hsize_t extent[2] = {rows, columns};
    const Handle space(H5Screate_simple(columns == 1 ? 1 : 2, extent, nullptr), H5Sclose);
    const Handle links(H5Pcreate(H5P_LINK_CREATE), H5Pclose);
    H5Pset_create_intermediate_group(links, 1);
    const hid_t type = in_memory(number);
    errno = 0;
    const Handle set(
        H5Dcreate2(impl_->file, path.c_str(), type, space, links, H5P_DEFAULT, H5P_DEFAULT),
        H5Dclose);
    if (set < 0) {
        if (errno == 0 && H5Lexists(impl_->file, path.c_str(), H5P_DEFAULT) > 0)
            throw std::logic_error("checkpoint: " + path + " is archived twice");
        fail("could not be written");
    }
    const std::size_t row_bytes = columns * H5Tget_size(type);
    const std::size_t rows_at_once = std::max<std::size_t>(1, piece / row_bytes);
    for (std::size_t first = 0; first < rows; first += rows_at_once) {
        const hsize_t start[2] = {first, 0};
        const hsize_t count[2] = {std::min(rows_at_once, rows - first), columns};
        const Handle part(H5Screate_simple(columns == 1 ? 1 : 2, count, nullptr), H5Sclose);
        H5Sselect_hyperslab(space, H5S_SELECT_SET, start, nullptr, count, nullptr);
        const auto* from = static_cast<const char*>(values) + first * row_bytes;
        if (H5Dwrite(set, type, part, space, H5P_DEFAULT, from) < 0) fail("could not be written");
        beat();
    }
    // HDF5's own tables as well: at the end, all of them would be one long write
    if (++impl_->stored % tables_at_once != 0) return;
    if (H5Fflush(impl_->file, H5F_SCOPE_LOCAL) < 0) fail("could not be written");
    beat();
}

WrittenFile ArchiveWriter::commit() {
    errno = 0;
    const bool flushed = H5Fflush(impl_->file, H5F_SCOPE_LOCAL) >= 0;
    const int why = errno;
    beat();
    const bool closed = H5Fclose(impl_->file) >= 0;
    impl_->file = -1;
    if (!flushed || !closed) {
        if (why) errno = why;
        fail("could not be written");
    }
    WrittenFile written;
    written.name = name_of(impl_->path);
    const int fd = ::open(impl_->aside.c_str(), O_RDONLY);
    struct stat status {};
    if (fd >= 0) ::fstat(fd, &status);
    const bool synced = fd >= 0 && sync_in_pieces(fd, status.st_size, impl_->pulse);
    if (fd >= 0) ::close(fd);
    if (!synced) fail("could not be written to the disk");
    written.bytes = status.st_size;
    written.sha = sha256_of_file(impl_->aside, impl_->pulse);
    if (std::rename(impl_->aside.c_str(), impl_->path.c_str()) != 0) fail("could not be renamed");
    impl_->aside.clear();
    if (!sync_folder(folder_of(impl_->path))) fail("could not be written to the disk");
    return written;
}

struct ArchiveReader::Impl {
    std::string path;
    Handle file;
    std::string last;  // dataset found last
    Handle set;
};

ArchiveReader::ArchiveReader(const std::string& path) : impl_(std::make_unique<Impl>()) {
    impl_->path = path;
    const Handle list = access();
    impl_->file = Handle(H5Fopen(path.c_str(), H5F_ACC_RDONLY, list), H5Fclose);
    if (impl_->file < 0)
        throw InputError(path + " cannot be read as a checkpoint; resume from another set.");
}

ArchiveReader::~ArchiveReader() {
    impl_->set = Handle();  // before the file
}

std::size_t ArchiveReader::find(const std::string& path, Number, std::size_t columns) {
    if (impl_->last != path) {
        impl_->set = Handle(H5Dopen2(impl_->file, path.c_str(), H5P_DEFAULT), H5Dclose);
        if (impl_->set < 0)
            throw InputError(impl_->path + " lacks " + path +
                             ": it was written by another version of this program, or by another "
                             "case; resume with the version that wrote it.");
        impl_->last = path;
    }
    const Handle space(H5Dget_space(impl_->set), H5Sclose);
    hsize_t extent[2] = {0, 1};
    const int rank = H5Sget_simple_extent_dims(space, extent, nullptr);
    if (rank != (columns == 1 ? 1 : 2) || extent[1] != columns)
        reject(path, rank == 1 ? 1 : std::size_t(extent[1]), columns);
    return std::size_t(extent[0]);
}

void ArchiveReader::fetch(const std::string& path, Number number, std::size_t rows,
                          std::size_t columns, void* values) {
    if (const std::size_t stored = find(path, number, columns); stored != rows)
        reject(path, stored, rows);
    if (rows > 0 &&
        H5Dread(impl_->set, in_memory(number), H5S_ALL, H5S_ALL, H5P_DEFAULT, values) < 0)
        throw InputError(impl_->path + ": " + path + " cannot be read; the file is damaged.");
}

void ArchiveReader::reject(const std::string& path, std::size_t stored, std::size_t expected) {
    throw InputError(impl_->path + ": " + path + " has " + std::to_string(stored) +
                     " values where this case and this version of the program have " +
                     std::to_string(expected) +
                     "; resume with the case and the version that "
                     "wrote it.");
}

}  // namespace undertow
