#pragma once
// Images behind no-slip planes as the viscous forces and the shear rate see them.
//
// The continuity equation wants images that move along the wall with their source: a reversed
// motion would make density changes out of disorder. The viscous forces of a resolved layer want
//   v' = 2 v_wall - v        [Takeda, Miyama & Sekiya 1994; on a lattice the wall is met to second
//   order]
// So records keep the free-slip motion, and what v' differs from it is added here, for those images
// only.
//
// With the force of a pair along x_ij ("strain") the image of j does not stand to i as that of i to
// j: one sees x_ij = x_i - R x_j, the other its reflection -R x_ij, while both move by -v. The two
// forces would be no transposes of each other: friction that can drive, and an implicit update
// whose matrix is not symmetric. So half of the force of such a pair acts along x_ij, half along
// y = R x_ij:
//   s [(v_ij . x) x + (v_ij . y) y]/2
// which is symmetric, dissipates for any motion, and has the stress of the other in uniform shear.

#include <array>
#include <type_traits>
#include <vector>

#include "sph_solver/boundary/mirror_planes.hpp"
#include "sph_solver/neighbors/neighborhood.hpp"
#include "sph_solver/particles.hpp"
#include "sph_solver/physics/fluid_law.hpp"

namespace undertow::sph {

/// v' = sign R(mirrored) v + wall, with R the reflection at the planes that let the fluid slip.
struct ViscousImage {
    double wall[3];  // [m/s]
    float sign;     // -1 behind a no-slip plane, 1 in the corner of two
    PlaneMask mirrored;

    ViscousImage(const MirrorPlanes& mirror, PlaneMask mask, bool resolves_walls) {
        sign = 1, mirrored = mask;
        double c[3] = {0, 0, 0};
        for (int k = 0; k < mirror.size(); ++k) {
            if (!resolves_walls || !(mask >> k & 1) || mirror.plane(k).slip != Slip::no_slip)
                continue;
            for (int a = 0; a < 3; ++a) c[a] = 2 * mirror.plane(k).velocity[a] - c[a];
            sign = -sign;
            mirrored &= ~(PlaneMask(1) << k);
        }
        for (int a = 0; a < 3; ++a) wall[a] = c[a];
    }
};

class NoSlipImages {
 public:
    /// Finds the images and the clusters that list them; after a rebuild.
    void find(const Neighborhood& neighbors, const MirrorPlanes& mirror,
              const std::vector<FluidLaw>& fluids, const Particles& particles);
    /// Their velocities; after each packing of the fluid's.
    void pack(const Neighborhood& neighbors, const MirrorPlanes& mirror);
    /// Viscoplastic fluids: the first layer, z < dx, gets the viscosity of the shear rate u/z
    /// between itself and the wall, so that its pair with its own image carries the law's stress at
    /// the wall. The summed rate is that of z = 5/8 dx: stresses at the wall 5 % too high for n =
    /// 0.23 at 40 particles across a channel. After each sum of forces.
    void take_wall_viscosity(const std::vector<FluidLaw>& fluids, const MirrorPlanes& mirror,
                             double spacing, Particles& particles) const;

    bool empty() const { return images_.empty(); }
    /// Of a cluster: records of its list that are such images, and their entries of change().
    struct Listed {
        int record, image;
        std::uint32_t hidden;  // from whom of the eight
    };
    const Listed* begin(int cluster) const { return listed_.data() + begin_[cluster]; }
    const Listed* end(int cluster) const { return listed_.data() + begin_[cluster + 1]; }
    template <class Real>
    struct Change {
        Real x, y, z;  // v' minus the record's velocity [m/s]
    };
    using Matrix = std::array<std::array<double, 3>, 3>;
    /// R of the no-slip planes of an image.
    const Matrix& reflection(int image) const { return reflection_[images_[image].held]; }
    /// Real: the precision of the sums.
    template <class Real>
    const Change<Real>& change(int image) const {
        if constexpr (std::is_same_v<Real, float>)
            return change_[image];
        else
            return exact_change_[image];
    }

 private:
    struct Image {
        int record, source;
        ViscousImage shown;
        PlaneMask held;  // its no-slip planes
        int plane;       // that plane, -1 in the corner of two
    };
    std::vector<Image> images_;
    std::vector<Matrix> reflection_;  // [masks of planes]
    template <class Real>
    void pack_as(const Neighborhood& neighbors, const MirrorPlanes& mirror,
                 std::vector<Change<Real>>& change) const;
    std::vector<Change<float>> change_;         // [images], of sums in float
    std::vector<Change<double>> exact_change_;  // of sums in double
    std::vector<int> image_of_;   // [extras], -1 = none
    std::vector<int> begin_;      // [clusters + 1]
    std::vector<Listed> listed_;
};

}  // namespace undertow::sph
