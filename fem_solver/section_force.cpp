#include "fem_solver/section_force.hpp"

#include "wire/errors.hpp"

namespace undertow::fem {

SectionForce::SectionForce(const Mesh& mesh, const std::vector<std::int32_t>& elements,
                           const Vec3& point, const std::string& where)
    : point_(point) {
    std::vector<std::uint8_t> in_group(mesh.n_elements(), 0), side(mesh.x.size(), 0);
    for (std::int32_t e : elements) in_group[e] = 1;
    for (std::size_t e = 0; e < mesh.n_elements(); ++e)
        for (std::int32_t n : mesh.corners(e)) side[n] |= in_group[e] ? 1 : 2;
    std::vector<std::int32_t> of_group, of_rest;
    for (std::size_t n = 0; n < side.size(); ++n) {
        if (side[n] == 1) of_group.push_back(std::int32_t(n));
        if (side[n] == 2) of_rest.push_back(std::int32_t(n));
        shared_ += side[n] == 3;
    }
    if (shared_ == 0)
        throw InputError(where +
                         " cuts no elements apart: there are none on one side of it, or the two "
                         "sides share no node; move it into the mesh.");
    // All forces of all elements add up to nothing as well: the nodes of the group alone, or all
    // others with the opposite sign.
    for (std::size_t n = 0; n < side.size(); ++n)
        if (side[n] == 3) of_rest.push_back(std::int32_t(n));
    const bool rest = of_rest.size() < of_group.size();
    node_ = rest ? of_rest : of_group;
    sign_ = rest ? 1 : -1;
}

void SectionForce::measure(const NodeRows& x, const NodeRows& f, const TurningNodes* turning) {
    force_ = {};
    Vec3 &sum = force_.force, &moment = force_.moment;
    for (std::int32_t n : node_) {
        const double *a = x[n].c, *g = f[n].c;
        const double r[3] = {a[0] - point_[0], a[1] - point_[1], a[2] - point_[2]};
        for (int d = 0; d < 3; ++d) {
            const int e = (d + 1) % 3, h = (d + 2) % 3;
            sum[d] += g[d];
            moment[d] += r[e] * g[h] - r[h] * g[e];
        }
        const std::int32_t turns = turning ? turning->index_of(n) : -1;
        if (turns >= 0)
            for (int d = 0; d < 3; ++d) moment[d] += turning->moment[turns].c[d];
    }
    for (int d = 0; d < 3; ++d) {
        sum[d] *= sign_;
        moment[d] *= sign_;
    }
}

}  // namespace undertow::fem
