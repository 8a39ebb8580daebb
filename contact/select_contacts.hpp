#pragma once
// Which of the facets that a particle touches act on it? The rules of detection.hpp, for one
// particle at a time: local minima of the distance, the side that the nearest of all tells, and the
// side that the particle remembers.

#include <algorithm>
#include <array>
#include <cstdint>

#include "contact/facet.hpp"
#include "contact/lanes.hpp"
#include "contact/surface.hpp"

namespace undertow::contact {

struct DetectionRules {
    double behind = 1.0;              // depth below the surface up to which it pushes out, in l0
    double same_normal = 0.70710678;  // cosine above which two contacts are one wall (45 degrees)
    double step_share = 0.25;  // a particle may approach a facet by this share of l0 per step
};

// Two feet are one point when they differ by less than this share of l0: round-off of positions.
constexpr double same_point = 1e-9;

constexpr std::uint32_t no_facet = 0xffffffffu;

/// A facet within reach of a particle.
struct Touch {
    std::uint32_t facet;
    Foot foot;
    double side;  // [m] offset along the facet's normal
    bool free_rim;
    bool wet() const { return side >= 0 || free_rim; }
};

class TouchList {
 public:
    void clear() { count_ = 0; }
    /// Of more than there is room for the nearest stay.
    void add(const Touch& touch);
    Touch* begin() { return touch_.data(); }
    Touch* end() { return touch_.data() + count_; }

 private:
    // A particle four times as large as its facets sees about 60.
    static constexpr int most_touches = 96;
    std::array<Touch, most_touches> touch_;
    int count_ = 0;
};

/// A touch that acts: sign -1 pushes back through the surface.
struct Chosen {
    const Touch* touch;
    double sign;
};
constexpr int most_contacts = 4;  // of one particle: a corner of three walls, and one to spare

/// Where a particle touched at the step before; facet no_facet = nowhere.
struct RememberedSide {
    std::uint32_t facet;
    const std::array<double, 4>& weight;
};

struct Ball {
    Vec x;
    double l0;  // [m]
};

/// Chooses the contacts of one particle among what it touches, at least one. Returns how many of
/// `chosen` were filled.
int select_contacts(const DetectionRules& rules, const Surface& surface, const Ball& particle,
                    const RememberedSide& before, TouchList& touches,
                    std::array<Chosen, most_contacts>& chosen);

/// Normal of a contact. With the center in the surface the offset has no direction left; the
/// facet's normal has.
template <typename T>
Three<T> contact_normal(const Three<T>& offset, const T& distance, const T& sign,
                        const Three<T>& plane_normal, const T& l0) {
    return select(less(same_point * l0, distance), (sign / distance) * offset, plane_normal);
}

}  // namespace undertow::contact
