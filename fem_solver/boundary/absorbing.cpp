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

/// m += along n n^T + across (1 - n n^T)
void add_projected(Symmetric<double>& m, double along, double across, const Vec3& n) {
    const double more = along - across;
    m.xx += across + more * n[0] * n[0];
    m.yy += across + more * n[1] * n[1];
    m.zz += across + more * n[2] * n[2];
    m.xy += more * n[0] * n[1];
    m.yz += more * n[1] * n[2];
    m.zx += more * n[2] * n[0];
}

/// A direction that a support holds takes no part.
void keep_free(Symmetric<double>& m, const double* free) {
    const double x = free[0] > 0, y = free[1] > 0, z = free[2] > 0;
    m = {x * m.xx, y * m.yy, z * m.zz, x * y * m.xy, y * z * m.yz, z * x * m.zx};
}

void multiply(const Symmetric<double>& m, const double (&a)[3], double (&out)[3]) {
    out[0] = m.xx * a[0] + m.xy * a[1] + m.zx * a[2];
    out[1] = m.xy * a[0] + m.yy * a[1] + m.yz * a[2];
    out[2] = m.zx * a[0] + m.yz * a[1] + m.zz * a[2];
}

}  // namespace

AbsorbingBoundary::AbsorbingBoundary(const std::vector<AbsorbingFacet>& facets,
                                     const std::vector<Vec3>& x)
    : dashpot_(nodes_of(facets).size()), reaction_(nodes_of(facets)) {
    for (const AbsorbingFacet& facet : facets)
        if (facet.normal_stiffness > 0) spring_.resize(dashpot_.size());
    for (const AbsorbingFacet& facet : facets) add_facet(facet, x);
    v_before_.resize(dashpot_.size());
}

void AbsorbingBoundary::add_facet(const AbsorbingFacet& facet, const std::vector<Vec3>& x) {
    const Vec3 a = area_vector(facet.node, x);
    const double area = std::sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]);
    const Vec3 n{a[0] / area, a[1] / area, a[2] / area};
    const std::vector<std::int32_t>& node = reaction_.node;
    const std::span<const std::int32_t> corners = corners_of(facet.node);
    const double share = area / double(corners.size());
    for (std::int32_t corner : corners) {
        const std::size_t i = std::lower_bound(node.begin(), node.end(), corner) - node.begin();
        add_projected(dashpot_[i], share * facet.normal_impedance,
                      share * facet.shear_impedance, n);
        if (!spring_.empty())
            add_projected(spring_[i], share * facet.normal_stiffness,
                          share * facet.shear_stiffness, n);
    }
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
        keep_free(dashpot_[i], free);
        if (!spring_.empty()) keep_free(spring_[i], free);
        x_start_.push_back(nodes.x[n]);
    }
    reaction_start_ = reaction_.force;
    released_ = true;
}

void AbsorbingBoundary::reset_work() {
    reaction_.work = dissipated_ = ahead_ = 0;
}

void AbsorbingBoundary::react(const NodeRows& x, NodeRows& f) {
    if (!released_) return;
    for (std::size_t i = 0; i < spring_.size(); ++i) {
        const NodeRow& now = x[reaction_.node[i]];
        double u[3], k_u[3];
        for (int d = 0; d < 3; ++d) u[d] = now.c[d] - x_start_[i].c[d];
        multiply(spring_[i], u, k_u);
        for (int d = 0; d < 3; ++d) reaction_.force[i].c[d] = reaction_start_[i].c[d] - k_u[d];
    }
    reaction_.add_to(f);
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
        const Symmetric<double>& c = dashpot_[i];
        // (m/s + alpha m/2 + C/2) dv = -C (v* + v-)/2, v* the velocity without dashpots
        const double r[3] = {-0.5 * (v[0] + old[0]), -0.5 * (v[1] + old[1]),
                             -0.5 * (v[2] + old[2])};
        double b[3], force[3];
        multiply(c, r, b);
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
        multiply(c, mean, force);
        for (int d = 0; d < 3; ++d) {
            const double without = v[d];
            v[d] += dv[d];
            nodes.f[n].c[d] -= force[d];
            dissipated_ += 0.5 * step.dt_before * force[d] * old[d];
            ahead_ += 0.5 * step.dt_after * force[d] * v[d];
            report.kinetic += 0.5 * m * old[d] * dv[d];
            const double quarter = 0.25 * step.damping * m;
            report.damping_before += quarter * step.dt_before * dv[d] * old[d];
            report.damping_after +=
                quarter * step.dt_after * ((old[d] + v[d]) * v[d] - (old[d] + without) * without);
        }
    }
}

}  // namespace undertow::fem
