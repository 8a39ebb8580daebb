#include "sph_solver/boundary/thin_plates.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <map>

#include "contact/candidates.hpp"
#include "contact/facet.hpp"
#include "contact/surface.hpp"
#include "sph_solver/neighbors/neighborhood.hpp"
#include "sph_solver/shapes/vectors.hpp"

namespace undertow::sph {

namespace {

// Two facets look opposite ways below this cosine of their normals; one is seen squarely from
// behind below it (cosine to the direction from its foot).
constexpr double opposite = -0.5;
// Facets within this many supports of each other's back are thin, so that few become so later: by
// find_again of a support nodes may move before all are looked at again.
constexpr double thin_within = 1.5, find_again = 0.25;
// All facets around a cluster within this cosine of one direction: they hide each other nowhere.
constexpr double level = 0.75;
// Of its length: round-off of a segment that meets an edge between two facets.
constexpr double on_edge = 1e-9;

/// Does ab cross the triangle p, q, r? Its edges belong to it.
bool crosses(const Vec3& a, const Vec3& b, const Vec3& p, const Vec3& q, const Vec3& r) {
    const Vec3 pa = p - a, qa = q - a, ra = r - a, d = b - a;
    const Vec3 n = cross(q - p, r - p);
    if (!(dot(n, pa) * dot(n, p - b) < 0)) return false;
    const double u = dot(d, cross(pa, qa)), v = dot(d, cross(qa, ra)), w = dot(d, cross(ra, pa));
    const double tiny = on_edge * (std::abs(u) + std::abs(v) + std::abs(w));
    return (u >= -tiny && v >= -tiny && w >= -tiny) || (u <= tiny && v <= tiny && w <= tiny);
}

/// As contact sees a facet: a quad is four triangles about its centroid.
template <class Facet>
bool crosses(const Vec3& a, const Vec3& b, const Facet& f) {
    if (f.corners == 3) return crosses(a, b, f.x[0], f.x[1], f.x[2]);
    const Vec3 center = 0.25 * (f.x[0] + f.x[1] + f.x[2] + f.x[3]);
    for (int k = 0; k < 4; ++k)
        if (crosses(a, b, f.x[k], f.x[(k + 1) % 4], center)) return true;
    return false;
}

Vec3 reflected(const Reflection& r, const Vec3& x) {
    return {r.m[0][0] * x[0] + r.m[0][1] * x[1] + r.m[0][2] * x[2] + r.t[0],
            r.m[1][0] * x[0] + r.m[1][1] * x[1] + r.m[1][2] * x[2] + r.t[1],
            r.m[2][0] * x[0] + r.m[2][1] * x[1] + r.m[2][2] * x[2] + r.t[2]};
}

Vec3 position(const ThinPlates::Scene& s, int record) {
    const Packed& q = s.records[record];
    return {s.fixed.x0 + q.x * s.fixed.unit, s.fixed.y0 + q.y * s.fixed.unit,
            s.fixed.z0 + q.z * s.fixed.unit};
}

/// The record that another one is an image of, itself if it is none. Dummies of bodies are.
int source_of(const ThinPlates::Scene& s, int record) {
    const int e = record - s.fluid_count;
    if (e < 0 || e >= static_cast<int>(s.extras.size()) || s.extras[e].from_body) return record;
    return s.extras[e].source;
}

/// Planes that a record was mirrored at. Images across a face of a period are too far from any
/// surface (see FluidSystem::place_surface) for a plate to be between.
PlaneMask mirrored_at(const ThinPlates::Scene& s, int record) {
    const int e = record - s.fluid_count;
    if (e < 0 || e >= static_cast<int>(s.extras.size()) || s.extras[e].from_body) return 0;
    return s.extras[e].mask;
}

}  // namespace

void ThinPlates::place(const std::vector<std::int32_t>& quad, const std::vector<double>& x,
                       double support, double spacing) {
    double moved2 = 0;
    const bool same = quad == quad_ && x.size() == last_x_.size() && support <= support_;
    for (std::size_t k = 0; same && k < x.size(); k += 3) {
        const Vec3 d{x[k] - last_x_[k], x[k + 1] - last_x_[k + 1], x[k + 2] - last_x_[k + 2]};
        moved2 = std::max(moved2, dot(d, d));
    }
    if (!same || std::sqrt(moved2) > find_again * support_) {
        quad_ = quad, support_ = support;
        find_thin(x);
    }
    spacing_ = spacing;
    facet_.clear();
    for (std::size_t k = 0; k < thin_.size(); ++k) {
        const std::int32_t* node = &quad_[4 * std::size_t(thin_[k])];
        Facet f{};
        for (int c = 0; c < 4; ++c)
            for (int a = 0; a < 3; ++a) f.x[c][a] = x[3 * std::size_t(node[c]) + a];
        f.corners = node[2] == node[3] ? 3 : 4;
        f.rim = rim_[k];
        facet_.push_back(f);
    }
    fill_cells();
}

/// Looks from points of each facet, no farther than a support apart, for another one's back.
void ThinPlates::find_thin(const std::vector<double>& x) {
    last_x_ = x;
    thin_.clear();
    rim_.clear();
    const std::size_t facets = quad_.size() / 4;
    if (facets == 0) return;
    contact::Surface surface(quad_, std::vector<double>(x.size() / 3, 1.0));
    const std::vector<double> at_rest(x.size(), 0.0);
    surface.move(x, at_rest);
    std::vector<double> from;
    std::vector<std::int32_t> owner;
    for (std::size_t f = 0; f < facets; ++f) {
        const contact::Corners c = surface.shape(std::uint32_t(f));
        const double along = std::max((c.x[1] - c.x[0]).norm(), (c.x[2] - c.x[3]).norm()),
                     across = std::max((c.x[3] - c.x[0]).norm(), (c.x[2] - c.x[1]).norm());
        const int n = std::max(1, int(std::ceil(along / support_))),
                  m = std::max(1, int(std::ceil(across / support_)));
        for (int i = 0; i < n; ++i)
            for (int j = 0; j < m; ++j) {
                const double u = (i + 0.5) / n, v = (j + 0.5) / m;
                const contact::Vec at =
                    (1 - u) * ((1 - v) * c.x[0] + v * c.x[3]) + u * ((1 - v) * c.x[1] + v * c.x[2]);
                from.insert(from.end(), at.data(), at.data() + 3);
                owner.push_back(static_cast<std::int32_t>(f));
            }
    }
    const std::vector<double> radius(owner.size(), thin_within * support_);
    contact::FacetCells cells;
    contact::CandidateList found;
    cells.search(
        {.x = from, .v = from, .mass = radius, .radius = radius, .stiffness = radius, .id = {}},
        surface, 0, found);
    std::vector<std::uint8_t> thin(facets, 0);
    for (std::size_t k = 0; k < found.row.size(); ++k) {
        const std::int32_t own = owner[found.row[k]];
        if (thin[own]) continue;
        const contact::Vec at = contact::Vec::Map(&from[3 * std::size_t(found.row[k])]),
                           n = surface.plane(std::uint32_t(own)).normal;
        for (std::uint32_t c = found.start[k]; c < found.start[k + 1] && !thin[own]; ++c) {
            if (surface.plane(found.facet[c]).normal.dot(n) > opposite) continue;
            const contact::Foot foot = contact::closest_point(at, surface.shape(found.facet[c]));
            if (foot.distance < thin_within * support_ &&
                foot.offset.dot(foot.normal) <= opposite * foot.distance)
                thin[own] = 1;
        }
    }
    // edges of one thin facet only
    std::map<std::pair<std::int32_t, std::int32_t>, int> edges;
    const auto for_each_edge = [&](std::size_t f, auto&& visit) {
        for (int c = 0; c < 4; ++c) {
            const std::int32_t p = quad_[4 * f + c], q = quad_[4 * f + (c + 1) % 4];
            if (p != q) visit(std::pair(std::min(p, q), std::max(p, q)));
        }
    };
    for (std::size_t f = 0; f < facets; ++f)
        if (thin[f]) for_each_edge(f, [&](auto edge) { ++edges[edge]; });
    for (std::size_t f = 0; f < facets; ++f) {
        if (!thin[f]) continue;
        std::uint8_t rim = 0;
        for_each_edge(f, [&](auto edge) { rim |= edges[edge] != 2; });
        thin_.push_back(static_cast<std::int32_t>(f));
        rim_.push_back(rim);
    }
}

std::size_t ThinPlates::bucket_of(std::int64_t i, std::int64_t j, std::int64_t k) const {
    const std::uint64_t key = std::uint64_t(i) * 0x8DA6B343C2B2AE35ull +
                              std::uint64_t(j) * 0xD8163841FDE6A8F9ull + std::uint64_t(k);
    return std::size_t((key * 0x9E3779B97F4A7C15ull) >> (64 - bits_));
}

template <class F>
void ThinPlates::for_each_bucket(const Box& box, F&& f) const {
    std::int64_t lo[3], hi[3];
    for (int a = 0; a < 3; ++a) {
        lo[a] = std::int64_t(std::floor(box.lo[a] / cell_));
        hi[a] = std::int64_t(std::floor(box.hi[a] / cell_));
    }
    for (std::int64_t i = lo[0]; i <= hi[0]; ++i)
        for (std::int64_t j = lo[1]; j <= hi[1]; ++j)
            for (std::int64_t k = lo[2]; k <= hi[2]; ++k) f(bucket_of(i, j, k));
}

void ThinPlates::fill_cells() {
    bounds_ = {{1e300, 1e300, 1e300}, {-1e300, -1e300, -1e300}};
    if (facet_.empty()) return;
    double diagonals = 0;
    for (const Facet& f : facet_) diagonals += length(f.x[2] - f.x[0]);
    cell_ = std::max(spacing_, 0.5 * diagonals / double(facet_.size()));
    // a segment is looked at in points half a cell apart: no point of it is farther than a quarter
    const double margin = 0.25 * cell_;
    bits_ = std::bit_width(4 * facet_.size()) + 2;
    start_.assign((std::size_t(1) << bits_) + 1, 0);
    const auto box_of = [&](const Facet& f) {
        Box box{f.x[0], f.x[0]};
        for (const Vec3& x : f.x)
            for (int a = 0; a < 3; ++a) {
                box.lo[a] = std::min(box.lo[a], x[a]);
                box.hi[a] = std::max(box.hi[a], x[a]);
            }
        return box;
    };
    const auto for_each_entry = [&](auto&& visit) {
        for (std::size_t f = 0; f < facet_.size(); ++f) {
            Box box = box_of(facet_[f]);
            for (int a = 0; a < 3; ++a) box.lo[a] -= margin, box.hi[a] += margin;
            for_each_bucket(box, [&](std::size_t bucket) { visit(bucket, std::uint32_t(f)); });
        }
    };
    for_each_entry([&](std::size_t bucket, std::uint32_t) { ++start_[bucket + 1]; });
    for (std::size_t b = 1; b < start_.size(); ++b) start_[b] += start_[b - 1];
    entry_.resize(start_.back());
    std::vector<std::uint32_t> at(start_.begin(), start_.end() - 1);
    for_each_entry([&](std::size_t bucket, std::uint32_t f) { entry_[at[bucket]++] = f; });
    for (const Facet& f : facet_) {
        const Box box = box_of(f);
        for (int a = 0; a < 3; ++a) {
            bounds_.lo[a] = std::min(bounds_.lo[a], box.lo[a]);
            bounds_.hi[a] = std::max(bounds_.hi[a], box.hi[a]);
        }
    }
}

bool ThinPlates::between(const Vec3& a, const Vec3& b) const {
    if (facet_.empty()) return false;
    for (int k = 0; k < 3; ++k)
        if (std::max(a[k], b[k]) < bounds_.lo[k] || std::min(a[k], b[k]) > bounds_.hi[k])
            return false;
    const Vec3 &from = a < b ? a : b, &to = a < b ? b : a;
    const Vec3 d = to - from;
    const int steps = std::max(1, int(std::ceil(length(d) / (0.5 * cell_))));
    std::size_t last = start_.size();
    for (int s = 0; s <= steps; ++s) {
        const Vec3 at = from + (double(s) / steps) * d;
        const std::size_t bucket = bucket_of(std::int64_t(std::floor(at[0] / cell_)),
                                             std::int64_t(std::floor(at[1] / cell_)),
                                             std::int64_t(std::floor(at[2] / cell_)));
        if (bucket == last) continue;
        last = bucket;
        for (std::uint32_t e = start_[bucket]; e < start_[bucket + 1]; ++e)
            if (crosses(from, to, facet_[entry_[e]])) return true;
    }
    return false;
}

/// The facets that come into a box.
struct ThinPlates::Around {
    std::vector<std::uint32_t> seen;  // [thin] the last box that a facet was found in
    std::uint32_t box = 0;
    std::vector<std::uint32_t> facets;
    bool simple = false;  // no edge, all within 40 degrees of n or -n
    Vec3 n{};
    double lo = 0, hi = 0;  // [m] along n: the slab they lie in

