#pragma once
// Everything the pair loop walks over: packed records of the fluid, then of bodies and mirror images
// ("extras"), and the cluster lists over them. Rebuilt when a pair may be missing, see DriftWatch.

#include <type_traits>
#include <vector>

#include "sph_solver/boundary/mirror_planes.hpp"
#include "sph_solver/boundary/bodies.hpp"
#include "sph_solver/boundary/thin_plates.hpp"
#include "sph_solver/neighbors/cluster_lists.hpp"
#include "sph_solver/neighbors/drift_watch.hpp"
#include "sph_solver/neighbors/marked_entries.hpp"
#include "sph_solver/neighbors/smoothing_lengths.hpp"
#include "sph_solver/particles.hpp"

namespace undertow::sph {

/// What sums over neighbors in double precision read in place of the float arrays of the same
/// names.
struct ExactShown {
    bool used = false;                 // sph.precision = "double"; else all are empty
    std::vector<ExactRecord> records;  // [records]
    std::vector<double> root_viscosity;  // [sqrt(Pa s)], [records]
    std::vector<double> smoothing;     // [m], [records]
    std::vector<double> gradient_correction;
};

/// A record beyond the fluid: a body's dummy, or the image of a particle or of a dummy.
struct Extra {
    int source;        // particle (sorted index) or dummy
    PlaneMask mask;    // planes it is mirrored at, periods it is moved by; 0 = the dummy itself
    bool from_body;
};

/// Where a particle lies, see find_free_surface.
enum class Depth : std::uint8_t {
    inside,
    near_surface,   // within 2h of one at the surface
    surface,
    loose,          // spray, jets: less than half of its neighbors
};

using FluidBits = std::uint8_t;   // bit k: fluid k

class Neighborhood {
 public:
    /// support: 2h [m], where lengths differ of the largest; skin [m]; spacing dx [m], the finest.
    Neighborhood(double support, double skin, double spacing)
        : support_(support),
          skin_(skin),
          spacing_(spacing),
          goes_(1.5 * support) {}

    /// Sorts the particles (all arrays), finds the extras, and builds all lists, without the pairs
    /// that a plate is between.
    void rebuild(Particles& particles, const Bodies& bodies, const MirrorPlanes& mirror,
                 const SmoothingLengths* sizes = nullptr, const ThinPlates* plates = nullptr);
    /// Whether plates are between pairs of the lists as they are.
    bool would_cut(const ThinPlates& plates, const MirrorPlanes& mirror) const {
        return plates.would_cut(scene(mirror, 0, fluid_count_), fluid_lists_);
    }
    /// Finds out which fluids each cluster holds and meets; to be called after a rebuild where there
    /// are several. Other clusters run as if their fluid were the only one. dummies: what they count
    /// as, for dummies of another size all fluids.
    void find_fluids(const Particles& particles, FluidBits dummies = 0);

    /// What the last rebuild found, and how far it has been worn.
    void archive(Archive& a);

    /// Whether a pair may be missing from the lists: surely not while nothing has moved by half the
    /// skin, surely where anything has moved farther than the lists look out for it; in between
    /// the records decide, which must show the present positions. reach: the most that fluid has
    /// moved, and bodies on top [m].
    enum class Wear { none, perhaps, out };
    Wear wear(double reach) const {
        if (2 * reach <= skin_) return Wear::none;
        return reach > goes_ ? Wear::out : Wear::perhaps;
    }
    bool worn() { return watch_.worn(records_); }
    double support() const { return support_; }
    double skin() const { return skin_; }
    /// For the next rebuild [m].
    void set_skin(double skin) { skin_ = skin; }

    const FixedPoint& fixed() const { return fixed_; }
    const ColumnGrid& grid() const { return grid_; }
    std::vector<Packed>& records() { return records_; }
    const std::vector<Packed>& records() const { return records_; }
    const std::vector<Extra>& extras() const { return extras_; }
    const ClusterLists& fluid_lists() const { return fluid_lists_; }
    const ClusterLists& body_lists() const { return body_lists_; }
    /// Dummies as targets of body_lists(), in that order.
    const std::vector<int>& body_targets() const { return body_targets_; }
    int fluid_count() const { return fluid_count_; }

    /// Bit k: the cluster holds fluid k; it or its list (dummies left out) holds fluid k.
    FluidBits held(int cluster) const { return fluids_[cluster].held; }
    FluidBits met(int cluster) const { return fluids_[cluster].met; }
    /// Root of the viscosity of each record [sqrt(Pa s)], [records]: pairs take means of it. Empty where
    /// no fluid is viscoplastic.
    std::vector<float>& root_viscosity() { return root_viscosity_; }
    const std::vector<float>& root_viscosity() const { return root_viscosity_; }
    /// Smoothing length of each record [m], [records]; empty where all have the same.
    std::vector<float>& smoothing() { return smoothing_; }
    const std::vector<float>& smoothing() const { return smoothing_; }
    /// Of each particle as of the last rebuild, padded to full clusters; empty where nobody asks.
    std::vector<Depth>& depth() { return depth_; }
    const std::vector<Depth>& depth() const { return depth_; }
    /// M^-1 of each cluster's particles as of the last rebuild, xx, xy, xz, yy, yz, zz of the eight,
    /// [clusters, 6, 8]; empty where nobody asks, see gradient_correction.hpp.
    std::vector<float>& gradient_correction() { return gradient_correction_; }
    const std::vector<float>& gradient_correction() const { return gradient_correction_; }
    int first_extra() const { return fluid_count_; }
    /// Entries of fluid_lists() within the support: a memory of the sums over neighbors, from a sum of
    /// rates to the sum of forces at the same positions.
    MarkedEntries& marked() const { return marked_; }
    /// Fluid or bodies have moved, or will have when they are packed next.
    void moved() { marked_.forget(); }

