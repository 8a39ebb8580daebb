// What the fluids press on rigid walls, from the same pair terms as the sums.

#include "sph_solver/physics/wall_forces.hpp"

#include <vector>

#include "sph_solver/kernels/kernels.hpp"
#include "sph_solver/physics/pair_clusters.hpp"

namespace undertow::sph {

namespace {

/// The sum over the images of one mask, or over one body's dummies and their images of one mask.
template <class Real>
struct OfWall {
    PlaneMask mask;
    int body;  // -1 = images of the fluid
    PairSums<Eight<Real>> sum;
};

/// What a dummy shows the implicit update beyond its record's velocity: 2 v_wall - u_i, or u_i
/// itself where the body lets the fluid slip.  [m/s]
template <class Real>
struct DummyChange {
    using Wide = Eight<Real>;
    Wide x, y, z;

    DummyChange(const Own<Wide>& i, const Record<Real>& j, const Bodies& bodies, int dummy) {
        const RigidBody& rigid = bodies.body[bodies.owner[dummy]];
        const Vec3 wall =
            rigid.pose().velocity_at({bodies.x[dummy], bodies.y[dummy], bodies.z[dummy]});
        const bool holds = rigid.body().slip == Slip::no_slip;
        const auto change = [&](double w, Wide own, Real shown) {
            return holds ? static_cast<Real>(2 * w) - own - shown : own - shown;
        };
        x = change(wall[0], i.vx, j.vx), y = change(wall[1], i.vy, j.vy);
        z = change(wall[2], i.vz, j.vz);
    }
};

/// Calls f(mask, body, ax, ay, az) with the accelerations that the eight get from each OfWall.
/// implicit: bodies hold the fluid as in the implicit update, by their dummies.
template <class KernelLaw, Content content, ViscousForm form, bool sized = false, class Real,
          class OfOwn, class F>
void for_each_wall(const PairConstants<Real>& c, const Factors<Real, OfOwn>& k,
                   const Lanes<Real>& i, const Meeting<Eight<Real>>* with,
                   const Neighborhood& neighbors, int cluster, const Bodies& bodies,
                   PlaneMask planes, bool implicit, std::vector<OfWall<Real>>& met, F&& f,
                   const OwnSize<Real>* own_size = nullptr) {
    constexpr bool variable = content == Content::viscoplastic;
    const Real* root_mu = variable ? neighbors.root_viscosity_in<Real>().data() : nullptr;
    const Record<Real>* records = neighbors.records_in<Real>().data();
    const ClusterLists& lists = neighbors.fluid_lists();
    const int n = neighbors.fluid_count();
    const auto add_entry = [&](const int* at, const Lanes<Real>& i) {
        const Extra& extra = neighbors.extras()[*at - n];
        if ((extra.mask & planes) == 0 && !extra.from_body) return;  // by translation only
        const Record<Real>& j = records[*at];
        const int body = extra.from_body ? bodies.owner[extra.source] : -1;
        std::size_t m = 0;
        while (m < met.size() && (met[m].mask != extra.mask || met[m].body != body)) ++m;
        if (m == met.size()) met.push_back({extra.mask, body, {}});
        const auto add = [&](const PairSize<Eight<Real>>* size) {
            add_pair<KernelLaw, Terms::force, content, sized, Gradient::plain, form>(
                c, i.own, to_real(i.x - j.x), to_real(i.y - j.y), to_real(i.z - j.z), j, met[m].sum,
                with ? with + FluidTag::of(j) : nullptr, variable ? root_mu[*at] : Real(0),
                static_cast<ShearSums<Eight<Real>>*>(nullptr), size);
        };
        if constexpr (sized) {
            const PairSize<Eight<Real>> size = own_size->with(*at);
            add(&size);
        } else {
            add(nullptr);
        }
        if (implicit && body >= 0)
            add_no_slip_image<KernelLaw, content, form>(
                c, i, DummyChange<Real>(i.own, j, bodies, extra.source), j, with,
                variable ? root_mu[*at] : Real(0), met[m].sum);
    };
    for (const int* at = lists.second(cluster); at != lists.end(cluster); ++at) add_entry(at, i);
    for (int k = 1; k < lists.parts(cluster); ++k) {
        const ClusterLists::Part part = lists.part(cluster, k);
        Lanes<Real> put = i;
        put.x = hide(i.x, part.hidden, neighbors.out_of_reach<Real>());
        for (const int* at = part.begin; at != part.end; ++at)
            if (*at >= n) add_entry(at, put);
    }
    for (const OfWall<Real>& of : met) {
        const Eight<Real> per_rho = i.volume * k.per_mass;
        Eight<Real> ax, ay, az;
        acceleration(k, per_rho, of.sum, ax, ay, az);
        f(of.mask, of.body, ax, ay, az);
    }
    met.clear();
}

/// Calls f(mask, ax, ay, az) with what the eight feel of images behind no-slip planes beyond that
/// of free-slip ones: the walls' shear.
template <class KernelLaw, Content content, ViscousForm form, class Real, class OfOwn, class F>
void for_each_shear(const PairConstants<Real>& c, const Factors<Real, OfOwn>& k,
                    const Lanes<Real>& all, const Meeting<Eight<Real>>* with,
                    const Neighborhood& neighbors, const NoSlipImages& no_slip, int cluster,
                    std::vector<OfWall<Real>>& met, F&& f) {
    if (no_slip.empty()) return;
    constexpr bool variable = content == Content::viscoplastic;
    for (const auto* at = no_slip.begin(cluster); at != no_slip.end(cluster); ++at) {
        Lanes<Real> i = all;
        i.x = hide(all.x, at->hidden, neighbors.out_of_reach<Real>());
        const PlaneMask mask = neighbors.extras()[at->record - neighbors.fluid_count()].mask;
        std::size_t m = 0;
        while (m < met.size() && met[m].mask != mask) ++m;
        if (m == met.size()) met.push_back({mask, -1, {}});
        const Record<Real>& j = neighbors.records_in<Real>()[at->record];
        const Real root_mu_j =
            variable ? neighbors.root_viscosity_in<Real>()[at->record] : Real(0);
        add_no_slip_image<KernelLaw, content, form>(c, i, no_slip.change<Real>(at->image), j, with,
                                                    root_mu_j, met[m].sum);
        if constexpr (form == ViscousForm::strain)
            turn_no_slip_image<KernelLaw, content>(c, i, no_slip.change<Real>(at->image),
                                                   no_slip.reflection(at->image), j, with,
                                                   root_mu_j, met[m].sum);
    }
    for (const OfWall<Real>& of : met) {
        const Eight<Real> per_rho = all.volume * k.per_mass;
        Eight<Real> ax, ay, az;
        acceleration(k, per_rho, of.sum, ax, ay, az);
        f(of.mask, ax, ay, az);
    }
    met.clear();
}

template <class Real, ViscousForm form, class KernelLaw>
std::vector<Vec3> force_on_walls(const KernelLaw& kernel, const PairPhysics& physics,
                                 const Neighborhood& neighbors, const MirrorPlanes& mirror,
                                 const Bodies& bodies, const NoSlipImages& no_slip, bool implicit) {
    using Wide = Eight<Real>;
    const double unit = neighbors.unit_in<Real>();
    const FluidLaw& first_fluid = physics.fluids[0];
    const auto c = pair_constants<Real>(physics, first_fluid, unit);
    const auto k = factors<Real>(physics, first_fluid, kernel.scale(), unit);
    const Mixture<Real> mixture(physics, kernel.scale(), unit);
    const bool mixed = physics.mixed(), variable = physics.viscoplastic();
    const Record<Real>* records = neighbors.records_in<Real>().data();
    const int n = neighbors.fluid_count(), clusters = neighbors.fluid_lists().clusters();
    const std::size_t planes = mirror.size(), fluids = physics.fluids.size();
    const PlaneMask any_plane = (PlaneMask(1) << planes) - 1;
    const std::size_t all = (planes + bodies.count()) * fluids;
    // per cluster first, then summed in order: the same bits for any number of threads
    std::vector<Vec3> part(clusters * all, Vec3{});

#pragma omp parallel
    {
        std::vector<OfWall<Real>> met;
#pragma omp for schedule(dynamic, 32)
        for (int cluster = 0; cluster < clusters; ++cluster) {
            const int first = cluster * lanes, members = std::min(lanes, n - first);
            Lanes<Real> i = load_cluster(records, first, n);
            Vec3* force = &part[cluster * all];
            const auto add = [&](PlaneMask mask, int body, Wide ax, Wide ay, Wide az) {
                double a[FluidTag::most][3] = {};
                for (int lane = 0; lane < members; ++lane) {
                    double* of = a[mixed ? FluidTag::of(records[first + lane]) : 0];
                    of[0] += ax[lane], of[1] += ay[lane], of[2] += az[lane];
                }
                for (std::size_t p = 0; p < planes; ++p) {
                    if (!(mask >> p & 1)) continue;
                    const Vec3& normal = mirror.plane(static_cast<int>(p)).normal;
                    for (std::size_t f = 0; f < fluids; ++f) {
                        const double along =
                            a[f][0] * normal[0] + a[f][1] * normal[1] + a[f][2] * normal[2];
                        for (int b = 0; b < 3; ++b) {
                            force[p * fluids + f][b] -= physics.fluids[f].mass * along * normal[b];
                            if (body >= 0) a[f][b] -= along * normal[b];
                        }
                    }
                }
                if (body < 0) return;
                const std::size_t w = planes + body;
                for (std::size_t f = 0; f < fluids; ++f)
                    for (int b = 0; b < 3; ++b)
                        force[w * fluids + f][b] -= physics.fluids[f].mass * a[f][b];
            };
            const auto add_shear = [&](PlaneMask mask, Wide ax, Wide ay, Wide az) {
                std::size_t plane = 0;  // the first of those that hold the fluid
                while (!(mask >> plane & 1) ||
                       mirror.plane(static_cast<int>(plane)).slip != Slip::no_slip)
                    ++plane;
                for (int lane = 0; lane < members; ++lane) {
                    const std::uint32_t f = mixed ? FluidTag::of(records[first + lane]) : 0;
                    Vec3& on = force[plane * fluids + f];
                    const double mass = physics.fluids[f].mass;
                    on[0] -= mass * ax[lane], on[1] -= mass * ay[lane], on[2] -= mass * az[lane];
                }
            };
            if (!mixed) {
                for_each_shear<KernelLaw, Content::one_fluid, form>(
                    c, k, i, nullptr, neighbors, no_slip, cluster, met, add_shear);
                for_each_wall<KernelLaw, Content::one_fluid, form>(
                    c, k, i, nullptr, neighbors, cluster, bodies, any_plane, implicit, met, add);
                continue;
            }
            MixedLanes<Real> m;
            look_up(mixture, records,
                    variable ? neighbors.root_viscosity_in<Real>().data() : nullptr, first, n,
                    i.own, m);
            if (variable)
                for_each_shear<KernelLaw, Content::viscoplastic, form>(
                    mixture.constants, m.factors, i, m.with, neighbors, no_slip, cluster, met,
                    add_shear);
            else
                for_each_shear<KernelLaw, Content::several, form>(mixture.constants, m.factors, i,
                                                                  m.with, neighbors, no_slip,
                                                                  cluster, met, add_shear);
            if (physics.sized()) {
                const OwnSize<Real> own_size(physics, &neighbors.smoothing_in<Real>(), first, n);
                if (variable)
                    for_each_wall<KernelLaw, Content::viscoplastic, form, true>(
                        mixture.constants, m.factors, i, m.with, neighbors, cluster, bodies,
                        any_plane, implicit, met, add, &own_size);
                else
                    for_each_wall<KernelLaw, Content::several, form, true>(
                        mixture.constants, m.factors, i, m.with, neighbors, cluster, bodies,
                        any_plane, implicit, met, add, &own_size);
                continue;
            }
            if (variable)
                for_each_wall<KernelLaw, Content::viscoplastic, form>(
                    mixture.constants, m.factors, i, m.with, neighbors, cluster, bodies, any_plane,
                    implicit, met, add);
            else
                for_each_wall<KernelLaw, Content::several, form>(mixture.constants, m.factors, i,
                                                                 m.with, neighbors, cluster, bodies,
                                                                 any_plane, implicit, met, add);
        }
    }
    std::vector<Vec3> force(all, Vec3{});
    for (int cluster = 0; cluster < clusters; ++cluster)
        for (std::size_t p = 0; p < all; ++p)
            for (int b = 0; b < 3; ++b) force[p][b] += part[cluster * all + p][b];
    return force;
}

}  // namespace

std::vector<Vec3> wall_forces(const PairPhysics& of, const Neighborhood& neighbors,
                              const MirrorPlanes& mirror, const Bodies& bodies,
                              const NoSlipImages& no_slip) {
    // of the velocities that the implicit update of the step before has found
    PairPhysics physics = of;
    physics.implicit_viscosity = false;
    return with_kernel(physics.kernel, physics.h, physics.dimension, [&](const auto& kernel) {
        const auto in = [&]<class Real>() {
            using Law = std::decay_t<decltype(kernel)>;
            const auto force = physics.explicit_form() == ViscousForm::strain
                                   ? force_on_walls<Real, ViscousForm::strain, Law>
                                   : force_on_walls<Real, ViscousForm::laplacian, Law>;
            return force(kernel, physics, neighbors, mirror, bodies, no_slip,
                         of.implicit_viscosity);
        };
        return neighbors.exact().used ? in.template operator()<double>()
                                      : in.template operator()<float>();
    });
}

}  // namespace undertow::sph
