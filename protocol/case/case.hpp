#pragma once
// A case: what all three programs read from one TOML file. Plain tables, SI units, defaults here.
// read_case() in case_file.hpp fills them; every key below is a TOML key of the same name.

#include <array>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "case/expression.hpp"

namespace undertow {

using Vec3 = std::array<double, 3>;

struct Box {
    Vec3 min{}, max{};                   // [m]
};

// ---------------------------------------------------------------- [case], [time], [start], [output]
struct CaseInfo {
    std::string name;                    // also the folder of the results
    std::string title;
    int dimension = 3;                   // 2: the x-z plane, y is out of plane
    double thickness = 1;                // [m] out-of-plane thickness of a 2D case
    Vec3 gravity{0, 0, -9.81};           // [m/s2]
};

struct TimeSettings {
    double end = 1;                      // [s]
    double max_step = std::numeric_limits<double>::infinity();   // [s]
    double min_step = 1e-10;             // [s] a stable step below this stops the run
    double growth = 1.05;                // largest ratio of successive steps
};

/// How a scene comes to rest before it begins: for this long the fluid's velocities are damped, held
/// fills stand still and the structure does not move.
struct StartSettings {                   // [start]
    double settle = 0;                   // [s]
    double damping = 0;                  // [1/s] 0 = critical for the slowest sound wave, pi c0/depth
};

struct OutputSettings {
    double fields_every = 0.02;          // [s] particle and mesh fields
    double history_every = 0;            // [s] forces, energies, gauges; 0 = 1/2000 of time.end
    bool contact_fields = true;          // contact.vtkhdf of a coupled run
    double contact_every = 0;            // [s] between its outputs; 0 = fields_every, at the same times
};

/// State on the disk to resume from. With the table there, SIGTERM and Ctrl-C end a run with one.
struct CheckpointSettings {              // [checkpoint]
    bool present = false;
    double every = 0;                    // [s] simulated time between two; 0 = none
    double every_wall = 0;               // [s] wall time between two; 0 = none
    bool on_interrupt = true;            // one when the user ends the run
    bool at_end = false;                 // one at time.end, to go on with a later end
    int keep = 2;                        // sets that stay, the oldest go first
};

// ---------------------------------------------------------------- [sph]
enum class Kernel { cubic_spline, wendland_c2, wendland_c4 };
enum class TensionControl { none, spray, switched };
enum class EquationOfState { us_up, tait };
enum class Integrator { automatic, one_pass, two_pass };
enum class Precision { float32, float64 };
enum class FillLattice { square, relaxed };
enum class Slip { free_slip, no_slip, friction };
enum class ViscositySolver { automatic, explicit_sums, implicit };
enum class ViscousForm { laplacian, strain };

struct Fluid {                           // [[sph.fluid]]
    std::string name;
    double density = 1000;               // [kg/m3] at zero pressure
    double spacing = 0;                  // [m] dx of its own particles; 0 = sph.spacing
    double viscosity = 0;                // [Pa s] dynamic; of the Newtonian part of a viscoplastic fluid
    // Herschel-Bulkley: tau = yield_stress + consistency gammadot^flow_index, where either is > 0
    double yield_stress = 0;             // [Pa]
    double consistency = 0;              // [Pa s^n]
    double flow_index = 1;               // n
    double max_viscosity = 0;            // [Pa s] cap where hardly anything shears; 0 = the largest
                                         // that does not shorten the step
    EquationOfState equation_of_state = EquationOfState::us_up;   // "us_up", "tait"
    std::optional<double> sound_speed{};  // [m/s]; "auto" (= nullopt): ten times sph.max_speed
    double hugoniot_slope = 0;           // s of Us = c0 + s up
    double gruneisen = 0;                // Gamma0
    double tait_exponent = 7;
};

/// A shape in space: a box, a prism, a cylinder or the inside of a closed surface.
struct Shape {
    std::optional<Box> box{};            // [m]
    std::vector<std::array<double, 2>> profile{};// [m] polygon in x, z: a prism along y, as long as
                                         // the box is if there is one, else without ends
    Vec3 from{}, to{};                   // [m] axis of a cylinder with flat ends; 2D: along y, a disc
    double radius = 0;                   // [m] of the cylinder; 0 = none
    std::string stl{};                     // file with a closed surface, ASCII or binary
    double scale = 1;                    // [m] of one unit in the file
    Vec3 at{};                           // [m] where the file's origin comes to lie
};

struct Fill {                            // [[sph.fill]] particles, cell-centered in the box
    std::string fluid;                   // where fills overlap, the later one has the place
    Box box;
    std::vector<std::array<double, 2>> profile{};// [m] polygon in x, z that cuts a prism out of the
                                         // box; empty = the whole box
    Vec3 velocity{};                     // [m/s]
    std::vector<Expression> velocity_field{};   // [m/s] vx, vy, vz of x, y, z, where `velocity` holds
                                         // formulas; empty = `velocity` everywhere
    std::optional<Expression> pressure{};// [Pa] of x, y, z at the start; none = hydrostatic
    double ramp = 0;                     // [s] > 0: after start.settle the fill is moved as a block,
                                         // its speed rising smoothly from 0 to `velocity` in this
                                         // time, then let go where box and profile say; it starts
                                         // velocity ramp/2 behind
    Shape within{};                      // only what lies in this cylinder or STL file; its keys
                                         // stand in the table itself
    std::optional<double> surface_level{}; // [m] z of p = 0 for the hydrostatic start; none = top of box
};

struct Obstacle {                        // [[sph.obstacle]] a body that fills leave free
    std::string name;
    Shape shape{};                       // its keys stand in the table itself
};

struct PlaneWall {                       // [[sph.plane]] infinite rigid wall, by mirror particles
    std::string name;
    Vec3 point{};                        // [m]
    Vec3 normal{0, 0, 1};                // into the fluid
    Slip slip = Slip::free_slip;         // "free" (or "free_slip"), "no_slip", "friction"
    double friction = 0;                 // Coulomb coefficient of "friction"
    Vec3 velocity{};                     // [m/s] along itself, of a no-slip plane
    bool symmetry = false;               // slip = "symmetry": free, and the summary says that forces
                                         // and masses are those of one half
};

/// A rigid body of dummy particles, at rest or moving by a law: velocity, displacement or motion.
struct Body {                            // [[sph.body]]
    std::string name;
    Shape shape{};                       // its keys stand in the table itself
    bool inside = false;                 // the fluid is inside the shape (a tank), not around it
    Vec3 velocity{};                     // [m/s] from start to stop
    double start = 0;                    // [s] motion begins
    double stop = std::numeric_limits<double>::infinity();   // [s] motion ends
    std::vector<Expression> displacement{};      // [m] x, y, z, formulas of t
    std::string motion;                  // CSV file: t [s], x, y, z [m] and, if it turns, angle [rad]
    std::optional<Expression> angle{};   // [rad] formula of t; counts about `axis` through `center`
    Vec3 axis{0, 1, 0};                  // unit vector
    Vec3 center{};                       // [m] moves with the body
    Slip slip = Slip::free_slip;         // "free", "no_slip", "friction"
    double friction = 0;                 // Coulomb coefficient of "friction"
};

enum class SphGaugeKind { front, pressure, water_level, flux, force };
struct SphGauge {                        // [[sph.gauge]]
    std::string name;
    SphGaugeKind kind = SphGaugeKind::front;   // "front", "pressure", "water_level", "flux", "force"
    Vec3 point{};                        // [m] pressure: where; water_level: its x, y
    Vec3 direction{1, 0, 0};             // front: which way it runs; flux: which way counts
    Box box{};                           // [m] flux: a rectangle, min = max in one direction
    std::string wall;                    // force: name of a [[sph.plane]] or [[sph.body]]
    double every = 0;                    // [s] 0 = output.history_every
};

struct Inflow {                          // [[sph.inflow]] an opening through which fluid comes
    std::string name;
    std::string fluid;
    Box box;                             // [m] the opening: flat along one axis
    Vec3 normal{1, 0, 0};                // along that axis, into the fluid
    std::optional<Expression> velocity{};// [m/s] along the normal, a number or a formula of x, y, z, t
    std::optional<double> level{};       // [m] z of a free surface: nothing comes above; none = the
                                         // whole opening
};

struct Outflow {                         // [[sph.outflow]] an opening through which fluid leaves
    std::string name;
    Box box;                             // [m] the opening: flat along one axis
    Vec3 normal{1, 0, 0};                // along that axis, into the fluid
    std::optional<double> pressure{};    // [Pa] held in the middle of the opening, or
    std::optional<double> level{};       // [m] z of p = 0 of the water beyond it; neither = the flow
                                         // goes on as it comes
};

/// A region in which motion dies out towards one side, so that neither sound nor surface waves come
/// back from there.
struct AbsorbingLayer {                  // [[sph.absorbing]]
    std::string name;
    Box box;                             // [m]
    Vec3 direction{1, 0, 0};             // along an axis, toward the boundary: damping rises that way
    Vec3 velocity{};                     // [m/s] of the current that remains
    double strength = 0;                 // A: surface waves come back weaker by exp(-A), or by what
                                         // too steep a ramp sends back; 0 = 3, the best for both
    double wave_speed = 0;               // [m/s] of the fastest surface wave; 0 = sqrt(g H) of the fills
};

struct SphSettings {
    bool present = false;                // the case has an [sph] table
    double spacing = 0;                  // [m] dx
    Kernel kernel = Kernel::wendland_c2; // "cubic_spline", "wendland_c2", "wendland_c4"
    double smoothing_ratio = 1.2;        // h/dx; support radius 2h; default in the plane: 1.5
    bool variable_smoothing = false;     // h = h0 (rho0/rho)^(1/d), at most 140 neighbors
    double density_diffusion = 0.1;      // delta of delta-SPH
    double artificial_viscosity = 0.02;  // alpha of Monaghan's term
    ViscositySolver viscosity_solver = ViscositySolver::automatic;   // "auto", "explicit", "implicit"
    double viscosity_tolerance = 1e-3;   // implicit: unbalanced over the change of velocity in a step
    ViscousForm viscous_form = ViscousForm::laplacian;   // "laplacian": div(mu grad v), "strain":
                                         // div(2 mu D), which lets a body turn and a free surface slip;
                                         // explicit viscous steps are half as long
    // negative pressure: "spray" takes it from spray (momentum to round-off), "switched" also pushes
    // particles inside the fluid by pressure differences, "none" lets all clump
    TensionControl tension_control = TensionControl::spray;
    double shifting = 0;                 // strength K of particle shifting; 0 = off, typical 10
    bool gradient_correction = false;    // the density's rate is exact in a linear velocity field
    Precision precision = Precision::float32;   // of sums over neighbors: "float", "double", see
                                         // docs/theory.md; the state is double in both
    FillLattice lattice = FillLattice::square;   // "square", "relaxed": fitted to curved bodies
    bool surface_images = true;          // completes the kernel at the coupled surface
    Integrator integrator = Integrator::automatic;   // "auto", "one_pass", "two_pass"
    double cfl = 0;                      // of the acoustic limit dt = cfl h/(c0+|v|); 0 = safe value of the integrator
    double force_cfl = 0.25;             // lambda' of Eq. 14
    double max_speed = 0;                // [m/s] largest expected speed, for sound_speed = "auto";
                                         // 0 = estimated from the fills (2 sqrt(g H), |v|)
    std::optional<Box> domain;           // particles that leave are removed, counted and reported
    std::vector<std::string> periodic;   // of "x", "y", "z": what leaves the domain there comes in on
                                         // the other side; gravity along it drives the flow
    std::vector<Fluid> fluid;
    std::vector<Fill> fill;
    std::vector<Obstacle> obstacle;
    std::vector<PlaneWall> plane;
    std::vector<Body> body;
    std::vector<Inflow> inflow;
    std::vector<Outflow> outflow;
    std::vector<AbsorbingLayer> absorbing;
    std::vector<SphGauge> gauge;
};

// ---------------------------------------------------------------- [fem]
enum class BlockCells { hexahedra, tetrahedra, shells };

struct FemBlock {                        // [fem.block] structured mesh, instead of a file
    Box box;
    std::array<int, 3> divisions{1, 1, 1};
    std::vector<Vec3> corners{};         // [m] eight, in the order of a hexahedron's nodes, instead of
                                         // the box (which then bounds them)
    BlockCells cells = BlockCells::hexahedra;  // "hexahedra", or each cut into six "tetrahedra"
    // volume set "block"; facet sets "xmin", "xmax", "ymin", "ymax", "zmin", "zmax"; node sets alike
    // "shells": a rectangle where the box is flat, divisions 0 along that axis; volume and facet set
    // "block", node sets "xmin", ... of its edges
};

enum class MaterialKind { linear_elastic, tresca, j2, mohr_coulomb };
inline const char* name_of(MaterialKind kind) {
    switch (kind) {
        case MaterialKind::tresca:
            return "tresca";
        case MaterialKind::j2:
            return "j2";
        case MaterialKind::mohr_coulomb:
            return "mohr_coulomb";
        default:
            return "linear_elastic";
    }
}
struct FemMaterial {                     // [[fem.material]]
    std::string name;
    MaterialKind kind = MaterialKind::linear_elastic;   // "linear_elastic", "tresca", "j2",
                                         // "mohr_coulomb"
    double density = 0;                  // [kg/m3] of the inertia (soil: saturated)
    std::optional<double> weight_density{};  // [kg/m3] of the weight (under water: less the water's);
                                         // none = density
    double young_modulus = 0;            // [Pa]
    double poisson_ratio = 0;            // -1 to 0.5
    double shear_strength = 0;           // [Pa] s_u of "tresca"
    double yield_stress = 0;             // [Pa] of "j2"
    double hardening = 0;                // [Pa] of "j2": rise of the yield stress per plastic strain
    std::vector<std::array<double, 2>> hardening_table{};  // of "j2", instead of these two: rows
                                         // [plastic strain, yield stress in Pa], from 0 on
    double cohesion = 0;                 // [Pa] c of "mohr_coulomb"
    double friction_angle = 0;           // [degrees] phi of "mohr_coulomb"
    double dilation_angle = 0;           // [degrees] psi of "mohr_coulomb", at most friction_angle
    std::optional<double> tension_cutoff{};  // [Pa] of "mohr_coulomb", largest tensile stress; none =
                                         // c cot phi, the tip of the cone
    std::optional<double> strength_gradient{};  // [Pa/m] of "tresca" and "mohr_coulomb": what
                                         // shear_strength or cohesion gains per meter of depth below
    double strength_level = 0;           // [m] this z; above it there is no gain
    double modulus_ratio = 0;            // of "tresca", instead of young_modulus: Young's modulus over
                                         // the shear strength of the place
};

/// How the elements of a part compute their stress. `automatic`: hexahedra "one_point", tetrahedra
/// "averaged_pressure". Quads are elements where they are "shell".
enum class ElementFormulation { automatic, one_point, b_bar, averaged_pressure, shell };

struct FemPart {                         // [[fem.part]]
    std::string set;                     // volume set of the mesh ($PhysicalNames); of shells a
                                         // surface
    std::string material;
    ElementFormulation element = ElementFormulation::automatic;  // "one_point", "b_bar",
                                                                 // "averaged_pressure", "shell"
    double thickness = 0;                // [m] of "shell"
    bool implicit = false;               // linearly implicit: does not limit the step; for stiff parts
                                         // that stay elastic (docs/theory_fem.md, section 14)
    double mass_factor = 1;              // inertia over the material's, >= 1; its weight stays
};

struct FemSupport {                      // [[fem.support]]
    std::string set;                     // node, facet or volume set
    std::vector<std::string> fix;        // of "x", "y", "z"; nodes of shells also "rx",
                                         // "ry", "rz", and "clamp" for all six
};

struct FemMass {                         // [[fem.mass]] on nodes, with inertia and weight
    std::string set;                     // node, facet or volume set, whose nodes share it, or
    Vec3 point{};                        // [m] the node nearest to it in the undeformed mesh
    double mass = 0;                     // [kg]
};

struct FemPressure {                     // [[fem.pressure]] follows the deforming facets
    std::string set;
    double value = 0;                    // [Pa] positive pushes against the facet's outward normal
    double ramp = 0;                     // [s] smooth rise from 0; 0 = at once
};

struct FemTraction {                     // [[fem.traction]] a load that neither turns nor grows with
    std::string set;                     // its facets
    Vec3 value{};                        // [Pa] force over undeformed area
    double ramp = 0;                     // [s] smooth rise from 0; 0 = at once
};

struct FemSurface {                      // [[fem.surface]] coupled surface; its name is the force's name
    std::string name;
    std::string set;                     // facet set
    bool immobile = false;               // facets of no element, at rest: a rigid bed; their normals
                                         // as the mesh has them
};

/// Static water over the coupled surfaces: what it presses on them is taken off, because weights are
/// submerged (weight_density). What remains of the contact forces is the excess.
struct FemWater {                        // [fem.water]
    double level = 0;                    // [m] z of p = 0
    double density = 1000;               // [kg/m3]
};

struct FemGeostatic {                    // [fem.geostatic] stress of soil at rest
    std::string set;                     // volume set
    double surface = 0;                  // [m] z where it is zero
    double earth_pressure = 1;           // K0, horizontal over vertical
};

/// Before the first step everything finds its equilibrium under its own weight, by kinetic damping;
/// displacements count from there.
struct FemSettle {                       // [fem.settle]
    double tolerance = 1e-3;             // largest force left on a node over the mean weight of a
                                         // node, and on a rigid body over its own weight
    int max_steps = 50000;
};

struct FemAbsorbing {                    // [[fem.absorbing]] viscous boundary, keeps the reaction of
    std::string set;                     // the start; facet set
    std::optional<Vec3> center{};        // [m] where the loads act: springs stand for the soil
                                         // beyond; none = dashpots alone, which give way to a load
                                         // that stays
};

struct FemRigid {                        // [[fem.rigid]] elements that move as one rigid body
    std::string name;                    // of its columns
    std::string set;                     // volume set
    std::vector<std::string> free{"x", "y", "z", "rx", "ry", "rz"};   // degrees of freedom
    double added_mass = 0;               // [kg] without weight, for example trapped water; in a half
                                         // model half of it
    Vec3 added_at{};                     // [m] its center
};

/// Nodes, or a rigid body, that move as they are told, and the force that takes. The laws are those
/// of [[sph.body]].
struct FemMotion {                       // [[fem.motion]]
    std::string name;                    // of its columns
    std::string set;                     // node, facet or volume set, or
    std::string rigid;                   // the name of a [[fem.rigid]]
    std::vector<std::string> directions{"x", "y", "z"};  // that are told; others stay as they are
    Vec3 velocity{};                     // [m/s] from start to stop, or
    double start = 0;                    // [s]
    double stop = std::numeric_limits<double>::infinity();   // [s]
    std::vector<Expression> displacement;  // [m] three formulas of t or numbers, or
    std::string motion;                  // CSV of t, x, y, z and, if it turns, angle [s, m, rad]
    double ramp = 0;                     // [s] velocity: rises (from start on) and falls (from stop on)
                                         // smoothly; displacement and angle: times a smooth rise from 0
    std::optional<Expression> angle;     // [rad] formula of t: all nodes turn as one
    Vec3 axis{0, 1, 0};                  // about this direction
    Vec3 center{};                       // [m] through this point, which moves along
};

/// Velocities at t = 0. What a support or a motion holds stays as it is.
struct FemInitialVelocity {              // [[fem.initial_velocity]]
    std::string set;                     // node, facet or volume set, or
    std::string rigid;                   // the name of a [[fem.rigid]]
    Vec3 velocity{};                     // [m/s], or
    std::vector<Expression> formulas;    // of a set: three formulas of x, y, z in the undeformed mesh
    Vec3 spin{};                         // [rad/s] on top: an angular velocity
    bool has_center = false;
    Vec3 center{};                       // [m] about this point; of a rigid body its center of mass,
                                         // where none is given
};

struct FemContact {                      // [[fem.contact]] contact inside the mesh
    std::string name;
    std::string nodes;                   // facet set whose nodes are kept out of
    std::string surface;                 // this facet set
    double friction = 0;                 // Coulomb coefficient
    double max_shear = 0;                // [Pa] upper limit of the friction stress; 0 = none
    double adhesion_factor = 0;          // the same as a share of the soil's own shear strength behind
                                         // each facet of `nodes`; 0 = none
    double gap = 0;                      // [m] distance in the mesh at which they touch
    double near = 0;                     // [m] nodes within it are kept in sight; 0 = two gaps
};

struct FemProbe {                        // [[fem.probe]] history of the node nearest to a point
    std::string name;
    Vec3 point{};                        // [m] in the undeformed mesh
};

/// A file of its own, fem.history.NAME.csv.
enum class FemHistoryKind { point, set, section, contact };
struct FemHistory {                      // [[fem.history]]
    std::string name;
    FemHistoryKind kind = FemHistoryKind::point;   // "point", "set", "section", "contact"
    Vec3 point{};                        // [m] point: the nearest node to it; section: a point of the
                                         // plane, and the one moments are about
    std::string set;                     // set: node, facet or volume set; section: a volume set,
                                         // whose force on the rest is taken, or
    std::optional<Vec3> normal{};        // section: of the plane; the force of the side that it points
                                         // to on the other
    std::string contact;                 // contact: name of a [[fem.contact]]
    double every = 0;                    // [s] 0 = output.history_every
};

struct FemSettings {
    bool present = false;
    std::string mesh;                    // path of a Gmsh .msh (4.1, 2.2) or an Abaqus
                                         // .inp, relative to the case file
    std::optional<FemBlock> block;
    double cfl = 0.9;                    // lambda of Eq. 13
    double damping_alpha = 0;            // [1/s] Rayleigh, mass-proportional
    double damping_beta = 0;             // [s] Rayleigh, stiffness-proportional; shortens the step
    std::optional<double> mass_scaling{};  // [s] elements that allow less than this step get heavier
                                         // until they do; their weight stays
    double bulk_viscosity_linear = 0.06;
    double bulk_viscosity_quadratic = 1.2;
    double implicit_damping = 0.005;     // of implicit parts: damping ratio of a mode over half of
                                         // omega dt; keeps a varying step from exciting fast modes
    std::vector<FemMaterial> material;
    std::vector<FemPart> part;
    std::vector<FemSupport> support;
    std::vector<FemMass> mass;
    std::vector<FemPressure> pressure;
    std::vector<FemTraction> traction;
    std::vector<FemSurface> surface;
    std::optional<FemWater> water;
    std::optional<FemGeostatic> geostatic;
    std::optional<FemSettle> settle;
    std::vector<FemAbsorbing> absorbing;
    std::vector<FemRigid> rigid;
    std::vector<FemMotion> motion;
    std::vector<FemInitialVelocity> initial_velocity;
    std::vector<FemContact> contact;
    std::vector<FemProbe> probe;
    std::vector<FemHistory> history;
};

// ---------------------------------------------------------------- [coupling]
enum class StiffnessLaw { fluid, eq11 };
enum class FrictionLaw { coulomb, viscous };

struct PressurePatch {                   // [[coupling.patch]] mean contact pressure over a patch
    std::string name;
    Box box;                             // [m] a contact counts by the share of its particle's
                                         // 2 l0 footprint that lies in the box
    double area = 0;                     // [m2] the force is divided by it
    double window = 0;                   // [s] moving mean, stated in the file's header; 0 = raw steps
};

struct CouplingSettings {
    StiffnessLaw law = StiffnessLaw::fluid;      // "fluid", "eq11"
    double stiffness_factor = 1;         // chi of k = chi rho c0^2 dx
    double beta = 0.25;                  // share of the stability budget for stiffness, (omega dt)^2
    double damping = 0.1;                // eta <= 0.1: share for normal damping, c dt / m_eff
    double friction = 0;                 // Coulomb coefficient
    FrictionLaw friction_law = FrictionLaw::coulomb;  // "coulomb", "viscous"
    double viscous_coefficient = 0;      // [N s/m] of Eq. 9, for "viscous"
    double skin = 0.3;                   // search skin in units of the particle spacing
    std::string transport = "shm";       // "shm" (on an ipc endpoint), "ipc", "tcp"
    double deadline = 60;                // [s]
    double join_timeout = 60;            // [s]
    std::vector<PressurePatch> patch;
};

struct Case {
    std::string file;                    // path as given
    std::string folder;                  // where relative paths start
    CaseInfo info;                       // [case]
    TimeSettings time;
    StartSettings start;
    OutputSettings output;
    CheckpointSettings checkpoint;
    SphSettings sph;
    FemSettings fem;
    CouplingSettings coupling;
    /// Every key as written, with its value: level, variants and --set laid over.
    std::vector<std::pair<std::string, std::string>> written;
};

}  // namespace undertow
