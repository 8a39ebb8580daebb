#pragma once
// The command line that all three programs share.
//
//     sph_solver CASE --out DIR [--level L] [--with V]... [--set key=value]...
//                (--alone | --coupler ENDPOINT [--keys FOLDER]) [--threads N] [--resume SET]
//                [--quiet]
//     coupler    CASE --out DIR --endpoint ENDPOINT [--keys FOLDER] [--record] [--level L]
//                [--with V]... [--set key=value]... [--resume SET] [--quiet]

#include <functional>
#include <string>

#include "case/case_file.hpp"

namespace undertow {

enum class ProgramKind { solver, coupler };

struct ProgramOptions {
    std::string case_path;
    CaseOptions layers;
    std::string folder;      // of the results; empty = results/NAME
    std::string endpoint;    // of the coupler; empty = alone
    std::string keys;        // folder, see wire/curve_keys.hpp; empty = none
    bool record = false;     // coupler: the sessions go to recording.NAME.utow
    int threads = 0;         // 0 = the program's own choice
    std::string resume;      // a set of checkpoints to go on from; empty = from the start
    bool quiet = false;
};

struct Program {
    std::string name;          // "sph_solver"
    std::string description;
    ProgramKind kind;
    /// Its result is the exit code; an error that it throws becomes one.
    std::function<int(const ProgramOptions&)> run;
};

/// Parses, installs the stop signal, runs, and turns errors into log lines and exit codes as
/// failure_of() has them; a wrong command line is 2.
int run_program(int argc, char** argv, const Program& program);

/// The case named on the command line; makes the folder of the results and opens the log there.
Case open_case(ProgramOptions& options, const std::string& program);

}  // namespace undertow
