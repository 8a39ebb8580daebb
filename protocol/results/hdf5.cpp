#include "results/hdf5.hpp"

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>

#include "wire/errors.hpp"

namespace undertow::hdf5 {

namespace {

/// Sets blocks aside behind the end of the file, which HDF5 then grows into. Returns errno, or 0.
int set_aside(const std::string& path, std::uint64_t room) {
    const int file = open(path.c_str(), O_WRONLY | O_CLOEXEC);
    if (file < 0) return errno;
    struct stat status {};
    struct rlimit limit {};
    int error = 0;
    if (fstat(file, &status) != 0 || getrlimit(RLIMIT_FSIZE, &limit) != 0)
        error = errno;
    else if (limit.rlim_cur != RLIM_INFINITY && status.st_size + room > limit.rlim_cur)
        error = EFBIG;  // a limit of the shell: ulimit -f
    else if (fallocate(file, FALLOC_FL_KEEP_SIZE, status.st_size, static_cast<off_t>(room)) != 0)
        error = errno == EOPNOTSUPP || errno == ENOSYS ? 0 : errno;  // some file systems cannot
    close(file);
    return error;
}

}  // namespace

Handle access_without_locks() {
    H5dont_atexit();
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);  // ours is one sentence
    Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
    H5Pset_file_locking(access, false, true);
    return access;
}

File::File(std::string path, hid_t id) : path_(std::move(path)), id_(id, H5Fclose) {
    if (id < 0) fail("cannot be opened for writing");
}

File File::create(const std::string& path) {
    const Handle access = access_without_locks();
    // A new file, not a truncated one: whoever still reads the old file keeps it.
    std::error_code ignored;
    std::filesystem::remove(path, ignored);
    return File(path, H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access));
}

File File::append(const std::string& path, std::uint64_t room) {
    const Handle access = access_without_locks();
    if (const int error = set_aside(path, room))
        throw FileError(path + ": there is no room for the " + std::to_string(room / 1024) +
                        " kB of the next output (" + std::strerror(error) +
                        "); check that the disk is not full. The outputs before are whole.");
    return File(path, H5Fopen(path.c_str(), H5F_ACC_RDWR, access));
}

void File::close() {
    const bool flushed = H5Fflush(id_, H5F_SCOPE_LOCAL) >= 0;
    id_ = Handle();
    if (!flushed) fail("could not be flushed");
}

void File::fail(const std::string& what) const {
    throw FileError(path_ + ": " + what +
                    "; check that its folder can be written and that the disk is not full.");
}

Handle File::own(hid_t id, herr_t (*close)(hid_t), const std::string& what) const {
    if (id < 0) fail(what + " could not be created or opened");
    return Handle(id, close);
}

