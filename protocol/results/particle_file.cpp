// Particles as VTKHDF PolyData whose vertices are 0, 1, ... n-1. The vertex list is shared by
// successive steps and written again only when the number of particles changes.

#include <numeric>
#include <stdexcept>

#include "results/field_file.hpp"
#include "results/vtkhdf.hpp"

namespace undertow {

namespace {

const char* const topologies[4] = {"Vertices", "Lines", "Strips", "Polygons"};

void create_topologies(hdf5::File& file, std::size_t n) {
    for (const char* topology : topologies) {
        const std::string group = std::string("/VTKHDF/") + topology + "/";
        const hsize_t chunk = group == "/VTKHDF/Vertices/" ? vtkhdf::chunk_rows(n) : 64;
        file.create_growing(group + "Connectivity", H5T_STD_I64LE, 0, chunk);
        file.create_growing(group + "Offsets", H5T_STD_I64LE, 0, chunk);
        file.create_growing(group + "NumberOfCells", H5T_STD_I64LE, 0, 64);
        file.create_growing(group + "NumberOfConnectivityIds", H5T_STD_I64LE, 0, 64);
    }
    file.create_growing("/VTKHDF/NumberOfPoints", H5T_STD_I64LE, 0, 64);
    file.create_growing("/VTKHDF/Steps/CellOffsets", H5T_STD_I64LE, 4, 256);
    file.create_growing("/VTKHDF/Steps/ConnectivityIdOffsets", H5T_STD_I64LE, 4, 256);
}

/// Appends the vertices of n particles; returns where they start.
std::int64_t append_topology(hdf5::File& file, std::int64_t n) {
    std::vector<std::int64_t> counting(static_cast<std::size_t>(n) + 1);
    std::iota(counting.begin(), counting.end(), 0);
    const std::int64_t zero = 0;
    hsize_t start = 0;
    for (const char* topology : topologies) {
        const std::string group = std::string("/VTKHDF/") + topology + "/";
        const std::int64_t cells = group == "/VTKHDF/Vertices/" ? n : 0;
        const auto rows = static_cast<hsize_t>(cells);
        if (cells > 0)
            start =
                file.append_rows(group + "Connectivity", H5T_NATIVE_INT64, rows, counting.data());
        file.append_rows(group + "Offsets", H5T_NATIVE_INT64, rows + 1,
                         cells > 0 ? counting.data() : &zero);
        vtkhdf::append_numbers(file, group + "NumberOfCells", {cells});
        vtkhdf::append_numbers(file, group + "NumberOfConnectivityIds", {cells});
    }
    vtkhdf::append_numbers(file, "/VTKHDF/NumberOfPoints", {n});
    return static_cast<std::int64_t>(start);
}

}  // namespace

ParticleFile::ParticleFile(const std::string& path, FileStart start) : path_(path) {
    if (start == FileStart::continued) return;
    hdf5::File file = hdf5::File::create(hdf_path());
    vtkhdf::create_root(file, "PolyData");
    file.close();
}

std::string ParticleFile::hdf_path() const {
    return path_ + ".vtkhdf";
}
int ParticleFile::steps() const {
    return static_cast<int>(times_.size());
}

void ParticleFile::append(double t, std::span<const double> x, std::span<const std::int64_t> id,
                          const std::vector<Field>& fields) {
    const std::size_t n = id.size(), step = times_.size();
    if (x.size() != 3 * n) throw std::logic_error("a particle step needs three coordinates per id");
    // x in single, id, and the vertices' numbers and offsets
    constexpr std::size_t row_bytes = 3 * sizeof(float) + 3 * sizeof(std::int64_t);
    hdf5::File file =
        hdf5::File::append(hdf_path(), vtkhdf::room_for_step(fields, n, row_bytes));
    if (step == 0) {
        create_topologies(file, n);
        file.create_growing("/VTKHDF/Points", H5T_IEEE_F32LE, 3, vtkhdf::chunk_rows(n));
        file.create_growing("/VTKHDF/PointData/id", H5T_STD_I64LE, 0, vtkhdf::chunk_rows(n));
        file.create_growing("/VTKHDF/Steps/PointDataOffsets/id", H5T_STD_I64LE, 0, 256);
        for (const Field& field : fields) {
            layout_.push_back(vtkhdf::layout_of(field));
            vtkhdf::create_field(file, "PointData", layout_.back(), n);
        }
    }
    vtkhdf::check_fields(fields, layout_, n);
    if (step == 0 || counts_.back() != static_cast<std::int64_t>(n)) {
        part_start_ = append_topology(file, static_cast<std::int64_t>(n));
        ++parts_;
    }

    const std::string view = view_group(step);
    const hsize_t first = vtkhdf::append_floats(file, "/VTKHDF/Points", view + "/Points", x, 3);
    file.append_rows("/VTKHDF/PointData/id", H5T_NATIVE_INT64, n, id.data());
    file.create_view(view + "/PointData/id", "/VTKHDF/PointData/id", first, n);
    file.create_view(view + "/Vertices", "/VTKHDF/Vertices/Connectivity",
                     static_cast<hsize_t>(part_start_), n);
    vtkhdf::append_fields(file, "PointData", step, fields);

    const std::string steps = "/VTKHDF/Steps/";
    const auto row = static_cast<std::int64_t>(first);
    vtkhdf::append_numbers(file, steps + "PointDataOffsets/id", {row});
    vtkhdf::append_numbers(file, steps + "PartOffsets", {parts_ - 1});
    vtkhdf::append_numbers(file, steps + "NumberOfParts", {1});
    vtkhdf::append_numbers(file, steps + "PointOffsets", {row});
    vtkhdf::append_numbers(file, steps + "CellOffsets", {part_start_, 0, 0, 0});
    vtkhdf::append_numbers(file, steps + "ConnectivityIdOffsets", {part_start_, 0, 0, 0});
    file.append_rows(steps + "Values", H5T_NATIVE_DOUBLE, 1, &t);
    file.set_attribute("/VTKHDF/Steps", "NSteps", static_cast<std::int64_t>(step + 1));
    file.close();

    times_.push_back(t);
    counts_.push_back(static_cast<std::int64_t>(n));
    write_index();
}

void ParticleFile::write_index() const {
    const std::string name = hdf_path().substr(hdf_path().find_last_of('/') + 1);
    write_xdmf(path_ + ".xdmf", {name, 0, times_, counts_, layout_, {}, true});
}

}  // namespace undertow
