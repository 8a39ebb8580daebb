#pragma once
// The coupler's two peers: one particle solver, one surface participant. All talk to the wire is
// here.

#include <array>
#include <span>
#include <string>
#include <vector>

#include "case/case.hpp"
#include "case/time_step.hpp"
#include "wire/host.hpp"

namespace undertow {
class Archive;
}

namespace undertow::coupler {

/// Wall time the coupler stood still, by who was missing.  [s]
struct Waits {
    double for_particles = 0;  // the surface was there, the particles were not
    double for_surface = 0;
    double for_both = 0;
};

/// Where the programs of a run meet.
struct MeetingPlace {
    std::string endpoint;   // see wire::HostOptions
    std::string keys;       // folder; empty = none
    std::string record_in;  // folder of recordings; empty = none
};

class Participants {
 public:
    enum Role : std::size_t { particles = 0, surface = 1 };

    /// first_step, t0 [s]: where the run begins (again).
    Participants(const MeetingPlace& place, const Case& input, std::int64_t first_step = 0,
                 double t0 = 0);

    /// HELLO, WELCOME and MESH of both.
    void join();
    const wire::Mesh& particle_mesh() const { return meshes_[particles].front(); }
    const std::vector<wire::Mesh>& surface_meshes() const { return meshes_[surface]; }

    /// One STATE (or PROBE) of each for the next step; waits, and notes for whom.
    void receive();
    bool searching() const { return std::holds_alternative<wire::Probe>(latest_[particles]); }
    const wire::Probe& probe() const { return std::get<wire::Probe>(latest_[particles]); }
    const wire::State& particle_state() const { return std::get<wire::State>(latest_[particles]); }
    const wire::State& surface_state() const { return std::get<wire::State>(latest_[surface]); }
    const StepOffer& offer(Role role) const { return offers_[role]; }  // "sph: sound"
    double work(Role role) const;      // particle- or element-steps done so far
    double waited(Role role) const;    // [s] it has waited for the coupler so far
    bool wants_to_stop() const;        // Ctrl-C at a participant

    bool can(Role role, const std::string& capability) const {
        return host_.can(role, capability);
    }
    /// Both write their state before step n under the name `id`.
    std::array<wire::CheckpointAck, 2> write_checkpoints(std::int64_t n, const std::string& id);
    /// See wire::Host::still_busy().
    void still_busy(const std::string& doing) { host_.still_busy(doing); }
    /// The latest messages of both. Whoever asked to stop then does not ask again.
    void archive(Archive& a);

    void send_surface(wire::Surface message);
    void send_active(wire::Active message);
    /// FORCE to both, first to the one that came last: it has the most to do.
    void send_forces(const wire::Force& common, std::span<const double> on_particles,
                     std::span<const double> on_nodes);

    void finish(std::int64_t n, const std::string& reason);
    void broadcast(const std::string& code, const std::string& text) noexcept;

    const std::string& name(Role role) const { return host_.name(role); }
    const std::string& software(Role role) const { return host_.software(role); }
    const char* transport() const;  // of STATE and FORCE: "shm", "ipc", "tcp"
    const std::string& endpoint() const { return host_.endpoint(); }
    double bytes() const { return double(host_.bytes_sent()) + double(host_.bytes_received()); }
    const Waits& waits() const { return waits_; }

 private:
    void note_offer(Role role);

    wire::Host host_;
    std::vector<std::vector<wire::Mesh>> meshes_;
    std::array<wire::Message, 2> latest_;
    std::array<StepOffer, 2> offers_;                                    // of the latest messages
    std::array<wire::Message, 2> forces_{wire::Force{}, wire::Force{}};  // reused each step
    wire::Received incoming_;
    Role last_to_come_ = particles;
    Waits waits_;
};

}  // namespace undertow::coupler
