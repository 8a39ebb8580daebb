#include "sph_solver/physics/viscous_operator.hpp"

#include <algorithm>
#include <cmath>
#include <type_traits>

#include "sph_solver/kernels/kernels.hpp"
#include "sph_solver/physics/pair_terms.hpp"

namespace undertow::sph {

namespace {

inline float8 load(const float* a) {
    float8 value;
    __builtin_memcpy(&value, a, sizeof value);
    return value;
}
inline void store(float* a, float8 value) {
    __builtin_memcpy(a, &value, sizeof value);
}

struct Target {
    int8 x, y, z;
    float8 volume, root_mu;
    float8 same[FluidTag::most];   // 1 with that fluid, 0 with another; where there are several
};

Target load_target(const Packed* records, int first, int last, int fluids) {
    Target c;
    for (int k = 0; k < lanes; ++k) {
        const Packed& q = records[std::min(first + k, last - 1)];
        c.x[k] = q.x, c.y[k] = q.y, c.z[k] = q.z;
        c.volume[k] = q.volume, c.root_mu[k] = q.p;
        if (fluids == 1) continue;
        for (int f = 0; f < fluids; ++f)
            c.same[f][k] = FluidTag::of(q) == static_cast<std::uint32_t>(f) ? 1.0f : 0.0f;
    }
    return c;
}

/// mu_ij V_j F
template <class KernelLaw, bool several>
float8 weight(const Target& i, const Packed& j, float8 r2, float inverse_h) {
    const float8 w = KernelLaw::gradient_factor(r2, inverse_h) * j.volume;
    if constexpr (several)
        return w * mean_viscosity(i.same[FluidTag::of(j)], i.root_mu, j.p);
    else
        return w * mean_within(i.root_mu, j.p);
}

struct Sum {
    float8 x{}, y{}, z{};
    float8 rubbed{};  // its product with u_ij
};

/// What multiplies the part along x_ij [-], [1/unit^2], see strain_weight.hpp
struct AlongPair {
    float near = 0, far = 0;
    explicit AlongPair(const PairPhysics& p, double h)   // h [unit]
        : near(static_cast<float>(p.strain_weight.near)),
          far(static_cast<float>(p.strain_weight.far / (h * h))) {}
};

/// sum_j mu_ij V_j F (u_i - u_j), or with its part along x_ij.
template <class KernelLaw, ViscousForm form, bool several, bool measured>
Sum sum_pairs(const Target& i, float8 ux, float8 uy, float8 uz, const Packed* records,
              const int* at, const int* end, float inverse_h, float tiny, AlongPair c) {
    Sum sum;
    for (; at != end; ++at) {
        const Packed& j = records[*at];
        const float8 dx = to_real(i.x - j.x), dy = to_real(i.y - j.y), dz = to_real(i.z - j.z);
        const float8 r2 = (dx * dx + tiny) + dy * dy + dz * dz;
        const float8 w = weight<KernelLaw, several>(i, j, r2, inverse_h);
        const float8 vx = ux - j.vx, vy = uy - j.vy, vz = uz - j.vz;
        if constexpr (form == ViscousForm::laplacian) {
            sum.x += w * vx, sum.y += w * vy, sum.z += w * vz;
            if constexpr (measured) sum.rubbed += w * (vx * vx + vy * vy + vz * vz);
        } else {
            const float8 approach = vx * dx + vy * dy + vz * dz;
            const float8 along = w * approach * positive_part(c.near * reciprocal(r2) + c.far);
            sum.x += along * dx, sum.y += along * dy, sum.z += along * dz;
            if constexpr (measured) sum.rubbed += along * approach;
        }
    }
    return sum;
}

/// What makes the part along x_ij of pairs with images behind no-slip planes one half along x_ij and
/// half along its reflection, see no_slip_images.hpp.
template <class KernelLaw, bool several>
void turn_no_slip(const Target& i, float8 ux, float8 uy, float8 uz, const Packed* records,
                  const NoSlipImages& no_slip, int cluster, float inverse_h, float tiny,
                  AlongPair c, Sum& sum) {
    for (const auto* at = no_slip.begin(cluster); at != no_slip.end(cluster); ++at) {
        const Packed& j = records[at->record];
        const auto& m = no_slip.reflection(at->image);
        const float8 dx = to_real(i.x - j.x), dy = to_real(i.y - j.y), dz = to_real(i.z - j.z);
        const float8 r2 = (dx * dx + tiny) + dy * dy + dz * dz;
        const auto along = [&](int a) {
            return float(m[a][0]) * dx + float(m[a][1]) * dy + float(m[a][2]) * dz;
        };
        const float8 ex = along(0), ey = along(1), ez = along(2);
        const float8 half = 0.5f * weight<KernelLaw, several>(i, j, r2, inverse_h) *
                            positive_part(c.near * reciprocal(r2) + c.far);
        const float8 vx = ux - j.vx, vy = uy - j.vy, vz = uz - j.vz;
        const float8 on_d = half * (vx * dx + vy * dy + vz * dz),
                     on_e = half * (vx * ex + vy * ey + vz * ez);
        sum.x += on_e * ex - on_d * dx;
        sum.y += on_e * ey - on_d * dy;
        sum.z += on_e * ez - on_d * dz;
    }
}

/// sum_j mu_ij V_j F without the particle itself, or of its part along x_ij the trace.
template <class KernelLaw, ViscousForm form, bool several>
float8 sum_weights(const Target& i, const Packed* records, const int* at, const int* end,
                   float inverse_h, float tiny, AlongPair c) {
    float8 sum{};
    for (; at != end; ++at) {
        const Packed& j = records[*at];
        const float8 dx = to_real(i.x - j.x), dy = to_real(i.y - j.y), dz = to_real(i.z - j.z);
        const float8 r2 = (dx * dx + tiny) + dy * dy + dz * dz;
        float8 w = weight<KernelLaw, several>(i, j, r2, inverse_h);
        if constexpr (form == ViscousForm::strain) w *= positive_part(c.near + c.far * r2);
        sum += r2 > 2 * tiny ? w : float8{};
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

void ViscousOperator::prepare(const PairPhysics& physics, const Neighborhood& neighbors,
                              const MirrorPlanes& mirror, const NoSlipImages& no_slip,
                              const Bodies& bodies, const Particles& particles) {
    physics_ = &physics, neighbors_ = &neighbors, mirror_ = &mirror, no_slip_ = &no_slip;
    records_ = neighbors.records();
    const int n = neighbors.fluid_count(), records = static_cast<int>(records_.size());
    const std::vector<Extra>& extras = neighbors.extras();
    // of the shear rates just found: the packed ones are a step older
    const std::vector<double>& viscosity = particles.viscosity;
    image_.resize(extras.size(), ViscousImage(mirror, 0, false));
    mass_.resize((n + lanes - 1) / lanes * lanes, 1.0f);
    part_.resize(neighbors.fluid_lists().clusters());
#pragma omp parallel for schedule(static)
    for (int j = 0; j < records; ++j) {
        Packed& q = records_[j];
        const bool extra = j >= n;
        const Extra* e = extra ? &extras[j - n] : nullptr;
        const std::uint8_t own = extra ? (e->from_body ? bodies.fluid[e->source]
                                                        : particles.fluid[e->source])
                                       : particles.fluid[j];
        const FluidLaw& fluid = physics.fluids[own];
        if (viscosity.empty())
            q.p = static_cast<float>(std::sqrt(fluid.mu));
        else
            q.p = std::sqrt(static_cast<float>(!extra         ? viscosity[j]
                                               : e->from_body ? bodies.viscosity[e->source]
                                                              : viscosity[e->source]));
        if (!extra) {
            mass_[j] = static_cast<float>(fluid.rho0 * fluid.volume);
            continue;
        }
        ViscousImage& image = image_[j - n];
        image = ViscousImage(mirror, e->mask, !e->from_body && fluid.resolves_walls);
        if (!e->from_body) continue;
        const int d = e->source;
        const RigidBody& body = bodies.body[bodies.owner[d]];
        // u_i - (2 v_w - u_i): twice the weight against the wall's velocity
        q.volume *= body.body().slip == Slip::no_slip ? 2.0f : 0.0f;
        const Vec3 v = body.pose().velocity_at({bodies.x[d], bodies.y[d], bodies.z[d]});
        for (int a = 0; a < 3; ++a) image.wall[a] = static_cast<float>(v[a]);
    }
}

void ViscousOperator::pack(const Field3& u, Walls walls) {
    const int n = neighbors_->fluid_count(), records = static_cast<int>(records_.size());
    const std::vector<Extra>& extras = neighbors_->extras();
    const float moving = walls == Walls::moving ? 1 : 0;
#pragma omp parallel for schedule(static)
    for (int j = 0; j < records; ++j) {
        Packed& q = records_[j];
        if (j < n) {
            q.vx = u.x[j], q.vy = u.y[j], q.vz = u.z[j];
            continue;
        }
        const Extra& e = extras[j - n];
        const ViscousImage& image = image_[j - n];
        q.vx = moving * image.wall[0], q.vy = moving * image.wall[1], q.vz = moving * image.wall[2];
        if (e.from_body) continue;
        const auto& m = mirror_->reflection(image.mirrored).m;
        const float s = image.sign, x = u.x[e.source], y = u.y[e.source], z = u.z[e.source];
        q.vx += s * (float(m[0][0]) * x + float(m[0][1]) * y + float(m[0][2]) * z);
        q.vy += s * (float(m[1][0]) * x + float(m[1][1]) * y + float(m[1][2]) * z);
        q.vz += s * (float(m[2][0]) * x + float(m[2][1]) * y + float(m[2][2]) * z);
    }
}

template <class Body>
double ViscousOperator::over_clusters(Body&& body) {
    const int clusters = neighbors_->fluid_lists().clusters();
#pragma omp parallel for schedule(dynamic, 32)
    for (int c = 0; c < clusters; ++c) part_[c] = body(c);
    double sum = 0;
    for (const double part : part_) sum += part;
    return sum;
}

template <class KernelLaw, ViscousForm form, bool several>
double ViscousOperator::apply_as(const Field3& u, double mass_factor, double dt, Field3& out,
                                 Returns returns) {
    const bool measured = returns == Returns::dissipation;
    const int n = neighbors_->fluid_count();
    const double unit = neighbors_->fixed().unit, h = physics_->h / unit;
    const auto inverse_h = static_cast<float>(1 / h), tiny = static_cast<float>(1e-6 * h * h);
    const auto to_force = static_cast<float>(dt * pair_scale(*physics_));
    const auto of_mass = static_cast<float>(mass_factor);
    const AlongPair along(*physics_, h);
    const int fluids = static_cast<int>(physics_->fluids.size());
    const ClusterLists& lists = neighbors_->fluid_lists();
    return over_clusters([&](int cluster) {
        const int first = cluster * lanes;
        const Target i = load_target(records_.data(), first, n, fluids);
        const float8 ux = load(&u.x[first]), uy = load(&u.y[first]), uz = load(&u.z[first]);
        const auto sum_with = measured ? sum_pairs<KernelLaw, form, several, true>
                                       : sum_pairs<KernelLaw, form, several, false>;
        Sum sum = sum_with(i, ux, uy, uz, records_.data(), lists.begin(cluster), lists.end(cluster),
                           inverse_h, tiny, along);
        if constexpr (form == ViscousForm::strain)
            if (!no_slip_->empty())
                turn_no_slip<KernelLaw, several>(i, ux, uy, uz, records_.data(), *no_slip_, cluster,
                                                 inverse_h, tiny, along, sum);
        const float8 m = of_mass * load(&mass_[first]), v = to_force * i.volume;
        const float8 x = m * ux + v * sum.x, y = m * uy + v * sum.y, z = m * uz + v * sum.z;
        store(&out.x[first], x), store(&out.y[first], y), store(&out.z[first], z);
        const float8 product = measured ? 0.5f * v * sum.rubbed : ux * x + uy * y + uz * z;
        double dot = 0;
        for (int k = 0; k < std::min(lanes, n - first); ++k) dot += product[k];
        return dot;
    });
}

double ViscousOperator::apply(const Field3& u, Walls walls, double mass_factor, double dt,
                              Field3& out) {
    pack(u, walls);
    return apply(u, mass_factor, dt, out, Returns::product);
}

double ViscousOperator::rub(const Field3& u, double dt, Field3& out) {
    pack(u, Walls::moving);
    return apply(u, 0, dt, out, Returns::dissipation);
}

double ViscousOperator::apply(const Field3& u, double mass_factor, double dt, Field3& out,
                              Returns returns) {
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

void ViscousOperator::diagonal(double dt, std::vector<float>& out) {
    out.resize(mass_.size());
    const int n = neighbors_->fluid_count();
    const double unit = neighbors_->fixed().unit, h = physics_->h / unit;
    const auto inverse_h = static_cast<float>(1 / h), tiny = static_cast<float>(1e-6 * h * h);
    // the mean of (e e^T) over directions e is 1/d
    const bool strain = physics_->viscous_form == ViscousForm::strain;
    const double share = strain ? 1.0 / physics_->dimension : 1;
    const AlongPair along(*physics_, h);
    const auto to_force = static_cast<float>(dt * pair_scale(*physics_) * share);
    const int fluids = static_cast<int>(physics_->fluids.size());
    const ClusterLists& lists = neighbors_->fluid_lists();
    over_clusters([&](int cluster) {
        const int first = cluster * lanes;
        const Target i = load_target(records_.data(), first, n, fluids);
        const float8 w =
            with_kernel(physics_->kernel, physics_->h, physics_->dimension, [&](const auto& law) {
                using Law = std::decay_t<decltype(law)>;
                constexpr auto s = ViscousForm::strain, l = ViscousForm::laplacian;
                const auto sum =
                    strain ? (fluids > 1 ? sum_weights<Law, s, true> : sum_weights<Law, s, false>)
                           : (fluids > 1 ? sum_weights<Law, l, true> : sum_weights<Law, l, false>);
                return sum(i, records_.data(), lists.begin(cluster), lists.end(cluster), inverse_h,
                           tiny, along);
            });
        store(&out[first], load(&mass_[first]) + to_force * i.volume * w);
        return 0.0;
    });
}

}  // namespace undertow::sph
