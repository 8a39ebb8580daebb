// The life cycle as a table: what is legal when, for both sides and both roles.

#include "wire/session.hpp"

#include <catch2/catch.hpp>
#include <set>

#include "peers.hpp"
#include "wire/codec.hpp"
#include "wire/errors.hpp"

using namespace undertow;
using namespace undertow::wire;

namespace {

constexpr std::uint64_t id = 99;

Message stamped(Message message) {
    set_session(message, id);
    return message;
}

Message welcome() {
    Welcome message;
    message.session = id;
    message.first_step = 5;
    message.t0 = 0.5;
    return message;
}

Message mesh_of(const std::string& role) {
    return stamped(role == "particles" ? particle_mesh() : square_mesh());
}

struct Script {
    std::string role;
    Session session{role};
    void operator()(Side from, Message message) {
        session.follow(from, stamped(std::move(message)));
    }
};

/// A session in the wanted phase. In "reply" of particles a PROBE has been answered with ACTIVE.
Session session_in(Phase phase, const std::string& role) {
    Script say{role};
    const bool particles = role == "particles";
    if (phase == Phase::hello) return say.session;
    say(Side::solver, Hello{});
    if (phase == Phase::welcome) return say.session;
    say(Side::coupler, welcome());
    if (phase == Phase::meshes) return say.session;
    say(Side::solver, mesh_of(role));
    if (phase == Phase::mesh_ack) return say.session;
    say(Side::coupler, MeshAck{});
    if (phase == Phase::surface) return say.session;
    if (particles) {
        say(Side::coupler, Surface{});
        if (phase == Phase::step) return say.session;
        say(Side::solver, probe_of(5, 0.5, 3));
        say(Side::coupler, Active{0, 5, {0, 2}});
    } else {
        say(Side::solver, state_of(5, 0.5, 4));
        if (phase == Phase::step) {
            say(Side::coupler, force_of(5, 0.5, 0.25, 4));
            return say.session;
        }
    }
    if (phase == Phase::reply) return say.session;
    if (phase == Phase::checkpoint) {
        say(Side::coupler, Checkpoint{0, 5, "k"});
        return say.session;
    }
    say(Side::coupler, Finish{0, 5, "done"});
    if (phase == Phase::bye) return say.session;
    say(Side::solver, Bye{0, 5});
    return say.session;
}

/// Well-formed messages for the running step of `session`, one of each type.
std::vector<Message> one_of_each(const Session& session, const std::string& role) {
    const std::int64_t n = session.step();
    const double t = n == 5 ? 0.5 : 0.75;
    Surface surface;
    surface.n = n;
    Progress progress;
    progress.n = n;
    return {Hello{},
            welcome(),
            mesh_of(role),
            stamped(MeshAck{}),
            stamped(surface),
            stamped(probe_of(n, t, 3)),
            stamped(Active{0, n, {1}}),
            stamped(state_of(n, t, session.rows())),
            stamped(force_of(n, t, 0.25, session.rows())),
            stamped(Checkpoint{0, n, "k"}),
            stamped(CheckpointAck{0, n, "f", "s"}),
            stamped(Finish{0, n, "done"}),
            stamped(Bye{0, n}),
            stamped(Error{}),
            stamped(progress)};
}

std::set<std::string> legal_types(Phase phase, const std::string& role, Side side) {
    std::set<std::string> legal;
    const Session start = session_in(phase, role);
    REQUIRE(start.phase() == phase);
    for (const Message& message : one_of_each(start, role)) {
        Session session = start;
        try {
            session.follow(side, message);
            legal.insert(name_of(type_of(message)));
        } catch (const PeerError& error) {
            CHECK((error.code == "E_STATE" || error.code == "E_SEQUENCE"));
        }
    }
    return legal;
}

std::string code_of(Session session, Side side, Message message) {
    try {
        session.follow(side, stamped(std::move(message)));
    } catch (const PeerError& error) {
        return error.code;
    }
    return "";
}

}  // namespace

TEST_CASE("in every phase exactly the messages of the life cycle are legal") {
    using Types = std::set<std::string>;
    struct Row {
        Phase phase;
        Side speaker;
        Types surface, particles;  // besides ERROR and PROGRESS
    };
    const std::vector<Row> table{
        {Phase::hello, Side::solver, {"HELLO"}, {"HELLO"}},
        {Phase::welcome, Side::coupler, {"WELCOME"}, {"WELCOME"}},
        {Phase::meshes, Side::solver, {"MESH"}, {"MESH"}},
        {Phase::mesh_ack, Side::coupler, {"MESH_ACK"}, {"MESH_ACK"}},
        {Phase::step, Side::solver, {"STATE"}, {"PROBE"}},
        {Phase::reply,
         Side::coupler,
         {"FORCE", "CHECKPOINT", "FINISH"},
         {"SURFACE", "FORCE", "CHECKPOINT", "FINISH"}},
        {Phase::checkpoint, Side::solver, {"CHECKPOINT_ACK"}, {"CHECKPOINT_ACK"}},
        {Phase::bye, Side::solver, {"BYE"}, {"BYE"}},
        {Phase::closed, Side::solver, {}, {}},
    };
    for (const Row& row : table) {
        for (const std::string role : {"surface", "particles"}) {
            INFO(name_of(row.phase) << ", " << role);
            Types always{"ERROR"};
            if (row.phase != Phase::hello && row.phase != Phase::welcome &&
                row.phase != Phase::closed) {
                always.insert("PROGRESS");
            }
            Types expected = role == "surface" ? row.surface : row.particles;
            expected.insert(always.begin(), always.end());
            CHECK(legal_types(row.phase, role, row.speaker) == expected);
            const Side other = row.speaker == Side::solver ? Side::coupler : Side::solver;
            CHECK(legal_types(row.phase, role, other) == always);
        }
    }
    CHECK(legal_types(Phase::surface, "particles", Side::coupler) ==
          Types{"SURFACE", "ERROR", "PROGRESS"});
}

