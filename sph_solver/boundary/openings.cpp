#include "sph_solver/boundary/openings.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "sph_solver/kernels/kernels.hpp"
#include "wire/errors.hpp"

namespace undertow::sph {

namespace {

// sigma of tau = L/(sigma c): between the drift of a small one and the reflections of a large one.
// [Rudy & Strikwerda 1980: 0.27 is best; Poinsot & Lele 1992: 0.25]
constexpr double sigma = 0.25;
// Less of the kernel than this before the plane, and there is no fluid to go by: of one half.
constexpr double dry = 0.05;

int axis_of(const Vec3& normal) {
    for (int a = 0; a < 3; ++a)
        if (normal[a] != 0) return a;
    return 0;
}

/// Length of the scene along an axis, fills and openings.   [m]
double length_along(const SphSettings& sph, int axis) {
    double low = 1e300, high = -1e300;
    const auto reach = [&](const Box& box) {
        low = std::min(low, box.min[axis]), high = std::max(high, box.max[axis]);
    };
    for (const Fill& f : sph.fill) reach(f.box);
    for (const Inflow& f : sph.inflow) reach(f.box);
    for (const Outflow& f : sph.outflow) reach(f.box);
    return std::max(high - low, 2 * sph.smoothing_ratio * sph.spacing);
}

}  // namespace

Openings::Openings(const Case& input, const PairPhysics& physics)
    : flat_(input.info.dimension == 2),
      spacing_(input.sph.spacing),
      depth_(spacing_ * std::ceil(2 * physics.h / spacing_ * (1 - 1e-9))),
      gravity_(physics.gravity) {
    const SphSettings& sph = input.sph;
    double c0 = 0;
    for (const FluidLaw& f : physics.fluids) c0 = std::max(c0, f.c0);
    const auto add = [&](const std::string& name, bool inflow, const Vec3& normal,
                         const Box& box) -> Opening& {
        Opening& o = openings_.emplace_back();
        o.name = name, o.inflow = inflow, o.box = box;
        o.axis = axis_of(normal), o.sign = normal[o.axis] > 0 ? 1 : -1;
        o.face = box.min[o.axis];
        o.passed.resize(physics.fluids.size());
        o.relaxation = length_along(sph, o.axis) / (sigma * c0);
        return o;
    };
    for (const Inflow& f : sph.inflow) {
        Opening& o = add(f.name, true, f.normal, f.box);
        o.speed = f.velocity, o.level = f.level;
        while (sph.fluid[o.fluid].name != f.fluid) ++o.fluid;
    }
    for (const Outflow& f : sph.outflow) {
        Opening& o = add(f.name, false, f.normal, f.box);
        o.pressure = f.pressure, o.level = f.level;
    }
}

double Openings::depth(const Opening& o, const Particles& p, std::size_t i) const {
    const double at = o.axis == 0 ? p.x[i] : o.axis == 1 ? p.y[i] : p.z[i];
    return o.sign * (o.face - at);
}

bool Openings::before(const Opening& o, const Particles& p, std::size_t i) const {
    const double at[3] = {p.x[i], p.y[i], p.z[i]};
    for (int a = 0; a < 3; ++a)
        if (a != o.axis && !(flat_ && a == 1) && (at[a] < o.box.min[a] || at[a] > o.box.max[a]))
            return false;
    return true;
}

void Openings::fill(const MirrorPlanes& mirror, const std::optional<Box>& domain,
                    Particles& particles) {
    Particles& p = particles;
    const auto put = [&](int k, const Vec3& x, const Vec3& v, int fluid, double drho) {
        const Opening& o = openings_[k];
        for (int w = 0; w < mirror.size(); ++w)
            if (mirror.distance(w, x[0], x[1], x[2]) < 0)
                throw InputError(fmt::format(
                    "sph.{} \"{}\": the fluid outside of the opening would stand behind sph.plane "
                    "\"{}\": a mirror plane has no openings; remove it, and build what is left of "
                    "that wall from [[sph.body]] boxes.",
                    o.inflow ? "inflow" : "outflow", o.name, mirror.plane(w).name));
        for (int a = 0; domain && a < 3; ++a)
            if (!(flat_ && a == 1) && (x[a] < domain->min[a] || x[a] > domain->max[a]))
                throw InputError(
                    fmt::format("sph.{} \"{}\": outside of the opening stand {:.4g} m of fluid, "
                                "which reach out "
                                "of sph.domain in {}: enlarge sph.domain.",
                                o.inflow ? "inflow" : "outflow", o.name, depth_, "xyz"[a]));
        const std::size_t i = p.size();
        p.resize(i + 1);
        p.x[i] = x[0], p.y[i] = x[1], p.z[i] = x[2];
        p.vx[i] = v[0], p.vy[i] = v[1], p.vz[i] = v[2];
        p.drho[i] = drho;
        p.fluid[i] = static_cast<std::uint8_t>(fluid);
        p.id[i] = static_cast<std::int64_t>(i);
        const double outward = -o.sign * v[o.axis];
        members_.push_back(
            {p.id[i], k, static_cast<int>(i), outward, 0, 0, outward, {v[0], v[1], v[2]}});
        role_.resize(p.size());
        role_[i] = static_cast<std::uint8_t>(k + 1);
    };
    role_.assign(p.size(), 0);
    const std::size_t filled = p.size();
    const int layers = static_cast<int>(std::lround(depth_ / spacing_));
    for (int k = 0; k < static_cast<int>(openings_.size()); ++k) {
        const Opening& o = openings_[k];
        if (!o.inflow) {
            for (std::size_t i = 0; i < filled; ++i) {
                const double s = depth(o, p, i);
                if (s > 0 || s < -depth_ || !before(o, p, i)) continue;
                Vec3 x{p.x[i], p.y[i], p.z[i]};
                x[o.axis] = 2 * o.face - x[o.axis];
                put(k, x, {p.vx[i], p.vy[i], p.vz[i]}, p.fluid[i], p.drho[i]);
            }
            continue;
        }
        int n[3];
        for (int a = 0; a < 3; ++a) {
            const double cells = (o.box.max[a] - o.box.min[a]) / spacing_;
            n[a] = a == o.axis ? layers : static_cast<int>(std::lround(cells));
            if (flat_ && a == 1) n[a] = 1;
            if (a == o.axis || (flat_ && a == 1)) continue;
            if (n[a] < 1 || std::abs(cells - n[a]) > 0.01)
                throw InputError(fmt::format(
                    "sph.inflow \"{}\": its box is {:.6g} m along {}, {:.3f} spacings of {:.6g} m; "
                    "it must be a whole number: {:.6g} or {:.6g} m.",
                    o.name, o.box.max[a] - o.box.min[a], "xyz"[a], cells, spacing_,
                    std::floor(cells) * spacing_, std::ceil(cells) * spacing_));
        }
        for (int ix = 0; ix < n[0]; ++ix)
            for (int iy = 0; iy < n[1]; ++iy)
                for (int iz = 0; iz < n[2]; ++iz) {
                    const int cell[3] = {ix, iy, iz};
                    Vec3 x;
                    for (int a = 0; a < 3; ++a) {
                        const double along = (cell[a] + 0.5) * spacing_;
                        x[a] = a == o.axis ? o.face - o.sign * along : o.box.min[a] + along;
                    }
                    if (flat_) x[1] = 0;
                    if (o.level && x[2] > *o.level) continue;
                    Vec3 v{};
                    v[o.axis] = o.sign * (*o.speed)(x[0], x[1], x[2], 0);
                    put(k, x, v, o.fluid, 0);
                }
    }
}

void Openings::count(Opening& o, const Particles& p, std::size_t i, int direction) {
    Passed& passed = o.passed[p.fluid[i]];
    passed.particles += direction;
    passed.momentum[0] += direction * p.vx[i];
    passed.momentum[1] += direction * p.vy[i];
    passed.momentum[2] += direction * p.vz[i];
}

void Openings::exchange(Particles& particles, std::vector<int>& index) {
    if (!any()) return;
    Particles& p = particles;
    copies_.clear();
    std::size_t kept = 0;
    for (std::size_t m = 0; m < members_.size(); ++m) {
        Member member = members_[m];
        const int i = index[member.id];
        if (i < 0) continue;  // left the domain
        Opening& o = openings_[member.opening];
        const double s = depth(o, p, i);
        if (s > depth_ && !o.inflow) {
            role_[i] = left;
            index[member.id] = -1;
            continue;
        }
        if (s < 0) {  // in: fluid from now on, and a copy takes its part
            role_[i] = 0;
            count(o, p, i, +1);
            copies_.push_back({i, o.axis, -o.sign * depth_, kept});
        }
        members_[kept++] = member;
    }
    members_.resize(kept);
    const std::size_t standing = kept;
    for (std::size_t i = 0; i < p.size(); ++i) {
        if (role_[i] != 0) continue;
        for (std::size_t k = 0; k < openings_.size(); ++k) {
            Opening& o = openings_[k];
            const double s = depth(o, p, i);
            if (!(s > 0 && s < depth_) || !before(o, p, i)) continue;
            if (o.inflow) {  // not against the stream
                double& x = o.axis == 0 ? p.x[i] : o.axis == 1 ? p.y[i] : p.z[i];
                double& v = o.axis == 0 ? p.vx[i] : o.axis == 1 ? p.vy[i] : p.vz[i];
                x += 2 * o.sign * s;
                if (v * o.sign < 0) v = -v;
                ++put_back_;
                continue;
            }
            const double v = o.axis == 0 ? p.vx[i] : o.axis == 1 ? p.vy[i] : p.vz[i];
            members_.push_back({p.id[i],
                                static_cast<int>(k),
                                static_cast<int>(i),
                                -o.sign * v,
                                p.p[i],
                                p.p[i],
                                -o.sign * v,
                                {p.vx[i], p.vy[i], p.vz[i]}});
            inherit_reference(p, standing, members_.back());
            role_[i] = static_cast<std::uint8_t>(k + 1);
            count(o, p, i, -1);
            break;
        }
    }
    append_copies(particles, index);
}

/// A particle that goes out takes the slow reference over from who stands in the buffer beside its
/// way; its own state is that of the wave that carries it out, and would send the wave back.
void Openings::inherit_reference(const Particles& p, std::size_t standing, Member& m) const {
    const int axis = openings_[m.opening].axis;
    double closest = 1.5 * spacing_ * 1.5 * spacing_;
    for (std::size_t k = 0; k < standing; ++k) {
        const Member& other = members_[k];
        if (other.opening != m.opening) continue;
        const double d[3] = {p.x[other.index] - p.x[m.index], p.y[other.index] - p.y[m.index],
                             p.z[other.index] - p.z[m.index]};
        const double apart = d[0] * d[0] + d[1] * d[1] + d[2] * d[2] - d[axis] * d[axis];
        if (apart >= closest) continue;
        closest = apart;
        m.u_ref = other.u_ref, m.p_ref = other.p_ref;
    }
}

/// All at once: the arrays grow by doubling, a few times in a run.
void Openings::append_copies(Particles& particles, std::vector<int>& index) {
    Particles& p = particles;
    std::size_t i = p.size();
    p.resize(i + copies_.size());
    for (const Copy& copy : copies_) {
        Member& member = members_[copy.member];
        p.copy(copy.source, i);
        for (auto* a : {&p.fx, &p.fy, &p.fz}) (*a)[i] = 0;
        (copy.axis == 0 ? p.x : copy.axis == 1 ? p.y : p.z)[i] += copy.shift;
        p.id[i] = static_cast<std::int64_t>(index.size());
        index.push_back(static_cast<int>(i));
        role_.push_back(static_cast<std::uint8_t>(member.opening + 1));
        member.id = p.id[i];
        ++i;
    }
}

void Openings::locate(const Particles& particles, const std::vector<int>& index,
                      const Neighborhood& neighbors) {
    if (!any()) return;
    role_.assign(particles.size(), 0);
    for (Member& m : members_) {
        m.index = index[m.id];
        if (m.index >= 0) role_[m.index] = static_cast<std::uint8_t>(m.opening + 1);
    }
    std::erase_if(members_, [](const Member& m) { return m.index < 0; });
    const FixedPoint& fixed = neighbors.fixed();
    const std::vector<Packed>& records = neighbors.records();
    const std::vector<Extra>& extras = neighbors.extras();
    const int fluid_count = neighbors.fluid_count();
    // both may move by half the skin until the next time
    const double range = neighbors.support() + neighbors.skin();
    near_.clear();
    near_begin_.assign(1, 0);
    for (const Member& m : members_) {
        const Opening& o = openings_[m.opening];
        double at[3] = {particles.x[m.index], particles.y[m.index], particles.z[m.index]};
        at[o.axis] = o.face;
        neighbors.for_each_near(at[0], at[1], at[2], neighbors.support(), [&](int j) {
            int source = j;
            if (j >= fluid_count) {
                const Extra& e = extras[j - fluid_count];
                if (e.from_body) return;
                source = e.source;
            }
            if (role_[source] != 0) return;
            const Packed& q = records[j];
            const double dx = fixed.x0 + q.x * fixed.unit - at[0],
                         dy = fixed.y0 + q.y * fixed.unit - at[1],
                         dz = fixed.z0 + q.z * fixed.unit - at[2];
            if (dx * dx + dy * dy + dz * dz < range * range) near_.push_back(j);
        });
        near_begin_.push_back(near_.size());
    }
}

/// Mean pressure, continued hydrostatically to the point `at`, and mean velocity of the fluid
/// there. False if there is none: then the particle flies on.
bool Openings::look_inside(const PairPhysics& physics, const Neighborhood& neighbors,
                           const Opening& o, const double at[3], std::size_t first,
                           std::size_t last, const Particles& p, Member& m) const {
    const FixedPoint& fixed = neighbors.fixed();
    const bool mixed = physics.mixed();
    double weight = 0, pressure = 0, v[3] = {0, 0, 0};
    const auto from = [&](const auto& q) -> Vec3 {
        if constexpr (std::is_same_v<std::decay_t<decltype(q)>, ExactRecord>)
            return {at[0] - q.x, at[1] - q.y, at[2] - q.z};
        else
            return {at[0] - fixed.x0 - q.x * fixed.unit, at[1] - fixed.y0 - q.y * fixed.unit,
                    at[2] - fixed.z0 - q.z * fixed.unit};
    };
    const auto look_with = [&](const auto& kernel, const auto& records) {
        for (std::size_t k = first; k < last; ++k) {
            const auto& q = records[near_[k]];
            const Vec3 d = from(q);
            const double w =
                q.volume * kernel.value(std::sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]));
            const double rho0 = physics.fluids[mixed ? FluidTag::of(q) : 0].rho0;
            weight += w;
            pressure +=
                w * (q.p + rho0 * (gravity_[0] * d[0] + gravity_[1] * d[1] + gravity_[2] * d[2]));
            v[0] += w * q.vx, v[1] += w * q.vy, v[2] += w * q.vz;
        }
    };
    with_kernel(physics.kernel, physics.h, physics.dimension, [&](const auto& kernel) {
        if (neighbors.exact().used)
            look_with(kernel, neighbors.exact().records);
        else
            look_with(kernel, neighbors.records());
    });
    const int i = m.index;
    if (weight < dry) {
        m.p_inside = 0;
        m.next[0] = p.vx[i], m.next[1] = p.vy[i], m.next[2] = p.vz[i];
        m.u_inside = m.u_ref = -o.sign * m.next[o.axis];
        return false;
    }
    m.p_inside = pressure / weight;
    for (int a = 0; a < 3; ++a) m.next[a] = v[a] / weight;
    m.u_inside = -o.sign * m.next[o.axis];
    return true;
}

