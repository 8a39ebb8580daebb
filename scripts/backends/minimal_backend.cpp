// The smallest structure: one square facet, 1 m by 1 m, of four free nodes on springs. Copy it to
// begin a backend in C++; scripts/backends/README.md says what to replace.
//
//     minimal_backend ENDPOINT

#include <csignal>
#include <cstdio>

#include "wire/errors.hpp"
#include "wire/failure.hpp"
#include "wire/participant.hpp"

namespace {

volatile std::sig_atomic_t ctrl_c = 0;

void note_ctrl_c(int) {
    ctrl_c = 1;
}

bool user_stops() {
    return ctrl_c;
}

}  // namespace

int main(int argc, char** argv) {
    using namespace undertow;
    if (argc != 2) {
        std::fprintf(stderr, "usage: minimal_backend ENDPOINT\n");
        return exit_input;
    }
    try {
        std::signal(SIGINT, note_ctrl_c);
        wire::ParticipantOptions options{argv[1], "fem", "surface", {}, "minimal_backend", 60};
        options.stop = user_stops;  // asked until the first step
        wire::Participant link(options);

        wire::Mesh mesh;
        mesh.mesh = "wall";
        mesh.kind = "surface";
        mesh.groups = {"wall"};
        mesh.x = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};  // [m], normal (0, 0, 1) to the fluid
        mesh.mass = {2, 2, 2, 2};                       // [kg]
        mesh.quad = {0, 1, 2, 3};
        mesh.group = {0};
        link.announce(mesh);

        const double stiffness = 2e4;           // [N/m] of each node's spring
        const double dt_limit = 0.9 * 2 / 100;  // [s] omega = sqrt(2e4/2) = 100 1/s
        const std::vector<double> x0 = mesh.x;
        std::vector<double> x = x0, v(12, 0.0);  // v at t - dt/2
        double t = link.welcome().t0, last_dt = 0;
        for (std::int64_t n = link.welcome().first_step;; ++n) {
            wire::State state;
            state.n = n;
            state.t = t;
            state.dt_limit = dt_limit;
            state.limiter = "spring";
            state.flags = user_stops() ? std::uint32_t(wire::state_stop) : 0;
            state.x = x;
            state.v = v;
            link.send(std::move(state));

            std::vector<double> f(12);  // [N] internal, while contact is computed
            for (std::size_t i = 0; i < 12; ++i) f[i] = -stiffness * (x[i] - x0[i]);

            const wire::StepReply reply = link.wait_reply();
            if (reply.finish) {
                link.say_goodbye(n);
                return reply.finish->reason == "done" ? exit_done : exit_interrupted;
            }
            if (!reply.force) throw PeerError("E_STATE", "this backend writes no checkpoints");
            const double dt = reply.force->dt;
            for (std::size_t i = 0; i < 12; ++i) {
                v[i] += 0.5 * (last_dt + dt) * (f[i] + reply.force->f[i]) / mesh.mass[i / 3];
                x[i] += dt * v[i];
            }
            last_dt = dt;
            t = reply.force->t1;  // never add up dt
        }
    } catch (const std::exception& error) {
        const Failure failure = failure_of(error);
        std::fprintf(stderr, "minimal_backend: %s\n", failure.text.c_str());
        return failure.exit;
    }
}
