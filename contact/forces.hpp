#pragma once
// Contacts -> forces on particles and nodes, equal and opposite to the last bit.
//
// Each contact force is rounded to multiples of a quantum, a power of two 2^-40 of the step's
// largest contact force, and summed as 64-bit integers. Integer sums do not depend on the order:
// the result is bit-identical for any order of contacts and any number of threads, and the sum over
// all particles and nodes is exactly zero. Head-room: 2^23 contacts of the largest force on one
// node.
//
// Stiffness never rises while a particle stays in contact. k follows dt and the number of neighbors
// on a node; if it rose with a stored penetration, 1/2 k d^2 would be created out of nothing (dt
// jumping between 1 and 1/2 gives a mean restitution of 1.16). It may fall: that loses energy,
// which the ledger books as `relaxation`. So the contact's time scale is the largest dt since the particle
// touched, a smaller dt keeps k, a larger one lowers it, and no vote on dt is needed.
//
// A particle that starts inside the surface is not shot out. What it is in at the first step, if
// more than a tenth of l0, is taken off its depth, and given back at the speed 0.02 l0 sqrt(k/m_c):
// a spring that is drawn at that speed swings by 0.02 l0.

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "contact/detection.hpp"

namespace undertow {
class Archive;
}

namespace undertow::contact {

struct NormalDamping;

enum class StiffnessKind { fluid, eq11 };
enum class FrictionKind { coulomb, viscous };

struct LawSettings {
    StiffnessKind stiffness = StiffnessKind::fluid;
    double chi = 1;      // of k = chi rho c0^2 dx
    double beta = 0.25;  // share of the stability budget for stiffness, (omega dt)^2
    double eta = 0.1;    // share for normal damping, c dt/m_c; 0 = none
    FrictionKind friction = FrictionKind::coulomb;
    double mu = 0;                 // Coulomb coefficient
    double alpha = 0;              // [N s/m] viscous coefficient of Eq. 9
    bool ease_start = false;  // push who starts inside out slowly; the coupler does
    bool scale_by_valence = true;  // false: m_c as if each contact were alone (unstable; for tests)
};

class ForceLaw {
 public:
    explicit ForceLaw(const LawSettings& settings) : settings_(settings) {}

    /// Forgets or carries over what is known of each particle's contact: old_row[i] is the former
    /// row of active particle i, or -1 if it was not active.
    void renumber(std::span<const std::int64_t> old_row);

    /// Fills in stiffness and forces of the contacts, then sums them.
    void compute(const Points& active, const Surface& surface, double dt,
                 ContactList& contacts);

    /// Who started inside: number of particles, the deepest in l0 and its identity.
    struct StartInside {
        std::int64_t particles = 0;
        double deepest = 0;  // [l0]
        std::uint64_t id = 0;
    };
    const StartInside& start_inside() const { return start_inside_; }

    std::span<const double> on_particles() const { return particle_force_; }  // [N] (A, 3)
    std::span<const double> on_nodes() const { return node_force_; }          // [N] (N, 3)
    /// Active rows in contact, each once: all others have no force.
    std::span<const std::uint32_t> touching() const { return in_contact_; }
    /// Nodes of the facets in contact, each once: all others have no force.
    std::span<const std::int32_t> touched_nodes() const {
        return {touched_.data(), touched_count_};
    }
    /// What is remembered from step to step.
    void archive(Archive& a);
    double quantum() const { return quantum_; }  // [N]
    bool finite() const { return finite_; }      // no NaN, no overflow in this step
    /// [N] largest component of the sum of all forces of this step: exactly 0, or a defect.
    double momentum_residual() const;

 private:
    void make_room(std::size_t particles, std::size_t nodes);
    void find_start_inside(const Points& active, const ContactList& contacts);
    void fetch_sums(const ContactList& contacts, std::size_t p);
    void share_masses(const ContactList& contacts);
    template <typename Stiffness, typename Friction>
    void push(const Stiffness& stiffness, double dt, const NormalDamping& damping,
              const Friction& friction, const Points& active, const Surface& surface,
              ContactList& contacts);
    void sum(const ContactPack& pack, int lanes, const Three<Lanes>& force,
             const Lanes& per_quantum);
    void sum_again(const ContactList& contacts);
    void give_forces();
    void take_off_inside(const Points& active, ContactList& contacts);
    void ease_out(const Points& active, double dt, const ContactPack& pack, int lanes,
                  const Lanes& m_c);

    LawSettings settings_;
    // [N/m] of each active particle's contact so far; 0 = not in contact
    std::vector<double> memory_, next_;
    std::vector<double> inside_, next_inside_;  // [m] taken off each one's depth; empty if none
    StartInside start_inside_;
    bool started_ = false;
    std::vector<std::uint32_t> in_contact_, former_;  // active rows with an entry in memory_
    // Per node: S_a (1 = 2^40) and sum of forces [quantum], cleared as soon as they are used up.
    static constexpr std::int64_t untouched = std::numeric_limits<std::int64_t>::min();
    struct NodeSum {
        std::int64_t share = untouched;
        std::array<std::int64_t, 3> force{};
    };
    std::vector<NodeSum> node_sum_;
    // Nodes of this step and of the one before; room for all of them and one more.
    std::vector<std::int32_t> touched_, were_touched_;
    std::size_t touched_count_ = 0, were_touched_count_ = 0;
    std::vector<double> contacts_of_;                  // c_i per active particle, as node_sum_
    std::vector<std::int64_t> particle_sum_;           // [quantum], as node_sum_
    std::vector<double> particle_force_, node_force_;  // [N]
    bool rows_changed_ = true;  // since the last step: forces are of other rows
    double largest_ = 0;                               // [N] component of a contact force
    double quantum_ = 0;                               // [N]
    bool finite_ = true;
};

}  // namespace undertow::contact
