#pragma once
// The XDMF sidecar: what ParaView 5.11 opens. Its items name the per-step views in the HDF5 file,
// relative to the sidecar, because hyperslab items lose fields in two of ParaView's three readers.

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace undertow {

/// name, unit, number of components of a field
using FieldLayout = std::array<std::string, 3>;

struct XdmfSeries {
    std::string hdf_name;                  // "sph.vtkhdf", in the sidecar's own folder
    std::int64_t cells = 0;                // 0 = particles
    std::vector<double> times;             // [s]
    std::vector<std::int64_t> points;      // per step
    std::vector<FieldLayout> point_fields, cell_fields;
    bool ids = false;                      // particles carry the int64 field "id"
    std::int64_t mixed_words = 0;          // cells of several kinds: length of /Views/Cells; 0 =
                                           // hexahedra alone
};

/// "/Views/00003"
std::string view_group(std::size_t step);

/// Written aside and renamed, so that a reader never sees half a file.
void write_xdmf(const std::string& path, const XdmfSeries& series);

}  // namespace undertow
