#pragma once
// Rigid bodies (gates, piles, tanks, wave makers) as dummy particles, at rest or moving. A dummy
// carries the pressure of the fluid next to it, see body_fluid.hpp.

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include "case/case.hpp"
#include "sph_solver/boundary/periodic.hpp"
#include "sph_solver/boundary/rigid_motion.hpp"
#include "sph_solver/shapes/solid.hpp"

namespace undertow {
class Archive;
}

namespace undertow::sph {

/// One [[sph.body]]: its shape and its motion.
class RigidBody {
 public:
    RigidBody(const Body& body, const Case& input);

    /// As seen from the fluid's side: distance < 0 inside the rigid material, `away` points into
    /// the fluid. x in the body's place at rest [m].
    FromSurface at_rest(const Vec3& x) const;
    /// The same for a point in space where the body is now; along periodic axes it repeats itself.
    FromSurface now(const Vec3& x, const Periodic& periodic) const;

    void move_to(double t) { pose_ = motion_(t); }

    const Body& body() const { return body_; }
    const Pose& pose() const { return pose_; }
    bool moves() const { return motion_.moves(); }
    /// Holds the shape at rest [m].
    const Box& bounds() const { return solid_.bounds(); }
    const TriangleSurface* surface() const { return solid_.surface(); }

 private:
    Body body_;
    Solid solid_;
    RigidMotion motion_;
    Pose pose_;
};

struct Bodies {
    std::vector<double> x, y, z;      // position now [m], [dummies]
    std::vector<Vec3> at_rest;        // position at rest [m], [dummies]
    std::vector<Vec3> periods;        // what put it back into a periodic domain [m], or empty
    std::vector<double> vx, vy, vz;   // what the pair loop sees [m/s], [dummies]
    std::vector<double> p;            // extrapolated pressure [Pa], [dummies]
    std::vector<double> share;        // of the lattice's cell that is solid, [dummies]
    std::vector<double> viscosity;    // of the fluid next to it [Pa s], [dummies]
    std::vector<std::uint8_t> fluid;  // the fluid that is most of what is near, [dummies]
    std::vector<int> owner;           // its body, [dummies]
    std::vector<RigidBody> body;

    int size() const { return static_cast<int>(x.size()); }
    int dummies_of(int k) const {
        return static_cast<int>(std::count(owner.begin(), owner.end(), k));
    }
    int count() const { return static_cast<int>(body.size()); }

    void archive(Archive& a);
    /// Moves all dummies to time t.
    void move_to(double t);
    /// A body that moves along a periodic axis comes in again on the other side, dummy by dummy.
    void wrap(const Periodic& periodic);
    /// Largest speed of any dummy now [m/s]; a constant velocity counts before and after its time.
    double fastest() const { return fastest_; }

 private:
    void find_fastest();
    double fastest_ = 0;
    double moved_to_ = -1;  // [s]

    friend Bodies make_bodies(const Case& input);
};

/// Dummies of all bodies at t = 0, as deep as a kernel reaches (2h) and no deeper. A box has a
/// lattice of its own, which starts half a spacing inside its faces. Other shapes have that of the
/// first fill; a cell that the surface cuts counts with its solid share and stands in that share's
/// middle, so that the walls' volume is right wherever the surface runs. In 2D one layer in y.
/// InputError: a shape cannot be read, or no dummy fits into it.
Bodies make_bodies(const Case& input);

}  // namespace undertow::sph
