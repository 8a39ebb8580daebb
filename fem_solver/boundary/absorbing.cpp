#include "fem_solver/boundary/absorbing.hpp"

#include <algorithm>
#include <cmath>

namespace undertow::fem {
namespace {

std::vector<std::int32_t> nodes_of(const std::vector<AbsorbingFacet>& facets) {
    std::vector<std::int32_t> nodes;
    for (const AbsorbingFacet& f : facets) nodes.insert(nodes.end(), f.node.begin(), f.node.end());
    std::sort(nodes.begin(), nodes.end());
    nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
    return nodes;
}

/// Area vector [m2] of a bilinear facet: half the cross product of its diagonals.
Vec3 area_vector(const Quad& q, const std::vector<Vec3>& x) {
    Vec3 d, e, a;
    for (int i = 0; i < 3; ++i) {
        d[i] = x[q[2]][i] - x[q[0]][i];
        e[i] = x[q[3]][i] - x[q[1]][i];
    }
    for (int i = 0; i < 3; ++i) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        a[i] = 0.5 * (d[j] * e[k] - d[k] * e[j]);
    }
    return a;
}

}  // namespace

AbsorbingBoundary::AbsorbingBoundary(const std::vector<AbsorbingFacet>& facets,
                                     const std::vector<Vec3>& x)
    : reaction_(nodes_of(facets)) {
    const std::vector<std::int32_t>& node = reaction_.node;
    dashpot_.resize(node.size());
    for (const AbsorbingFacet& facet : facets) {
        const Vec3 a = area_vector(facet.node, x);
        const double area = std::sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]);
        const Vec3 n{a[0] / area, a[1] / area, a[2] / area};
        const double shear = 0.25 * area * facet.shear_impedance;
        const double more = 0.25 * area * (facet.normal_impedance - facet.shear_impedance);
        for (std::int32_t corner : facet.node) {
            Dashpot& c =
                dashpot_[std::lower_bound(node.begin(), node.end(), corner) - node.begin()];
            c.xx += shear + more * n[0] * n[0];
            c.yy += shear + more * n[1] * n[1];
            c.zz += shear + more * n[2] * n[2];
            c.xy += more * n[0] * n[1];
            c.yz += more * n[1] * n[2];
            c.zx += more * n[2] * n[0];
        }
    }
    v_before_.resize(node.size());
}

void AbsorbingBoundary::hold(Nodes& nodes) {
    inverse_mass_.clear();
    for (std::int32_t n : reaction_.node) {
        inverse_mass_.push_back(nodes.inverse_mass[n]);
        nodes.inverse_mass[n] = NodeRow{};
    }
}

void AbsorbingBoundary::release(Nodes& nodes, const Vec3& gravity) {
    for (std::size_t i = 0; i < reaction_.node.size(); ++i) {
        const std::int32_t n = reaction_.node[i];
        nodes.inverse_mass[n] = inverse_mass_[i];
        const double* free = inverse_mass_[i].c;
        for (int d = 0; d < 3; ++d)
            reaction_.force[i].c[d] =
                free[d] > 0
                    ? -(nodes.f[n].c[d] + nodes.mass[n] * nodes.weight_share[n] * gravity[d])
                    : 0;
        Dashpot& c = dashpot_[i];  // a direction that a support holds takes no part
        const double x = free[0] > 0, y = free[1] > 0, z = free[2] > 0;
        c = {x * c.xx, y * c.yy, z * c.zz, x * y * c.xy, y * z * c.yz, z * x * c.zx};
    }
    released_ = true;
}

void AbsorbingBoundary::add_reaction(NodeRows& f) const {
    if (released_) reaction_.add_to(f);
}

void AbsorbingBoundary::before_kick(const Nodes& nodes, double dt_before) {
    if (!released_) return;
    for (std::size_t i = 0; i < reaction_.node.size(); ++i)
        v_before_[i] = nodes.v[reaction_.node[i]];
    reaction_.do_work(nodes.v, 0.5 * dt_before);
}

void AbsorbingBoundary::drift(const NodeRows& v, double dt) {
    if (released_) reaction_.do_work(v, 0.5 * dt);
}

void AbsorbingBoundary::after_kick(Nodes& nodes, const Kick& step, KickReport& report) {
    if (!released_) return;
    const double span = 0.5 * (step.dt_before + step.dt_after);
    dissipated_ += ahead_;
    ahead_ = 0;
    for (std::size_t i = 0; i < reaction_.node.size(); ++i) {
        const std::int32_t n = reaction_.node[i];
        const double m = nodes.mass[n];
        const double* old = v_before_[i].c;
        double* v = nodes.v[n].c;
        const Dashpot& c = dashpot_[i];
        // (m/s + alpha m/2 + C/2) dv = -C (v* + v-)/2, v* the velocity without dashpots
        const double r[3] = {-0.5 * (v[0] + old[0]), -0.5 * (v[1] + old[1]),
                             -0.5 * (v[2] + old[2])};
        const double b[3] = {c.xx * r[0] + c.xy * r[1] + c.zx * r[2],
                             c.xy * r[0] + c.yy * r[1] + c.yz * r[2],
                             c.zx * r[0] + c.yz * r[1] + c.zz * r[2]};
        const double own = m * (1 / span + 0.5 * step.damping);
        const double xx = own + 0.5 * c.xx, yy = own + 0.5 * c.yy, zz = own + 0.5 * c.zz;
        const double xy = 0.5 * c.xy, yz = 0.5 * c.yz, zx = 0.5 * c.zx;
        const double ix = yy * zz - yz * yz, iy = zz * xx - zx * zx, iz = xx * yy - xy * xy;
        const double ixy = yz * zx - xy * zz, iyz = xy * zx - yz * xx, izx = xy * yz - zx * yy;
        const double inverse_det = 1 / (xx * ix + xy * ixy + zx * izx);
        const double dv[3] = {inverse_det * (ix * b[0] + ixy * b[1] + izx * b[2]),
                              inverse_det * (ixy * b[0] + iy * b[1] + iyz * b[2]),
                              inverse_det * (izx * b[0] + iyz * b[1] + iz * b[2])};
        const double mean[3] = {0.5 * dv[0] - r[0], 0.5 * dv[1] - r[1], 0.5 * dv[2] - r[2]};
        const double force[3] = {-(c.xx * mean[0] + c.xy * mean[1] + c.zx * mean[2]),
                                 -(c.xy * mean[0] + c.yy * mean[1] + c.yz * mean[2]),
                                 -(c.zx * mean[0] + c.yz * mean[1] + c.zz * mean[2])};
        for (int d = 0; d < 3; ++d) {
            const double without = v[d];
            v[d] += dv[d];
            nodes.f[n].c[d] += force[d];
            dissipated_ -= 0.5 * step.dt_before * force[d] * old[d];
            ahead_ -= 0.5 * step.dt_after * force[d] * v[d];
            report.kinetic += 0.5 * m * old[d] * dv[d];
            const double quarter = 0.25 * step.damping * m;
            report.damping_before += quarter * step.dt_before * dv[d] * old[d];
            report.damping_after +=
                quarter * step.dt_after * ((old[d] + v[d]) * v[d] - (old[d] + without) * without);
        }
    }
}

}  // namespace undertow::fem