    /// The records' twins in double, packed next to them where `used`.
    ExactShown& exact() { return exact_; }
    const ExactShown& exact() const { return exact_; }
    /// What sums in a precision read.
    template <class Real>
    const std::vector<Record<Real>>& records_in() const {
        if constexpr (std::is_same_v<Real, float>)
            return records_;
        else
            return exact_.records;
    }
    template <class Real>
    const std::vector<Real>& root_viscosity_in() const {
        if constexpr (std::is_same_v<Real, float>)
            return root_viscosity_;
        else
            return exact_.root_viscosity;
    }
    template <class Real>
    const std::vector<Real>& smoothing_in() const {
        if constexpr (std::is_same_v<Real, float>)
            return smoothing_;
        else
            return exact_.smoothing;
    }
    template <class Real>
    const std::vector<Real>& gradient_correction_in() const {
        if constexpr (std::is_same_v<Real, float>)
            return gradient_correction_;
        else
            return exact_.gradient_correction;
    }
    /// How far away who does not see a part of a list is put while it is walked, in the unit of
    /// the records' positions, see hide().
    template <class Real>
    auto out_of_reach() const {
        const double far = 2.001 * (support_ + skin_) / unit_in<Real>();
        if constexpr (std::is_same_v<Real, float>)
            return static_cast<std::int32_t>(far);
        else
            return far;
    }
    /// Unit of the positions in records_in<Real>() [m].
    template <class Real>
    double unit_in() const {
        return std::is_same_v<Real, float> ? fixed_.unit : 1;
    }
    /// x of a point [m] minus that of a record  [m]
    Vec3 apart(const Vec3& at, const Packed& q) const {
        return {((at[0] - fixed_.x0) / fixed_.unit - q.x) * fixed_.unit,
                ((at[1] - fixed_.y0) / fixed_.unit - q.y) * fixed_.unit,
                ((at[2] - fixed_.z0) / fixed_.unit - q.z) * fixed_.unit};
    }
    static Vec3 apart(const Vec3& at, const ExactRecord& q) {
        return {at[0] - q.x, at[1] - q.y, at[2] - q.z};
    }

    /// Calls f(record index) for every record whose cell is within `range` of the point.
    template <class F>
    void for_each_near(double x, double y, double z, double range, F&& f) const {
        const double r = range + skin_;
        const int k0 = grid_.level(z - r), k1 = grid_.level(z + r);
        for (int iy = grid_.column_y(y - r); iy <= grid_.column_y(y + r); ++iy)
            for (int ix = grid_.column_x(x - r); ix <= grid_.column_x(x + r); ++ix) {
                std::int64_t c0, c1;
                grid_.range(ix, iy, k0, k1, c0, c1);
                for (int j = fluid_start_[c0]; j < fluid_start_[c1 + 1]; ++j) f(j);
                for (int j = extra_start_[c0]; j < extra_start_[c1 + 1]; ++j) f(fluid_count_ + j);
            }
    }

 private:
    void lay_out_grid(const Particles& particles, const Periodic& periodic, bool with_bodies);
    double image_range(const Periodic& periodic) const;   // [m]
    ThinPlates::Scene scene(const MirrorPlanes& mirror, int first, int n) const {
        return {records_, fixed_, extras_, mirror, fluid_count_, support_ + skin_, first, n};
    }
    void sort(Particles& particles);
    template <class T>
    void reorder(std::vector<T>& array, std::vector<T>& scratch) const;
    void find_smoothing(const Particles& particles, const SmoothingLengths& sizes);
    void find_extras(const Particles& particles, const Bodies& bodies, const MirrorPlanes& mirror);

    double support_, skin_, spacing_;   // [m]
    double goes_;                       // [m] how far anything, from one rebuild to the next
    DriftWatch watch_;
    std::vector<DriftWatch::Border> borders_;
    double lo_[3], hi_[3];              // [m] bounds of the grid
    ColumnGrid grid_;
    FixedPoint fixed_;
    int fluid_count_ = 0;
    std::vector<Extra> extras_, unsorted_extras_;
    std::vector<Packed> records_;
    std::vector<int> fluid_start_, extra_start_, order_, body_targets_;
    std::vector<std::int64_t> cell_;
    std::vector<double> scratch_;
    ExactShown exact_;
    std::vector<std::int64_t> scratch_id_;
    std::vector<std::uint8_t> scratch_byte_;
    std::vector<PlaneMask> masks_;
    ClusterLists fluid_lists_, body_lists_;
    mutable MarkedEntries marked_;
    struct ClusterFluids {
        FluidBits held, met;
    };
    std::vector<ClusterFluids> fluids_;        // [clusters]
    std::vector<FluidBits> record_fluid_;      // one bit, none for a dummy, [records]
    std::vector<float> root_viscosity_;
    std::vector<float> smoothing_, listed_;    // listed_: as lists were made for [m]
    std::vector<Depth> depth_;
    std::vector<float> gradient_correction_;
};

}  // namespace undertow::sph
