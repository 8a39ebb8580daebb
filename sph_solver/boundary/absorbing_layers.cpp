#include "sph_solver/boundary/absorbing_layers.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "wire/errors.hpp"

namespace undertow::sph {

namespace {

// A of surface waves, A of sound over that, and tau in passages of sound through the layer:
// docs/theory.md has the reflections measured.
constexpr double default_strength = 3, of_sound = 5.0 / 3, passages = 1;

/// What is left of `value` after dt of d(value)/dt = -gamma (value - s), ds/dt = (value - s)/tau,
/// implicit, whatever gamma and tau are.
double damp_what_is_quick(double value, double& s, double gamma, double tau, double dt) {
    const double away = (value - s) / (1 + (gamma + 1 / tau) * dt);
    s += dt / tau * away;
    return s + away;
}

/// sqrt(g H) of the fills' height.   [m/s]
double shallow_water_speed(const Case& input, const Vec3& gravity) {
    double low = 1e300, high = -1e300;
    for (const Fill& f : input.sph.fill) {
        low = std::min(low, f.box.min[2]);
        high = std::max(high, f.surface_level.value_or(f.box.max[2]));
    }
    return std::sqrt(std::hypot(gravity[0], gravity[1], gravity[2]) * std::max(0.0, high - low));
}

}  // namespace

AbsorbingLayers::AbsorbingLayers(const Case& input, const PairPhysics& physics)
    : flat_(input.info.dimension == 2) {
    double c0 = 0;
    for (const FluidLaw& f : physics.fluids) c0 = std::max(c0, f.c0);
    for (const AbsorbingLayer& l : input.sph.absorbing) {
        Layer layer;
        layer.box = l.box, layer.target = l.velocity;
        layer.axis = l.direction[0] != 0 ? 0 : l.direction[1] != 0 ? 1 : 2;
        const bool up = l.direction[layer.axis] > 0;
        const double length = l.box.max[layer.axis] - l.box.min[layer.axis];
        if (length < 2 * physics.h)
            throw InputError(fmt::format(
                "{}: sph.absorbing \"{}\": its box is {:.4g} m long along its direction; it must "
                "be "
                "at least the support of the kernel, {:.4g} m, and a wavelength to be of use.",
                input.file, l.name, length, 2 * physics.h));
        layer.begin = up ? l.box.min[layer.axis] : l.box.max[layer.axis];
        layer.per_length = (up ? 1 : -1) / length;
        const double strength = l.strength > 0 ? l.strength : default_strength;
        const double c_wave =
            l.wave_speed > 0 ? l.wave_speed : shallow_water_speed(input, physics.gravity);
        layer.waves = 3 * strength * c_wave / length;
        layer.sound = 3 * of_sound * strength * c0 / length;
        layer.follow = passages * length / c0;
        layers_.push_back(layer);
    }
}

void AbsorbingLayers::locate(const Particles& p) {
    if (!any()) return;
    members_.clear();
    for (std::size_t i = 0; i < p.size(); ++i) {
        const std::size_t id = static_cast<std::size_t>(p.id[i]);
        if (id >= slow_.size()) slow_.resize(id + 1), inside_.resize(id + 1, 0);
        const double at[3] = {p.x[i], p.y[i], p.z[i]};
        bool member = false;
        for (std::size_t k = 0; k < layers_.size() && !member; ++k) {
            member = true;
            for (int a = 0; a < 3; ++a)
                if (!(flat_ && a == 1) &&
                    (at[a] < layers_[k].box.min[a] || at[a] > layers_[k].box.max[a]))
                    member = false;
            if (member) members_.push_back({static_cast<int>(i), static_cast<int>(k)});
        }
        if (member && !inside_[id]) slow_[id] = {p.drho[i], {p.vx[i], p.vy[i], p.vz[i]}};
        inside_[id] = member;
    }
}

void AbsorbingLayers::damp(double dt, double kick, const Vec3& gravity, Particles& particles) {
    Particles& p = particles;
    const int n = static_cast<int>(members_.size());
#pragma omp parallel for schedule(static)
    for (int m = 0; m < n; ++m) {
        const Layer& l = layers_[members_[m].layer];
        const int i = members_[m].particle;
        const double at[3] = {p.x[i], p.y[i], p.z[i]};
        const double xi = std::clamp((at[l.axis] - l.begin) * l.per_length, 0.0, 1.0);
        const double ramp = xi * xi;
        Slow& s = slow_[p.id[i]];
        // v+ = (v + a kick + gamma kick v_target)/(1 + gamma kick): implicit, whatever gamma is
        const double share = 1 / (1 + l.waves * ramp * kick);
        Summed* const a[3] = {&p.ax, &p.ay, &p.az};
        const double v[3] = {p.vx[i], p.vy[i], p.vz[i]}, f[3] = {p.fx[i], p.fy[i], p.fz[i]};
        for (int c = 0; kick > 0 && c < 3; ++c) {
            const double free = v[c] + kick * ((*a[c])[i] + f[c] + gravity[c]);
            const double damped = l.target[c] + share * (free - l.target[c]);
            const double next = damp_what_is_quick(damped, s.v[c], l.sound * ramp, l.follow, kick);
            a[c]->set(i, (*a[c])[i] + (next - free) / kick);
        }
        p.drho[i] = damp_what_is_quick(p.drho[i], s.drho, l.sound * ramp, l.follow, dt);
    }
}

}  // namespace undertow::sph
