// fem_solver: explicit finite elements, alone or as the surface side of a coupled run.

#include <algorithm>
#include <cstdio>
#include <exception>
#include <memory>
#include <optional>
#include <utility>
#include <thread>

#include "case/program_options.hpp"
#include "fem_solver/coupling.hpp"
#include "fem_solver/settle.hpp"
#include "fem_solver/setup/mesh_check.hpp"
#include "fem_solver/solver.hpp"
#include "results/log.hpp"
#include "wire/failure.hpp"

namespace undertow::fem {
namespace {

template <class... Values>
std::string sentence(const char* format, Values... values) {
    char text[512];
    std::snprintf(text, sizeof text, format, values...);
    return text;
}

/// "120 hexahedra and 14 tetrahedra"
std::string count_elements(const Mesh& mesh) {
    std::string words;
    const auto add = [&](std::size_t n, const char* kind) {
        if (n > 0) words += (words.empty() ? "" : " and ") + std::to_string(n) + " " + kind;
    };
    add(mesh.hexahedra.size(), "hexahedra");
    add(mesh.tetrahedra.size(), "tetrahedra");
    add(mesh.shells.size(), "shells");
    return words;
}

void log_start(const Structure& structure, const MeshQuality& quality) {
    const Mesh& mesh = structure.model().mesh;
    log_info(
        sentence("mesh %s: %s, %zu nodes; worst aspect %.3g (%s), smallest corner "
                 "Jacobian %.3g of its element's mean (%s)",
                 mesh.source.c_str(), count_elements(mesh).c_str(), mesh.x.size(), quality.worst_aspect,
                 mesh.element_name(quality.worst_aspect_element).c_str(), quality.worst_corner,
                 mesh.element_name(quality.worst_corner_element).c_str()));
    for (const std::string& remark : mesh.remarks) log_warning(mesh.source + ": " + remark);
    for (const RigidBody& body : structure.bodies())
        log_info(sentence("rigid body %s: %zu elements, %.6g kg (of it %g added), center (%.4g, "
                          "%.4g, %.4g) m",
                          body.set().name.c_str(), body.set().elements.size(), body.mass(),
                          body.set().added_mass, body.center()[0], body.center()[1],
                          body.center()[2]));
    for (const ContactPair& pair : structure.pairs())
        log_info(sentence("contact %s: %zu nodes, %d of them touching, on %zu facets; springs at "
                          "least %.3g E A/h (10 unless stability allows less)",
                          pair.set().name.c_str(), pair.set().nodes.size(), pair.nodes_near(),
                          pair.set().surface.size(), pair.softest()));
    if (const ImplicitParts* implicit = structure.implicit())
        log_info(sentence("implicit parts: %zu unknowns; explicit, their elements' bound would be "
                          "%.4g s. A mode omega moves slower by (omega dt)^2/9",
                          implicit->unknowns(), implicit->explicit_step()));
    for (const ScaledPart& part : structure.model().mass_scaling)
        log_info(sentence("mass scaling of %s: %zu elements are heavier, %.6g kg of inertia added "
                          "to %.6g kg (%.3g %%); weight is as it was",
                          part.part.c_str(), part.elements, part.added, part.mass,
                          part.mass > 0 ? 100 * part.added / part.mass : 0.0));
    if (structure.omega_bound() == 0) return;
    const std::size_t stiffest = structure.elements().stiffest();
    log_info(
        sentence("stable step: %.4g s by the elements' bound (%s of %s), %.4g s by the "
                 "largest frequency of the mesh; fem.cfl = %g and viscosity come on top",
                 2 / structure.omega_bound(), mesh.element_name(stiffest).c_str(),
                 structure.elements().part_name(stiffest).c_str(), 2 / structure.omega_start(),
                 structure.model().cfl));
}

void log_settlement(const Settlement& s, const Structure& structure) {
    if (!s.complete) return log_info("settling ended by the user");
    std::string bodies;
    for (std::size_t b = 0; b < s.body_displacement.size(); ++b)
        bodies += sentence(", %s by %.4g m in z", structure.bodies()[b].set().name.c_str(),
                           s.body_displacement[b][2]);
    log_info(sentence("settled in %lld steps (%.1f s): largest force left %.3g N (a node weighs "
                      "%.3g N on average), largest displacement %.4g m",
                      static_cast<long long>(s.steps), s.wall, s.residual, s.reference,
                      s.largest_displacement) +
             bodies);
}

/// The structure at rest in equilibrium, ready for its first step.
struct Prepared {
    std::unique_ptr<Structure> structure;
    std::optional<Settlement> settlement;
};

Prepared prepare(const Case& c, const ProgramOptions& options) {
    const bool alone = options.endpoint.empty();
    Model model = build_model(c);
    const MeshQuality quality = check_mesh(model.mesh);
    const int cores = int(std::max(1u, std::thread::hardware_concurrency()));
    Prepared prepared;
    prepared.structure = std::make_unique<Structure>(std::move(model),
                                                     options.threads > 0 ? options.threads
                                                     : alone             ? cores
                                                                         : 1);
    log_start(*prepared.structure, quality);
    if (c.fem.settle && options.resume.empty()) {
        prepared.settlement = settle(*prepared.structure, *c.fem.settle);
        log_settlement(*prepared.settlement, *prepared.structure);
    }
    return prepared;
}

int run(const Case& c, const ProgramOptions& options, Link& link, Prepared prepared) {
    const bool alone = options.endpoint.empty();
    const FileStart files = options.resume.empty() ? FileStart::fresh : FileStart::continued;
    Output output(options.folder, c, *prepared.structure, prepared.settlement, files);
    ProgressLine line(options.quiet || !alone, alone ? options.folder + "/status.json" : "");
    Solver solver(c, *prepared.structure, link, output, line);
    if (!options.resume.empty()) solver.resume(options.resume);
    const bool complete = solver.run();
    log_info(complete ? "done" : "ended by the user");
    return complete ? exit_done : exit_interrupted;
}

int join_and_run(ProgramOptions options) {
    const Case c = open_case(options, "fem_solver");
    if (!c.fem.present) throw InputError(c.file + ": the case has no [fem] table.");
    // Settling takes its time before the others are asked to wait; what it finds wrong is told to
    // them all the same.
    Prepared prepared;
    std::exception_ptr trouble;
    if (c.fem.settle) try {
            prepared = prepare(c, options);
        } catch (const std::exception&) {
            trouble = std::current_exception();
        }
    const std::unique_ptr<Link> link =
        options.endpoint.empty() ? run_alone(c, options.folder)
                                 : join_coupler(c, options.endpoint, options.keys);
    try {
        if (trouble) std::rethrow_exception(trouble);
        if (!prepared.structure) prepared = prepare(c, options);
        return run(c, options, *link, std::move(prepared));
    } catch (const std::exception& error) {
        link->report_error(failure_of(error).code, error.what());
        throw;
    }
}

}  // namespace
}  // namespace undertow::fem

int main(int argc, char** argv) {
    using namespace undertow;
    return run_program(argc, argv,
                       {"fem_solver", "Explicit finite elements for structures, alone or coupled.",
                        ProgramKind::solver, fem::join_and_run});
}
