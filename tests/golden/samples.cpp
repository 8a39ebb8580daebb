#include "samples.hpp"

#include <cstring>
#include <limits>
#include <sstream>
#include <stdexcept>

#include "wire/codec.hpp"

namespace undertow::wire {

namespace {

constexpr std::uint64_t session = 0x1234;

State two_nodes() {
    State state;
    state.session = session;
    state.n = 7;
    state.t = 1.25e-5;
    state.dt_limit = 2e-6;
    state.limiter = "hexahedron 3";
    state.reach = 0;
    state.work = 56;
    state.wait = 0.001;
    state.x = {0, 0, 0, 1, 0, -0.5};
    state.v = {0, 0, 0, 0.25, 0, 1e-3};
    return state;
}

Force two_forces() {
    Force force;
    force.session = session;
    force.n = 7;
    force.dt = 1.5e-6;
    force.t1 = 1.4e-5;
    force.flags = force_probe | force_output;
    force.limiter = "sph: sound";
    force.f = {0, 0, -1, 0.5, 0, 2};
    return force;
}

/// Replaces the only occurrence of `from` in the header by `to`.
RawFrames edited(RawFrames frames, const std::string& from, const std::string& to) {
    const std::size_t place = frames.at(0).find(from);
    if (place == std::string::npos || frames[0].find(from, place + 1) != std::string::npos) {
        throw std::logic_error("the text to edit must stand in the header once");
    }
    frames[0].replace(place, from.size(), to);
    return frames;
}

std::string bytes(std::initializer_list<unsigned char> list) {
    return {list.begin(), list.end()};
}

}  // namespace

std::vector<Sample> golden_samples() {
    std::vector<Sample> samples;

    const std::array<int, 2> first_version{1, 0};
    Hello hello;
    hello.version = first_version;
    hello.name = "fem";
    hello.role = "surface";
    hello.capabilities = {"checkpoint"};
    hello.software = "demo-fem 0.1";
    samples.push_back({"hello", "HELLO of a surface participant", hello});

    hello.version = {1, 1};
    hello.case_keys = {"case.name = \"dam\"", "time.max_step = 0.0001",
                       "fem.mesh = #a5b1e6c9f0d24738"};
    samples.push_back({"hello_case", "HELLO of version 1.1 that names keys of its case", hello});

    Welcome welcome;
    welcome.version = first_version;
    welcome.session = session;
    welcome.t_end = 0.5;
    welcome.contact_share = 0.45;
    welcome.max_message = 536870912;
    samples.push_back({"welcome", "WELCOME to session 0x1234", welcome});

    Mesh mesh;
    mesh.session = session;
    mesh.mesh = "wall";
    mesh.kind = "surface";
    mesh.groups = {"front", "side"};
    mesh.thickness = 0.002;
    mesh.x = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 2, 0.5, 0};
    mesh.mass = {0.5, 0.75, 0.75, 0.5, 0.25};
    mesh.quad = {0, 1, 2, 3, 1, 4, 2, 2};
    mesh.group = {0, 1};
    samples.push_back({"mesh_surface", "MESH: one quadrilateral and one triangle", mesh});

    Mesh particles;
    particles.session = session;
    particles.mesh = "fluid";
    particles.kind = "particles";
    particles.groups = {"water"};
    particles.radius = 0.005;
    samples.push_back({"mesh_particles", "MESH of particles: no arrays' rows", particles});

    samples.push_back({"mesh_ack", "MESH_ACK with the checksum of mesh_surface",
                       MeshAck{session, "wall", 0, checksum(mesh)}});

    Surface surface;
    surface.session = session;
    surface.range = 0.0125;
    surface.x = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};
    surface.quad = {0, 1, 2, 3};
    surface.boxes = {-0.0125, -0.0125, -0.0125, 1.0125, 1.0125, 0.0125};
    samples.push_back({"surface", "SURFACE before the first step", surface});

    Probe probe;
    probe.session = session;
    probe.n = 7;
    probe.t = 1.25e-5;
    probe.dt_limit = 3e-6;
    probe.limiter = "sound";
    probe.flags = state_stop;
    probe.work = 1e6;
    probe.wait = 0.25;
    probe.id = {11, 5000000000};
    probe.x = {0.5, 0.5, 0.004, 0.25, 0.5, 0.25};
    probe.v = {0, 0, -1, 0, 0, -1};
    probe.mass = {0.001, 0.001};
    probe.radius = {0.005, 0.005};
    probe.stiffness = {2.1e7, 2.1e7};
    probe.phase = {0, 0};
    samples.push_back({"probe", "PROBE of step 7 with two particles, Ctrl-C was pressed", probe});

    samples.push_back(
        {"active", "ACTIVE: only row 0 of PROBE(7) may touch", Active{session, 7, {0}}});
    samples.push_back({"state", "STATE of step 7 with two nodes", two_nodes()});

    State empty = two_nodes();
    empty.x.clear();
    empty.v.clear();
    empty.reach = 0.0015;
    empty.limiter = "sound";
    samples.push_back(
        {"state_empty", "STATE of a particle solver without active particles", empty});

    samples.push_back({"force", "FORCE answering it: probe and output flags", two_forces()});
    samples.push_back({"checkpoint", "CHECKPOINT before step 7", Checkpoint{session, 7, "k0007"}});
    samples.push_back({"checkpoint_ack", "CHECKPOINT_ACK",
                       CheckpointAck{session, 7, "fem.k0007.h5", "e3b0c44298fc1c14"}});
    samples.push_back({"finish", "FINISH in place of FORCE(7)", Finish{session, 7, "done"}});
    samples.push_back({"bye", "BYE", Bye{session, 7}});
    samples.push_back({"error", "ERROR by the coupler about participant fem",
                       Error{session, 7, "E_NONFINITE", "x[5] of mesh wall is NaN", "fem"}});
    samples.push_back(
        {"progress", "PROGRESS in a long step", Progress{session, 7, 0.5, "writing fields"}});
    return samples;
}

