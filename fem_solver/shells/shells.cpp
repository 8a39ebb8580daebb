#include "fem_solver/shells/shells.hpp"

#include <algorithm>
#include <cmath>

#include "wire/errors.hpp"

namespace undertow::fem {
namespace {

// Of a uniform shear over the thickness against the parabola that equilibrium asks for, by energy.
constexpr double shear_correction = 5.0 / 6;

ShellLaw make_law(const Part& part) {
    const LinearElastic moduli = form_moduli(part.material);
    const double nu = moduli.poisson_ratio(), E = 2 * moduli.mu * (1 + nu);
    return {.density = part.density,
            .thickness = part.thickness,
            .young_modulus = E,
            .poisson_ratio = nu,
            .plane_modulus = E / (1 - nu * nu),
            .shear_modulus = shear_correction * moduli.mu};
}

}  // namespace

Shells::Shells(const Mesh& mesh, const std::vector<Part>& parts)
    : parts_(parts), batches_(mesh, parts) {
    for (Part& part : parts_) part.elements = {};
    for (const Part& part : parts) {
        law_.push_back(make_law(part));
        const ShellLaw& law = law_.back();
        if (const J2* plastic = std::get_if<J2>(&part.material))
            section_.push_back(PlasticSection{law.thickness, *plastic});
        else
            section_.push_back(ElasticSection{law.thickness, law.plane_modulus, law.poisson_ratio});
    }
    for (std::size_t b = 0; b < batches_.size(); ++b) {
        const bool yields = std::holds_alternative<PlasticSection>(section_[batches_[b].part]);
        layers_at_.push_back(yields ? std::int32_t(layers_.size()) : -1);
        if (yields) layers_.push_back(LayeredState<Lanes>{});
    }
    state_.resize(batches_.size(), ShellState<Lanes>{});
    resultants_.resize(batches_.size(), Resultants<Lanes>{});
    axes_.resize(batches_.size(), Axes{});
    omega2_.resize(batches_.size());
    build_constants(mesh);
    build_turning(mesh);
}

void Shells::build_constants(const Mesh& mesh) {
    constants_.resize(batches_.size());
    for (std::size_t b = 0; b < batches_.size(); ++b)
        for (int l = 0; l < n_lanes; ++l) {
            double xi[3], eta[3], h[3];
            for (int d = 0; d < 3; ++d) {
                double x[4];
                for (int corner = 0; corner < 4; ++corner)
                    x[corner] = mesh.x[batches_[b].node[corner][l]][d];
                const QuadModes<double> modes = quad_modes(x);
                xi[d] = modes.xi, eta[d] = modes.eta, h[d] = modes.h;
            }
            const ShellFrame<double> frame = shell_frame(xi, eta, h);
            const ShellLaw& law = law_[batches_[b].part];
            const double t = law.thickness;
            const ShellConstants<double> element{
                .mass = law.density * t * frame.area,
                .area = frame.area,
                .rotary = (frame.area + t * t) / 12,  // docs/theory_shells.md, 5
                .axis_weight = {1 / dot(xi, xi), 1 / dot(eta, eta)},
                .omega2_reference = 0};
            const double omega2 = shell_eigenvalue_bound(law, element, frame);
            ShellConstants<Lanes>& out = constants_[b];
            out.mass[l] = element.mass;
            out.area[l] = element.area;
            out.rotary[l] = element.rotary;
            out.axis_weight[0][l] = element.axis_weight[0];
            out.axis_weight[1][l] = element.axis_weight[1];
            out.omega2_reference[l] = omega2;
            for (int d = 0; d < 3; ++d) {
                axes_[b].e1[d][l] = frame.e1[d];
                axes_[b].e2[d][l] = frame.e2[d];
            }
            omega2_[b][l] = omega2;
            omega2_start_ = std::max(omega2_start_, omega2);
        }
}

void Shells::build_turning(const Mesh& mesh) {
    std::vector<double> inertia(mesh.x.size(), 0.0);
    for (std::size_t b = 0; b < batches_.size(); ++b)
        for (int l = 0; l < batches_[b].valid; ++l)
            for (int corner = 0; corner < 4; ++corner)
                inertia[batches_[b].node[corner][l]] +=
                    constants_[b].mass[l] / 4 * constants_[b].rotary[l];
    std::vector<std::int32_t> node, index(mesh.x.size(), -1);
    std::vector<double> of_node;
    for (std::size_t n = 0; n < inertia.size(); ++n)
        if (inertia[n] > 0) {
            index[n] = std::int32_t(node.size());
            node.push_back(std::int32_t(n));
            of_node.push_back(inertia[n]);
        }
    corners_.resize(batches_.size());
    for (std::size_t b = 0; b < batches_.size(); ++b)
        for (int corner = 0; corner < 4; ++corner)
            for (int l = 0; l < n_lanes; ++l)
                corners_[b].node[corner][l] = index[batches_[b].node[corner][l]];
    turning_ = make_turning_nodes(std::move(node), std::move(of_node));
}

void Shells::add_nodal_masses(std::vector<double>& mass) const {
    batches_.add_masses(
        mass, [&](std::size_t b) { return constants_[b].mass; }, [](int) { return 1.0; });
}

void Shells::add_nodal_weight_masses(std::vector<double>& mass) const {
    batches_.add_masses(
        mass, [&](std::size_t b) { return constants_[b].mass; },
        [&](int p) {
            return parts_[p].weight_density ? *parts_[p].weight_density / parts_[p].density : 1;
        });
}

void Shells::set_stress(std::int32_t element, const Symmetric<double>&) {
    throw InputError("fem.geostatic: shell " + std::to_string(element) +
                     " of its set has no stress of the ground; give a set of solid elements.");
}

KickReport Shells::kick(const Kick& step, int threads) {
    return turning_.kick(step, threads);
}

void Shells::drift(double /*dt*/, int threads) {
    turning_.clear_moments(threads);
}

void Shells::accept_shape() {
    for (std::size_t b = 0; b < batches_.size(); ++b) constants_[b].omega2_reference = omega2_[b];
}

ExtremeElement Shells::most_compressed(const Nodes& nodes) const {
    return batches_.smallest([&](std::size_t b, int l) {
        double xi[3], eta[3], h[3];
        for (int d = 0; d < 3; ++d) {
            double x[4];
            for (int corner = 0; corner < 4; ++corner)
                x[corner] = nodes.x[batches_[b].node[corner][l]].c[d];
            const QuadModes<double> modes = quad_modes(x);
            xi[d] = modes.xi, eta[d] = modes.eta, h[d] = modes.h;
        }
        return relative_area(shell_frame(xi, eta, h), double(constants_[b].area[l]));
    });
}

Resultants<double> Shells::resultants(std::int32_t element) const {
    Resultants<double> out{};
    batches_.at_lanes_of(element, [&](std::size_t b, int l) {
        for (int k = 0; k < 3; ++k) {
            out.N[k] = resultants_[b].N[k][l];
            out.M[k] = resultants_[b].M[k][l];
        }
    });
    return out;
}

void Shells::write_row(const double (&plane)[3], std::size_t b, int l, double* row) const {
    constexpr int at[6][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {1, 2}, {2, 0}};
    const Axes& axes = axes_[b];
    for (int k = 0; k < 6; ++k) {
        const int i = at[k][0], j = at[k][1];
        row[k] = plane[0] * axes.e1[i][l] * axes.e1[j][l] +
                 plane[1] * axes.e2[i][l] * axes.e2[j][l] +
                 plane[2] * (axes.e1[i][l] * axes.e2[j][l] + axes.e2[i][l] * axes.e1[j][l]);
    }
}

void Shells::write_stress(std::span<double> stress) const {
    batches_.for_each_element([&](std::size_t e, std::size_t b, int l) {
        const double t = law_[batches_[b].part].thickness;
        double plane[3];
        for (int k = 0; k < 3; ++k) plane[k] = resultants_[b].N[k][l] / t;
        write_row(plane, b, l, &stress[6 * e]);
    });
}

void Shells::write_face_stress(std::span<double> top, std::span<double> bottom) const {
    batches_.for_each_element([&](std::size_t e, std::size_t b, int l) {
        const double t = law_[batches_[b].part].thickness;
        for (int side : {1, -1}) {
            double plane[3];
            for (int k = 0; k < 3; ++k)
                plane[k] =
                    layers_at_[b] < 0
                        ? resultants_[b].N[k][l] / t + side * 6 * resultants_[b].M[k][l] / (t * t)
                        : layers_[layers_at_[b]].stress[side > 0 ? n_layers - 1 : 0][k][l];
            write_row(plane, b, l, side > 0 ? &top[6 * e] : &bottom[6 * e]);
        }
    });
}

void Shells::write_plastic_strain(std::span<double> strain) const {
    batches_.for_each_element([&](std::size_t e, std::size_t b, int l) {
        if (layers_at_[b] < 0) return;
        for (const Lanes& layer : layers_[layers_at_[b]].plastic_strain)
            strain[e] = std::max(strain[e], double(layer[l]));
    });
}

}  // namespace undertow::fem
