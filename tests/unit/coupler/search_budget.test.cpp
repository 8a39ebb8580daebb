#include "coupler/search_budget.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "contact/boxes.hpp"
#include "contact/penalty_contact.hpp"

using namespace undertow;
using namespace undertow::coupler;
using contact::Contact;
using contact::PenaltyContact;
using contact::Points;
using contact::Surface;
using contact::Vec;

namespace {

constexpr double spacing = 0.02, l0 = spacing / 2;

/// A heaving, tilting plate and a gas of particles that jostle around it.
struct Bath {
    std::mt19937 random;
    std::vector<double> x, v, mass, radius, stiffness;  // particles
    std::vector<std::uint64_t> id;
    std::vector<std::uint32_t> phase;
    std::vector<double> nodes, rest, v_nodes, node_mass;
    std::vector<std::int32_t> quad;
    double t = 0;

    explicit Bath(unsigned seed) : random(seed) {
        std::uniform_real_distribution<double> any(0, 1);
        const int n = 24;
        for (int j = 0; j <= n; ++j)
            for (int i = 0; i <= n; ++i)
                rest.insert(rest.end(), {i * 0.025, j * 0.025, 0.02 * std::sin(0.4 * i)});
        for (int j = 0; j < n; ++j)
            for (int i = 0; i < n; ++i) {
                const int a = j * (n + 1) + i;
                quad.insert(quad.end(), {a, a + 1, a + n + 2, a + n + 1});
            }
        nodes = rest;
        v_nodes.assign(rest.size(), 0);
        node_mass.assign(rest.size() / 3, 1);
        for (int i = 0; i < 4000; ++i) {
            x.insert(x.end(),
                     {0.7 * any(random) - 0.05, 0.7 * any(random) - 0.05, 0.3 * any(random) - 0.1});
            for (int axis = 0; axis < 3; ++axis) v.push_back(4 * any(random) - 2);
            id.push_back(std::uint64_t(i) * 3 + 5);
        }
        mass.assign(id.size(), 1);
        radius.assign(id.size(), l0);
        stiffness.assign(id.size(), 1e4);
    }

    /// Velocities change by at most what the force limit of the SPH step allows.
    void move(double dt) {
        std::uniform_real_distribution<double> any(-1, 1);
        const double kick = 0.0625 * 1.2 * spacing / dt;  // a dt, from a dt^2 < 0.0625 h
        t += dt;
        for (std::size_t i = 0; i < x.size(); ++i) {
            v[i] = std::clamp(v[i] + 0.2 * kick * any(random), -3.0, 3.0);
            if ((x[i] < -0.1 && v[i] < 0) || (x[i] > 0.7 && v[i] > 0)) v[i] = -v[i];
            x[i] += dt * v[i];
        }
        for (std::size_t n = 0; n < rest.size(); n += 3) {
            const double before = nodes[n + 2];
            nodes[n + 2] = rest[n + 2] + 0.05 * std::sin(20 * t) * (1 + rest[n]);
            nodes[n] = rest[n] + 0.02 * std::sin(31 * t);
            v_nodes[n + 2] = (nodes[n + 2] - before) / dt;
        }
    }

    Points all() const { return {x, v, mass, radius, stiffness, id}; }
};

using Pair = std::pair<std::uint64_t, std::uint32_t>;  // particle id, facet

}  // namespace

