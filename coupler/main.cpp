// coupler: brings a particle solver and a structure together.

#include "case/program_options.hpp"
#include "coupler/coupler.hpp"

int main(int argc, char** argv) {
    using namespace undertow;
    return run_program(
        argc, argv,
        {"coupler", "Couples a particle solver and a structure: contact, common time step, audit.",
         ProgramKind::coupler, [](ProgramOptions options) {
             const Case input = open_case(options, "coupler");
             const coupler::CouplerOptions own{
                 options.folder,
                 {options.endpoint, options.keys, options.record ? options.folder : ""},
                 options.quiet,
                 options.resume};
             return coupler::Coupler(input, own).run();
         }});
}
