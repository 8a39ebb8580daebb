#include "sph_solver/losses.hpp"

#include <cmath>
#include <cstdlib>

#include <fmt/format.h>

#include "results/log.hpp"
#include "sph_solver/physics/viscosity_plan.hpp"

namespace undertow::sph {

namespace {

constexpr const char* face_name[6] = {"x_min", "x_max", "y_min", "y_max", "z_min", "z_max"};

void set_flow(Summary& s, const std::string& key, std::int64_t particles, const double velocity[3],
              double mass) {
    s.set(key + "particles", particles);
    s.set(key + "mass_kg", mass * double(particles));
    for (int a = 0; a < 3; ++a) s.set(key + "momentum_" + "xyz"[a] + "_kg_m_s", mass * velocity[a]);
}

}  // namespace

void LossReport::report(double t, const FluidSystem& fluid) {
    for (; seen_ < fluid.removed().size(); ++seen_) {
        const Removed& r = fluid.removed()[seen_];
        if (said_[r.face]) continue;
        said_[r.face] = true;
        log_warning(fmt::format(
            "t = {:.6g} s: particle {} left sph.domain through {} at ({:.4g}, {:.4g}, {:.4g}) m "
            "with "
            "({:.3g}, {:.3g}, {:.3g}) m/s and was removed; what follows it there is counted, see "
            "sph.budget in the summary",
            t, r.id, face_name[r.face], r.x[0], r.x[1], r.x[2], r.v[0], r.v[1], r.v[2]));
    }
    if (fluid.put_back() > 0 && !said_put_back_) {
        said_put_back_ = true;
        log_warning(
            fmt::format("t = {:.6g} s: a particle got behind a wall and was put back; all of "
                        "them are counted, see sph.put_back_behind_walls in the summary",
                        t));
    }
}

void add_budget(const std::vector<std::string>& names, const FluidSystem& fluid, Summary& s) {
    const std::size_t fluids = names.size();
    const Openings& openings = fluid.openings();
    std::vector<std::int64_t> end(fluids, 0), removed(fluids, 0), in(fluids, 0), out(fluids, 0);
    std::vector<double> removed_volume(fluids, 0);
    for (const std::uint8_t k : fluid.particles.fluid) ++end[k];
    const std::vector<std::int64_t> buffered = openings.buffered(fluid.particles);
    for (const Removed& r : fluid.removed())
        ++removed[r.fluid], removed_volume[r.fluid] += r.volume;
    for (std::size_t o = 0; o < openings.size(); ++o)
        for (std::size_t k = 0; k < fluids; ++k) {
            const Passed& passed = openings.passed(o, static_cast<int>(k));
            (openings.is_inflow(o) ? in[k] : out[k]) +=
                openings.is_inflow(o) ? passed.particles : -passed.particles;
        }
    std::int64_t open = 0;
    double mass_start = 0, mass_end = 0, mass_removed = 0, mass_in = 0, mass_out = 0,
           mass_buffered = 0;
    for (std::size_t k = 0; k < fluids; ++k) {
        end[k] -= buffered[k];
        const FluidLaw& law = fluid.fluid(static_cast<int>(k));
        const std::string key = "sph.fluid." + names[k] + ".";
        s.set(key + "particles_start", fluid.filled()[k]);
        s.set(key + "particles_end", end[k]);
        s.set(key + "removed", removed[k]);
        s.set(key + "removed_volume_m3", removed_volume[k]);
        s.set(key + "particle_mass_kg", law.mass);
        s.set(key + "mass_start_kg", law.mass * double(fluid.filled()[k]));
        s.set(key + "sound_speed", law.c0);
        if (law.viscoplastic()) {
            const Creep creep = creep_of(law, static_cast<int>(k), fluid.particles);
            s.set(key + "max_viscosity", law.rheology.max_viscosity);
            s.set(key + "share_at_max_viscosity", creep.share_at_cap);
            s.set(key + "creep_rate_1_s", creep.rate);
            s.set(key + "creep_rate_at_half_yield_1_s", creep.at_yield);
        }
        if (law.viscoplastic()) s.set(key + "max_viscosity", law.rheology.max_viscosity);
        for (int face = 0; face < 6; ++face) {
            const Departed& d = fluid.departed(face, static_cast<int>(k));
            if (d.particles > 0)
                set_flow(s, key + "left." + face_name[face] + ".", d.particles, d.momentum,
                         law.mass);
        }
        for (std::size_t o = 0; o < openings.size(); ++o) {
            const Passed& passed = openings.passed(o, static_cast<int>(k));
            if (passed.particles != 0)
                set_flow(s, key + "into." + openings.name(o) + ".", passed.particles,
                         passed.momentum, law.mass);
        }
        open += std::abs(fluid.filled()[k] + in[k] - out[k] - end[k] - removed[k]);
        mass_start += law.mass * double(fluid.filled()[k]);
        mass_end += law.mass * double(end[k]);
        mass_removed += law.mass * double(removed[k]);
        mass_in += law.mass * double(in[k]);
        mass_out += law.mass * double(out[k]);
        mass_buffered += law.mass * double(buffered[k]);
    }
    s.set("sph.budget.mass_start_kg", mass_start);
    s.set("sph.budget.mass_end_kg", mass_end);
    s.set("sph.budget.mass_removed_kg", mass_removed);
    if (openings.any()) {
        s.set("sph.budget.mass_in_kg", mass_in);
        s.set("sph.budget.mass_out_kg", mass_out);
        s.set("sph.budget.mass_in_buffers_kg", mass_buffered);
    }
    s.set("sph.budget.unaccounted_particles", open);
    s.set("sph.budget.closed", open == 0);
}

void add_model_share(const MirrorPlanes& mirror, Summary& s) {
    double share = 1;
    for (int k = 0; k < mirror.size(); ++k)
        if (mirror.plane(k).symmetry) share *= 0.5;
    if (share < 1) s.set("sph.model_share", share);
}

void add_density_advice(double deviation, double c0, Summary& s) {
    s.set("sph.max_density_deviation", deviation);
    constexpr double much = 0.03, aim = 0.01;
    if (!(deviation > much)) return;
    const double enough = c0 * std::sqrt(deviation / aim);
    s.set("sph.sound_speed_for_1_percent", enough);
    log_warning(fmt::format(
        "the density departed by {:.1f} % from its reference, where 1 % is weakly compressible: "
        "sound_speed = {:.3g} m/s instead of {:.3g} m/s would hold it there, for {:.1f} times the "
        "steps; single particles in an impact may be left out of account",
        100 * deviation, enough, c0, enough / c0));
}

}  // namespace undertow::sph
