// dummy_peer particles|surface --endpoint E --log FILE [figures] [misbehavior]
//
// The smallest participants that have an exact solution:
//   particles  `count` free particles of one mass, side by side on the z axis of motion
//   surface    one horizontal square facet of 1 m whose four nodes share the mass and, if asked,
//              hang on springs
// Both are integrated by leapfrog and print their last position and velocity:  final z = ... v =
// ... Exit codes as everywhere: 0 done, 3 peer, 130 interrupted.

#include <CLI/CLI.hpp>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <limits>
#include <string>
#include <thread>
#include <vector>

#include "wire/channel.hpp"
#include "wire/errors.hpp"
#include "wire/failure.hpp"
#include "wire/participant.hpp"

using namespace undertow;
using namespace undertow::wire;

namespace {

struct Figures {
    std::string role, endpoint, log;
    int count = 1;            // particles
    double mass = 1;          // [kg] of one particle, or of the whole facet
    double radius = 0.1;      // [m]
    double stiffness = 1e4;   // [N/m] natural contact stiffness of a particle
    double spring = 0;        // [N/m] of the whole facet against the ground, along z
    double height = 0.1;      // [m] z at the start
    double velocity = 0;      // [m/s] along z
    double load = 0;          // [N] along z, on one particle or the whole facet
    double dt = 1e-4;         // [s] offered step
    double join_timeout = 60;  // [s]
};

struct Misbehavior {
    std::int64_t die_at = -1;     // kill -9 of itself
    std::int64_t silent_at = -1;  // stops answering
    std::int64_t hang_at = -1;    // computes forever, its connection alive
    std::int64_t nan_at = -1;     // sends NaN as a position
    std::int64_t stop_at = -1;    // asks to stop, like Ctrl-C
    std::int64_t fail_at = -1;    // reports an error of its own
    std::string version;          // speaks another protocol, "2.0"
};

std::FILE* log_file = nullptr;

void say(const std::string& text) {
    for (std::FILE* file : {stderr, log_file})
        if (file) {
            std::fprintf(file, "%s\n", text.c_str());
            std::fflush(file);
        }
}

/// Masses that move along z only; x and y stay.
struct Body {
    std::vector<double> x, v;               // [m], [m/s] (N, 3)
    std::vector<double> mass;               // [kg]
    double spring = 0, rest = 0, load = 0;  // per mass: [N/m], [m], [N]

    void advance(const std::vector<double>& contact, double kick, double dt) {
        for (std::size_t i = 0; i < mass.size(); ++i) {
            double& z = x[3 * i + 2];
            v[3 * i + 2] += kick * (contact[3 * i + 2] + load - spring * (z - rest)) / mass[i];
            z += dt * v[3 * i + 2];
        }
    }
};

Body make_body(const Figures& figures) {
    Body body;
    const bool facet = figures.role == "surface";
    const int masses = facet ? 4 : figures.count;
    for (int i = 0; i < masses; ++i) {
        // Facet corners counter-clockwise from above; particles spread around the middle.
        const double x = facet ? (i == 1 || i == 2) : 0.5 + 0.01 * (i - 0.5 * (masses - 1));
        const double y = facet ? (i >= 2) : 0.5;
        body.x.insert(body.x.end(), {x, y, figures.height});
        body.v.insert(body.v.end(), {0, 0, figures.velocity});
        body.mass.push_back(facet ? figures.mass / 4 : figures.mass);
    }
    body.rest = figures.height;
    body.spring = facet ? figures.spring / 4 : 0;
    body.load = facet ? figures.load / 4 : figures.load;
    return body;
}

Mesh mesh_of(const Figures& figures, const Body& body) {
    Mesh mesh;
    mesh.mesh = figures.role == "surface" ? "plate" : "balls";
    mesh.kind = figures.role;
    mesh.groups = {mesh.mesh};
    if (figures.role == "particles") {
        mesh.radius = figures.radius;
        return mesh;
    }
    mesh.x = body.x;
    mesh.mass = body.mass;
    mesh.quad = {0, 1, 2, 3};
    mesh.group = {0};
    return mesh;
}

void misbehave(const Misbehavior& bad, std::int64_t n, Participant& link) {
    if (n == bad.die_at) std::raise(SIGKILL);
    if (n == bad.silent_at) std::this_thread::sleep_for(std::chrono::hours(1));
    if (n == bad.hang_at) {
        say("hangs");
        for (volatile bool forever = true; forever;) {
        }
    }
    if (n == bad.fail_at) {
        const std::string text = "the dummy was told to fail at step " + std::to_string(n);
        link.report_error("E_PHYSICS", text);
        throw PhysicsError(text);
    }
}

/// A HELLO of another version; the answer is printed.
int greet_with_version(const Figures& figures, const std::string& version) {
    Channel channel(Channel::End::solver, figures.endpoint, default_max_message);
    Hello hello;
    std::sscanf(version.c_str(), "%d.%d", &hello.version[0], &hello.version[1]);
    hello.name = "dummy";
    hello.role = figures.role;
    if (channel.send(hello, {}, figures.join_timeout) != Sent::yes) return exit_peer;
    Packet packet;
    for (double waited = 0; waited < figures.join_timeout; waited += channel.wait(0.2))
        if (channel.receive(packet)) {
            Message answer;
            decode(packet, answer);
            if (const auto* error = std::get_if<Error>(&answer))
                say(error->code + ": " + error->text);
            return exit_peer;
        }
    say("no answer to HELLO");
    return exit_peer;
}

/// What differs between the roles: particles answer a probe with all particles and keep the list.
struct Sender {
    const Figures& figures;
    Participant& link;
    std::vector<double> x_probe = {};  // [m] positions at the last PROBE
    std::vector<std::uint32_t> active = {};
    bool probe_due = true;

