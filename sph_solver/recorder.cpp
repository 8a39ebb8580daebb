#include "sph_solver/recorder.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "results/log.hpp"
#include "sph_solver/shapes/vectors.hpp"

namespace undertow::sph {

namespace {

std::vector<std::string> with_time(std::vector<std::string> columns) {
    columns.insert(columns.begin(), "t [s]");
    return columns;
}

std::vector<std::string> names_of(const std::vector<Fluid>& fluids) {
    std::vector<std::string> names;
    for (const Fluid& fluid : fluids) names.push_back(fluid.name);
    return names;
}

/// Iterations of the implicit viscosity, and a warning where they did not get there.
void add_viscosity_figures(const ImplicitViscosity& viscosity, Summary& s) {
    const ImplicitFigures& i = viscosity.figures();
    s.set("sph.viscosity.iterations_mean", i.steps ? double(i.iterations) / double(i.steps) : 0);
    s.set("sph.viscosity.iterations_most", static_cast<std::int64_t>(i.most_iterations));
    s.set("sph.viscosity.steps_not_converged", i.not_converged);
    s.set("sph.viscosity.worst_residual_over_tolerance", i.worst_residual);
    if (i.not_converged == 0) return;
    log_warning(fmt::format(
        "the implicit viscosity did not get to sph.viscosity_tolerance, in {} iterations or as far "
        "as sph.precision goes, in {} of {} steps; at worst {:.3g} times the tolerance was left and "
        "carried into the next step. A lower max_viscosity or a smaller time.max_step makes it "
        "converge, a larger tolerance admits what is left",
        viscosity.most_iterations(), i.not_converged, i.steps, i.worst_residual));
}

}  // namespace

Recorder::Recorder(const Case& input, const std::string& folder, bool alone, FileStart start)
    : folder_(folder),
      alone_(alone),
      row_times_(input.output.history_every, input.time.end),
      gauges_(input, folder, start),
      fields_(folder + "/sph", start),
      names_(names_of(input.sph.fluid)),
      energy_file_(folder + "/energy.sph.csv",
                   {"energies of the fluid", "elastic: sum V p^2/(2 rho0 c0^2); potential: 0 at t = 0"},
                   with_time({"kinetic [J]", "potential [J]", "elastic [J]"}), start) {
    for (const PlaneWall& plane : input.sph.plane) walls_.push_back(plane.name);
    for (const Body& body : input.sph.body) walls_.push_back(body.name);
    if (alone && !walls_.empty()) {
        std::vector<std::string> columns;
        for (const std::string& wall : walls_)
            for (const std::string& name : names_)
                for (const char* part : {"fx [N]", "fy [N]", "fz [N]", "impulse [N s]"})
                    columns.push_back(fmt::format("{}.{}.{}", wall, name, part));
        force_file_ = std::make_unique<History>(
            folder + "/forces.csv",
            std::vector<std::string>{"force of the fluid on each rigid plane and body, unfiltered",
                                     "impulse: integral of the force on a plane along its normal, on "
                                     "a body of its magnitude, trapezoidal over the rows"},
            with_time(columns), start);
        impulse_.assign(walls_.size() * names_.size(), 0);
        last_force_.assign(impulse_.size(), 0);
        largest_force_.assign(walls_.size(), 0);
    }
}

void Recorder::observe(double t, const FluidSystem& fluid) {
    gauges_.observe(t, fluid);
    if (!row_times_.due(t)) return;
    if (force_file_) write_wall_forces(t, fluid);
    write_energies(t, fluid);
    losses_.report(t, fluid);
}

void Recorder::write_wall_forces(double t, const FluidSystem& fluid) {
    const std::vector<Vec3> force = fluid.wall_forces();
    std::vector<double> row{t};
    wall_force_ = 0;
    const std::size_t fluids = names_.size();
    for (std::size_t wall = 0; wall < walls_.size(); ++wall) {
        const bool plane = static_cast<int>(wall) < fluid.mirror().size();
        Vec3 total{};
        for (std::size_t k = wall * fluids; k < (wall + 1) * fluids; ++k) {
            const Vec3& f = force[k];
            const double size = plane ? -dot(f, fluid.mirror().plane(static_cast<int>(wall)).normal)
                                      : length(f);
            if (last_force_t_ >= 0)
                impulse_[k] += 0.5 * (size + last_force_[k]) * (t - last_force_t_);
            last_force_[k] = size;
            row.insert(row.end(), f.begin(), f.end());
            row.push_back(impulse_[k]);
            total = total + f;
        }
        largest_force_[wall] = std::max(largest_force_[wall], length(total));
        wall_force_ = std::max(wall_force_, length(total));
    }
    last_force_t_ = t;
    force_file_->row(row);
}

void Recorder::write_energies(double t, const FluidSystem& fluid) {
    const Particles& p = fluid.particles;
    const Vec3& g = fluid.physics().gravity;   // along a periodic axis there is no potential
    using Sums = EnergySums;
    using ByFluid = std::array<Sums, FluidTag::most>;
    constexpr int block = 4096;   // particles; sums of blocks, in order: the same for any threads
    const int n = static_cast<int>(p.size()), blocks = (n + block - 1) / block;
    std::vector<ByFluid>& part = energy_parts_;
    part.assign(blocks, ByFluid{});
#pragma omp parallel for schedule(static)
    for (int b = 0; b < blocks; ++b)
        for (int i = b * block; i < std::min(n, (b + 1) * block); ++i) {
            Sums& sum = part[b][p.fluid[i]];
            sum.kinetic += p.vx[i] * p.vx[i] + p.vy[i] * p.vy[i] + p.vz[i] * p.vz[i];
            sum.potential -= g[0] * p.x[i] + g[1] * p.y[i] + g[2] * p.z[i];
            sum.elastic += p.p[i] * p.p[i];
        }
    ByFluid of{};
    for (const ByFluid& sums : part)
        for (std::size_t k = 0; k < of.size(); ++k) {
            of[k].kinetic += sums[k].kinetic;
            of[k].potential += sums[k].potential;
            of[k].elastic += sums[k].elastic;
        }
    double row[4] = {t, 0, 0, 0};
    for (std::size_t k = 0; k < fluid.fluids().size(); ++k) {
        const FluidLaw& law = fluid.fluid(static_cast<int>(k));
        const double true_volume = law.mass / law.rho0;   // with the thickness in 2D [m3]
        row[1] += 0.5 * law.mass * of[k].kinetic;
        row[2] += law.mass * of[k].potential;
        row[3] += of[k].elastic * true_volume / (2 * law.rho0 * law.c0 * law.c0);
    }
    energy_file_.row(row);
}

void Recorder::write_fields(double t, const FluidSystem& fluid) {
    const Particles& p = fluid.particles;
    const std::size_t n = p.size();
    std::vector<double> x(3 * n), v(3 * n), density(n);
    for (std::size_t i = 0; i < n; ++i) {
        x[3 * i] = p.x[i], x[3 * i + 1] = p.y[i], x[3 * i + 2] = p.z[i];
        fluid.periodic().wrap(&x[3 * i]);
        v[3 * i] = p.vx[i], v[3 * i + 1] = p.vy[i], v[3 * i + 2] = p.vz[i];
        density[i] = fluid.fluid_of(i).rho0 + p.drho[i];
    }
    std::vector<Field> fields{
        {"velocity", "m/s", 3, v}, {"pressure", "Pa", 1, p.p}, {"density", "kg/m3", 1, density}};
    std::vector<double> index, viscosity, shear_rate;
    if (fluid.fluids().size() > 1) {
        index.assign(p.fluid.begin(), p.fluid.end());
        fields.push_back({"fluid", "", 1, index});
    }
    if (!p.viscosity.empty()) {
        viscosity.assign(p.viscosity.begin(), p.viscosity.begin() + std::ptrdiff_t(n));
        shear_rate.resize(n);   // of a Newtonian fluid it is not known
        for (std::size_t i = 0; i < n; ++i)
            if (fluid.fluid_of(i).viscoplastic()) shear_rate[i] = p.shear_rate[i];
        fields.push_back({"viscosity", "Pa s", 1, viscosity});
        fields.push_back({"shear_rate", "1/s", 1, shear_rate});
    }
    fields_.append(t, x, p.id, fields);
    last_fields_ = t;
}

void Recorder::flush() {
    gauges_.flush();
    if (force_file_) force_file_->flush();
    energy_file_.flush();
}

void Recorder::write_summary(const RunFigures& f, const FluidSystem& fluid, int threads,
                             const std::string& ended) {
    Summary s;
    const double c0 = fluid.largest_sound_speed();
    s.set("ended", ended);
    s.set("wall_s", f.wall);
    s.set("steps", f.steps);
    s.set("dt_min", f.steps ? f.dt_min : 0);
    s.set("dt_mean", f.steps ? f.dt_sum / f.steps : 0);
    s.set("sph.particles", static_cast<std::int64_t>(fluid.particles.size()));
    s.set("sph.removed", static_cast<std::int64_t>(fluid.removed().size()));
    s.set("sph.put_back_behind_walls", fluid.put_back());
    s.set("sph.precision", fluid.physics().precision == Precision::float64 ? "double" : "float");
    s.set("sph.threads", static_cast<std::int64_t>(threads));
    s.set("sph.two_pass_share", f.steps ? double(f.two_pass_steps) / f.steps : 0);
    s.set("sph.particle_steps", f.particle_steps);
    s.set("sph.particle_steps_per_s", f.wall > 0 ? f.particle_steps / f.wall : 0);
    const double computing = f.wall - f.contact_wait - f.output;
    s.set("sph.particle_steps_per_busy_s", computing > 0 ? f.particle_steps / computing : 0);
    s.set("sph.neighbors_mean", fluid.mean_neighbors());
    s.set("sph.list_rebuilds", fluid.rebuilds());
    if (fluid.plates().any()) {
        s.set("sph.thin_plates.facets", static_cast<std::int64_t>(fluid.plates().facets()));
        s.set("sph.thin_plates.pairs_cut", fluid.pairs_cut());
    }
    if (fluid.sizes().variable()) {
        s.set("sph.smoothing.capped", fluid.sizes().capped());
        s.set("sph.smoothing.capped_most", fluid.sizes().most_capped());
        s.set("sph.smoothing.least", fluid.least_smoothing());
    }
    s.set("sph.sound_speed", c0);
    s.set("sph.max_speed", f.max_speed);
    s.set("sph.max_mach", f.max_speed / c0);
    add_density_advice(f.max_compression, c0, s);
    if (fluid.implicit_viscosity()) add_viscosity_figures(*fluid.implicit_viscosity(), s);
    add_budget(names_, fluid, s);
    add_model_share(fluid.mirror(), s);
    for (std::size_t wall = 0; wall < largest_force_.size(); ++wall) {
        double impulse = 0;
        for (std::size_t k = 0; k < names_.size(); ++k) impulse += impulse_[wall * names_.size() + k];
        s.set("sph.wall." + walls_[wall] + ".max_force_N", largest_force_[wall]);
        s.set("sph.wall." + walls_[wall] + ".impulse_N_s", impulse);
    }
    for (const auto& [name, total] : gauges_.totals()) s.set("sph.flux." + name + ".total_m3", total);
    if (fluid.bodies.count() > 0) s.set("sph.dummies", static_cast<std::int64_t>(fluid.bodies.size()));
    s.set("sph.wall_split_s.neighbors", f.neighbors);
    s.set("sph.wall_split_s.pack", f.pack);
    s.set("sph.wall_split_s.sums", f.sums);
    if (fluid.implicit_viscosity()) s.set("sph.wall_split_s.viscosity", f.viscosity);
    s.set("sph.wall_split_s.waiting", f.contact_wait);
    s.set("sph.wall_split_s.move", f.move);
    s.set("sph.wall_split_s.output", f.output);
    s.set("wait_s", f.contact_wait);
    f.checkpoints.add_to(s);
    s.write(folder_ + "/summary.sph.json");
}

}  // namespace undertow::sph
