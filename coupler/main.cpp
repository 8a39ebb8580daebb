// coupler CASE --out DIR --endpoint ENDPOINT [--level L] [--with V]... [--set key=value]...
// [--quiet]

#include <CLI/CLI.hpp>
#include <filesystem>

#include "case/case_file.hpp"
#include "coupler/coupler.hpp"
#include "results/log.hpp"
#include "results/stop_signal.hpp"
#include "wire/errors.hpp"

namespace {

void open_folder(const std::string& folder) {
    std::error_code error;
    std::filesystem::create_directories(folder, error);
    if (error)
        throw undertow::InputError("--out: cannot create the folder " + folder + ": " +
                                   error.message() + ".");
    undertow::open_log(folder + "/coupler.log", "coupler");
}

}  // namespace

int main(int argc, char** argv) {
    CLI::App app{"Couples a particle solver and a structure: contact, common time step, audit."};
    app.set_version_flag("--version", "coupler " UNDERTOW_VERSION);
    std::string path;
    undertow::CaseOptions layers;
    undertow::coupler::CouplerOptions options;
    app.add_option("CASE", path, "a .toml file, or a folder that holds case.toml")->required();
    app.add_option("--out", options.folder, "folder of the results")->required();
    app.add_option("--endpoint", options.endpoint,
                   "where the solvers find this program: ipc:///DIR/coupler.sock or "
                   "tcp://127.0.0.1:PORT")
        ->required();
    app.add_option("--level", layers.level, "a [level.NAME] of the case");
    app.add_option("--with", layers.variants, "a [variant.NAME] of the case; may be repeated")
        ->allow_extra_args(false);
    app.add_option("--set", layers.set, "key=value, overrides a key; may be repeated")
        ->allow_extra_args(false);
    app.add_flag("--quiet", options.quiet, "no live line");
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        return app.exit(error) == 0 ? undertow::exit_done : undertow::exit_input;
    }
    try {
        undertow::install_stop_signal();
        const undertow::Case input = undertow::read_case(path, layers);
        open_folder(options.folder);
        return undertow::coupler::Coupler(input, options).run();
    } catch (const undertow::InputError& error) {
        undertow::log_error(error.what());
        return undertow::exit_input;
    } catch (const undertow::PeerError& error) {
        undertow::log_error(error.code + ": " + error.what());
        return undertow::exit_peer;
    } catch (const undertow::PhysicsError& error) {
        undertow::log_error(error.what());
        return undertow::exit_physics;
    } catch (const std::exception& error) {
        // A defect of this program; the participants have been told.
        undertow::log_error(std::string("internal error: ") + error.what());
        return undertow::exit_physics;
    }
}
