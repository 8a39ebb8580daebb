#include "fem_solver/elements/hexahedra.hpp"

#include <algorithm>
#include <cmath>

#include "fem_solver/elements/coloring.hpp"

namespace undertow::fem {
namespace {

HexahedronLaw make_law(const Part& part, const BulkViscosity& viscosity) {
    const LinearElastic& moduli = elastic_moduli(part.material);
    const double lambda = moduli.lambda, mu = moduli.mu;
    const double nu = moduli.poisson_ratio();
    return {.inverse_density = 1 / part.density,
            .lambda = lambda,
            .mu = mu,
            .sound_speed = std::sqrt((lambda + 2 * mu) / part.density),
            .bending_modulus = 2 * mu / (1 - nu),
            .poisson_ratio = nu,
            .young_modulus = 2 * mu * (1 + nu),
            .bulk_viscosity_linear = viscosity.linear,
            .bulk_viscosity_quadratic = viscosity.quadratic};
}

}  // namespace

Hexahedra::Hexahedra(const Mesh& mesh, const std::vector<Part>& parts,
                     const BulkViscosity& viscosity) {
    for (const Part& part : parts) law_.push_back(make_law(part, viscosity));
    build_batches(mesh, parts);
    build_constants(mesh);
    color_chunks(mesh.x.size());
    parts_ = parts;
    for (Part& part : parts_) part.elements = {};
    omega2_start_ = largest_omega2(WhichParts::with_explicit_step);
    if (std::any_of(parts.begin(), parts.end(),
                    [](const Part& p) { return is_plastic(p.material); }))
        plastic_strain_.resize(batch_.size(), Lanes{});
}

void Hexahedra::build_batches(const Mesh& mesh, const std::vector<Part>& parts) {
    // 512 elements: their nodes and state stay in a 1 MB second-level cache, and a color holds
    // enough chunks to share
    constexpr std::int32_t batches_per_chunk = 64;
    slot_of_.assign(mesh.hexahedra.size(), -1);
    for (std::size_t p = 0; p < parts.size(); ++p) {
        const std::vector<std::int32_t>& elements = parts[p].elements;
        const std::int32_t first_batch = std::int32_t(batch_.size());
        for (std::size_t e = 0; e < elements.size(); e += n_lanes) {
            Batch batch;
            batch.part = int(p);
            batch.valid = int(std::min<std::size_t>(n_lanes, elements.size() - e));
            for (int l = 0; l < n_lanes; ++l) {
                const std::int32_t element = elements[e + std::min(l, batch.valid - 1)];
                for (int corner = 0; corner < 8; ++corner)
                    batch.node[corner][l] = mesh.hexahedra[element][corner];
                if (l < batch.valid) slot_of_[element] = std::int32_t(batch_.size()) * n_lanes + l;
                element_at_.push_back(element);
            }
            batch_.push_back(batch);
        }
        const std::int32_t last_batch = std::int32_t(batch_.size());
        for (std::int32_t b = first_batch; b < last_batch; b += batches_per_chunk)
            chunk_.push_back({b, std::min(b + batches_per_chunk, last_batch)});
    }
    state_.resize(batch_.size());
    omega2_.resize(batch_.size());
    for (auto& state : state_) state = HexahedronState<Lanes>{};
}

void Hexahedra::build_constants(const Mesh& mesh) {
    constants_.resize(batch_.size());
    for (std::size_t b = 0; b < batch_.size(); ++b)
        for (int l = 0; l < n_lanes; ++l) {
            const Hexahedron& nodes = mesh.hexahedra[element_at_[b * n_lanes + l]];
            double x[3][8];
            for (int corner = 0; corner < 8; ++corner)
                for (int d = 0; d < 3; ++d) x[d][corner] = mesh.x[nodes[corner]][d];
            const Modes<double> modes[3] = {to_modes(x[0]), to_modes(x[1]), to_modes(x[2])};
            double C[6][3], D;
            mean_gradient(modes, C, D);
            const HexahedronLaw& law = law_[batch_[b].part];
            HexahedronConstants<Lanes>& constants = constants_[b];
            const double mass = D / 64 / law.inverse_density;
            const double omega2 = eigenvalue_bound(C, D, mass, law.lambda, law.mu);
            constants.mass[l] = mass;
            constants.omega2_reference[l] = omega2;
            constants.length[l] = 2 * law.sound_speed / std::sqrt(omega2);
            for (int k = 0; k < 3; ++k) {
                double squared = 0;
                for (int d = 0; d < 3; ++d) squared += modes[d].linear[k] * modes[d].linear[k];
                constants.axis_weight[k][l] = 1 / squared;
            }
            omega2_[b][l] = omega2;
        }
}

bool Hexahedra::is_among(std::size_t batch, WhichParts which) const {
    return which == WhichParts::all ||
           parts_[batch_[batch].part].implicit == (which == WhichParts::with_implicit_step);
}

double Hexahedra::largest_omega2(WhichParts which) const {
    double largest = 0;
    for (std::size_t b = 0; b < batch_.size(); ++b)
        if (is_among(b, which)) largest = std::max(largest, largest_lane(omega2_[b]));
    return largest;
}

double Hexahedra::largest_stress_stiffness(WhichParts which) const {
    double largest2 = 0;
    for (std::size_t b = 0; b < batch_.size(); ++b) {
        if (!is_among(b, which)) continue;
        const Symmetric<Lanes>& s = state_[b].stress;
        const double modulus = law_[batch_[b].part].lambda + 2 * law_[batch_[b].part].mu;
        const Lanes norm2 = (s.xx * s.xx + s.yy * s.yy + s.zz * s.zz) +
                            2.0 * (s.xy * s.xy + s.yz * s.yz + s.zx * s.zx);
        largest2 = std::max(largest2, largest_lane(norm2) / (modulus * modulus));
    }
    return std::sqrt(largest2);
}

void Hexahedra::color_chunks(std::size_t n_nodes) {
    std::vector<std::vector<std::int32_t>> nodes_of_chunk;
    for (const Chunk& chunk : chunk_) {
        std::vector<std::int32_t> nodes;
        for (std::int32_t b = chunk.begin; b < chunk.end; ++b)
            nodes.insert(nodes.end(), &batch_[b].node[0][0], &batch_[b].node[0][0] + 64);
        nodes_of_chunk.push_back(std::move(nodes));
    }
    const Coloring coloring = color_by_nodes(nodes_of_chunk, n_nodes);
    std::vector<Chunk> sorted;
    for (std::int32_t c : coloring.order) sorted.push_back(chunk_[c]);
    chunk_ = std::move(sorted);
    color_begin_ = coloring.begin;
    chunk_report_.resize(chunk_.size());
}

std::size_t Hexahedra::deformable() const {
    return std::size_t(std::count_if(slot_of_.begin(), slot_of_.end(),
                                     [](std::int32_t slot) { return slot >= 0; }));
}

std::vector<double> Hexahedra::nodal_masses(std::size_t n_nodes) const {
    std::vector<double> mass(n_nodes, 0.0);
    for (std::size_t b = 0; b < batch_.size(); ++b)
        for (int l = 0; l < batch_[b].valid; ++l)
            for (int corner = 0; corner < 8; ++corner)
                mass[batch_[b].node[corner][l]] += constants_[b].mass[l] / 8;
    return mass;
}

std::vector<double> Hexahedra::nodal_weight_masses(std::size_t n_nodes) const {
    std::vector<double> mass(n_nodes, 0.0);
    for (std::size_t b = 0; b < batch_.size(); ++b) {
        const Part& part = parts_[batch_[b].part];
        // exactly 1 where weight and inertia are alike
        const double ratio = part.weight_density ? *part.weight_density / part.density : 1;
        for (int l = 0; l < batch_[b].valid; ++l)
            for (int corner = 0; corner < 8; ++corner)
                mass[batch_[b].node[corner][l]] += ratio * constants_[b].mass[l] / 8;
    }
    return mass;
}

void Hexahedra::set_stress(std::int32_t element, const Symmetric<double>& stress) {
    const std::int32_t first = slot_of_[element] / n_lanes * n_lanes;
    for (std::int32_t slot = first; slot < first + n_lanes; ++slot) {
        if (element_at_[slot] != element) continue;  // padding repeats its element
        Symmetric<Lanes>& s = state_[slot / n_lanes].stress;
        const int l = slot % n_lanes;
        s.xx[l] = stress.xx;
        s.yy[l] = stress.yy;
        s.zz[l] = stress.zz;
        s.xy[l] = stress.xy;
        s.yz[l] = stress.yz;
        s.zx[l] = stress.zx;
    }
}

void Hexahedra::accept_shape() {
    for (std::size_t b = 0; b < batch_.size(); ++b) constants_[b].omega2_reference = omega2_[b];
}

std::size_t Hexahedra::stiffest() const {
    std::size_t best = 0;
    double largest = 0;
    for (std::size_t slot = 0; slot < element_at_.size(); ++slot) {
        const double omega2 = omega2_[slot / n_lanes][slot % n_lanes];
        if (omega2 > largest && is_among(slot / n_lanes, WhichParts::with_explicit_step)) {
            best = slot;
            largest = omega2;
        }
    }
    return element_at_[best];
}

std::size_t Hexahedra::most_compressed(const Nodes& nodes) const {
    std::size_t worst = 0;
    double smallest = 1e300;
    for (std::size_t slot = 0; slot < element_at_.size(); ++slot) {
        const Batch& batch = batch_[slot / n_lanes];
        const int l = int(slot % n_lanes);
        double x[3][8];
        for (int corner = 0; corner < 8; ++corner)
            for (int d = 0; d < 3; ++d) x[d][corner] = nodes.x[batch.node[corner][l]].c[d];
        const Modes<double> modes[3] = {to_modes(x[0]), to_modes(x[1]), to_modes(x[2])};
        double C[6][3], D;
        mean_gradient(modes, C, D);
        const double relative = D / constants_[slot / n_lanes].mass[l];
        if (!(relative >= smallest)) {  // a NaN is the worst of all
            smallest = relative;
            worst = slot;
            if (!(relative == relative)) break;
        }
    }
    return element_at_[worst];
}

const std::string& Hexahedra::part_name(std::size_t element) const {
    return parts_[batch_[slot_of_[element] / n_lanes].part].name;
}

double Hexahedra::largest_wave_speed() const {
    double largest = 0;
    for (const HexahedronLaw& law : law_) largest = std::max(largest, law.sound_speed);
    return largest;
}

std::vector<double> Hexahedra::stress() const {
    std::vector<double> out(6 * size());
    for (std::size_t e = 0; e < size(); ++e) {
        if (slot_of_[e] < 0) continue;  // of a rigid body: none
        const Symmetric<Lanes>& s = state_[slot_of_[e] / n_lanes].stress;
        const int l = slot_of_[e] % n_lanes;
        const double row[6] = {s.xx[l], s.yy[l], s.zz[l], s.xy[l], s.yz[l], s.zx[l]};
        std::copy(row, row + 6, &out[6 * e]);
    }
    return out;
}

std::vector<double> Hexahedra::plastic_strain() const {
    std::vector<double> out(size(), 0.0);
    if (any_plastic())
        for (std::size_t e = 0; e < size(); ++e)
            if (slot_of_[e] >= 0)  // else of no part
                out[e] = plastic_strain_[slot_of_[e] / n_lanes][slot_of_[e] % n_lanes];
    return out;
}

}  // namespace undertow::fem
