#include "sph_solver/solver.hpp"

#include <omp.h>

#include <memory>

#include <fmt/format.h>

#include "checkpoint/checkpoint_set.hpp"
#include "results/log.hpp"
#include "results/progress.hpp"
#include "results/wall_clock.hpp"
#include "sph_solver/checkpoint.hpp"
#include "sph_solver/coupling.hpp"
#include "sph_solver/fluid_system.hpp"
#include "sph_solver/physics/stable_step.hpp"
#include "sph_solver/recorder.hpp"
#include "sph_solver/setup/doubts.hpp"
#include "wire/failure.hpp"

namespace undertow::sph {

namespace {

/// Adds the time since the last lap to a figure.
class Stopwatch {
 public:
    void lap(double& figure) {
        const double t = wall_clock();
        figure += t - last_;
        last_ = t;
    }

 private:
    double last_ = wall_clock();
};

/// Two passes allow 2.7 times the step of one for 1.6 times its cost: best where the fluid limits the
/// step. Where a structure wants steps below half of what one pass bears, one pass does. Decided anew
/// each step from the last agreed dt; the first step takes two.
bool takes_two_passes(Integrator integrator, double last_dt, double one_pass_dt) {
    if (integrator != Integrator::automatic) return integrator == Integrator::two_pass;
    return last_dt == 0 || last_dt > 0.5 * one_pass_dt;
}

void check(const Health& health, double t, const FluidSystem& fluid) {
    if (health.finite) return;
    // its position is not finite either: the record still shows where it was before the step
    const int i = health.worst;
    const FixedPoint& fixed = fluid.neighbors().fixed();
    const Packed& before = fluid.neighbors().records()[i];
    throw PhysicsError(fmt::format(
        "Particle {} near ({:.4g}, {:.4g}, {:.4g}) m got a velocity or density that is not finite in "
        "the step to t = {:.6g} s. The fields written before are whole: look at the last one. Usual "
        "causes: a sound_speed far below ten times the fastest speed (here {:.3g} m/s), a body or plane "
        "that squeezes fluid with no way out, sph.cfl above its default.",
        fluid.particles.id[i], fixed.x0 + before.x * fixed.unit, fixed.y0 + before.y * fixed.unit,
        fixed.z0 + before.z * fixed.unit, t, fluid.largest_sound_speed()));
}

/// The coupler would refuse such an offer as well; only here is it known which particle makes it.
void check_floor(const StableStep& stable, double t, double min_step, const FluidSystem& fluid,
                 double c0, double last_fields) {
    if (stable.dt >= min_step) return;
    const std::string limiter = stable.limiter;
    std::string who = limiter == "viscosity" ? "the viscosity of a fluid" : "all particles alike";
    if (const int i = fluid.limiting_particle(limiter); i >= 0) {
        const Particles& p = fluid.particles;
        who = fmt::format("particle {} of {} at ({:.5g}, {:.5g}, {:.5g}) m with a speed of {:.4g} m/s",
                          p.id[i], p.size(), p.x[i], p.y[i], p.z[i],
                          std::hypot(p.vx[i], p.vy[i], p.vz[i]));
    }
    throw StepCollapse(fmt::format(
        "At t = {:.6g} s the stable step fell to {:.4g} s, below time.min_step = {:.4g} s; it is "
        "limited by {} ({}), c0 = {:.4g} m/s. {} {}",
        t, stable.dt, min_step, limiter, who, c0,
        last_fields < 0 ? std::string("No fields were written before.")
                        : fmt::format("The last good fields are those of t = {:.6g} s: look at that "
                                      "place there.",
                                      last_fields),
        limiter == "viscosity"
            ? "A lower max_viscosity of that fluid, or a coarser sph.spacing, allows a longer step."
        : t == 0 && limiter == "sound"
            ? "That is the step of fluid at rest, nothing has gone wrong: lower time.min_step to a "
              "tenth of it, or leave it out."
            : "If the state is sound there, lower time.min_step; if it is not, something is squeezed "
              "or thrown: look for fluid between closing walls and for a sound_speed that is too "
              "small. A finer sph.spacing shortens the step further."));
}

}  // namespace

int run(const Case& input, const SolverOptions& options) {
    const bool alone = options.endpoint.empty();
    if (options.threads > 0) omp_set_num_threads(options.threads);
    const int threads = omp_get_max_threads();

    const Integrator integrator = input.sph.integrator;
    const Begin begin = options.resume.empty() ? Begin::anew : Begin::resumed;
    FluidSystem fluid(input, alone && integrator != Integrator::one_pass ? 0.4 : 0.2, begin);
    const std::vector<std::string> doubts = doubts_at_start(input, fluid);
    const double one_pass_cfl = default_cfl(Integrator::one_pass, input.sph.smoothing_ratio);
    const double cfl = acoustic_cfl(input.sph);
    const double c0 = fluid.largest_sound_speed();
    std::unique_ptr<Link> link =
        alone ? make_lonely_link(input, options.folder)
              : make_coupled_link(input, options.endpoint, options.keys);
    Recorder recorder(input, options.folder, alone,
                      options.resume.empty() ? FileStart::fresh : FileStart::continued);
    ProgressLine progress(options.quiet || !alone, alone ? options.folder + "/status.json" : "");
    log_info(fmt::format("{} particles, spacing {:.4g} m, c0 = {:.4g} m/s, {} threads",
                         fluid.particles.size(), fluid.spacing(), c0, threads));
    for (const std::string& doubt : doubts) log_warning(doubt);
    for (std::size_t k = 0; k < fluid.fluids().size(); ++k)
        if (fluid.sizes().used())
            log_info(fmt::format("fluid \"{}\": spacing {:.4g} m, smoothing length {:.4g} m{}",
                                 input.sph.fluid[k].name, fluid.fluids()[k].spacing,
                                 fluid.fluids()[k].h,
                                 fluid.sizes().variable() ? ", follows from density" : ""));
    for (std::size_t k = 0; k < fluid.fluids().size(); ++k)
        if (fluid.fluids()[k].viscoplastic())
            log_info(fmt::format("fluid \"{}\": viscosity at most {:.4g} Pa s{}",
                                 input.sph.fluid[k].name, fluid.fluids()[k].rheology.max_viscosity,
                                 input.sph.fluid[k].max_viscosity > 0 ? ""
                                 : fluid.implicit_viscosity()
                                     ? ", a thousandth of the flow's shear rate at yield"
                                     : ", the largest that does not shorten the step"));

    if (fluid.implicit_viscosity())
        log_info(fmt::format("viscous forces: implicit, velocities to {:.2g} of their change in a step",
                             input.sph.viscosity_tolerance));
    if (input.sph.lattice == FillLattice::relaxed && begin == Begin::anew)
        log_info(fmt::format("relaxed start: {} iterations, unevenness {:.3g} -> {:.3g}",
                             fluid.relaxation().iterations, fluid.relaxation().before,
                             fluid.relaxation().after));
    for (const RigidBody& b : fluid.bodies.body)
        log_info(fmt::format(
            "body \"{}\": {:.4g} x {:.4g} x {:.4g} m{}, {} dummies", b.body().name,
            b.bounds().max[0] - b.bounds().min[0], b.bounds().max[1] - b.bounds().min[1],
            b.bounds().max[2] - b.bounds().min[2],
            b.surface() ? fmt::format(", {} facets", b.surface()->facets()) : "",
            fluid.bodies.dummies_of(static_cast<int>(&b - fluid.bodies.body.data()))));

    if (fluid.start().end() > 0)
        log_info(fmt::format("start: damped at {:.4g} 1/s until {:.4g} s, all let go at {:.4g} s",
                             fluid.start().damping(), input.start.settle, fluid.start().end()));

    RunFigures figures;
    double start = wall_clock();
    LoopState loop;
    std::int64_t& n = loop.n;
    double &t = loop.t, &dt = loop.dt, &dt_before = loop.dt_before;
    bool& two_pass = loop.two_pass;
    Health health = fluid.health();
    bool fields_due = true, density_due = false;
    StepOrder order;
    const auto figures_now = [&] {
        ProgressFigures p;
        p.t = t, p.t_end = input.time.end, p.n = figures.steps, p.dt = dt;
        p.limiter = order.limiter;
        p.particle_steps = figures.particle_steps;
        p.force = recorder.wall_force();
        return p;
    };
    const auto finish = [&](const std::string& ended) {
        figures.wall = wall_clock() - start;
        recorder.flush();
        recorder.write_summary(figures, fluid, threads, ended);
    };

    Checkpoints checkpoints(input, options.folder, loop, fluid, *link, recorder, figures);
    bool summed = false;   // the forces of the step are there: those of the checkpoint
    const auto offer = [&] {
        link->offer({n, t, loop.dt_limit, loop.limiter, figures.particle_steps}, fluid);
    };

    try {
        if (!options.resume.empty()) {
            checkpoints.resume(options.resume);
            start -= figures.wall;
            progress.kept("checkpoints/" + checkpoint_id(n), t, written_at(options.resume));
            summed = true;
        }
        for (;; ++n) {
            Stopwatch watch;
            if (summed) {
                offer();
            } else {
                const StableStep stable =
                    stable_step({fluid.least_smoothing(), fluid.limiting_sound_speed(), health.max_speed, health.max_acceleration,
                                 health.max_kinematic_viscosity},
                                cfl, input.sph.force_cfl);
                check_floor(stable, t, input.time.min_step, fluid, c0, recorder.last_fields());
                loop.dt_limit = stable.dt;
                loop.limiter.assign("sph: ").append(stable.limiter);
                offer();
                watch.lap(figures.contact_wait);

                fluid.refresh_neighbors(t);
                watch.lap(figures.neighbors);
                fluid.pack(t);
                watch.lap(figures.pack);
                if (density_due) {   // the step just taken left it to a pass of its own
                    fluid.sum_over_neighbors(Terms::rate);
                    fluid.advance_density(dt);
                    watch.lap(figures.sums);
                    fluid.pack(t);
                    watch.lap(figures.pack);
                }
                const double one_pass_dt =
                    one_pass_cfl * fluid.least_smoothing() /
                    (fluid.limiting_sound_speed() + health.max_speed);
                two_pass = takes_two_passes(integrator, dt, one_pass_dt);
                fluid.sum_over_neighbors(two_pass ? Terms::force : Terms::both);
                fluid.add_wall_friction();
                watch.lap(figures.sums);

                recorder.observe(t, fluid);
                if (fields_due) recorder.write_fields(t, fluid);
                watch.lap(figures.output);
            }
            summed = false;

            order = link->wait(fluid);
            while (!order.checkpoint.empty()) {
                ProgressFigures p = figures_now();
                p.doing = "writing " + order.checkpoint;
                progress.update_now(p);
                link->confirm(checkpoints.write(order.checkpoint, wall_clock() - start));
                progress.kept("checkpoints/" + order.checkpoint, t);
                order = link->wait(fluid);
            }
            watch.lap(figures.contact_wait);
            if (order.finished) break;

            fluid.take_viscosity(order.dt, dt);
            watch.lap(figures.viscosity);
            fluid.add_coulomb_friction(order.dt, dt);
            fluid.constrain_start(t, order.dt, dt);
            fluid.constrain_ends(t, order.dt, dt);
            health = fluid.kick_and_drift(order.dt, dt, dt_before, !two_pass);
            density_due = two_pass;
            figures.two_pass_steps += two_pass;
            dt_before = dt;
            dt = order.dt;
            t = order.t1;
            fields_due = order.output;
            check(health, t, fluid);
            watch.lap(figures.move);

            ++figures.steps;
            figures.particle_steps += static_cast<double>(fluid.particles.size());
            figures.dt_min = std::min(figures.dt_min, dt);
            figures.dt_sum += dt;
            figures.max_speed = std::max(figures.max_speed, health.max_speed);
            figures.max_compression = std::max(figures.max_compression, health.max_compression);
            if (progress.due()) progress.update(figures_now());
        }
    } catch (const std::exception& error) {
        link->report_error(failure_of(error).code, error.what());
        finish("failed");
        throw;
    }
    progress.finish(figures_now());
    finish(order.interrupted ? "interrupted" : "done");
    return order.interrupted ? exit_interrupted : exit_done;
}

}  // namespace undertow::sph
