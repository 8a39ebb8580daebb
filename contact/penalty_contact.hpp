#pragma once
// Penalty contact of particles against one surface: the part of the coupler, and of any program
// that wants it in-process. One step n:
//
//     contact.rebuild(points, x, v);       at a search, or
//     contact.update(x_p, v_p, x, v);      between searches: the active points in list order
//     ... choose dt <= contact.step_limit() ...
//     contact.compute_forces(dt);          on_particles(), on_nodes()
//     contact.settle();                    books the work of step n - 1; may run after sending
//
// Nothing is allocated between searches once the arrays have grown.

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "contact/candidates.hpp"
#include "contact/detection.hpp"
#include "contact/forces.hpp"
#include "contact/ledger.hpp"

namespace undertow {
class Archive;
}

namespace undertow::contact {

class PenaltyContact {
 public:
    static constexpr double any_dt = std::numeric_limits<double>::infinity();

    PenaltyContact(Surface surface, const LawSettings& law, DetectionRules rules = {},
                   int threads = 1);

    /// Searches the facets within radius + skin [m] of each point. x, v (N, 3) of the nodes.
    /// longest_dt [s]: no longer step is asked for, so a step_limit() above it may be anything.
    void rebuild(const Points& points, double skin, std::span<const double> x,
                 std::span<const double> v, double longest_dt = any_dt);

    /// New positions and velocities of the active points (A, 3) and of the nodes (N, 3). The arrays
    /// are borrowed until the next update or rebuild.
    void update(std::span<const double> x_active, std::span<const double> v_active,
                std::span<const double> x, std::span<const double> v, double longest_dt = any_dt);

    /// Rows of the last rebuild's points that have a candidate facet, rising.
    std::span<const std::uint32_t> active_rows() const { return candidates_.row; }
    double step_limit() const { return step_limit_; }  // [s]

    void compute_forces(double dt);  // dt [s] of the step to be taken
    void settle();

    /// Between settle() of a step and the update or rebuild of the next.
    void archive(Archive& a);

    std::span<const double> on_particles() const { return law_.on_particles(); }  // [N] (A, 3)
    std::span<const double> on_nodes() const { return law_.on_nodes(); }          // [N] (N, 3)
    const ContactList& contacts() const { return contacts_; }
    const Surface& surface() const { return surface_; }
    const InterfaceEnergy& energy() const { return ledger_.energy(); }
    double kick() const { return kick_; }  // [s] (dt^{n-1} + dt^n)/2 of this step
    const ForceLaw::StartInside& start_inside() const { return law_.start_inside(); }
    bool finite() const { return law_.finite(); }
    double momentum_residual() const { return law_.momentum_residual(); }          // [N]
    double radius(std::uint32_t active_row) const { return radius_[active_row]; }  // [m]

 private:
    Points active_points() const;
    void map_rows(const Points& points);
    void detect(double longest_dt);

    Surface surface_;
    Detector detector_;
    ForceLaw law_;
    Ledger ledger_;
    FacetCells cells_;
    CandidateList candidates_;
    ContactList contacts_, former_contacts_;

    std::span<const double> x_, v_;                  // active points at this step
    std::vector<double> x_rebuilt_, v_rebuilt_;      // copies of a rebuild's active rows
    std::vector<double> mass_, radius_, stiffness_;  // per active row
    std::vector<std::uint64_t> id_;

    // At a search: rows of the former active points among the searched ones, and back; -1 = none.
    std::vector<std::int64_t> row_now_, old_row_, slot_;
    std::vector<std::int64_t> former_row_;  // of each active particle among the former active ones
    std::vector<double> v_searched_;  // [m/s] all points of the search
    bool rebuilt_ = false, settled_ = false;

    double step_limit_ = 0, last_dt_ = 0, dt_before_ = 0, kick_ = 0;  // [s]
};

}  // namespace undertow::contact
