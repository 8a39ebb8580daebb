// sph_solver: weakly compressible SPH, alone or as the particle side of a coupled run.

#include "case/program_options.hpp"
#include "sph_solver/solver.hpp"
#include "wire/errors.hpp"

int main(int argc, char** argv) {
    using namespace undertow;
    return run_program(
        argc, argv,
        {"sph_solver", "Smoothed particle hydrodynamics for water and slides, alone or coupled.",
         ProgramKind::solver, [](ProgramOptions options) {
             const Case input = open_case(options, "sph_solver");
             if (!input.sph.present)
                 throw InputError(input.file + ": the case has no [sph] table.");
             return sph::run(input, {options.folder, options.endpoint, options.threads, options.quiet,
                                     options.keys, options.resume});
         }});
}
