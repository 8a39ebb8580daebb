// Does the energy of particles pressed on one node stay bounded? Fills the table of
// docs/theory_contact.md, section 3: largest kinetic energy after the first tenth of the steps over
// the largest in it, the worst of eight starts, for P particles, their mass against the node's, and
// the structure's own CFL.
//   bench_contact_stability [steps, default 1000000] [--long]
//       [--cfl C] [--particles P] [--ratio R] [--share S] [--undamped] [--damped]
//       [--eta F] [--implicit] [--friction MU]
// Each of the first four picks cells (several times: several cells). --long: mass ratios of every
// decade instead of every third. --share S: stiffness and damping use S of what the structure
// leaves; without it 2/3, and no more than the defaults beta = 0.25, eta = 0.1. --eta F: times the
// damping. --implicit: the structure takes linearly implicit steps, C is half its omega dt and any
// number.

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>

#include "../unit/contact/pressed_node_lanes.hpp"
#include "clocks.hpp"

using namespace undertow::contact;
using namespace undertow::contact::test;

namespace {

/// beta + 2 eta = share of the rest, in the proportion of the defaults.
LawSettings share_of_rest(double cfl, bool damped, double share) {
    LawSettings law = within_budget(cfl, damped);
    const double rest = 4 * (1 - cfl * cfl), scale = share * rest / (law.beta + 2 * law.eta);
    law.beta *= scale;
    law.eta *= scale;
    return law;
}

}  // namespace

int main(int argc, char** argv) {
    int steps = 1000000;
    std::vector<double> cfls, ratios, counts, shares;
    double eta_factor = 1, mu = 0;
    WallStep wall = WallStep::leapfrog;
    bool damped = true, undamped = true, every_decade = false;
    for (int i = 1; i < argc; ++i) {
        const std::string word = argv[i];
        const auto number = [&] { return ++i < argc ? std::atof(argv[i]) : 0; };
        if (word == "--cfl")
            cfls.push_back(number());
        else if (word == "--particles")
            counts.push_back(number());
        else if (word == "--ratio")
            ratios.push_back(number());
        else if (word == "--share")
            shares.push_back(number());
        else if (word == "--eta")
            eta_factor = number();
        else if (word == "--friction")
            mu = number();
        else if (word == "--implicit")
            wall = WallStep::linearly_implicit;
        else if (word == "--damped")
            undamped = false;
        else if (word == "--undamped")
            damped = false;
        else if (word == "--long")
            every_decade = true;
        else
            steps = std::atoi(word.c_str());
    }
    if (cfls.empty()) {
        cfls = {0.8, 0.9, 0.95, 0.98};
        if (wall == WallStep::linearly_implicit) cfls = {0.01, 0.5, 1, 10, 100};
    }
    if (counts.empty()) counts = {1, 4, 9, 16, 100};
    if (shares.empty()) shares = {0};
    if (ratios.empty())
        for (int decade = -3; decade <= 3; decade += every_decade ? 1 : 3)
            ratios.push_back(std::pow(10.0, decade));

    const double start = undertow::benchmarks::cpu_clock();
    double contact_steps = 0;
    int cells = 0, grown = 0;
    std::printf(
        "%d steps; largest kinetic energy after the first tenth over the largest in it "
        "(in the last tenth), worst of eight starts\n",
        steps);
    for (const bool with_damping : {false, true}) {
        if (with_damping ? !damped : !undamped) continue;
        for (const double share : shares)
            for (const double cfl : cfls) {
                // What a linearly implicit structure leaves of its node is beta's whole range.
                const double limit = wall == WallStep::leapfrog ? cfl : 0;
                LawSettings law = share > 0 ? share_of_rest(limit, with_damping, share)
                                            : within_budget(limit, with_damping);
                law.eta *= eta_factor;
                law.mu = mu;
                std::printf("\n%s, CFL %.2f: beta = %.3f, eta = %.3f\nmass ratio",
                            with_damping ? "damped" : "undamped", cfl, law.beta, law.eta);
                for (const double P : counts) std::printf("             P = %-4g", P);
                for (const double ratio : ratios) {
                    std::printf("\n%10g", ratio);
                    for (const double P : counts) {
                        const EightEnergies e =
                            PressedNodeLanes({int(P), ratio, cfl, steps}, law, wall).run();
                        contact_steps += lane_count * P * steps;
                        ++cells;
                        if (!(e.worst() < 2)) ++grown;
                        std::printf(" %8.2g (%8.2g)", e.worst(), e.worst_at_end());
                        std::fflush(stdout);
                    }
                }
                std::printf("\n");
            }
    }
    const double spent = undertow::benchmarks::cpu_clock() - start;
    std::printf("\n%d of %d cells more than doubled; %.0f CPU s, %.1f ns a particle and step\n",
                grown, cells, spent, 1e9 * spent / contact_steps);
    return 0;
}