TEST_CASE("a surface announces meshes until its first STATE, which carries all their nodes") {
    Session session = session_in(Phase::meshes, "surface");
    CHECK(code_of(session, Side::solver, state_of(5, 0.5, 0)) == "E_STATE");  // no mesh yet
    for (int i = 0; i < 2; ++i) {
        session.follow(Side::solver, mesh_of("surface"));
        session.follow(Side::coupler, stamped(MeshAck{}));
    }
    CHECK(code_of(session, Side::solver, state_of(5, 0.5, 4)) == "E_SHAPE");
    CHECK(code_of(session, Side::solver, state_of(5, 0.5, 8)) == "");
}

TEST_CASE("a stale, duplicate or skipped step is a sequence error") {
    const Session step = session_in(Phase::step, "surface");
    REQUIRE(step.step() == 6);
    CHECK(code_of(step, Side::solver, state_of(5, 0.75, 4)) == "E_SEQUENCE");
    CHECK(code_of(step, Side::solver, state_of(7, 0.75, 4)) == "E_SEQUENCE");
    CHECK(code_of(step, Side::solver, state_of(6, 0.75, 4)) == "");
    CHECK(code_of(step, Side::coupler, force_of(5, 0.5, 0.25, 4)) == "E_SEQUENCE");
    const Session reply = session_in(Phase::reply, "surface");
    CHECK(code_of(reply, Side::solver, state_of(5, 0.5, 4)) == "E_SEQUENCE");
    CHECK(code_of(reply, Side::coupler, force_of(4, 0.5, 0.25, 4)) == "E_SEQUENCE");
    CHECK(code_of(reply, Side::coupler, force_of(6, 0.5, 0.25, 4)) == "E_SEQUENCE");
}

TEST_CASE("a message of another session is a sequence error") {
    Session session = session_in(Phase::step, "surface");
    Message state = state_of(6, 0.75, 4);
    set_session(state, id + 1);
    try {
        session.follow(Side::solver, state);
        FAIL("accepted");
    } catch (const PeerError& error) {
        CHECK(error.code == "E_SEQUENCE");
    }
}

TEST_CASE("the time of a STATE is t1 of the FORCE before, to the last bit") {
    const Session session = session_in(Phase::step, "surface");
    CHECK(code_of(session, Side::solver, state_of(6, 0.75, 4)) == "");
    CHECK(code_of(session, Side::solver, state_of(6, std::nextafter(0.75, 1), 4)) == "E_TIME");
}

TEST_CASE("offered and granted steps are > 0") {
    State state = state_of(6, 0.75, 4);
    state.dt_limit = 0;
    CHECK(code_of(session_in(Phase::step, "surface"), Side::solver, state) == "E_NONFINITE");
    const Session reply = session_in(Phase::reply, "surface");
    CHECK(code_of(reply, Side::coupler, force_of(5, 0.5, 0, 4)) == "E_TIME");
    CHECK(code_of(reply, Side::coupler, force_of(5, 0.5, -0.1, 4)) == "E_TIME");
}

TEST_CASE("ACTIVE answers a PROBE, names its rows in increasing order, and sets the rows") {
    Script say{"particles"};
    say.session = session_in(Phase::step, "particles");
    say(Side::solver, probe_of(5, 0.5, 3));
    CHECK(code_of(say.session, Side::coupler, force_of(5, 0.5, 0.25, 0)) == "E_STATE");
    CHECK(code_of(say.session, Side::coupler, Active{0, 5, {0, 3}}) == "E_SHAPE");
    CHECK(code_of(say.session, Side::coupler, Active{0, 5, {2, 1}}) == "E_SHAPE");
    CHECK(code_of(say.session, Side::coupler, Active{0, 5, {1, 1}}) == "E_SHAPE");
    say(Side::coupler, Active{0, 5, {0, 2}});
    CHECK(say.session.rows() == 2);
    CHECK(code_of(say.session, Side::coupler, force_of(5, 0.5, 0.25, 3)) == "E_SHAPE");
    say(Side::coupler, force_of(5, 0.5, 0.25, 2));
    CHECK_FALSE(say.session.owes_probe());
    CHECK(code_of(say.session, Side::solver, probe_of(6, 0.75, 3)) == "E_STATE");
    say(Side::solver, state_of(6, 0.75, 2));
    say(Side::coupler, force_of(6, 0.75, 0.25, 2, 0, force_probe));
    CHECK(say.session.owes_probe());
    CHECK(code_of(say.session, Side::solver, state_of(7, 1.0, 2)) == "E_STATE");
    CHECK(code_of(say.session, Side::solver, probe_of(7, 1.0, 9)) == "");
}

TEST_CASE("after CHECKPOINT_ACK the same step goes on") {
    Script say{"surface"};
    say.session = session_in(Phase::checkpoint, "surface");
    CHECK(code_of(say.session, Side::solver, CheckpointAck{0, 4, "f", "s"}) == "E_SEQUENCE");
    say(Side::solver, CheckpointAck{0, 5, "f", "s"});
    CHECK(code_of(say.session, Side::coupler, force_of(5, 0.5, 0.25, 4)) == "");
}
