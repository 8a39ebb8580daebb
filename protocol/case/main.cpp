// undertow_case CASE [--level L] [--with V]... [--set key=value]... [--binding]: reads a case by
// the rules of the solvers and prints it resolved as JSON, or with --binding the keys that the
// programs of a coupled run must have in common, a line each (case/binding_keys.hpp). Exit code 2
// and one sentence when it is not valid.

#include <CLI/CLI.hpp>
#include <cstdio>

#include "case/binding_keys.hpp"
#include "case/resolved_case.hpp"
#include "wire/errors.hpp"

int main(int argc, char** argv) {
    CLI::App app{"Checks a case file and prints it resolved as JSON."};
    app.set_version_flag("--version", "undertow_case " UNDERTOW_VERSION);
    std::string path;
    undertow::CaseOptions options;
    app.add_option("CASE", path, "a .toml file, or a folder that holds case.toml")->required();
    app.add_option("--level", options.level, "a [level.NAME] of the case");
    app.add_option("--with", options.variants, "a [variant.NAME] of the case; may be repeated")
        ->allow_extra_args(false);
    app.add_option("--set", options.set, "key=value, overrides a key; may be repeated")
        ->allow_extra_args(false);
    bool binding = false;
    app.add_flag("--binding", binding,
                 "print the keys that all programs of a coupled run must have in common");
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        return app.exit(error) == 0 ? undertow::exit_done : undertow::exit_input;
    }
    try {
        const undertow::ResolvedCase resolved = undertow::resolve_case(path, options);
        if (binding)
            for (const std::string& line : undertow::binding_keys(resolved.values))
                std::puts(line.c_str());
        else
            std::puts(undertow::case_json(resolved).c_str());
        return undertow::exit_done;
    } catch (const undertow::InputError& error) {
        std::fprintf(stderr, "%s\n", error.what());
        return undertow::exit_input;
    }
}