void File::create_group(const std::string& name) {
    own(H5Gcreate2(id_, name.c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Gclose, name);
}

void File::set_attribute(const std::string& object, const char* name, std::int64_t value) {
    const Handle owner = own(H5Oopen(id_, object.c_str(), H5P_DEFAULT), H5Oclose, object);
    const Handle space = own(H5Screate(H5S_SCALAR), H5Sclose, name);
    const Handle attribute =
        H5Aexists(owner, name) > 0
            ? own(H5Aopen(owner, name, H5P_DEFAULT), H5Aclose, name)
            : own(H5Acreate2(owner, name, H5T_STD_I64LE, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose,
                  name);
    if (H5Awrite(attribute, H5T_NATIVE_INT64, &value) < 0) fail(object + " could not be written");
}

void File::set_attribute(const std::string& object, const char* name,
                         std::vector<std::int64_t> values) {
    const Handle owner = own(H5Oopen(id_, object.c_str(), H5P_DEFAULT), H5Oclose, object);
    const hsize_t count = values.size();
    const Handle space = own(H5Screate_simple(1, &count, nullptr), H5Sclose, name);
    const Handle attribute = own(
        H5Acreate2(owner, name, H5T_STD_I64LE, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose, name);
    if (H5Awrite(attribute, H5T_NATIVE_INT64, values.data()) < 0)
        fail(object + " could not be written");
}

void File::set_attribute(const std::string& object, const char* name, std::string_view text) {
    const Handle owner = own(H5Oopen(id_, object.c_str(), H5P_DEFAULT), H5Oclose, object);
    // VTK reads "Type" as a fixed-length ASCII string without a terminating zero.
    const Handle type = own(H5Tcopy(H5T_C_S1), H5Tclose, name);
    H5Tset_size(type, text.empty() ? 1 : text.size());
    H5Tset_strpad(type, H5T_STR_NULLPAD);
    const Handle space = own(H5Screate(H5S_SCALAR), H5Sclose, name);
    const Handle attribute =
        own(H5Acreate2(owner, name, type, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose, name);
    if (H5Awrite(attribute, type, text.empty() ? "" : text.data()) < 0)
        fail(object + " could not be written");
}

void File::create_growing(const std::string& name, hid_t type, hsize_t columns, hsize_t chunk) {
    const int rank = columns > 0 ? 2 : 1;
    const std::array<hsize_t, 2> now{0, columns}, most{H5S_UNLIMITED, columns};
    const std::array<hsize_t, 2> block{chunk, columns};
    const Handle space = own(H5Screate_simple(rank, now.data(), most.data()), H5Sclose, name);
    const Handle layout = own(H5Pcreate(H5P_DATASET_CREATE), H5Pclose, name);
    H5Pset_chunk(layout, rank, block.data());
    const Handle links = own(H5Pcreate(H5P_LINK_CREATE), H5Pclose, name);
    H5Pset_create_intermediate_group(links, 1);
    own(H5Dcreate2(id_, name.c_str(), type, space, links, layout, H5P_DEFAULT), H5Dclose, name);
}

hsize_t File::append_rows(const std::string& name, hid_t type, hsize_t rows, const void* data) {
    const Handle dataset = own(H5Dopen2(id_, name.c_str(), H5P_DEFAULT), H5Dclose, name);
    std::array<hsize_t, 2> extent{};
    int rank = 0;
    {
        const Handle space = own(H5Dget_space(dataset), H5Sclose, name);
        rank = H5Sget_simple_extent_dims(space, extent.data(), nullptr);
    }
    const hsize_t first = extent[0];
    if (rows == 0) return first;
    const std::array<hsize_t, 2> start{first, 0}, count{rows, extent[1]};
    extent[0] += rows;
    if (H5Dset_extent(dataset, extent.data()) < 0) fail(name + " could not grow");
    const Handle file_space = own(H5Dget_space(dataset), H5Sclose, name);
    H5Sselect_hyperslab(file_space, H5S_SELECT_SET, start.data(), nullptr, count.data(), nullptr);
    const Handle memory_space = own(H5Screate_simple(rank, count.data(), nullptr), H5Sclose, name);
    if (H5Dwrite(dataset, type, memory_space, file_space, H5P_DEFAULT, data) < 0)
        fail(name + " could not be written");
    return first;
}

void File::create_view(const std::string& name, const std::string& source, hsize_t first,
                       hsize_t rows) {
    const Handle dataset = own(H5Dopen2(id_, source.c_str(), H5P_DEFAULT), H5Dclose, source);
    const Handle type = own(H5Dget_type(dataset), H5Tclose, source);
    const Handle source_space = own(H5Dget_space(dataset), H5Sclose, source);
    std::array<hsize_t, 2> extent{};
    const int rank = H5Sget_simple_extent_dims(source_space, extent.data(), nullptr);
    const std::array<hsize_t, 2> start{first, 0}, count{rows, extent[1]};
    const Handle space = own(H5Screate_simple(rank, count.data(), nullptr), H5Sclose, name);
    const Handle layout = own(H5Pcreate(H5P_DATASET_CREATE), H5Pclose, name);
    if (rows > 0) {
        H5Sselect_hyperslab(source_space, H5S_SELECT_SET, start.data(), nullptr, count.data(),
                            nullptr);
        if (H5Pset_virtual(layout, space, ".", source.c_str(), source_space) < 0)
            fail(name + " could not be mapped");
    }
    const Handle links = own(H5Pcreate(H5P_LINK_CREATE), H5Pclose, name);
    H5Pset_create_intermediate_group(links, 1);
    own(H5Dcreate2(id_, name.c_str(), type, space, links, layout, H5P_DEFAULT), H5Dclose, name);
}

}  // namespace undertow::hdf5
