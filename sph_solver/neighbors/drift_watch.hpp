#pragma once
// Tells how long neighbor lists hold. A list misses a pair only when two particles have come closer
// to each other by more than the skin: what counts is how far neighbors have moved RELATIVE to each
// other, not how far any one has moved. A stream, a sliding block or a falling column keep their
// lists for many steps, though each step carries them far.
//
// Space is cut into cells of width B > R + skin, R the support. Since the lists were built, all
// displacements of a cell lie in a box. Two particles whose cells touch must not have moved against
// each other by more than the skin; two whose cells do not touch stood at least B apart and may
// lose B - R. Where the whole scene has spread further than that, cells twice as wide judge: those
// that do not touch may lose 2 B - R.

#include <cstdint>
#include <vector>

#include "case/case.hpp"
#include "sph_solver/particles.hpp"

namespace undertow {
class Archive;
}

namespace undertow::sph {

class DriftWatch {
 public:
    /// A plane that gives a record to each particle nearer than some range (a mirror's image, for
    /// example): no particle without one may come nearer than R.
    struct Border {
        Vec3 point, normal;  // [m], into the fluid
    };

    /// B of the fine cells [m]; support R, skin [m].
    static double width(double support, double skin);

    /// Records as the lists were built from them, the fluid's first. range: of the borders [m].
    /// periodic: a particle may meet others across a face as soon as it has drifted by B - R.
    void start(const std::vector<Packed>& records, int fluid_count, const FixedPoint& fixed,
               double support, double skin, const std::vector<Border>& borders, double range,
               bool periodic);

    /// True if a pair within the support may be missing from the lists. The records are those of
    /// start() at later positions.
    bool worn(const std::vector<Packed>& records);
    void archive(Archive& a);

 private:
    typedef std::int32_t int4
        __attribute__((vector_size(16)));  // x, y, z and a fourth of no meaning
    struct Spread {
        int4 lo, hi;  // displacements of the members [unit]
    };
    struct Cells {                          // those that hold anything, and their neighbors
        std::vector<int> first, group;      // CSR cell -> groups of level 1, or cells of level 1
        std::vector<int> next_first, next;  // CSR cell -> cells that touch it, itself included
        std::vector<Spread> all, fluid;     // [cells]
        int size() const { return static_cast<int>(all.size()); }
        void archive(Archive& a);
    };

    static int4 load(const Packed& q);
    static Spread nothing();
    static void widen(Spread& s, const Spread& by);
    static double apart(const Spread& a, const Spread& b);  // squared [unit^2]
    void link(Cells& cells, const std::int64_t n[3]);
    void find_approaches(const std::vector<Packed>& records, const FixedPoint& fixed, double range);
    void measure(const std::vector<Packed>& records);
    bool neighbors_apart(const Cells& cells, double limit) const;

    int fluid_count_ = 0, fluid_groups_ = 0;
    bool periodic_ = false;
    double unit_ = 1, support_ = 0, skin_ = 0, width_ = 0;  // [m]
    std::vector<int4> start_;                               // [records]
    std::vector<Spread> group_;                             // eight records each, the fluid's first
    Cells fine_, coarse_;
    struct Approach {
        int cell, border;
        double room;  // [m] until a particle without a record comes nearer than R
    };
    std::vector<Approach> approach_;
    std::vector<Border> borders_;
    // scratch of start()
    std::vector<std::int64_t> key_;
    std::vector<int> count_, cell_;
    std::vector<double> room_;
    struct Place {
        std::int64_t key;
        int item;
    };
    std::vector<Place> place_;
};

}  // namespace undertow::sph