std::vector<Fault> golden_faults() {
    const RawFrames state = raw_frames(two_nodes());
    std::vector<Fault> faults;
    const auto add = [&](const char* file, const char* comment, const char* code,
                         RawFrames frames) {
        faults.push_back({std::string("fault_") + file, comment, code, std::move(frames)});
    };

    RawFrames truncated = state;
    truncated[0].resize(40);
    add("truncated", "STATE whose header ends after 40 bytes", "E_MALFORMED", truncated);

    RawFrames trailing = state;
    trailing[0] += '\xc0';
    add("trailing", "STATE with one byte behind the map", "E_MALFORMED", trailing);

    add("bomb", "a list that claims 4294967295 entries", "E_MALFORMED",
        {bytes({0xdd, 0xff, 0xff, 0xff, 0xff})});
    add("deep", "BYE with an unknown key nested 5 levels deep", "E_MALFORMED",
        {bytes({0x82, 0xa1, 'm', 0x0a, 0xa1, 'z', 0x91, 0x91, 0x91, 0x91, 0x00})});
    add("extension", "BYE with an unknown key of an extension type", "E_MALFORMED",
        {bytes({0x82, 0xa1, 'm', 0x0a, 0xa1, 'z', 0xd4, 0x01, 0x00})});
    add("unknown_type", "message type 99", "E_MALFORMED",
        edited(state, bytes({0xa1, 'm', 0x05}), bytes({0xa1, 'm', 99})));
    add("missing_key", "STATE without n (the key is called q)", "E_MALFORMED",
        edited(state, bytes({0xa1, 'n', 0x07}), bytes({0xa1, 'q', 0x07})));
    add("missing_array", "STATE without v (the array is called w)", "E_MALFORMED",
        edited(state, bytes({0xa1, 'v', 0xa2}), bytes({0xa1, 'w', 0xa2})));
    add("wrong_kind", "STATE whose n is a text", "E_MALFORMED",
        edited(state, bytes({0xa1, 'n', 0x07}), bytes({0xa1, 'n', 0xa1, '7'})));
    add("wrong_dtype", "STATE whose v claims to be i8", "E_SHAPE",
        edited(state, bytes({0xa1, 'v', 0xa2, 'f', '8'}), bytes({0xa1, 'v', 0xa2, 'i', '8'})));
    add("unknown_dtype", "STATE whose v claims to be c8", "E_SHAPE",
        edited(state, bytes({0xa1, 'v', 0xa2, 'f', '8'}), bytes({0xa1, 'v', 0xa2, 'c', '8'})));
    add("wrong_columns", "STATE whose v has the shape (3, 2)", "E_SHAPE",
        edited(state, bytes({0xa1, 'v', 0xa2, 'f', '8', 0x92, 2, 3}),
               bytes({0xa1, 'v', 0xa2, 'f', '8', 0x92, 3, 2})));

    RawFrames frame_missing = state;
    frame_missing.pop_back();
    add("frame_missing", "STATE without its last frame", "E_SHAPE", frame_missing);

    RawFrames frame_short = state;
    frame_short.back().pop_back();
    add("frame_short", "STATE whose last frame lacks one byte", "E_SHAPE", frame_short);

    RawFrames rows_differ = edited(state, bytes({0xa1, 'v', 0xa2, 'f', '8', 0x92, 2, 3}),
                                   bytes({0xa1, 'v', 0xa2, 'f', '8', 0x92, 1, 3}));
    rows_differ.back().resize(24);
    add("rows_differ", "STATE with two rows of x and one of v", "E_SHAPE", rows_differ);

    State nan_array = two_nodes();
    nan_array.x[5] = std::numeric_limits<double>::quiet_NaN();
    add("nan_array", "STATE with x[1, 2] = NaN", "E_NONFINITE", raw_frames(nan_array));

    State infinite = two_nodes();
    infinite.dt_limit = std::numeric_limits<double>::infinity();
    add("infinite_key", "STATE with dl = infinity", "E_NONFINITE", raw_frames(infinite));
    return faults;
}

RawFrames raw_frames(const Message& message) {
    Frames frames;
    encode(message, frames);
    RawFrames raw{frames.header};
    for (std::size_t i = 0; i < frames.n_arrays; ++i) {
        const Bytes array = frames.arrays[i];
        raw.emplace_back(reinterpret_cast<const char*>(array.data()), array.size());
    }
    return raw;
}

Message decoded(const RawFrames& frames) {
    std::vector<Bytes> arrays;
    for (std::size_t i = 1; i < frames.size(); ++i) {
        arrays.push_back(std::as_bytes(std::span(frames[i])));
    }
    Message message;
    decode(std::as_bytes(std::span(frames.at(0))), arrays, message);
    return message;
}

std::string to_hex(const RawFrames& frames) {
    std::string text;
    for (const std::string& frame : frames) {
        for (const unsigned char byte : frame) {
            text += "0123456789abcdef"[byte >> 4];
            text += "0123456789abcdef"[byte & 15];
        }
        text += frame.empty() ? "-\n" : "\n";
    }
    return text;
}

RawFrames from_hex(const std::string& text) {
    RawFrames frames;
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) {
        if (line.empty() || line[0] == '#') continue;
        std::string frame;
        for (std::size_t i = 0; line != "-" && i + 1 < line.size(); i += 2) {
            frame += static_cast<char>(std::stoi(line.substr(i, 2), nullptr, 16));
        }
        frames.push_back(frame);
    }
    return frames;
}

}  // namespace undertow::wire