    void send(const Body& body, std::int64_t n, double t, std::uint32_t flags, bool nan) {
        const double poison = nan ? std::numeric_limits<double>::quiet_NaN() : 0;
        if (figures.role == "particles" && probe_due) {
            Probe probe;
            probe.n = n, probe.t = t, probe.dt_limit = figures.dt, probe.flags = flags;
            probe.limiter = "dummy";
            probe.work = double(n) * body.mass.size();
            probe.x = x_probe = body.x;
            probe.v = body.v;
            probe.x[0] += poison;
            probe.mass = body.mass;
            for (std::size_t i = 0; i < body.mass.size(); ++i) probe.id.push_back(i + 1);
            probe.radius.assign(body.mass.size(), figures.radius);
            probe.stiffness.assign(body.mass.size(), figures.stiffness);
            probe.phase.assign(body.mass.size(), 0);
            link.send(std::move(probe));
            return;
        }
        State state;
        state.n = n, state.t = t, state.dt_limit = figures.dt, state.flags = flags;
        state.limiter = "dummy";
        state.work = double(n) * body.mass.size();
        if (figures.role == "surface") {
            state.x = body.x;
            state.v = body.v;
        } else {
            for (std::size_t i = 2; i < body.x.size(); i += 3)
                state.reach = std::max(state.reach, std::abs(body.x[i] - x_probe[i]));
            for (std::uint32_t row : active)
                for (int axis = 0; axis < 3; ++axis) {
                    state.x.push_back(body.x[3 * row + axis]);
                    state.v.push_back(body.v[3 * row + axis]);
                }
        }
        if (!state.x.empty()) state.x[0] += poison;
        link.send(std::move(state));
    }

    /// Contact forces of the reply for every mass.
    std::vector<double> forces(const StepReply& reply, std::size_t masses) {
        if (figures.role == "surface") return reply.force->f;
        if (reply.active) active = reply.active->row;
        probe_due = reply.force->flags & force_probe;
        std::vector<double> all(3 * masses, 0);
        for (std::size_t i = 0; i < active.size(); ++i)
            for (int axis = 0; axis < 3; ++axis)
                all[3 * active[i] + axis] = reply.force->f[3 * i + axis];
        return all;
    }
};

int run(const Figures& figures, const Misbehavior& bad) {
    if (!bad.version.empty()) return greet_with_version(figures, bad.version);
    ParticipantOptions options;
    options.endpoint = figures.endpoint;
    options.name = figures.role == "surface" ? "fem" : "sph";
    options.role = figures.role;
    options.software = "dummy";
    options.join_timeout = figures.join_timeout;
    Participant link(options);
    say("joined");
    Body body = make_body(figures);
    link.announce(mesh_of(figures, body));
    if (figures.role == "particles") link.wait_surface();

    Sender sender{figures, link};
    double t = link.welcome().t0, last_dt = 0;
    for (std::int64_t n = link.welcome().first_step;; ++n) {
        misbehave(bad, n, link);
        sender.send(body, n, t, n == bad.stop_at ? std::uint32_t(state_stop) : 0, n == bad.nan_at);
        const StepReply reply = link.wait_reply();
        if (reply.finish) {
            link.say_goodbye(n);
            char text[160];
            std::snprintf(text, sizeof text, "%s at t = %.9g n = %lld\nfinal z = %.12g v = %.12g",
                          reply.finish->reason.c_str(), t, static_cast<long long>(n), body.x[2],
                          body.v[2]);
            say(text);
            return reply.finish->reason == "done" ? exit_done : exit_interrupted;
        }
        const double dt = reply.force->dt;
        body.advance(sender.forces(reply, body.mass.size()), 0.5 * (last_dt + dt), dt);
        last_dt = dt;
        t = reply.force->t1;
    }
}

}  // namespace

int main(int argc, char** argv) {
    CLI::App app{"A participant of few masses, for tests of the coupling."};
    Figures figures;
    Misbehavior bad;
    app.add_option("ROLE", figures.role)
        ->required()
        ->check(CLI::IsMember({"particles", "surface"}));
    app.add_option("--endpoint", figures.endpoint)->required();
    app.add_option("--log", figures.log);
    app.add_option("--count", figures.count);
    app.add_option("--mass", figures.mass);
    app.add_option("--radius", figures.radius);
    app.add_option("--stiffness", figures.stiffness);
    app.add_option("--spring", figures.spring);
    app.add_option("--height", figures.height);
    app.add_option("--velocity", figures.velocity);
    app.add_option("--load", figures.load);
    app.add_option("--dt", figures.dt);
    app.add_option("--join-timeout", figures.join_timeout);
    app.add_option("--die-at-step", bad.die_at);
    app.add_option("--silent-at-step", bad.silent_at);
    app.add_option("--hang-at-step", bad.hang_at);
    app.add_option("--nan-at-step", bad.nan_at);
    app.add_option("--stop-at-step", bad.stop_at);
    app.add_option("--fail-at-step", bad.fail_at);
    app.add_option("--version-spoken", bad.version);
    CLI11_PARSE(app, argc, argv);
    if (!figures.log.empty()) log_file = std::fopen(figures.log.c_str(), "w");
    try {
        return run(figures, bad);
    } catch (const InputError& error) {
        say(error.what());
        return exit_input;
    } catch (const PeerError& error) {
        say(error.code + ": " + error.what());
        return undertow::failure_of(error).exit;
    } catch (const PhysicsError& error) {
        say(error.what());
        return exit_physics;
    }
}
