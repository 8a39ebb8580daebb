// A mesh as VTKHDF UnstructuredGrid: one part whose connectivity all steps share.

#include <stdexcept>

#include "results/field_file.hpp"
#include "results/vtkhdf.hpp"

namespace undertow {

namespace {

/// One kind of cells, as VTK and XDMF number it.
struct CellKind {
    std::uint8_t vtk;
    std::int64_t xdmf;
    std::size_t corners;
};
constexpr CellKind hexahedron{12, 9, 8}, tetrahedron{10, 6, 4}, quad{9, 5, 4};

/// Connectivity of all cells, as both formats want it.
struct Topology {
    std::vector<std::int64_t> connectivity, offsets{0};  // flat, for VTKHDF
    std::vector<std::uint8_t> types;
    std::vector<std::int64_t> mixed;  // kind and nodes of each cell, for XDMF

    void add(const CellKind& kind, const std::vector<std::int32_t>& nodes) {
        for (std::size_t n = 0; n < nodes.size(); ++n) {
            if (n % kind.corners == 0) {
                types.push_back(kind.vtk);
                mixed.push_back(kind.xdmf);
                offsets.push_back(offsets.back() + static_cast<std::int64_t>(kind.corners));
            }
            connectivity.push_back(nodes[n]);
            mixed.push_back(nodes[n]);
        }
    }
};

/// The connectivity goes in twice: flat for VTKHDF, and for XDMF as rows of eight of the hexahedra
/// (64 byte per cell) or, when there are other cells too, as one list of all kinds. Returns that
/// list's length, 0 without it.
std::size_t write_topology(hdf5::File& file, std::size_t nodes, const MeshCells& mesh) {
    Topology cells;
    cells.add(hexahedron, mesh.hexahedra);
    cells.add(tetrahedron, mesh.tetrahedra);
    cells.add(quad, mesh.quads);
    const bool mixed = !mesh.tetrahedra.empty() || !mesh.quads.empty();
    const std::size_t n = cells.types.size(), ids = cells.connectivity.size();
    const hsize_t chunk = vtkhdf::chunk_rows(n);
    file.create_growing("/VTKHDF/Connectivity", H5T_STD_I64LE, 0, 8 * chunk);
    file.create_growing("/VTKHDF/Offsets", H5T_STD_I64LE, 0, chunk);
    file.create_growing("/VTKHDF/Types", H5T_STD_U8LE, 0, chunk);
    file.append_rows("/VTKHDF/Connectivity", H5T_NATIVE_INT64, ids, cells.connectivity.data());
    file.append_rows("/VTKHDF/Offsets", H5T_NATIVE_INT64, n + 1, cells.offsets.data());
    file.append_rows("/VTKHDF/Types", H5T_NATIVE_UINT8, n, cells.types.data());
    if (!mesh.hexahedra.empty()) {  // also of a mixed mesh: pictures read them
        file.create_growing("/Views/Hexahedra", H5T_STD_I64LE, 8, chunk);
        file.append_rows("/Views/Hexahedra", H5T_NATIVE_INT64, mesh.hexahedra.size() / 8,
                         cells.connectivity.data());
    }
    if (mixed) {
        file.create_growing("/Views/Cells", H5T_STD_I64LE, 0, 8 * chunk);
        file.append_rows("/Views/Cells", H5T_NATIVE_INT64, cells.mixed.size(), cells.mixed.data());
    }
    for (const char* table : {"NumberOfPoints", "NumberOfCells", "NumberOfConnectivityIds"})
        file.create_growing(std::string("/VTKHDF/") + table, H5T_STD_I64LE, 0, 64);
    vtkhdf::append_numbers(file, "/VTKHDF/NumberOfPoints", {static_cast<std::int64_t>(nodes)});
    vtkhdf::append_numbers(file, "/VTKHDF/NumberOfCells", {static_cast<std::int64_t>(n)});
    vtkhdf::append_numbers(file, "/VTKHDF/NumberOfConnectivityIds",
                           {static_cast<std::int64_t>(ids)});
    return mixed ? cells.mixed.size() : 0;
}

}  // namespace

MeshFile::MeshFile(const std::string& path, std::size_t nodes, const MeshCells& cells,
                   FileStart start)
    : path_(path), nodes_(nodes), cells_(cells.count()) {
    if (start == FileStart::continued) return;
    hdf5::File file = hdf5::File::create(hdf_path());
    vtkhdf::create_root(file, "UnstructuredGrid");
    mixed_words_ = write_topology(file, nodes, cells);
    file.create_growing("/VTKHDF/Points", H5T_IEEE_F32LE, 3, vtkhdf::chunk_rows(nodes));
    file.create_growing("/VTKHDF/Steps/CellOffsets", H5T_STD_I64LE, 0, 256);
    file.create_growing("/VTKHDF/Steps/ConnectivityIdOffsets", H5T_STD_I64LE, 0, 256);
    file.close();
}

std::string MeshFile::hdf_path() const {
    return path_ + ".vtkhdf";
}
int MeshFile::steps() const {
    return static_cast<int>(times_.size());
}

void MeshFile::append(double t, std::span<const double> x, const std::vector<Field>& point_fields,
                      const std::vector<Field>& cell_fields) {
    const std::size_t step = times_.size();
    if (x.size() != 3 * nodes_) throw std::logic_error("a mesh step needs every node's position");
    hdf5::File file = hdf5::File::append(
        hdf_path(), vtkhdf::room_for_step(point_fields, nodes_, 3 * sizeof(float)) +
                        vtkhdf::room_for_step(cell_fields, cells_, 0));
    if (step == 0) {
        for (const Field& field : point_fields) {
            point_layout_.push_back(vtkhdf::layout_of(field));
            vtkhdf::create_field(file, "PointData", point_layout_.back(), nodes_);
        }
        for (const Field& field : cell_fields) {
            cell_layout_.push_back(vtkhdf::layout_of(field));
            vtkhdf::create_field(file, "CellData", cell_layout_.back(), cells_);
        }
    }
    vtkhdf::check_fields(point_fields, point_layout_, nodes_);
    vtkhdf::check_fields(cell_fields, cell_layout_, cells_);

    const hsize_t first =
        vtkhdf::append_floats(file, "/VTKHDF/Points", view_group(step) + "/Points", x, 3);
    vtkhdf::append_fields(file, "PointData", step, point_fields);
    vtkhdf::append_fields(file, "CellData", step, cell_fields);

    const std::string steps = "/VTKHDF/Steps/";
    vtkhdf::append_numbers(file, steps + "PointOffsets", {static_cast<std::int64_t>(first)});
    vtkhdf::append_numbers(file, steps + "NumberOfParts", {1});
    for (const char* table : {"PartOffsets", "CellOffsets", "ConnectivityIdOffsets"})
        vtkhdf::append_numbers(file, steps + table, {0});
    file.append_rows(steps + "Values", H5T_NATIVE_DOUBLE, 1, &t);
    file.set_attribute("/VTKHDF/Steps", "NSteps", static_cast<std::int64_t>(step + 1));
    file.close();

    times_.push_back(t);
    write_index();
}

void MeshFile::write_index() const {
    const std::string name = hdf_path().substr(hdf_path().find_last_of('/') + 1);
    write_xdmf(path_ + ".xdmf",
               {name, static_cast<std::int64_t>(cells_), times_,
                std::vector<std::int64_t>(times_.size(), static_cast<std::int64_t>(nodes_)),
                point_layout_, cell_layout_, false, static_cast<std::int64_t>(mixed_words_)});
}

}  // namespace undertow
