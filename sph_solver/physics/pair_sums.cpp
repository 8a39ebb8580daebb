#include "sph_solver/physics/pair_sums.hpp"

#include <algorithm>
#include <cmath>

#include "sph_solver/kernels/kernels.hpp"

namespace undertow::sph {

namespace {

/// Constants that multiply the finished sums.
template <class Scalar>
struct Factors {
    Scalar gradient;     // scale * unit: of sums with x_ij [1/m^(d+1)]
    Scalar viscous;      // 2 mu scale [Pa s/m^(d+2)]
    Scalar diffusive;    // 2 delta h scale / c0 [s/m^(d+2)]: from pressure to density differences
    Scalar per_mass;     // 1/(rho0 V0): 1/rho_i = V_i/(rho0 V0) exactly, so that pair forces are
                         // equal and opposite
};

template <class Scalar>
PairConstants<Scalar> pair_constants(const PairPhysics& p, double unit) {
    const FluidLaw& f = p.fluid;
    const double h = p.h / unit;
    return {Scalar(1 / h),
            Scalar(1e-6 * h * h),
            Scalar(p.artificial_viscosity * p.h * f.c0 * f.rho0 / unit),
            Scalar(f.rho0 * p.gravity[0] * unit),
            Scalar(f.rho0 * p.gravity[1] * unit),
            Scalar(f.rho0 * p.gravity[2] * unit)};
}

template <class Scalar>
Factors<Scalar> factors(const PairPhysics& p, double scale, double unit) {
    const FluidLaw& f = p.fluid;
    return {Scalar(scale * unit), Scalar(2 * f.mu * scale),
            Scalar(2 * p.density_diffusion * p.h * scale / f.c0), Scalar(1 / (f.rho0 * f.volume))};
}

template <class Real, class Scalar>
Real density_rate(const Factors<Scalar>& k, Real per_rho, const PairSums<Real>& s) {
    return k.diffusive * s.diffusion - (k.gradient * s.divergence) / per_rho;
}

template <class Real, class Scalar>
void acceleration(const Factors<Scalar>& k, Real per_rho, const PairSums<Real>& s, Real& ax,
                  Real& ay, Real& az) {
    ax = per_rho * (k.gradient * s.ax - k.viscous * s.lx);
    ay = per_rho * (k.gradient * s.ay - k.viscous * s.ly);
    az = per_rho * (k.gradient * s.az - k.viscous * s.lz);
}

struct Lanes {
    int8 x, y, z;
    Own<float8> own;
    float8 volume;
};

inline Lanes load_cluster(const Packed* records, int first, int last) {
    Lanes c;
    for (int k = 0; k < lanes; ++k) {
        const Packed& q = records[std::min(first + k, last - 1)];
        c.x[k] = q.x, c.y[k] = q.y, c.z[k] = q.z;
        c.own.vx[k] = q.vx, c.own.vy[k] = q.vy, c.own.vz[k] = q.vz;
        c.own.p[k] = q.p, c.volume[k] = q.volume;
    }
    return c;
}

inline void store(float* a, float8 value) { __builtin_memcpy(a, &value, sizeof value); }

template <class KernelLaw, Terms terms>
void sum_clusters(const PairPhysics& physics, const Neighborhood& neighbors, Particles& particles) {
    const double unit = neighbors.fixed().unit;
    const auto c = pair_constants<float>(physics, unit);
    const KernelLaw kernel(physics.h, physics.dimension);
    const auto k = factors<float>(physics, kernel.scale(), unit);
    const Packed* records = neighbors.records().data();
    const ClusterLists& lists = neighbors.fluid_lists();
    const int n = neighbors.fluid_count(), clusters = lists.clusters();

#pragma omp parallel for schedule(dynamic, 32)
    for (int cluster = 0; cluster < clusters; ++cluster) {
        const int first = cluster * lanes;
        const Lanes i = load_cluster(records, first, n);
        PairSums<float8> sum;
        const int* end = lists.end(cluster);
        for (const int* at = lists.begin(cluster); at != end; ++at) {
            const Packed& j = records[*at];
            const float8 dx = to_real(i.x - j.x), dy = to_real(i.y - j.y), dz = to_real(i.z - j.z);
            add_pair<KernelLaw, terms>(c, i.own, dx, dy, dz, j, sum);
        }
        const float8 per_rho = i.volume * k.per_mass;
        if constexpr (terms != Terms::force)
            store(&particles.drho_dt[first], density_rate(k, per_rho, sum));
        if constexpr (terms != Terms::rate) {
            float8 ax, ay, az;
            acceleration(k, per_rho, sum, ax, ay, az);
            store(&particles.ax[first], ax);
            store(&particles.ay[first], ay);
            store(&particles.az[first], az);
        }
    }
}

template <class KernelLaw>
void dispatch(const PairPhysics& physics, const Neighborhood& neighbors, Terms terms,
              Particles& particles) {
    if (terms == Terms::both)
        sum_clusters<KernelLaw, Terms::both>(physics, neighbors, particles);
    else if (terms == Terms::rate)
        sum_clusters<KernelLaw, Terms::rate>(physics, neighbors, particles);
    else
        sum_clusters<KernelLaw, Terms::force>(physics, neighbors, particles);
}

template <class KernelLaw>
void reference(const PairPhysics& physics, const Neighborhood& neighbors, Particles& particles,
               std::vector<double>& rate, std::vector<Vec3>& a) {
    const double unit = neighbors.fixed().unit;
    const auto c = pair_constants<double>(physics, unit);
    const KernelLaw kernel(physics.h, physics.dimension);
    const auto k = factors<double>(physics, kernel.scale(), unit);
    const auto& records = neighbors.records();
    rate.resize(particles.size());
    a.resize(particles.size());
    for (int i = 0; i < neighbors.fluid_count(); ++i) {
        const Packed& q = records[i];
        const Own<double> own{q.vx, q.vy, q.vz, q.p};
        PairSums<double> sum;
        for (const Packed& j : records) {   // all records: no list to be wrong
            const double dx = to_real(q.x - j.x, 0.0), dy = to_real(q.y - j.y, 0.0),
                         dz = to_real(q.z - j.z, 0.0);
            if (dx * dx + dy * dy + dz * dz > 4.01 * physics.h * physics.h / (unit * unit)) continue;
            add_pair<KernelLaw, Terms::both>(c, own, dx, dy, dz, j, sum);
        }
        const double per_rho = q.volume * k.per_mass;
        rate[i] = density_rate(k, per_rho, sum);
        acceleration(k, per_rho, sum, a[i][0], a[i][1], a[i][2]);
    }
}

template <class KernelLaw>
std::vector<double> force_on_planes(const PairPhysics& physics, const Neighborhood& neighbors,
                                    const MirrorPlanes& mirror) {
    const double unit = neighbors.fixed().unit;
    const auto c = pair_constants<float>(physics, unit);
    const KernelLaw kernel(physics.h, physics.dimension);
    const auto k = factors<float>(physics, kernel.scale(), unit);
    const Packed* records = neighbors.records().data();
    const ClusterLists& lists = neighbors.fluid_lists();
    const int n = neighbors.fluid_count(), clusters = lists.clusters(), planes = mirror.size();
    // per cluster first, then summed in order: the same bits for any number of threads
    std::vector<double> part(std::size_t(clusters) * planes, 0.0);

#pragma omp parallel for schedule(dynamic, 32)
    for (int cluster = 0; cluster < clusters; ++cluster) {
        const int first = cluster * lanes, members = std::min(lanes, n - first);
        const Lanes i = load_cluster(records, first, n);
        for (const int* at = lists.begin(cluster); at != lists.end(cluster); ++at) {
            if (*at < n) continue;
            const PlaneMask mask = neighbors.extras()[*at - n].mask;
            if (mask == 0) continue;
            const Packed& j = records[*at];
            PairSums<float8> sum;
            add_pair<KernelLaw, Terms::force>(c, i.own, to_real(i.x - j.x), to_real(i.y - j.y),
                                              to_real(i.z - j.z), j, sum);
            const float8 per_rho = i.volume * k.per_mass;
            float8 ax, ay, az;
            acceleration(k, per_rho, sum, ax, ay, az);
            double a[3] = {0, 0, 0};
            for (int lane = 0; lane < members; ++lane)
                a[0] += ax[lane], a[1] += ay[lane], a[2] += az[lane];
            for (int p = 0; p < planes; ++p)
                if (mask >> p & 1) {
                    const Vec3& normal = mirror.plane(p).normal;
                    part[std::size_t(cluster) * planes + p] +=
                        physics.fluid.mass *
                        (a[0] * normal[0] + a[1] * normal[1] + a[2] * normal[2]);
                }
        }
    }
    std::vector<double> force(planes, 0.0);
    for (int cluster = 0; cluster < clusters; ++cluster)
        for (int p = 0; p < planes; ++p) force[p] += part[std::size_t(cluster) * planes + p];
    return force;
}

}  // namespace

void sum_over_neighbors(const PairPhysics& physics, const Neighborhood& neighbors, Terms terms,
                        Particles& particles) {
    if (physics.kernel == Kernel::wendland_c2)
        dispatch<WendlandC2>(physics, neighbors, terms, particles);
    else
        dispatch<CubicSpline>(physics, neighbors, terms, particles);
}

void sum_over_neighbors_reference(const PairPhysics& physics, const Neighborhood& neighbors,
                                  Particles& particles, std::vector<double>& rate,
                                  std::vector<Vec3>& acceleration) {
    if (physics.kernel == Kernel::wendland_c2)
        reference<WendlandC2>(physics, neighbors, particles, rate, acceleration);
    else
        reference<CubicSpline>(physics, neighbors, particles, rate, acceleration);
}

std::vector<double> plane_forces(const PairPhysics& physics, const Neighborhood& neighbors,
                                 const MirrorPlanes& mirror) {
    if (physics.kernel == Kernel::wendland_c2)
        return force_on_planes<WendlandC2>(physics, neighbors, mirror);
    return force_on_planes<CubicSpline>(physics, neighbors, mirror);
}

}  // namespace undertow::sph
