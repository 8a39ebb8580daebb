#pragma once
// The [fem] table with every name resolved: sets to nodes, facets and elements, materials to laws.

#include <limits>
#include <string>
#include <vector>

#include "fem_solver/boundary/prescribed_motion.hpp"
#include "fem_solver/boundary/pressure.hpp"
#include "fem_solver/boundary/traction.hpp"
#include "fem_solver/contact_pairs/contact_set.hpp"
#include "fem_solver/elements/part.hpp"
#include "fem_solver/mesh.hpp"
#include "fem_solver/setup/ground.hpp"
#include "fem_solver/setup/initial_velocities.hpp"
#include "fem_solver/setup/mass_scaling.hpp"
#include "fem_solver/setup/point_masses.hpp"
#include "fem_solver/rigid/rigid_set.hpp"
#include "fem_solver/section_force.hpp"
#include "fem_solver/shells/face_layout.hpp"

namespace undertow::fem {

struct Support {
    std::string name;  // its set
    std::vector<std::int32_t> nodes;
    std::array<bool, 3> fixed{};   // x, y, z
    std::array<bool, 3> turned{};  // rotations about x, y, z that are held; of nodes of shells
};

/// The coupled surfaces as one list of facets on their own nodes.
struct CoupledSurface : FaceLayout {
    std::vector<std::string> names;
    std::vector<std::int32_t> group;  // per quad, index into names
};

struct Probe {
    std::string name;
    std::int32_t node = 0;
};

struct Model {
    Mesh mesh;
    std::vector<Part> parts;
    BulkViscosity bulk_viscosity;
    std::vector<Support> supports;
    std::vector<PressureLoad> pressures;
    std::vector<TractionLoad> tractions;
    std::vector<PrescribedMotion> motions;
    InitialVelocities initial_velocities;
    CoupledSurface surface;
    std::vector<InitialStress> initial_stress;
    AbsorbingBoundary far_field;
    std::optional<StaticWater> water;
    std::vector<Probe> probes;
    std::vector<SectionForce> sections;  // of [[fem.history]], in its order
    std::vector<RigidSet> rigid;       // their elements are in no part
    std::vector<ContactSet> contacts;  // inside the mesh
    std::vector<PointMass> point_masses;
    std::vector<double> strength;  // [Pa] (n_elements) s_u or c of each element, 0 of what has none;
                                   // empty when it is one value in every part
    std::vector<ScaledPart> mass_scaling;  // of every part, empty when none was asked for
    double coupled_share = 0;  // of the stability budget that the coupler takes at coupled nodes
    double max_step = std::numeric_limits<double>::infinity();  // [s] the case's own limit
    Vec3 gravity{};      // [m/s2]
    double damping = 0;  // [1/s] Rayleigh alpha
    double damping_beta = 0;  // [s] Rayleigh beta
    double cfl = 0.9;    // lambda of Eq. 13
    double implicit_damping = 0;  // of implicit parts: c/dt, see fem_solver/implicit
};

/// Of the undeformed mesh.
std::int32_t nearest_node(const Mesh& mesh, const Vec3& point);

/// Reads or makes the mesh and resolves the tables. A 2D case holds every node in y and must be one
/// case.thickness thick. InputError for unknown names, elements in no part or in two, and the like.
Model build_model(const Case& c);
/// The same with a mesh that is there already.
Model build_model(const Case& c, Mesh mesh);

}  // namespace undertow::fem
