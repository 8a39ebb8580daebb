// Does the energy of particles pressed on one node stay bounded? Prints the table of
// docs/theory_contact.md, section 3: largest kinetic energy after the first tenth of the steps over
// the largest in it, for P particles, their mass against the node's, and the structure's own CFL.
//   bench_contact_stability [steps, default 1000000]
// With the default it takes six minutes on one core.

#include <cstdio>
#include <cstdlib>

#include "../unit/contact/pressed_node.hpp"
#include "clocks.hpp"

using namespace undertow::contact;
using namespace undertow::contact::test;

int main(int argc, char** argv) {
    const int steps = argc > 1 ? std::atoi(argv[1]) : 1000000;
    const double start = undertow::benchmarks::cpu_clock();
    double contact_steps = 0;
    int grown = 0;
    std::printf("%d steps; largest kinetic energy after the first tenth over the largest in it\n",
                steps);
    for (const bool damped : {false, true})
        for (const double cfl : {0.8, 0.9, 0.98}) {
            const LawSettings law = within_budget(cfl, damped);
            std::printf("\n%s, CFL %.2f: beta = %.3f, eta = %.3f\nmass ratio",
                        damped ? "damped" : "undamped", cfl, law.beta, law.eta);
            for (const int P : {1, 4, 9, 16, 100}) std::printf("   P = %-3d", P);
            for (const double ratio : {1e-3, 1.0, 1e3}) {
                std::printf("\n%10g", ratio);
                for (const int P : {1, 4, 9, 16, 100}) {
                    const PressedEnergies e = press_on_one_node({P, ratio, cfl, steps}, law);
                    contact_steps += double(P) * steps;
                    if (!(e.late < 2 * e.early)) ++grown;
                    std::printf(" %9.3g", e.late / e.early);
                    std::fflush(stdout);
                }
            }
            std::printf("\n");
        }
    const double spent = undertow::benchmarks::cpu_clock() - start;
    std::printf("\n%d of 90 more than doubled; %.0f CPU s, %.0f ns a particle and step\n",
                grown, spent, 1e9 * spent / contact_steps);
    return 0;
}
