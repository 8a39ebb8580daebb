#pragma once
// The messages of protocol version 1, as plain structs. docs/protocol.md describes the bytes.
// On the wire a message is a ZeroMQ multipart: frame 0 a MessagePack map (the scalar members, keys
// in the order of the codec), frames 1..k the arrays, raw little-endian, listed in key "a".
// SI units throughout. Vectors of points are row-major (n, 3).

#include <array>
#include <cstdint>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace undertow::wire {

inline constexpr int version_major = 1;
inline constexpr int version_minor = 1;
inline constexpr const char* protocol_name = "undertow";

enum class MessageType : std::uint8_t {
    hello = 1, welcome = 2, mesh = 3, mesh_ack = 4, state = 5, force = 6,
    checkpoint = 7, checkpoint_ack = 8, finish = 9, bye = 10, error = 11, progress = 12,
    active = 14, probe = 15, surface = 16,
};

/// Solver -> coupler, first message. Answer: WELCOME or ERROR.
struct Hello {
    std::string protocol = protocol_name;                              // key p
    std::array<int, 2> version{version_major, version_minor};          // key v
    std::string name;          // participant, unique within the run, for example "sph"
    std::string role;          // "particles" or "surface"
    std::vector<std::string> capabilities;  // key caps
    std::string software;      // key sw, for logs
    std::string units = "SI";
    std::vector<std::string> case_keys{};  // key case, since 1.1, optional: "sph.spacing = 0.01",
                                           // what the participant's case must have in common with
                                           // the coupler's; empty: not told
};

/// Coupler -> solver: the session is open.
struct Welcome {
    std::uint64_t session = 0;                                         // key s
    std::array<int, 2> version{version_major, version_minor};          // key v, the common one
    std::vector<std::string> capabilities;
    std::int64_t first_step = 0;   // key n0
    double t0 = 0;                 // [s]
    double t_end = 0;              // [s] for information: the coupler alone ends the run
    double deadline = 60;          // [s] longest silence allowed to either side
    double contact_share = 0;      // beta + 2 eta the coupler takes of the stability budget
                                   // sum(beta + 2 eta) <= 4 (1 - lambda^2), lambda the FEM's CFL
    std::uint64_t max_message = 0; // [byte] larger messages are refused
};

/// Solver -> coupler, one per mesh, once (and again with a higher revision if topology changes).
/// kind "surface": x, mass, quad, group are filled. kind "particles": only radius, thickness,
/// groups (the phases' names).
struct Mesh {
    std::uint64_t session = 0;
    std::string mesh;              // name of the mesh
    std::int64_t revision = 0;     // key rev
    std::string kind;              // "surface" or "particles"
    std::vector<std::string> groups;   // names that `group` (facets) or Probe::phase index
    double radius = 0;             // [m] largest contact radius l0 of a particle (half the spacing)
    double thickness = 0;          // [m] shell thickness of a surface; 0 for a solid's skin
    std::vector<double> x;         // [m] nodes, (N, 3)
    std::vector<double> mass;      // [kg] lumped nodal mass, (N)
    std::vector<std::int32_t> quad;    // (F, 4) nodes, counter-clockwise seen from the wet side
                                       // (normal points to the particles); a triangle repeats its
                                       // third node
    std::vector<std::int32_t> group;   // (F) index into groups
};

/// Coupler -> solver: mesh accepted. `sum` is the FNV-1a 64 checksum of all array bytes, hex.
struct MeshAck {
    std::uint64_t session = 0;
    std::string mesh;
    std::int64_t revision = 0;
    std::string sum;
};

/// Coupler -> particle solver: where the coupled surfaces are. Sent once before the first step and
/// again before a PROBE is asked for. All meshes joined into one.
struct Surface {
    std::uint64_t session = 0;
    std::int64_t n = 0;            // step at which x was taken
    double range = 0;              // [m] already contained in boxes: radius + skin
    std::vector<double> x;         // [m] (N, 3)
    std::vector<std::int32_t> quad;    // (F, 4)
    std::vector<double> boxes;     // [m] (B, 6) xmin ymin zmin xmax ymax zmax: a particle outside
                                   // all boxes cannot touch before the next probe
};

