#include "sph_solver/physics/viscous_operator.hpp"

#include <algorithm>
#include <cmath>
#include <type_traits>

#include "sph_solver/kernels/kernels.hpp"
#include "sph_solver/physics/pair_factors.hpp"
#include "sph_solver/physics/pair_terms.hpp"

namespace undertow::sph {

namespace {

template <class Real>
inline Eight<Real> load(const Real* a) {
    Eight<Real> value;
    __builtin_memcpy(&value, a, sizeof value);
    return value;
}
template <class Real>
inline void store(Real* a, Eight<Real> value) {
    __builtin_memcpy(a, &value, sizeof value);
}

template <class Real>
struct Target {
    typename EightOf<Real>::Place x, y, z;
    Eight<Real> volume, root_mu;
    Eight<Real> same[FluidTag::most];  // 1 with that fluid, 0 with another; where there are several
};

template <class AnyRecord>
auto load_target(const AnyRecord* records, int first, int last, int fluids) {
    using Real = typename AnyRecord::Real;
    Target<Real> c;
    for (int k = 0; k < lanes; ++k) {
        const AnyRecord& q = records[std::min(first + k, last - 1)];
        c.x[k] = q.x, c.y[k] = q.y, c.z[k] = q.z;
        c.volume[k] = q.volume, c.root_mu[k] = q.p;
        if (fluids == 1) continue;
        for (int f = 0; f < fluids; ++f)
            c.same[f][k] = FluidTag::of(q) == static_cast<std::uint32_t>(f) ? Real(1) : Real(0);
    }
    return c;
}

/// mu_ij V_j F
template <class KernelLaw, bool several, class Real>
Eight<Real> weight(const Target<Real>& i, const Record<Real>& j, Eight<Real> r2, Real inverse_h) {
    const Eight<Real> w = KernelLaw::gradient_factor(r2, inverse_h) * j.volume;
    if constexpr (several)
        return w * mean_viscosity(i.same[FluidTag::of(j)], i.root_mu, j.p);
    else
        return w * mean_within(i.root_mu, j.p);
}

template <class Real>
struct Sum {
    Eight<Real> x{}, y{}, z{};
    Eight<Real> rubbed{};  // its product with u_ij
};

/// What multiplies the part along x_ij [-], [1/unit^2], see strain_weight.hpp
template <class Real>
struct AlongPair {
    Real near = 0, far = 0;
    explicit AlongPair(const PairPhysics& p, double h)  // h [unit]
        : near(static_cast<Real>(p.strain_weight.near)),
          far(static_cast<Real>(p.strain_weight.far / (h * h))) {}
};

/// sum_j mu_ij V_j F (u_i - u_j), or with its part along x_ij.
template <class Real, class KernelLaw, ViscousForm form, bool several, bool measured>
void sum_pairs(const Target<Real>& i, Eight<Real> ux, Eight<Real> uy, Eight<Real> uz,
               const Record<Real>* records, const int* at, const int* end, Real inverse_h,
               Real tiny, AlongPair<Real> c, Sum<Real>& total) {
    using Wide = Eight<Real>;
    Sum<Real> sum = total;
    for (; at != end; ++at) {
        const Record<Real>& j = records[*at];
        const Wide dx = to_real(i.x - j.x), dy = to_real(i.y - j.y), dz = to_real(i.z - j.z);
        const Wide r2 = (dx * dx + tiny) + dy * dy + dz * dz;
        const Wide w = weight<KernelLaw, several>(i, j, r2, inverse_h);
        const Wide vx = ux - j.vx, vy = uy - j.vy, vz = uz - j.vz;
        if constexpr (form == ViscousForm::laplacian) {
            sum.x += w * vx, sum.y += w * vy, sum.z += w * vz;
            if constexpr (measured) sum.rubbed += w * (vx * vx + vy * vy + vz * vz);
        } else {
            const Wide approach = vx * dx + vy * dy + vz * dz;
            const Wide along = w * approach * positive_part(c.near * reciprocal(r2) + c.far);
            sum.x += along * dx, sum.y += along * dy, sum.z += along * dz;
            if constexpr (measured) sum.rubbed += along * approach;
        }
    }
    total = sum;
}

/// What makes the part along x_ij of pairs with images behind no-slip planes one half along x_ij
/// and half along its reflection, see no_slip_images.hpp.
template <class Real, class KernelLaw, bool several, class Length>
void turn_no_slip(Target<Real> i, Eight<Real> ux, Eight<Real> uy, Eight<Real> uz,
                  const Record<Real>* records, const NoSlipImages& no_slip, int cluster,
                  Length out_of_reach, Real inverse_h, Real tiny, AlongPair<Real> c,
                  Sum<Real>& sum) {
    using Wide = Eight<Real>;
    const auto x = i.x;
    for (const auto* at = no_slip.begin(cluster); at != no_slip.end(cluster); ++at) {
        i.x = hide(x, at->hidden, out_of_reach);
        const Record<Real>& j = records[at->record];
        const auto& m = no_slip.reflection(at->image);
        const Wide dx = to_real(i.x - j.x), dy = to_real(i.y - j.y), dz = to_real(i.z - j.z);
        const Wide r2 = (dx * dx + tiny) + dy * dy + dz * dz;
        const auto along = [&](int a) {
            return Real(m[a][0]) * dx + Real(m[a][1]) * dy + Real(m[a][2]) * dz;
        };
        const Wide ex = along(0), ey = along(1), ez = along(2);
        const Wide half = Real(0.5) * weight<KernelLaw, several>(i, j, r2, inverse_h) *
                          positive_part(c.near * reciprocal(r2) + c.far);
        const Wide vx = ux - j.vx, vy = uy - j.vy, vz = uz - j.vz;
        const Wide on_d = half * (vx * dx + vy * dy + vz * dz),
                   on_e = half * (vx * ex + vy * ey + vz * ez);
        sum.x += on_e * ex - on_d * dx;
        sum.y += on_e * ey - on_d * dy;
        sum.z += on_e * ez - on_d * dz;
    }
}

/// sum_j mu_ij V_j F without the particle itself, or of its part along x_ij the trace.
template <class Real, class KernelLaw, ViscousForm form, bool several>
Eight<Real> sum_weights(const Target<Real>& i, const Record<Real>* records, const int* at,
                        const int* end, Real inverse_h, Real tiny, AlongPair<Real> c) {
    using Wide = Eight<Real>;
    Wide sum{};
    for (; at != end; ++at) {
        const Record<Real>& j = records[*at];
        const Wide dx = to_real(i.x - j.x), dy = to_real(i.y - j.y), dz = to_real(i.z - j.z);
        const Wide r2 = (dx * dx + tiny) + dy * dy + dz * dz;
        Wide w = weight<KernelLaw, several>(i, j, r2, inverse_h);
        if constexpr (form == ViscousForm::strain) w *= positive_part(c.near + c.far * r2);
        sum += r2 > 2 * tiny ? w : Wide{};
    }
    return sum;
}

/// 2 scale
double pair_scale(const PairPhysics& p) {
    const double scale =
        with_kernel(p.kernel, p.h, p.dimension, [](const auto& kernel) { return kernel.scale(); });
    return 2 * scale / p.lattice_moment;
}

}  // namespace

template <class Real>
void ViscousOperator<Real>::prepare(const PairPhysics& physics, const Neighborhood& neighbors,
                                    const MirrorPlanes& mirror, const NoSlipImages& no_slip,
                                    const Bodies& bodies, const Particles& particles) {
    physics_ = &physics, neighbors_ = &neighbors, mirror_ = &mirror, no_slip_ = &no_slip;
    records_ = neighbors.records_in<Real>();
    const int n = neighbors.fluid_count(), records = static_cast<int>(records_.size());
    const std::vector<Extra>& extras = neighbors.extras();
    // of the shear rates just found: the packed ones are a step older
    const std::vector<double>& viscosity = particles.viscosity;
    image_.resize(extras.size(), ViscousImage(mirror, 0, false));
    mass_.resize((n + lanes - 1) / lanes * lanes, Real(1));
    part_.resize(neighbors.fluid_lists().clusters());
#pragma omp parallel for schedule(static)
    for (int j = 0; j < records; ++j) {
        Record<Real>& q = records_[j];
        const bool extra = j >= n;
        const Extra* e = extra ? &extras[j - n] : nullptr;
        const std::uint8_t own =
            extra ? (e->from_body ? bodies.fluid[e->source] : particles.fluid[e->source])
                  : particles.fluid[j];
        const FluidLaw& fluid = physics.fluids[own];
        if (viscosity.empty())
            q.p = static_cast<Real>(std::sqrt(fluid.mu));
        else
            q.p = std::sqrt(static_cast<Real>(!extra         ? viscosity[j]
                                              : e->from_body ? bodies.viscosity[e->source]
                                                             : viscosity[e->source]));
        if (!extra) {
            mass_[j] = static_cast<Real>(fluid.rho0 * fluid.volume);
            continue;
        }
        ViscousImage& image = image_[j - n];
        image = ViscousImage(mirror, e->mask, !e->from_body && fluid.resolves_walls);
        if (!e->from_body) continue;
        const int d = e->source;
        const RigidBody& body = bodies.body[bodies.owner[d]];
        // u_i - (2 v_w - u_i): twice the weight against the wall's velocity
        q.volume *= body.body().slip == Slip::no_slip ? 2 : 0;
        const Vec3 v = body.pose().velocity_at({bodies.x[d], bodies.y[d], bodies.z[d]});
        for (int a = 0; a < 3; ++a) image.wall[a] = static_cast<Real>(v[a]);
    }
}

template <class Real>
void ViscousOperator<Real>::pack(const Field3<Real>& u, Walls walls) {
    const int n = neighbors_->fluid_count(), records = static_cast<int>(records_.size());
    const std::vector<Extra>& extras = neighbors_->extras();
    const Real moving = walls == Walls::moving ? 1 : 0;
#pragma omp parallel for schedule(static)
    for (int j = 0; j < records; ++j) {
        Record<Real>& q = records_[j];
        if (j < n) {
            q.vx = u.x[j], q.vy = u.y[j], q.vz = u.z[j];
            continue;
        }
        const Extra& e = extras[j - n];
        const ViscousImage& image = image_[j - n];
        q.vx = moving * image.wall[0], q.vy = moving * image.wall[1], q.vz = moving * image.wall[2];
        if (e.from_body) continue;
        const auto& m = mirror_->reflection(image.mirrored).m;
        const Real s = image.sign, x = u.x[e.source], y = u.y[e.source], z = u.z[e.source];
        q.vx += s * (Real(m[0][0]) * x + Real(m[0][1]) * y + Real(m[0][2]) * z);
        q.vy += s * (Real(m[1][0]) * x + Real(m[1][1]) * y + Real(m[1][2]) * z);
        q.vz += s * (Real(m[2][0]) * x + Real(m[2][1]) * y + Real(m[2][2]) * z);
    }
}

template <class Real>
template <class Body>
double ViscousOperator<Real>::over_clusters(Body&& body) {
    const int clusters = neighbors_->fluid_lists().clusters();
#pragma omp parallel for schedule(dynamic, 32)
    for (int c = 0; c < clusters; ++c) part_[c] = body(c);
    double sum = 0;
    for (const double part : part_) sum += part;
    return sum;
}

template <class Real>
template <class KernelLaw, ViscousForm form, bool several>
double ViscousOperator<Real>::apply_as(const Field3<Real>& u, double mass_factor, double dt,
                                       Field3<Real>& out, Returns returns) {
    using Wide = Eight<Real>;
    const bool measured = returns == Returns::dissipation;
    const int n = neighbors_->fluid_count();
    const double unit = neighbors_->unit_in<Real>(), h = physics_->h / unit;
    const auto inverse_h = static_cast<Real>(1 / h), tiny = static_cast<Real>(tiny_share<Real> * h * h);
    const auto to_force = static_cast<Real>(dt * pair_scale(*physics_));
    const auto of_mass = static_cast<Real>(mass_factor);
    const AlongPair<Real> along(*physics_, h);
    const int fluids = static_cast<int>(physics_->fluids.size());
    const ClusterLists& lists = neighbors_->fluid_lists();
    const auto out_of_reach = neighbors_->out_of_reach<Real>();
    return over_clusters([&](int cluster) {
        const int first = cluster * lanes;
        Target<Real> i = load_target(records_.data(), first, n, fluids);
        const auto x_of_all = i.x;
        const Wide ux = load(&u.x[first]), uy = load(&u.y[first]), uz = load(&u.z[first]);
        const auto sum_with = measured ? sum_pairs<Real, KernelLaw, form, several, true>
                                       : sum_pairs<Real, KernelLaw, form, several, false>;
        Sum<Real> sum;
        for (int k = 0; k < lists.parts(cluster); ++k) {
            const ClusterLists::Part part = lists.part(cluster, k);
            i.x = hide(x_of_all, part.hidden, out_of_reach);
            sum_with(i, ux, uy, uz, records_.data(), part.begin, part.end, inverse_h, tiny, along,
                     sum);
        }
        i.x = x_of_all;
        if constexpr (form == ViscousForm::strain)
            if (!no_slip_->empty())
                turn_no_slip<Real, KernelLaw, several>(i, ux, uy, uz, records_.data(), *no_slip_,
                                                       cluster, out_of_reach, inverse_h, tiny,
                                                       along, sum);
        const Wide m = of_mass * load(&mass_[first]), v = to_force * i.volume;
        const Wide x = m * ux + v * sum.x, y = m * uy + v * sum.y, z = m * uz + v * sum.z;
        store(&out.x[first], x), store(&out.y[first], y), store(&out.z[first], z);
        const Wide product = measured ? Real(0.5) * v * sum.rubbed : ux * x + uy * y + uz * z;
        double dot = 0;
        for (int k = 0; k < std::min(lanes, n - first); ++k) dot += product[k];
        return dot;
    });
}

template <class Real>
double ViscousOperator<Real>::apply(const Field3<Real>& u, Walls walls, double mass_factor,
                                    double dt, Field3<Real>& out) {
    pack(u, walls);
    return apply(u, mass_factor, dt, out, Returns::product);
}

template <class Real>
double ViscousOperator<Real>::rub(const Field3<Real>& u, double dt, Field3<Real>& out) {
    pack(u, Walls::moving);
    return apply(u, 0, dt, out, Returns::dissipation);
}

template <class Real>
double ViscousOperator<Real>::apply(const Field3<Real>& u, double mass_factor, double dt,
                                    Field3<Real>& out, Returns returns) {
    const bool strain = physics_->viscous_form == ViscousForm::strain;
    return with_kernel(physics_->kernel, physics_->h, physics_->dimension, [&](const auto& kernel) {
        using Law = std::decay_t<decltype(kernel)>;
        constexpr auto strain_form = ViscousForm::strain, laplacian = ViscousForm::laplacian;
        if (physics_->fluids.size() > 1)
            return strain ? apply_as<Law, strain_form, true>(u, mass_factor, dt, out, returns)
                          : apply_as<Law, laplacian, true>(u, mass_factor, dt, out, returns);
        return strain ? apply_as<Law, strain_form, false>(u, mass_factor, dt, out, returns)
                      : apply_as<Law, laplacian, false>(u, mass_factor, dt, out, returns);
    });
}

template <class Real>
void ViscousOperator<Real>::diagonal(double dt, std::vector<Real>& out) {
    out.resize(mass_.size());
    const int n = neighbors_->fluid_count();
    const double unit = neighbors_->unit_in<Real>(), h = physics_->h / unit;
    const auto inverse_h = static_cast<Real>(1 / h), tiny = static_cast<Real>(tiny_share<Real> * h * h);
    // the mean of (e e^T) over directions e is 1/d
    const bool strain = physics_->viscous_form == ViscousForm::strain;
    const double share = strain ? 1.0 / physics_->dimension : 1;
    const AlongPair<Real> along(*physics_, h);
    const auto to_force = static_cast<Real>(dt * pair_scale(*physics_) * share);
    const int fluids = static_cast<int>(physics_->fluids.size());
    const ClusterLists& lists = neighbors_->fluid_lists();
    const auto out_of_reach = neighbors_->out_of_reach<Real>();
    over_clusters([&](int cluster) {
        const int first = cluster * lanes;
        Target<Real> i = load_target(records_.data(), first, n, fluids);
        const auto x_of_all = i.x;
        const Eight<Real> w =
            with_kernel(physics_->kernel, physics_->h, physics_->dimension, [&](const auto& law) {
                using Law = std::decay_t<decltype(law)>;
                constexpr auto s = ViscousForm::strain, l = ViscousForm::laplacian;
                const auto sum = strain ? (fluids > 1 ? sum_weights<Real, Law, s, true>
                                                      : sum_weights<Real, Law, s, false>)
                                        : (fluids > 1 ? sum_weights<Real, Law, l, true>
                                                      : sum_weights<Real, Law, l, false>);
                Eight<Real> of_all{};
                for (int k = 0; k < lists.parts(cluster); ++k) {
                    const ClusterLists::Part part = lists.part(cluster, k);
                    i.x = hide(x_of_all, part.hidden, out_of_reach);
                    of_all += sum(i, records_.data(), part.begin, part.end, inverse_h, tiny, along);
                }
                return of_all;
            });
        store(&out[first], load(&mass_[first]) + to_force * i.volume * w);
        return 0.0;
    });
}

template class ViscousOperator<float>;
template class ViscousOperator<double>;

}  // namespace undertow::sph
