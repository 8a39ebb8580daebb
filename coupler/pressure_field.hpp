#pragma once
// contact.vtkhdf: what the particles press on each facet of the coupled surface, at every common
// output time or at an interval of its own, on the surface as it is deformed then. ParaView opens it
// beside the structure.

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "contact/penalty_contact.hpp"
#include "coupler/joint_surface.hpp"
#include "results/field_file.hpp"

namespace undertow::coupler {

class PressureField {
 public:
    /// every [s] = output.contact_every; 0 = at the common output times.
    PressureField(const std::string& folder, const JointSurface& surface, double every = 0,
                  FileStart start = FileStart::fresh);

    /// Adds the normal forces of this step's contacts; after compute_forces().
    void count(const contact::PenaltyContact& contact);

    /// At t [s], which is a common output time or not. An interval of its own makes no step shorter: the
    /// first step that has reached a multiple of it writes.
    bool due(double t, bool common) const;

    /// Writes mean and peak since the output before, and starts anew. t [s], nodes at x [m] (N, 3).
    /// Nothing where t has been written.
    void write(double t, std::span<const double> x);
    void archive(Archive& a);

    /// [Pa] (F), of the output written last: impulse over time and area; the largest of any step.
    const std::vector<double>& mean() const { return mean_; }
    const std::vector<double>& peak() const { return peak_; }

 private:
    double every_;  // [s]
    std::vector<std::int32_t> quad_;
    std::vector<double> impulse_;     // [N s] (F) of normal forces since the last output
    std::vector<double> largest_;     // [N] (F) largest force of a step since then
    std::vector<double> force_;       // [N] (F) of this step; zero where no contact is
    std::vector<std::uint32_t> hit_;  // facets in contact
    double time_ = 0;                 // [s] since the last output
    double written_ = -1;             // [s] time of it
    std::vector<double> mean_, peak_;
    MeshFile file_;
};

}  // namespace undertow::coupler
