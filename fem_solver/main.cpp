// fem_solver: explicit finite elements, alone or as the surface side of a coupled run.

#include <algorithm>
#include <cstdio>
#include <memory>
#include <thread>

#include "case/program_options.hpp"
#include "fem_solver/coupling.hpp"
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

void log_start(const Structure& structure, const MeshQuality& quality) {
    const Mesh& mesh = structure.model().mesh;
    const std::size_t stiffest = structure.elements().stiffest();
    log_info(
        sentence("mesh %s: %zu hexahedra, %zu nodes; worst aspect %.3g (%s), smallest corner "
                 "Jacobian %.3g of its element's mean (%s)",
                 mesh.source.c_str(), mesh.hexahedra.size(), mesh.x.size(), quality.worst_aspect,
                 mesh.element_name(quality.worst_aspect_element).c_str(), quality.worst_corner,
                 mesh.element_name(quality.worst_corner_element).c_str()));
    log_info(
        sentence("stable step: %.4g s by the elements' bound (%s of %s), %.4g s by the "
                 "largest frequency of the mesh; fem.cfl = %g and viscosity come on top",
                 2 / structure.omega_bound(), mesh.element_name(stiffest).c_str(),
                 structure.elements().part_name(stiffest).c_str(), 2 / structure.omega_start(),
                 structure.model().cfl));
}

int run(const Case& c, const ProgramOptions& options, Link& link) {
    const bool alone = options.endpoint.empty();
    Model model = build_model(c);
    const MeshQuality quality = check_mesh(model.mesh);
    const int cores = int(std::max(1u, std::thread::hardware_concurrency()));
    Structure structure(std::move(model), options.threads > 0 ? options.threads
                                          : alone             ? cores
                                                              : 1);
    log_start(structure, quality);

    Output output(options.folder, c, structure);
    ProgressLine line(options.quiet || !alone, alone ? options.folder + "/status.json" : "");
    const bool complete = Solver(c, structure, link, output, line).run();
    log_info(complete ? "done" : "ended by the user");
    return complete ? exit_done : exit_interrupted;
}

int join_and_run(ProgramOptions options) {
    const Case c = open_case(options, "fem_solver");
    if (!c.fem.present) throw InputError(c.file + ": the case has no [fem] table.");
    const std::unique_ptr<Link> link =
        options.endpoint.empty() ? run_alone(c) : join_coupler(c, options.endpoint);
    try {
        return run(c, options, *link);
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
