// fem_solver CASE --out DIR [--level L] [--with V]... [--set key=value]...
//            (--alone | --coupler ENDPOINT) [--threads N] [--quiet]

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <thread>

#include "case/case_file.hpp"
#include "fem_solver/coupling.hpp"
#include "fem_solver/setup/mesh_check.hpp"
#include "fem_solver/solver.hpp"
#include "results/log.hpp"
#include "results/stop_signal.hpp"
#include "wire/errors.hpp"

namespace undertow::fem {
namespace {

struct Arguments {
    std::string case_path, folder, coupler;
    CaseOptions options;
    bool alone = false, quiet = false;
    int threads = 0;  // 0: all cores alone, one in a coupled run
};

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

int run(const Arguments& arguments, std::unique_ptr<Link>& link) {
    const Case c = read_case(arguments.case_path, arguments.options);
    const std::string folder =
        arguments.folder.empty() ? "results/" + c.info.name : arguments.folder;
    std::error_code failed;
    std::filesystem::create_directories(folder, failed);
    if (failed)
        throw InputError("--out: cannot make the folder " + folder + ": " + failed.message() + ".");
    open_log(folder + "/fem_solver.log", "fem_solver");
    if (!c.fem.present) throw InputError(c.file + ": the case has no [fem] table.");

    link = arguments.alone ? run_alone(c) : join_coupler(c, arguments.coupler);
    Model model = build_model(c);
    const MeshQuality quality = check_mesh(model.mesh);
    const int cores = int(std::max(1u, std::thread::hardware_concurrency()));
    const int threads = arguments.threads > 0 ? arguments.threads : arguments.alone ? cores : 1;
    Structure structure(std::move(model), threads);
    log_start(structure, quality);

    Output output(folder, c, structure);
    ProgressLine line(arguments.quiet || !arguments.alone,
                      arguments.alone ? folder + "/status.json" : "");
    const bool complete = Solver(c, structure, *link, output, line).run();
    log_info(complete ? "done" : "ended by the user");
    return complete ? exit_done : exit_interrupted;
}

int report(const std::unique_ptr<Link>& link, ExitCode exit, const std::string& code,
           const std::string& text) {
    log_error(text);
    if (link) link->report_error(code, text);
    return exit;
}

}  // namespace
}  // namespace undertow::fem

int main(int argc, char** argv) {
    using namespace undertow;
    CLI::App app{"Explicit finite elements for structures, alone or coupled."};
    app.set_version_flag("--version", "fem_solver " UNDERTOW_VERSION);
    fem::Arguments arguments;
    app.add_option("CASE", arguments.case_path, "a .toml file, or a folder that holds case.toml")
        ->required();
    app.add_option("--out", arguments.folder, "folder of the results; default results/NAME");
    app.add_option("--level", arguments.options.level, "a [level.NAME] of the case");
    app.add_option("--with", arguments.options.variants, "a [variant.NAME]; may be repeated")
        ->allow_extra_args(false);
    app.add_option("--set", arguments.options.set, "key=value, overrides a key; may be repeated")
        ->allow_extra_args(false);
    auto* where = app.add_option_group("where");
    where->add_flag("--alone", arguments.alone, "without a coupler");
    where->add_option("--coupler", arguments.coupler, "endpoint of the coupler, ipc:// or tcp://");
    where->require_option(1);
    app.add_option("--threads", arguments.threads, "default: all cores alone, one when coupled")
        ->check(CLI::PositiveNumber);
    app.add_flag("--quiet", arguments.quiet, "no live line");
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        return app.exit(error) == 0 ? exit_done : exit_input;
    }

    std::unique_ptr<fem::Link> link;
    try {
        install_stop_signal();
        return fem::run(arguments, link);
    } catch (const InputError& error) {
        return fem::report(link, exit_input, "E_INPUT", error.what());
    } catch (const PeerError& error) {
        return fem::report(link, exit_peer, error.code, error.what());
    } catch (const PhysicsError& error) {
        return fem::report(link, exit_physics, "E_PHYSICS", error.what());
    } catch (const std::exception& error) {  // a full disk, no memory
        return fem::report(link, exit_input, "E_IO", error.what());
    }
}
