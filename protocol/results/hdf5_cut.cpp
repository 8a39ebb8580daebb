#include "results/hdf5_cut.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>

#include "results/hdf5.hpp"
#include "results/xdmf.hpp"
#include "wire/errors.hpp"

namespace undertow::hdf5 {

namespace {

Handle open(const std::string& path, unsigned mode) {
    const Handle access = access_without_locks();
    Handle file(H5Fopen(path.c_str(), mode, access), H5Fclose);
    if (file < 0)
        throw InputError(path +
                         " cannot be opened, so that the run cannot go on in it: it was removed, "
                         "or damaged when the run before was killed. Run the case anew.");
    return file;
}

herr_t add_table(hid_t file, const char* name, const H5O_info_t* info, void* tables) {
    if (info->type != H5O_TYPE_DATASET) return 0;
    const Handle set(H5Dopen2(file, name, H5P_DEFAULT), H5Dclose);
    const Handle space(H5Dget_space(set), H5Sclose);
    hsize_t now[2] = {0, 0}, most[2] = {0, 0};
    if (H5Sget_simple_extent_ndims(space) > 2) return 0;
    H5Sget_simple_extent_dims(space, now, most);
    if (most[0] == H5S_UNLIMITED)
        static_cast<std::vector<Table>*>(tables)->push_back({name, std::int64_t(now[0])});
    return 0;
}

std::vector<Table> tables_of(hid_t file, const std::string& path) {
    std::vector<Table> tables;
    if (H5Ovisit(file, H5_INDEX_NAME, H5_ITER_INC, add_table, &tables) < 0)
        throw InputError(path + " cannot be listed; it is damaged. Run the case anew.");
    return tables;
}

}  // namespace

std::vector<Table> growing_tables(const std::string& path) {
    std::vector<Table> tables = tables_of(open(path, H5F_ACC_RDONLY), path);
    if (const int fd = ::open(path.c_str(), O_RDONLY); fd >= 0) {
        ::fsync(fd);
        ::close(fd);
    }
    return tables;
}

void cut(const std::string& path, const std::vector<Table>& tables, std::size_t steps) {
    {
        const Handle file = open(path, H5F_ACC_RDWR);
        for (const Table& there : tables_of(file, path)) {
            const auto kept = std::find_if(tables.begin(), tables.end(),
                                           [&](const Table& t) { return t.name == there.name; });
            if (kept == tables.end()) {
                H5Ldelete(file, there.name.c_str(), H5P_DEFAULT);
                continue;
            }
            if (there.rows < kept->rows)
                throw InputError(path + ": " + there.name + " has " + std::to_string(there.rows) +
                                 " rows, it had " + std::to_string(kept->rows) +
                                 " at the checkpoint; the file is not the one of this run.");
            const Handle set(H5Dopen2(file, there.name.c_str(), H5P_DEFAULT), H5Dclose);
            const Handle space(H5Dget_space(set), H5Sclose);
            hsize_t extent[2] = {0, 0};
            H5Sget_simple_extent_dims(space, extent, nullptr);
            extent[0] = hsize_t(kept->rows);
            if (there.rows > kept->rows && H5Dset_extent(set, extent) < 0)
                throw InputError(path + ": " + there.name + " cannot be cut.");
        }
        for (std::size_t step = steps; H5Lexists(file, "/Views", H5P_DEFAULT) > 0 &&
                                       H5Lexists(file, view_group(step).c_str(), H5P_DEFAULT) > 0;
             ++step)
            H5Ldelete(file, view_group(step).c_str(), H5P_DEFAULT);
    }
    File file = File::append(path, 4096);
    file.set_attribute("/VTKHDF/Steps", "NSteps", std::int64_t(steps));
    file.close();
}

}  // namespace undertow::hdf5