    /// 1 above, -1 below, 0 in the slab
    int side(const Vec3& x) const {
        const double height = dot(n, x);
        return height > hi ? 1 : height < lo ? -1 : 0;
    }
};

bool ThinPlates::look_around(const Box& box, Around& around) const {
    around.facets.clear();
    for (int a = 0; a < 3; ++a)
        if (box.hi[a] < bounds_.lo[a] || box.lo[a] > bounds_.hi[a]) return false;
    around.seen.resize(facet_.size(), 0);
    const std::uint32_t stamp = ++around.box;
    for_each_bucket(box, [&](std::size_t bucket) {
        for (std::uint32_t e = start_[bucket]; e < start_[bucket + 1]; ++e) {
            if (around.seen[entry_[e]] == stamp) continue;
            around.seen[entry_[e]] = stamp;
            around.facets.push_back(entry_[e]);
        }
    });
    if (around.facets.empty()) return false;
    const auto area = [&](std::uint32_t f) {
        const Facet& q = facet_[f];
        return cross(q.x[2] - q.x[0], q.corners == 3 ? q.x[1] - q.x[0] : q.x[3] - q.x[1]);
    };
    Vec3 sum{};
    for (const std::uint32_t f : around.facets) {
        const Vec3 n = area(f);
        sum = dot(sum, n) < 0 ? sum - n : sum + n;
    }
    around.n = (1 / length(sum)) * sum;
    around.simple = true;
    around.lo = 1e300, around.hi = -1e300;
    for (const std::uint32_t f : around.facets) {
        const Vec3 n = area(f);
        if (facet_[f].rim || std::abs(dot(n, around.n)) < level * length(n)) around.simple = false;
        for (const Vec3& x : facet_[f].x) {
            const double height = dot(around.n, x);
            around.lo = std::min(around.lo, height), around.hi = std::max(around.hi, height);
        }
    }
    return true;
}

ThinPlates::Hidden ThinPlates::hidden_in(const Scene& s, const ClusterLists& lists) const {
    const int clusters = lists.clusters();
    Hidden found{std::vector<std::vector<std::uint8_t>>(clusters)};
    std::int64_t pairs = 0;
    const std::size_t planes = std::size_t(1) << s.mirror.size();
    /// Is a plate between target i and record j, as the planes reflect the path between them?
    const auto apart = [&](int i, const Vec3& x_i, int j, const Vec3& x_j) {
        const PlaneMask mask = mirrored_at(s, j);
        if (mask == 0) return i < j ? between(x_i, x_j) : between(x_j, x_i);
        if (mask >= planes) return false;
        const int source = source_of(s, j);
        const Vec3 low = position(s, std::min(i, source)), high = position(s, std::max(i, source));
        for (PlaneMask part = mask;; part = (part - 1) & mask) {  // all subsets
            if (between(reflected(s.mirror.reflection(part), low),
                        reflected(s.mirror.reflection(mask & ~part), high)))
                return true;
            if (part == 0) return false;
        }
    };
#pragma omp parallel reduction(+ : pairs)
    {
        Around around;
        std::vector<std::uint8_t> hidden;
#pragma omp for schedule(dynamic, 32)
        for (int c = 0; c < clusters; ++c) {
            const int first = s.first + c * lanes, members = std::min(lanes, s.first + s.n - first);
            Vec3 x[lanes];
            Box box{{1e300, 1e300, 1e300}, {-1e300, -1e300, -1e300}};
            for (int k = 0; k < members; ++k) {
                x[k] = position(s, first + k);
                for (int a = 0; a < 3; ++a) {
                    box.lo[a] = std::min(box.lo[a], x[k][a] - s.range);
                    box.hi[a] = std::max(box.hi[a], x[k][a] + s.range);
                }
            }
            if (!look_around(box, around)) continue;
            int side[lanes];
            for (int k = 0; k < members; ++k) side[k] = around.side(x[k]);
            hidden.clear();
            bool any = false;
            for (const int* at = lists.begin(c); at != lists.end(c); ++at) {
                const Vec3 x_j = position(s, *at);
                const PlaneMask mask = mirrored_at(s, *at);
                int side_j = around.side(x_j);
                if (mask && side_j != around.side(position(s, source_of(s, *at)))) side_j = 0;
                std::uint8_t who = 0;
                bool all = true;  // within range
                for (int k = 0; k < members; ++k) {
                    const Vec3 d = x[k] - x_j;
                    if (!(dot(d, d) < s.range * s.range)) continue;
                    bool cut = false;
                    if (side[k] == 0 || side_j == 0 || (side[k] != side_j && !around.simple))
                        cut = apart(first + k, x[k], *at, x_j);
                    else
                        cut = side[k] != side_j;
                    if (cut)
                        who |= std::uint8_t(1u << k);
                    else
                        all = false;
                }
                pairs += std::popcount(who);
                if (who && all) who = ClusterLists::nobody;
                any |= who != 0;
                hidden.push_back(who);
            }
            if (any) found.of[c] = hidden;
        }
    }
    found.pairs = pairs;
    return found;
}

void ThinPlates::cut(const Scene& scene, ClusterLists& lists) const {
    if (!any()) return;
    const Hidden hidden = hidden_in(scene, lists);
    if (hidden.any()) lists.hide(hidden.of, hidden.pairs);
}

bool ThinPlates::would_cut(const Scene& scene, const ClusterLists& lists) const {
    return any() && hidden_in(scene, lists).any();
}

}  // namespace undertow::sph
