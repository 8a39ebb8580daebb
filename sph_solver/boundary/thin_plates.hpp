#pragma once
// Coupled plates thinner than the kernel's support. Two waters on both sides of one must not see
// each other: a pair whose segment crosses the plate is taken out of the neighbor lists when these
// are built, so that no sum knows of it: rates, forces, viscosity, shifting, the free surface,
// heat.
//
// A facet is of a thin plate if another one that looks the other way lies behind it, nearer than
// the support: walls that are thicker, or of which the structure shows one face only, cut nothing.
// Decided by the positions at that moment, of particles and of the surface as the coupler showed it
// last. Until lists are built anew, particles move by 0.2 dx at most. A pair whose segment passes
// beside the free edge is not cut. An image behind a plane is seen along the path that the plane
// reflects. The decision is the same for (i, j) and (j, i): momentum is conserved as ever.
//
// Near most of a plate it takes two comparisons: all its facets around a cluster lie in a slab, and
// between what is above the slab and what is below it there is the plate. Where an edge is near, or
// somebody is inside the slab, each segment is looked at facet by facet.

#include <cstdint>
#include <vector>

#include "case/case.hpp"
#include "sph_solver/boundary/mirror_planes.hpp"
#include "sph_solver/neighbors/cluster_lists.hpp"
#include "sph_solver/particles.hpp"

namespace undertow {
class Archive;
}

namespace undertow::sph {

struct Extra;

class ThinPlates {
 public:
    /// Facets (F, 4), a triangle repeats its third node; x (N, 3) [m]; support: 2h [m]; spacing
    /// [m].
    void place(const std::vector<std::int32_t>& quad, const std::vector<double>& x, double support,
               double spacing);
    bool any() const { return !thin_.empty(); }
    /// Facets of thin plates.
    std::size_t facets() const { return thin_.size(); }
    /// Facets of the surface that was placed, thin or not.
    std::size_t all_facets() const { return quad_.size() / 4; }
    void archive(Archive& a);

    /// Whether a plate is between two points [m]; the same for (a, b) and (b, a).
    bool between(const Vec3& a, const Vec3& b) const;

    /// What lists are cut from: targets are records [first, first + n), extras begin at record
    /// `fluid_count`; range [m].
    struct Scene {
        const std::vector<Packed>& records;
        const FixedPoint& fixed;
        const std::vector<Extra>& extras;
        const MirrorPlanes& mirror;
        int fluid_count;
        double range;
        int first, n;
    };
    /// Takes the pairs that a plate is between out of lists just built.
    void cut(const Scene& scene, ClusterLists& lists) const;
    /// Whether it would take any.
    bool would_cut(const Scene& scene, const ClusterLists& lists) const;

 private:
    struct Facet {
        Vec3 x[4];  // [m]
        int corners;
        bool rim;  // next to a free edge of the thin part, or to one that is not thin
    };
    struct Box {
        Vec3 lo, hi;  // [m]
    };
    void find_thin(const std::vector<double>& x);
    void fill_cells();
    std::size_t bucket_of(std::int64_t i, std::int64_t j, std::int64_t k) const;
    template <class F>
    void for_each_bucket(const Box& box, F&& f) const;
    struct Around;
    bool look_around(const Box& box, Around& around) const;
    /// [clusters], empty or by entry who does not see it; and how many pairs that are.
    struct Hidden {
        std::vector<std::vector<std::uint8_t>> of;
        std::int64_t pairs = 0;
        bool any() const { return pairs > 0; }
    };
    Hidden hidden_in(const Scene& scene, const ClusterLists& lists) const;

    std::vector<std::int32_t> quad_;
    std::vector<double> last_x_;        // as of find_thin
    double support_ = 0, spacing_ = 0;  // [m]
    std::vector<std::int32_t> thin_;    // indices of facets
    std::vector<std::uint8_t> rim_;     // [thin]
    std::vector<Facet> facet_;          // [thin], as placed last
    Box bounds_{};                      // of facet_
    double cell_ = 1;                   // [m] edge of the hashed cells
    // facets by cell: in all that its box comes near
    std::vector<std::uint32_t> start_, entry_;
    int bits_ = 0;
};

}  // namespace undertow::sph
