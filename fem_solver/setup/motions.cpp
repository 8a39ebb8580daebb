#include "fem_solver/setup/motions.hpp"

#include <algorithm>
#include <cmath>

#include "wire/errors.hpp"
#include "wire/number_text.hpp"

namespace undertow::fem {
namespace {

constexpr char axis[] = "xyz";

std::string name_of(const PrescribedMotion& motion) {
    return "fem.motion \"" + motion.name() + "\"";
}

std::array<bool, 3> directions_of(const FemMotion& motion) {
    std::array<bool, 3> told{};
    for (const std::string& direction : motion.directions) told[direction[0] - 'x'] = true;
    return told;
}

int drive_body(const FemMotion& motion, const std::array<bool, 3>& told, bool turns,
               std::vector<RigidSet>& bodies) {
    const auto body = std::find_if(bodies.begin(), bodies.end(),
                                   [&](const RigidSet& b) { return b.name == motion.rigid; });
    for (int d = 0; d < 3; ++d) {
        if (!told[d]) continue;
        if (body->driven[d])
            throw InputError("fem.motion \"" + motion.name + "\": " + axis[d] +
                             " of the rigid body \"" + body->name +
                             "\" is told by another fem.motion already; keep one.");
        body->driven[d] = true;
    }
    body->turn_driven |= turns;
    return int(body - bodies.begin());
}

void check_nodes(const std::string& name, const Mesh& mesh, const std::vector<RigidSet>& bodies,
                 const std::vector<std::int32_t>& nodes) {
    for (const RigidSet& body : bodies)
        for (std::int32_t n : nodes)
            if (std::binary_search(body.nodes.begin(), body.nodes.end(), n))
                throw InputError(name + ": its node at " + point_text(mesh.x[n]) +
                                 " belongs to the rigid body \"" + body.name +
                                 "\"; tell the body, by rigid = \"" + body.name + "\".");
    std::vector<bool> of_element(mesh.x.size(), false);
    for (std::size_t e = 0; e < mesh.n_elements(); ++e)
        for (std::int32_t n : mesh.corners(e)) of_element[n] = true;
    for (std::int32_t n : nodes)
        if (!of_element[n])
            throw InputError(name + ": its node at " + point_text(mesh.x[n]) +
                             " belongs to no element; immobile facets cannot move.");
}

void check_held_start(const Case& c, const MotionLaw& law, const std::string& name) {
    const MotionLaw::Place start = law(0);
    for (const double t : {0.5 * c.start.settle, c.start.settle}) {
        const MotionLaw::Place place = law(t);
        if (place.shift == start.shift && place.angle == start.angle) continue;
        throw InputError(name + " moves before t = " + number_text(c.start.settle) +
                         " s, until when start.settle holds the structure; let it begin there, "
                         "for example by start.");
    }
}

[[noreturn]] void reject_node(const Model& model, const PrescribedMotion& motion, std::int32_t n,
                              const std::string& other) {
    throw InputError(name_of(motion) + ": the node at " + point_text(model.mesh.x[n]) + " is " +
                     other);
}

void check_twice_told(const Model& model) {
    std::vector<std::uint8_t> told(model.mesh.x.size(), 0);
    for (const Support& support : model.supports)
        for (std::int32_t n : support.nodes)
            for (int d = 0; d < 3; ++d) told[n] |= std::uint8_t(support.fixed[d] << d);
    const std::vector<std::uint8_t> fixed = told;
    for (const PrescribedMotion& motion : model.motions)
        for (std::int32_t n : motion.nodes())
            for (int d = 0; d < 3; ++d) {
                if (!motion.directions()[d]) continue;
                if (fixed[n] >> d & 1)
                    reject_node(model, motion, n,
                                std::string("held in ") + axis[d] +
                                    " by a support as well; take it out of one of the two, or "
                                    "name other directions.");
                if (told[n] >> d & 1)
                    reject_node(model, motion, n,
                                std::string("told in ") + axis[d] +
                                    " by another fem.motion as well; keep one.");
                told[n] |= std::uint8_t(1 << d);
            }
}

void check_other_nodes(const Case& c, const Model& model) {
    std::vector<std::uint8_t> absorbing(model.mesh.x.size(), 0), implicit = absorbing;
    for (const FemAbsorbing& a : c.fem.absorbing)
        for (std::int32_t n : model.mesh.nodes_of(a.set, "fem.absorbing")) absorbing[n] = 1;
    for (const Part& part : model.parts)
        if (part.implicit)
            for (std::int32_t e : part.elements)
                for (std::int32_t n : model.mesh.corners(e)) implicit[n] = 1;
    for (const PrescribedMotion& motion : model.motions)
        for (std::int32_t n : motion.nodes()) {
            if (absorbing[n])
                reject_node(model, motion, n, "on an absorbing boundary, which moves by itself.");
            if (implicit[n])
                reject_node(model, motion, n, "of an implicit part; leave that part explicit.");
        }
}

}  // namespace

std::vector<PrescribedMotion> make_motions(const Case& c, const Mesh& mesh,
                                           std::vector<RigidSet>& bodies) {
    std::vector<PrescribedMotion> motions;
    for (const FemMotion& m : c.fem.motion) {
        const std::string name = "fem.motion \"" + m.name + "\"";
        MotionLaw law(m, c.time.end, c.folder, name);
        check_held_start(c, law, name);
        const std::array<bool, 3> told =
            law.turns() ? std::array<bool, 3>{true, true, true} : directions_of(m);
        std::vector<std::int32_t> nodes;
        int body = -1;
        if (m.rigid.empty()) {
            nodes = mesh.nodes_of(m.set, "fem.motion");
            check_nodes(name, mesh, bodies, nodes);
        } else {
            body = drive_body(m, told, law.turns(), bodies);
        }
        motions.emplace_back(m.name, std::move(law), told, std::move(nodes), body);
    }
    return motions;
}

void check_motions(const Case& c, Model& model) {
    if (model.motions.empty()) return;
    check_twice_told(model);
    check_other_nodes(c, model);
    for (RigidSet& body : model.rigid)
        for (int d = 0; d < 3; ++d) {
            body.free[d] &= !body.driven[d];
            body.free[3 + d] &= !body.turn_driven;
        }
}

}  // namespace undertow::fem
