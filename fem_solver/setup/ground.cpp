#include "fem_solver/setup/ground.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "wire/errors.hpp"
#include "wire/number_text.hpp"

namespace undertow::fem {
namespace {

double vertical_gravity(const Case& c, const std::string& key) {
    const Vec3& g = c.info.gravity;
    if (g[0] != 0 || g[1] != 0 || !(g[2] < 0))
        throw InputError(key + " takes z as up, but case.gravity = [" + number_text(g[0]) + ", " +
                         number_text(g[1]) + ", " + number_text(g[2]) +
                         "] is not along -z; turn the scene.");
    return -g[2];
}

struct FarFacet {
    AbsorbingFacet facet;
    std::optional<Vec3> center;  // [m] where the loads act
};

double distance_to_center(const Quad& facet, const std::vector<Vec3>& x, const Vec3& center) {
    const std::span<const std::int32_t> corners = corners_of(facet);
    double squared = 0;
    for (int d = 0; d < 3; ++d) {
        double sum = 0;
        for (std::int32_t n : corners) sum += x[n][d];
        squared += std::pow(sum / double(corners.size()) - center[d], 2);
    }
    return std::sqrt(squared);
}

std::vector<int> part_of_elements(const Mesh& mesh, const std::vector<Part>& parts) {
    std::vector<int> part_of(mesh.n_elements(), -1);
    for (std::size_t p = 0; p < parts.size(); ++p)
        for (std::int32_t e : parts[p].elements) part_of[e] = int(p);
    return part_of;
}

/// What a material bears beside a vertical stress, both horizontal ones alike.
struct Strength {
    double least, most;  // [Pa] horizontal stress, tension positive
    std::string keys;    // that set it
};

struct StrengthBeside {
    double vertical;  // [Pa]
    std::optional<Strength> operator()(const LinearElastic&) const { return {}; }
    template <class Law>
    std::optional<Strength> operator()(const WithDepth<Law>& law) const {
        return (*this)(law.form);  // law_at() has chosen one before
    }
    std::optional<Strength> operator()(const Tresca& law) const {
        const double k = 2 * law.shear_strength;
        return Strength{vertical - k, vertical + k,
                        "shear_strength = " + number_text(law.shear_strength) + " Pa"};
    }
    std::optional<Strength> operator()(const J2& law) const {
        const double k = law.hardening.yield_stress;  // |s_h - s_v| = sqrt(3 J2)
        return Strength{vertical - k, vertical + k, "a yield stress of " + number_text(k) + " Pa"};
    }
    std::optional<Strength> operator()(const MohrCoulomb& law) const {
        const double a = 1 + law.sin_friction, b = 1 - law.sin_friction;
        return Strength{(a * vertical - 2 * law.cohesion) / b,
                        std::min(law.tension, (b * vertical + 2 * law.cohesion) / a),
                        "cohesion, friction_angle and tension_cutoff"};
    }
};

std::optional<Strength> strength_of(const Material& material, double z, double vertical) {
    return std::visit(StrengthBeside{vertical}, law_at(material, z));
}

/// InputError where ground at rest would have yielded already.
void check_at_rest(const Strength& strength, double vertical, double K0, double z,
                   const std::string& element, const std::string& part) {
    const double horizontal = K0 * vertical, round_off = 1e-12 * std::abs(vertical);
    if (horizontal >= strength.least - round_off && horizontal <= strength.most + round_off) return;
    const double allowed = horizontal < vertical ? strength.least : strength.most;
    throw InputError(
        "fem.geostatic: at z = " + number_text(z) + " m (" + element + " of \"" + part +
        "\") earth_pressure = " + number_text(K0) + " asks for " +
        number_text((horizontal - vertical) / (allowed - vertical)) +
        " times the shear stress that " + strength.keys + " allow; there, " +
        number_text(std::max(0.0, strength.most / vertical)) + " to " + number_text(strength.least / vertical) +
        " would do: bring earth_pressure nearer to 1.");
}

}  // namespace

std::vector<InitialStress> geostatic_stress(const Case& c, const Mesh& mesh,
                                            const std::vector<Part>& parts) {
    if (!c.fem.geostatic) return {};
    const FemGeostatic& ground = *c.fem.geostatic;
    const double g = vertical_gravity(c, "fem.geostatic"), K0 = ground.earth_pressure;
    const std::vector<int> part_of = part_of_elements(mesh, parts);
    std::vector<InitialStress> all;
    for (std::int32_t e : mesh.elements_of(ground.set, "fem.geostatic")) {
        if (part_of[e] < 0) continue;  // nothing that could be stressed
        if (mesh.shape_of(e) == ElementShape::shell)
            throw InputError("fem.geostatic: set = \"" + ground.set + "\" holds " +
                             mesh.element_name(e) +
                             ", but only solid ground has a stress at rest; give a set of solids.");
        const Part& part = parts[part_of[e]];
        const double z = height_of(mesh, e);
        if (z > ground.surface)
            throw InputError("fem.geostatic: " + mesh.element_name(e) +
                             " at z = " + number_text(z) + " m lies above surface = " +
                             number_text(ground.surface) + " m; raise it or shrink the set.");
        const double vertical =
            -part.weight_density.value_or(part.density) * g * (ground.surface - z);
        const double horizontal = K0 * vertical;
        if (const std::optional<Strength> strength = strength_of(part.material, z, vertical))
            check_at_rest(*strength, vertical, K0, z, mesh.element_name(e), part.name);
        all.push_back({e, {horizontal, horizontal, vertical, 0, 0, 0}});
    }
    return all;
}

AbsorbingBoundary make_far_field(const FemSettings& fem, const Mesh& mesh,
                                 const std::vector<Part>& parts) {
    if (fem.absorbing.empty()) return {};
    std::map<Quad, FarFacet> facets;  // by sorted nodes: sets may overlap
    for (const FemAbsorbing& a : fem.absorbing)
        for (const Quad& q : mesh.facets_of(a.set, "fem.absorbing"))
            facets[sorted_facet(q)] = {{.node = q}, a.center};
    const std::vector<int> part_of = part_of_elements(mesh, parts);
    for_each_face(mesh, [&](std::size_t e, const Quad& face) {
        const auto found = facets.find(sorted_facet(face));
        if (found == facets.end() || part_of[e] < 0) return;
        const Part& part = parts[part_of[e]];
        const LinearElastic moduli = elastic_moduli(part.material, height_of(mesh, e));
        AbsorbingFacet& facet = found->second.facet;
        facet.normal_impedance = std::sqrt(part.density * (moduli.lambda + 2 * moduli.mu));
        facet.shear_impedance = std::sqrt(part.density * moduli.mu);
        if (!found->second.center) return;
        const double r = distance_to_center(facet.node, mesh.x, *found->second.center);
        facet.normal_stiffness = 4 * moduli.mu / r;
        facet.shear_stiffness = 2 * moduli.mu / r;
    });
    std::vector<AbsorbingFacet> list;
    for (const auto& [nodes, far] : facets) {
        const AbsorbingFacet& facet = far.facet;
        if (!(facet.normal_impedance > 0))
            throw InputError("fem.absorbing: a facet (nodes " + std::to_string(nodes[0]) + ", " +
                             std::to_string(nodes[1]) +
                             ", ...) is not a face of any solid element that deforms; only the outer "
                             "skin of those can absorb waves.");
        list.push_back(facet);
    }
    return AbsorbingBoundary(list, mesh.x);
}

std::optional<StaticWater> make_static_water(const Case& c, const Mesh& mesh) {
    if (!c.fem.water) return std::nullopt;
    const double g = vertical_gravity(c, "fem.water");
    std::vector<Quad> facets;  // immobile ones as well: they share nodes with those that move
    for (const FemSurface& s : c.fem.surface) {
        const std::vector<Quad>& set = mesh.facets_of(s.set, "fem.surface");
        facets.insert(facets.end(), set.begin(), set.end());
    }
    return StaticWater(facets, c.fem.water->density * g, c.fem.water->level);
}

}  // namespace undertow::fem