/// Particle solver -> coupler, in place of STATE(n) when FORCE(n-1) asked for it (flag probe) and
/// always at the first step: every particle inside any box.
struct Probe {
    std::uint64_t session = 0;
    std::int64_t n = 0;
    double t = 0;                  // [s]
    double dt_limit = 0;           // [s] key dl, largest stable step the solver offers for step n
    std::string limiter;           // what limits it, for the live line ("sound", "viscosity", ...)
    std::uint32_t flags = 0;       // key fl, StateFlag
    double work = 0;               // particle-steps done so far
    double wait = 0;               // [s] time spent waiting for the coupler so far
    std::vector<std::uint64_t> id; // (P) particle identity, constant during the run
    std::vector<double> x;         // [m] (P, 3) at t
    std::vector<double> v;         // [m/s] (P, 3) at t - dt/2
    std::vector<double> mass;      // [kg] (P)
    std::vector<double> radius;    // [m] (P) contact radius l0
    std::vector<double> stiffness; // [N/m] (P) rho c0^2 dx, natural contact stiffness ("fluid" law)
    std::vector<std::uint32_t> phase;  // (P) index into Mesh::groups of the particle mesh
};

/// Coupler -> particle solver, answer to PROBE(n), just before FORCE(n): the rows of that PROBE
/// that may touch before the next one. STATE and FORCE carry these, in this order, until then.
struct Active {
    std::uint64_t session = 0;
    std::int64_t n = 0;
    std::vector<std::uint32_t> row;    // (A) rows of PROBE(n), increasing
};

enum StateFlag : std::uint32_t {
    state_stop = 1,   // the user asked this participant to stop (Ctrl-C, SIGTERM)
};

/// Solver -> coupler, each step. Surface: all nodes of its meshes; particles: the active ones.
struct State {
    std::uint64_t session = 0;
    std::int64_t n = 0;
    double t = 0;                  // [s]
    double dt_limit = 0;           // [s] key dl
    std::int64_t revision = 0;     // key rev
    std::string limiter;
    std::uint32_t flags = 0;       // key fl, StateFlag
    double reach = 0;              // [m] bound on the displacement of any particle since the PROBE
    double work = 0;               // particle- or element-steps done so far
    double wait = 0;               // [s]
    std::vector<double> x;         // [m] (N, 3) at t
    std::vector<double> v;         // [m/s] (N, 3) at t - dt/2
};

enum ForceFlag : std::uint32_t {
    force_probe = 1,      // answer the next step with PROBE instead of STATE
    force_output = 2,     // t1 is a common output time: write fields at t1
};

/// Coupler -> solver, answer to STATE(n) or PROBE(n): take step n with dt, arriving at t1.
/// Take t1 as it is; never add up dt.
struct Force {
    std::uint64_t session = 0;
    std::int64_t n = 0;
    double dt = 0;                 // [s]
    double t1 = 0;                 // [s]
    std::uint32_t flags = 0;       // key fl, ForceFlag
    std::string limiter;           // who limits dt: "sph: sound", "fem: hexahedron 17 of wall", ...
    std::vector<double> f;         // [N] (N, 3) contact force at t, in the order of STATE
};

/// Coupler -> solver, instead of FORCE: write a checkpoint of the state before step n.
struct Checkpoint {
    std::uint64_t session = 0;
    std::int64_t n = 0;
    std::string id;
};
struct CheckpointAck {
    std::uint64_t session = 0;
    std::int64_t n = 0;
    std::string file;
    std::string sha256;
};

/// Coupler -> solver, instead of FORCE(n): the run is over; answer with BYE.
struct Finish {
    std::uint64_t session = 0;
    std::int64_t n = 0;
    std::string reason;            // "done" or "interrupted"
};
struct Bye {
    std::uint64_t session = 0;
    std::int64_t n = 0;
};

/// Either way, ends the run. `who` names the participant at fault.
struct Error {
    std::uint64_t session = 0;
    std::int64_t n = 0;
    std::string code;              // E_VERSION, E_NAME_TAKEN, E_LATE, E_MALFORMED, E_SHAPE, E_STATE,
                                   // E_SEQUENCE, E_TIME, E_NONFINITE, E_MESH, E_DT, E_TIMEOUT,
                                   // E_PEER_LOST, E_IO, E_PHYSICS, E_INPUT, E_STOP, E_KEY
    std::string text;              // one sentence: what is wrong, value, what to do
    std::string who;
};

/// Solver -> coupler while a step takes long (output, a rebuild): restarts the deadline.
struct Progress {
    std::uint64_t session = 0;
    std::int64_t n = 0;
    double fraction = 0;           // 0 to 1, of whatever takes long
    std::string text;
};

using Message = std::variant<Hello, Welcome, Mesh, MeshAck, Surface, Probe, Active, State, Force,
                             Checkpoint, CheckpointAck, Finish, Bye, Error, Progress>;

}  // namespace undertow::wire
