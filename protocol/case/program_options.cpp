#include "case/program_options.hpp"

#include <CLI/CLI.hpp>
#include <filesystem>

#include "results/log.hpp"
#include "results/stop_signal.hpp"
#include "wire/failure.hpp"

namespace undertow {

int run_program(int argc, char** argv, const Program& program) {
    CLI::App app{program.description};
    app.name(program.name);
    app.set_version_flag("--version", program.name + " " UNDERTOW_VERSION);
    ProgramOptions options;
    bool alone = false;
    app.add_option("CASE", options.case_path, "a .toml file, or a folder that holds case.toml")
        ->required();
    app.add_option("--out", options.folder, "folder of the results; default results/NAME");
    app.add_option("--level", options.layers.level, "a [level.NAME] of the case");
    app.add_option("--with", options.layers.variants, "a [variant.NAME]; may be repeated")
        ->allow_extra_args(false);
    app.add_option("--set", options.layers.set, "key=value, overrides a key; may be repeated")
        ->allow_extra_args(false);
    if (program.kind == ProgramKind::solver) {
        auto* where = app.add_option_group("where", "alone or coupled");
        where->add_flag("--alone", alone, "without a coupler");
        where->add_option("--coupler", options.endpoint,
                          "endpoint of the coupler, ipc:// or tcp://, or replay://FILE");
        where->require_option(1);
        app.add_option("--threads", options.threads, "default: all cores alone, one when coupled")
            ->check(CLI::PositiveNumber);
    } else {
        app.add_option("--endpoint", options.endpoint,
                       "where to listen: ipc:///folder/coupler.sock, tcp://127.0.0.1:port, or with --keys "
                       "tcp://address:port")
            ->required();
        app.add_flag("--record", options.record,
                     "write the sessions to recording.NAME.utow, to be replayed");
    }
    app.add_option("--resume", options.resume,
                   "go on from this set: DIR/checkpoints/STEP, with the same case and DIR");
    app.add_option("--keys", options.keys,
                   "folder of keys for other hosts, made by `undertow keys`");
    app.add_flag("--quiet", options.quiet, "no live line");
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        return app.exit(error) == 0 ? exit_done : exit_input;
    }

    try {
        install_stop_signal();
        return program.run(options);
    } catch (const std::exception& error) {
        const Failure failure = failure_of(error);
        log_error(failure.text);
        return failure.exit;
    }
}

Case open_case(ProgramOptions& options, const std::string& program) {
    Case input = read_case(options.case_path, options.layers);
    if (options.folder.empty()) options.folder = "results/" + input.info.name;
    std::error_code failed;
    std::filesystem::create_directories(options.folder, failed);
    if (failed)
        throw InputError("--out: cannot make the folder " + options.folder + ": " +
                         failed.message() + ".");
    open_log(options.folder + "/" + program + ".log", program,
             options.resume.empty() ? LogStart::fresh : LogStart::continued);
    return input;
}

}  // namespace undertow