TEST_CASE("between searches no contact is ever missed (brute force at every step)") {
    const auto seed = GENERATE(1u, 2u, 3u);
    const double skin_share = GENERATE(0.15, 0.3, 0.6);
    Bath bath(seed);
    const double dt = 2e-4;
    const Surface surface(bath.quad, bath.node_mass);
    PenaltyContact cached(surface, {}), brute(surface, {});
    SearchBudget budget(l0, skin_share * spacing);
    budget.boxes_sent(bath.nodes);
    Surface boxed(bath.quad, bath.node_mass);
    boxed.move(bath.nodes, bath.v_nodes);
    std::vector<double> boxes = contact::boxes_around(boxed, budget.box_range());

    std::vector<std::uint32_t> probed;     // particles in PROBE
    std::vector<double> x_search, xp, vp;  // as the particle solver would hold and send them
    bool search = true;
    int searches = 0, contacts = 0;
    for (int n = 0; n < 300; ++n) {
        if (search) {
            ++searches;
            probed.clear();
            std::vector<double> px, pv, pm, pr, pk;
            std::vector<std::uint64_t> pid;
            double speed = 0;
            for (std::uint32_t i = 0; i < bath.id.size(); ++i) {
                const double* p = &bath.x[3 * i];
                bool inside = false;
                for (std::size_t b = 0; b < boxes.size(); b += 6)
                    inside = inside ||
                             (boxes[b] <= p[0] && p[0] <= boxes[b + 3] && boxes[b + 1] <= p[1] &&
                              p[1] <= boxes[b + 4] && boxes[b + 2] <= p[2] && p[2] <= boxes[b + 5]);
                if (!inside) continue;
                probed.push_back(i);
                px.insert(px.end(), p, p + 3);
                pv.insert(pv.end(), &bath.v[3 * i], &bath.v[3 * i] + 3);
                pm.push_back(1), pr.push_back(l0), pk.push_back(1e4), pid.push_back(bath.id[i]);
                speed = std::max(speed, Vec::Map(&bath.v[3 * i]).norm());
            }
            REQUIRE(probed.size() < bath.id.size());  // the boxes do leave some out
            budget.searched(bath.nodes, speed);
            cached.rebuild({px, pv, pm, pr, pk, pid}, budget.skin(), bath.nodes, bath.v_nodes);
            x_search = bath.x;
        } else {
            double reach = 0;
            for (std::size_t i = 0; i < bath.x.size(); i += 3)
                reach = std::max(reach, (Vec::Map(&bath.x[i]) - Vec::Map(&x_search[i])).norm());
            budget.moved(reach, bath.nodes, dt);
            xp.clear(), vp.clear();
            for (std::uint32_t row : cached.active_rows())
                for (int axis = 0; axis < 3; ++axis) {
                    xp.push_back(bath.x[3 * probed[row] + axis]);
                    vp.push_back(bath.v[3 * probed[row] + axis]);
                }
            cached.update(xp, vp, bath.nodes, bath.v_nodes);
        }
        brute.rebuild(bath.all(), 0, bath.nodes, bath.v_nodes);

        std::vector<Pair> got, expected;
        for (const Contact& c : cached.contacts())
            got.push_back({bath.id[probed[cached.active_rows()[c.particle]]], c.facet});
        for (const Contact& c : brute.contacts())
            expected.push_back({bath.id[brute.active_rows()[c.particle]], c.facet});
        std::sort(got.begin(), got.end());
        std::sort(expected.begin(), expected.end());
        REQUIRE(got == expected);
        contacts += int(expected.size());

        search = budget.due(dt);
        if (search) {  // boxes travel with FORCE(n), before the step is taken
            budget.boxes_sent(bath.nodes);
            boxed.move(bath.nodes, bath.v_nodes);
            boxes = contact::boxes_around(boxed, budget.box_range());
        }
        bath.move(dt);
    }
    CHECK(budget.late() == 0);
    CHECK(contacts > 1000);
    CHECK(searches < 300);  // and it does save searches
    if (skin_share > 0.5) CHECK(searches < 60);
}

TEST_CASE("a displacement beyond the skin is noticed") {
    SearchBudget budget(0.01, 0.004);
    const std::vector<double> nodes(12, 0);
    budget.boxes_sent(nodes);
    budget.searched(nodes, 1);
    CHECK_FALSE(budget.due(1e-4));
    budget.moved(0.003, nodes, 1e-3);
    CHECK(budget.late() == 0);
    CHECK(budget.due(1e-3));  // 3 m/s as seen, twice that for a millisecond
    budget.moved(0.0041, nodes, 1e-3);
    CHECK(budget.late() == 1);
}

TEST_CASE("what the surface moved between boxes and search is taken off the skin") {
    SearchBudget budget(0.01, 0.004);
    std::vector<double> nodes(12, 0);
    budget.boxes_sent(nodes);
    nodes[4] = 0.003;  // boxes reach 1.25 skins: 0.002 of the skin is left
    budget.searched(nodes, 0);
    budget.moved(0.0019, nodes, 1e-3);
    CHECK(budget.late() == 0);
    budget.moved(0.0021, nodes, 1e-3);
    CHECK(budget.late() == 1);
}