void Openings::extrapolate(const PairPhysics& physics, FluidTag tag, Neighborhood& neighbors,
                           Particles& particles) {
    Particles& p = particles;
    const int n = static_cast<int>(members_.size());
#pragma omp parallel for schedule(static)
    for (int k = 0; k < n; ++k) {
        Member& m = members_[k];
        const Opening& o = openings_[m.opening];
        const int i = m.index;
        const FluidLaw& fluid = physics.fluids[p.fluid[i]];
        double at[3] = {p.x[i], p.y[i], p.z[i]};
        const double outside = o.sign * (o.face - at[o.axis]);
        at[o.axis] = o.face;
        const bool wet =
            look_inside(physics, neighbors, o, at, near_begin_[k], near_begin_[k + 1], p, m);
        double pressure = m.p_inside;
        if (!o.inflow && wet) {
            double held = m.p_ref;
            if (o.level) held = std::max(0.0, -fluid.rho0 * gravity_[2] * (*o.level - at[2]));
            if (o.pressure) {
                held = *o.pressure;
                for (int a = 0; a < 3; ++a)
                    held +=
                        fluid.rho0 * gravity_[a] * (at[a] - 0.5 * (o.box.min[a] + o.box.max[a]));
            }
            m.p_ref = held;
            const double impedance = fluid.rho0 * fluid.c0;
            const double u = 0.5 * (m.u_inside + m.u_ref) + 0.5 * (m.p_inside - held) / impedance;
            pressure = 0.5 * (m.p_inside + held) + 0.5 * impedance * (m.u_inside - m.u_ref);
            m.next[o.axis] = -o.sign * u;
        }
        if (wet) pressure -= fluid.rho0 * gravity_[o.axis] * o.sign * outside;
        p.drho[i] = fluid.deviation_at(pressure);
        p.p[i] = fluid.pressure(p.drho[i], p.energy[i]);
        Packed& q = neighbors.records()[i];
        const double volume = fluid.rho0 * fluid.volume / (fluid.rho0 + p.drho[i]);
        q.p = static_cast<float>(p.p[i]);
        q.volume = tag(volume, p.fluid[i]);
        if (!neighbors.exact().used) continue;
        ExactRecord& exact = neighbors.exact().records[i];
        exact.p = p.p[i], exact.volume = tag.exact(volume, p.fluid[i]);
    }
}

