#pragma once
// Field output: one HDF5 file per solver in VTKHDF 2.x layout, per-step virtual datasets in the same
// file, and an XDMF sidecar that ParaView 5.11 opens. Opened, appended, flushed and closed at each
// output (default libver, never SWMR): readable while running and after kill -9. float32 on disk.

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "results/file_start.hpp"

namespace undertow {

class Archive;

/// One field of an output step. `components` is 1, 3 or 6 (xx yy zz xy yz zx).
struct Field {
    std::string name;                   // "velocity", "pressure"
    std::string unit;                   // "m/s"
    int components = 1;
    std::span<const double> values;     // n * components, row-major
};

/// Particles: points that may change in number.
class ParticleFile {
 public:
    /// `path` without extension: writes path.vtkhdf and path.xdmf; replaces what was there.
    explicit ParticleFile(const std::string& path, FileStart start = FileStart::fresh);
    /// x [m] (n, 3); ids (n). Fields must be the same set at every step.
    void append(double t, std::span<const double> x, std::span<const std::int64_t> id,
                const std::vector<Field>& fields);
    std::string hdf_path() const;
    int steps() const;
    void archive(Archive& a);  // what has been written so far

 private:
    void write_index() const;

    std::string path_;
    std::vector<double> times_;
    std::vector<std::int64_t> counts_;
    std::vector<std::array<std::string, 3>> layout_;   // name, unit, components
    std::int64_t parts_ = 0;           // topologies written; a new one when the number changes
    std::int64_t part_start_ = 0;      // where the latest one starts
};

/// Cells by their nodes in VTK's order, 8, 4 and 4 each; numbered in this order.
struct MeshCells {
    std::vector<std::int32_t> hexahedra, tetrahedra, quads;

    std::size_t count() const {
        return hexahedra.size() / 8 + tetrahedra.size() / 4 + quads.size() / 4;
    }
};

/// A mesh with fixed connectivity; positions move.
class MeshFile {
 public:
    MeshFile(const std::string& path, std::size_t nodes, const MeshCells& cells,
             FileStart start = FileStart::fresh);
    /// x [m] (nodes, 3) deformed positions.
    void append(double t, std::span<const double> x, const std::vector<Field>& point_fields,
                const std::vector<Field>& cell_fields);
    std::string hdf_path() const;
    int steps() const;
    void archive(Archive& a);  // what has been written so far

 private:
    void write_index() const;

    std::string path_;
    std::size_t nodes_, cells_;
    std::size_t mixed_words_ = 0;      // length of /Views/Cells; 0 = hexahedra alone
    std::vector<double> times_;
    std::vector<std::array<std::string, 3>> point_layout_, cell_layout_;
};

}  // namespace undertow
