#include "sph_solver/physics/shifting.hpp"

#include <algorithm>
#include <cmath>

#include "sph_solver/kernels/kernels.hpp"
#include "sph_solver/physics/pair_clusters.hpp"

namespace undertow::sph {

namespace {

constexpr double largest_share = 1;   // of h |grad v|: |u| at most
constexpr double stable_share = 0.5;  // of h^2/interval: the diffusion's limit

/// Of one cluster: sums of V F times x_ij, (p_i - p_j) x_ij, x_ij . x_ij, v_ij . v_ij; and what is
/// foreign.
template <class Real>
struct ShiftSums {
    Eight<Real> x{}, y{}, z{}, px{}, py{}, pz{}, lambda{}, v2{}, foreign{};
};

template <class KernelLaw, class Real>
ShiftSums<Real> sum_cluster(const PairConstants<Real>& c, const Neighborhood& neighbors, bool mixed,
                            int first, const Lanes<Real>& i) {
    using Wide = Eight<Real>;
    const Record<Real>* records = neighbors.records_in<Real>().data();
    const int n = neighbors.fluid_count(), cluster = first / lanes;
    Wide own{};
    if (mixed)
        for (int k = 0; k < lanes; ++k)
            own[k] = static_cast<Real>(FluidTag::of(records[std::min(first + k, n - 1)]));
    ShiftSums<Real> sum;
    for_each_entry(neighbors, i, cluster, [&](const int* at, const auto& x) {
        const Record<Real>& j = records[*at];
        const Wide dx = to_real(x - j.x), dy = to_real(i.y - j.y), dz = to_real(i.z - j.z);
        const Wide r2 = (dx * dx + c.tiny) + dy * dy + dz * dz;
        const Wide F = KernelLaw::gradient_factor(r2, c.inverse_h) * j.volume;
        const Wide p = F * (i.own.p - j.p);
        sum.x += F * dx, sum.y += F * dy, sum.z += F * dz;
        sum.px += p * dx, sum.py += p * dy, sum.pz += p * dz;
        sum.lambda += F * r2;
        const Wide vx = i.own.vx - j.vx, vy = i.own.vy - j.vy, vz = i.own.vz - j.vz;
        sum.v2 += F * (vx * vx + vy * vy + vz * vz);
        if (mixed) {
            const Wide differ = own - static_cast<Real>(FluidTag::of(j));
            sum.foreign += F * (differ * differ);
        }
    });
    return sum;
}

/// Of one particle.
struct Drift {
    double u[3] = {0, 0, 0};       // [m/s]
    double normal[3] = {0, 0, 0};  // outward, length 1; zero where it is not at the surface
    double grad_p[3] = {0, 0, 0};  // [Pa/m]
};

/// From the sums of the pair loop to SI.
struct DriftScale {
    double to_sum;     // of sums of V F x_ij [1/(m^d unit)]
    double to_lambda;  // of sums of V F x_ij . x_ij [1/(m^d unit^2)]
    double strength;   // K 2 h^2 [m2]
    double to_v2;      // of sums of V F v_ij . v_ij [1/m^(d+2)]
    double largest;    // of u over |grad v| [m]
    double stable;     // largest strength |grad v| [m2/s]
    int dimension;
};

template <class Real>
Drift drift_of(const DriftScale& scale, const ShiftSums<Real>& s, int k, Depth depth) {
    Drift of;
    if (depth == Depth::loose || s.foreign[k] > 0) return of;
    const double x[3] = {s.x[k], s.y[k], s.z[k]}, p[3] = {s.px[k], s.py[k], s.pz[k]};
    const double complete = scale.dimension / (scale.to_lambda * s.lambda[k]);
    const double gamma = std::sqrt(scale.to_v2 * s.v2[k]);
    const double strength = std::min(scale.strength * gamma, scale.stable);
    double length2 = 0;
    for (int a = 0; a < 3; ++a) {
        of.u[a] = strength * scale.to_sum * x[a];  // -grad W = scale F x
        of.grad_p[a] = complete * scale.to_sum * p[a];
        length2 += of.u[a] * of.u[a];
    }
    const double length = std::sqrt(length2);
    if (depth == Depth::surface && length > 0)
        for (int a = 0; a < 3; ++a) of.normal[a] = of.u[a] / length;
    if (length > scale.largest * gamma)
        for (double& u : of.u) u *= scale.largest * gamma / length;
    return of;
}

template <class Real, class KernelLaw>
void find(const KernelLaw& kernel, const PairPhysics& physics, const Neighborhood& neighbors,
          double interval, Shift& shift) {
    const double unit = neighbors.unit_in<Real>();
    const auto c = pair_constants<Real>(physics, physics.fluids[0], unit);
    const DriftScale scale{kernel.scale() * unit,
                           kernel.scale() * unit * unit,
                           physics.shifting * 2 * physics.h * physics.h,
                           kernel.scale(),
                           largest_share * physics.h,
                           stable_share * physics.h * physics.h / interval,
                           physics.dimension};
    const double reach = 2 * physics.h / unit;
    const Record<Real>* records = neighbors.records_in<Real>().data();
    const ClusterLists& lists = neighbors.fluid_lists();
    const std::vector<Depth>& depth = neighbors.depth();
    const int n = neighbors.fluid_count(), clusters = lists.clusters();
    const bool mixed = physics.fluids.size() > 1;
    for (auto* a : {&shift.ux, &shift.uy, &shift.uz, &shift.rate})
        a->resize(std::size_t(clusters) * lanes);
    std::vector<Drift> drift(shift.ux.size());
#pragma omp parallel for schedule(dynamic, 32)
    for (int cluster = 0; cluster < clusters; ++cluster) {
        const int first = cluster * lanes;
        const Lanes<Real> i = load_cluster(records, first, n);
        const ShiftSums<Real> sum = sum_cluster<KernelLaw>(c, neighbors, mixed, first, i);
        for (int k = 0; k < lanes; ++k)
            drift[first + k] = drift_of(scale, sum, k, depth[first + k]);
    }
    double fastest2 = 0;
#pragma omp parallel for schedule(dynamic, 256) reduction(max : fastest2)
    for (int i = 0; i < n; ++i) {
        const Drift& of = drift[i];
        double normal[3] = {of.normal[0], of.normal[1], of.normal[2]};
        if (depth[i] == Depth::near_surface)
            lists.for_each_seen(i, [&](int j) {
                if (j >= n || depth[j] < Depth::surface) return;
                const double x = double(records[i].x) - records[j].x,
                             y = double(records[i].y) - records[j].y,
                             z = double(records[i].z) - records[j].z;
                const double w = positive_part(1 - std::sqrt(x * x + y * y + z * z) / reach);
                for (int a = 0; a < 3; ++a) normal[a] += w * drift[j].normal[a];
            });
        double length2 = 0, along = 0;
        for (int a = 0; a < 3; ++a) length2 += normal[a] * normal[a], along += of.u[a] * normal[a];
        const double outward = length2 > 0 ? along / length2 : 0;
        double u[3], u2 = 0, rate = 0;
        for (int a = 0; a < 3; ++a) {
            u[a] = of.u[a] - outward * normal[a];
            u2 += u[a] * u[a];
            rate += u[a] * of.grad_p[a];
        }
        const double c0 = physics.fluids[mixed ? FluidTag::of(records[i]) : 0].c0;
        shift.ux[i] = Real(u[0]), shift.uy[i] = Real(u[1]), shift.uz[i] = Real(u[2]);
        shift.rate[i] = Real(rate / (c0 * c0));
        fastest2 = std::max(fastest2, u2);
    }
    shift.fastest = std::sqrt(fastest2);
}

}  // namespace

void Shift::move(double dt, Particles& p) const {
    const int n = static_cast<int>(p.size());
#pragma omp parallel for schedule(static)
    for (int i = 0; i < n; ++i) {
        p.x[i] += dt * ux[i];
        p.y[i] += dt * uy[i];
        p.z[i] += dt * uz[i];
    }
}

void Shift::carry_density(Particles& p) const {
    const int n = static_cast<int>(p.size());
#pragma omp parallel for schedule(static)
    for (int i = 0; i < n; ++i) p.drho_dt.add(i, rate[i]);
}

void find_shift(const PairPhysics& physics, const Neighborhood& neighbors, double interval,
                Shift& shift) {
    with_kernel(physics.kernel, physics.h, physics.dimension, [&](const auto& kernel) {
        if (neighbors.exact().used)
            find<double>(kernel, physics, neighbors, interval, shift);
        else
            find<float>(kernel, physics, neighbors, interval, shift);
    });
}

}  // namespace undertow::sph