void Openings::prescribe(double t, double dt, double kick, const Vec3& gravity,
                         Particles& particles) {
    if (!(kick > 0)) return;
    Particles& p = particles;
    for (Member& m : members_) {
        const Opening& o = openings_[m.opening];
        const int i = m.index;
        if (o.inflow) {
            const double speed = (*o.speed)(p.x[i], p.y[i], p.z[i], t + 0.5 * dt);
            if (speed < 0)
                throw InputError(fmt::format(
                    "sph.inflow \"{}\": at t = {:.4g} s velocity = {:.4g} m/s at ({:.4g}, {:.4g}, "
                    "{:.4g}): it must be >= 0, into the fluid; fluid leaves through an "
                    "[[sph.outflow]].",
                    o.name, t, speed, p.x[i], p.y[i], p.z[i]));
            for (double& v : m.next) v = 0;
            m.next[o.axis] = o.sign * speed;
        } else {
            const double share = dt / o.relaxation;
            m.u_ref += share * (m.u_inside - m.u_ref);
            m.p_ref += share * (m.p_inside - m.p_ref);  // given anew where the case gives it
        }
        Summed* const a[3] = {&p.ax, &p.ay, &p.az};
        const double v[3] = {p.vx[i], p.vy[i], p.vz[i]}, f[3] = {p.fx[i], p.fy[i], p.fz[i]};
        for (int c = 0; c < 3; ++c) a[c]->set(i, (m.next[c] - v[c]) / kick - f[c] - gravity[c]);
    }
}

std::vector<std::int64_t> Openings::buffered(const Particles& particles) const {
    std::vector<std::int64_t> n(FluidTag::most, 0);
    for (const Member& m : members_) ++n[particles.fluid[m.index]];
    return n;
}

}  // namespace undertow::sph
