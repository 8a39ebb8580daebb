// The reference of the fast sums: double precision, one pair at a time, all records, of whatever
// precision these are.

#include "sph_solver/kernels/kernels.hpp"
#include "sph_solver/physics/pair_factors.hpp"

namespace undertow::sph {

namespace {

template <class Real, class KernelLaw>
ReferenceSums reference(const KernelLaw& kernel, const PairPhysics& physics,
                        const Neighborhood& neighbors) {
    const double unit = neighbors.unit_in<Real>();
    const Mixture<double> mixture(physics, kernel.scale(), unit);
    const auto& records = neighbors.records_in<Real>();
    const std::vector<Real>& h_of = neighbors.smoothing_in<Real>();  // empty unless sized
    const bool sized = physics.sized(), mixed = physics.mixed(), variable = physics.viscoplastic();
    const auto fluid_of = [&](const Record<Real>& j) { return mixed ? FluidTag::of(j) : 0; };
    const auto root_viscosity_of = [&](std::size_t j) {
        return variable ? double(neighbors.root_viscosity_in<Real>()[j])
                        : std::sqrt(physics.fluids[fluid_of(records[j])].mu);
    };
    ReferenceSums of;
    for (int i = 0; i < neighbors.fluid_count(); ++i) {
        const Record<Real>& q = records[i];
        const auto fluid = fluid_of(q);
        const Factors<double> k{mixture.gradient, mixture.viscous, mixture.diffusive[fluid],
                                mixture.per_mass[fluid]};
        const bool inside = physics.tension_control == TensionControl::switched &&
                            neighbors.depth()[i] == Depth::inside;
        const Own<double> own{q.vx, q.vy, q.vz, q.p, inside ? std::abs(q.p) : q.p, mixture.rho0[fluid],
                               root_viscosity_of(i)};
        PairSums<double> sum;
        ShearSums<double> shear;
        for (std::size_t at = 0; at < records.size(); ++at) {  // no list to be wrong
            const Record<Real>& j = records[at];
            const double dx = to_real(q.x - j.x, 0.0), dy = to_real(q.y - j.y, 0.0),
                         dz = to_real(q.z - j.z, 0.0);
            const double h = sized ? 0.5 * (h_of[i] + double(h_of[at])) : physics.h;
            if (dx * dx + dy * dy + dz * dz > 4.01 * h * h / (unit * unit)) continue;
            const PairSize<double> size(0.5 * h / physics.h, 0.5 * h / physics.h,
                                        physics.dimension == 2);
            const auto add = [&]<ViscousForm form>() {
                add_pair<KernelLaw, Terms::both, Content::sheared, true, Gradient::plain, form>(
                    mixture.constants, own, dx, dy, dz, j, sum,
                    &mixture.meeting[fluid][fluid_of(j)], root_viscosity_of(at), &shear, &size);
            };
            if (physics.explicit_form() == ViscousForm::strain)
                add.template operator()<ViscousForm::strain>();
            else
                add.template operator()<ViscousForm::laplacian>();
        }
        if (physics.gradient_correction) {   // G : M^-1
            const double to = mixture.gradient * unit;
            const auto m = divergence_correction<double>(
                Symmetric<double>{to * shear.xx, to * shear.xy, to * shear.xz, to * shear.yy,
                                  to * shear.yz, to * shear.zz},
                physics.dimension);
            sum.divergence = m.xx * shear.vxx + m.yy * shear.vyy + m.zz * shear.vzz +
                             m.xy * (shear.vxy + shear.vyx) + m.xz * (shear.vxz + shear.vzx) +
                             m.yz * (shear.vyz + shear.vzy);
        }
        const double per_rho = q.volume * k.per_mass;
        Vec3 a;
        acceleration(k, per_rho, sum, a[0], a[1], a[2]);
        of.rate.push_back(density_rate(k, per_rho, sum));
        of.acceleration.push_back(a);
        of.shear_rate.push_back(
            shear_rate(shear, mixture.gradient, mixture.gradient * unit, physics.dimension));
    }
    return of;
}

}  // namespace

ReferenceSums sum_over_neighbors_reference(const PairPhysics& physics,
                                           const Neighborhood& neighbors) {
    return with_kernel(physics.kernel, physics.h, physics.dimension, [&](const auto& kernel) {
        return neighbors.exact().used ? reference<double>(kernel, physics, neighbors)
                                      : reference<float>(kernel, physics, neighbors);
    });
}

}  // namespace undertow::sph
