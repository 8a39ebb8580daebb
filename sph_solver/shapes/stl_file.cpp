#include "sph_solver/shapes/stl_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <fstream>
#include <map>
#include <numeric>
#include <sstream>

#include "sph_solver/shapes/vectors.hpp"
#include "wire/errors.hpp"

namespace undertow::sph {

namespace {

std::string point_text(const Vec3& x) {
    return fmt::format("({:.6g}, {:.6g}, {:.6g})", x[0], x[1], x[2]);
}

/// 80 bytes of anything, the count, then 50 bytes a facet: normal, three corners, an attribute.
bool is_binary(const std::string& bytes) {
    if (bytes.size() < 84) return false;
    std::uint32_t facets;
    std::memcpy(&facets, bytes.data() + 80, 4);
    return bytes.size() == 84 + 50 * std::size_t(facets);
}

std::vector<Vec3> corners_of_binary(const std::string& bytes) {
    std::vector<Vec3> corner;
    for (std::size_t at = 84; at + 50 <= bytes.size(); at += 50)
        for (int k = 0; k < 3; ++k) {
            float x[3];
            std::memcpy(x, bytes.data() + at + 12 * (k + 1), 12);
            corner.push_back({x[0], x[1], x[2]});
        }
    return corner;
}

std::vector<Vec3> corners_of_text(const std::string& bytes, const std::string& where) {
    std::istringstream words(bytes);
    std::vector<Vec3> corner;
    std::string word;
    bool ended = false;
    while (words >> word) {
        ended = ended || word == "endsolid";
        if (word != "vertex") continue;
        Vec3 x;
        if (!(words >> x[0] >> x[1] >> x[2]))
            throw InputError(
                fmt::format("{}: vertex {} of the ASCII STL file is not three numbers; "
                            "export it again.",
                            where, corner.size() + 1));
        corner.push_back(x);
    }
    if (!ended || corner.size() % 3 != 0)
        throw InputError(
            fmt::format("{}: the ASCII STL file ends after {} vertices without "
                        "\"endsolid\": it is cut off; export it again.",
                        where, corner.size()));
    return corner;
}

/// Index of the first of all corners that are the same point.
std::vector<std::int32_t> join(const std::vector<Vec3>& corner, double tolerance) {
    std::vector<std::int32_t> order(corner.size()), same(corner.size());
    std::iota(order.begin(), order.end(), 0);
    std::sort(order.begin(), order.end(),
              [&](int a, int b) { return corner[a][0] < corner[b][0]; });
    for (std::size_t k = 0; k < order.size(); ++k) {
        const Vec3& x = corner[order[k]];
        same[order[k]] = order[k];
        for (std::size_t j = k; j-- > 0 && x[0] - corner[order[j]][0] <= tolerance;)
            if (std::abs(x[1] - corner[order[j]][1]) <= tolerance &&
                std::abs(x[2] - corner[order[j]][2]) <= tolerance) {
                same[order[k]] = same[order[j]];
                break;
            }
    }
    return same;
}

/// Each edge is used as often one way as the other, or the surface is open or has facets turned
/// over.
void require_closed(const TriangleMesh& mesh, const std::string& where) {
    std::map<std::pair<int, int>, std::pair<int, int>> uses;  // of edge a < b: a to b, b to a
    for (const auto& f : mesh.facet)
        for (int k = 0; k < 3; ++k) {
            const int a = f[k], b = f[(k + 1) % 3];
            auto& use = uses[{std::min(a, b), std::max(a, b)}];
            ++(a < b ? use.first : use.second);
        }
    int open = 0, turned = 0;
    std::pair<int, int> open_edge, turned_edge;
    for (const auto& [edge, use] : uses) {
        if (use.first == use.second) continue;
        if ((use.first + use.second) % 2)
            ++open, open_edge = edge;
        else
            ++turned, turned_edge = edge;
    }
    const auto edge_text = [&](const std::pair<int, int>& e) {
        return point_text(mesh.vertex[e.first]) + " to " + point_text(mesh.vertex[e.second]);
    };
    if (open)
        throw InputError(fmt::format(
            "{}: the surface is open: {} of its {} edges belong to an odd number of facets, one "
            "from "
            "{} m; close it (in Blender: Mesh, Clean Up, Fill Holes) and export it again.",
            where, open, uses.size(), edge_text(open_edge)));
    if (turned)
        throw InputError(fmt::format(
            "{}: some facets are turned over: at {} of {} edges, one from {} m, neighbors disagree "
            "about outside; let your program recalculate the normals and export it again.",
            where, turned, uses.size(), edge_text(turned_edge)));
}

}  // namespace

TriangleMesh read_stl(const std::string& path, double scale, const Vec3& at,
                      const std::string& where) {
    std::ifstream file(path, std::ios::binary);
    if (!file)
        throw InputError(
            fmt::format("{}: stl = \"{}\" could not be opened; the path is relative to "
                        "the case file.",
                        where, path));
    const std::string bytes((std::istreambuf_iterator<char>(file)), {});
    const bool binary = is_binary(bytes);
    if (!binary && bytes.rfind("solid", 0) != 0)
        throw InputError(
            fmt::format("{}: \"{}\" is not an STL file, or it is cut off: it neither "
                        "begins with \"solid\" nor has {} bytes the length that its "
                        "number of facets asks for.",
                        where, path, bytes.size()));
    std::vector<Vec3> corner = binary ? corners_of_binary(bytes) : corners_of_text(bytes, where);
    if (corner.empty()) throw InputError(fmt::format("{}: \"{}\" holds no facet.", where, path));
    double size = 0;
    for (Vec3& x : corner) {
        x = at + scale * x;
        if (!std::isfinite(x[0] + x[1] + x[2]))
            throw InputError(
                fmt::format("{}: \"{}\" holds a vertex that is not finite.", where, path));
        for (int a = 0; a < 3; ++a) size = std::max(size, std::abs(x[a] - corner[0][a]));
    }
    const std::vector<std::int32_t> same = join(corner, 1e-6 * size);
    TriangleMesh mesh;
    mesh.vertex = std::move(corner);
    for (std::size_t k = 0; k + 2 < same.size(); k += 3) {
        const std::array<std::int32_t, 3> f{same[k], same[k + 1], same[k + 2]};
        const Vec3 area =
            cross(mesh.vertex[f[1]] - mesh.vertex[f[0]], mesh.vertex[f[2]] - mesh.vertex[f[0]]);
        if (f[0] == f[1] || f[1] == f[2] || f[2] == f[0]) continue;  // shrunk to a line or a point
        if (length(area) > 0) mesh.facet.push_back(f);
    }
    if (mesh.facet.empty())
        throw InputError(fmt::format("{}: all facets of \"{}\" are without area.", where, path));
    require_closed(mesh, where);
    const double volume = TriangleSurface(mesh).volume();
    if (volume <= 0)
        throw InputError(fmt::format(
            "{}: the surface is inside out: its normals point inward, it encloses {:.4g} m3; let "
            "your program flip the normals (for a tank give outward normals and inside = true).",
            where, volume));
    return mesh;
}

}  // namespace undertow::sph
