#include "coupler/recorder.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace undertow::coupler {

namespace {

using contact::Contact;
using contact::Vec;

std::string number(double value) {
    char text[32];
    std::snprintf(text, sizeof text, "%g", value);
    return text;
}

double history_interval(const Case& input) {
    return input.output.history_every > 0 ? input.output.history_every : input.time.end / 2000;
}

void add_columns(std::vector<std::string>& columns, const std::string& name) {
    for (const char* axis : {"fx", "fy", "fz"}) columns.push_back(name + "." + axis + " [N]");
    for (const char* axis : {"mx", "my", "mz"}) columns.push_back(name + "." + axis + " [N m]");
    for (const char* axis : {"jx", "jy", "jz"}) columns.push_back(name + "." + axis + " [N s]");
}

std::vector<std::string> force_columns(const JointSurface& surface,
                                       const std::vector<std::string>& phases) {
    std::vector<std::string> columns{"t [s]", "dt [s]"};
    for (const std::string& name : surface.names) add_columns(columns, name);
    if (phases.size() > 1)
        for (const std::string& name : surface.names)
            for (const std::string& phase : phases) add_columns(columns, name + "." + phase);
    return columns;
}

std::vector<std::string> force_notes() {
    return {
        "contact forces on the coupled surfaces, one column set per surface and per "
        "surface.phase",
        "f: force at t; m: moment about the origin; j: impulse from the start to t + dt/2, "
        "sum of f (dt_before + dt)/2 over all steps, so that nothing is lost between rows"};
}

std::vector<std::string> patch_notes(const std::vector<PressurePatch>& patches) {
    std::vector<std::string> notes{
        "mean contact pressure: sum of the normal contact forces over the patch's area, each with "
        "the share of its particle's footprint (2 l0 wide) that lies in the patch's box"};
    for (const PressurePatch& patch : patches)
        notes.push_back(patch.name + ": area " + number(patch.area) + " m2, " +
                        (patch.window > 0 ? "moving mean over the last " + number(patch.window) +
                                                " s, sampled at every step"
                                          : "unfiltered, the value of the step at t"));
    return notes;
}

std::vector<std::string> patch_columns(const std::vector<PressurePatch>& patches) {
    std::vector<std::string> columns{"t [s]"};
    for (const PressurePatch& patch : patches) columns.push_back(patch.name + " [Pa]");
    return columns;
}

/// Share of a contact's force that falls into the box. A particle presses on the square that it
/// stands for, 2 l0 wide in the plane of contact: counted as points, a patch not much larger than
/// the spacing would see a row of particles more or less with every small displacement.
double share_in(const Box& box, const Contact& c, double l0) {
    double share = 1;
    for (int axis = 0; axis < 3; ++axis) {
        const double half = l0 * std::sqrt(std::max(0.0, 1 - c.normal[axis] * c.normal[axis]));
        const double low = std::max(box.min[axis], c.point[axis] - half);
        const double high = std::min(box.max[axis], c.point[axis] + half);
        if (high < low) return 0;
        if (half > 1e-6 * l0) share *= (high - low) / (2 * half);
    }
    return share;
}

}  // namespace

Recorder::Recorder(const std::string& folder, const Case& input, const JointSurface& surface,
                   const std::vector<std::string>& phases, FileStart start)
    : names_(surface.names),
      phases_(phases.size()),
      group_(surface.group),
      total_(surface.names.size()),
      of_phase_(phases.size() > 1 ? surface.names.size() * phases.size() : 0),
      every_(history_interval(input)),
      forces_(folder + "/forces.csv", force_notes(), force_columns(surface, phases), start),
      energy_(
          folder + "/energy.interface.csv",
          {"work done by contact since the start, energy stored and lost at the interface",
           "residual = sum of all the others [J]: round-off, or a force is not what it should be",
           "impact: springs that open and close within a step; uneven: a changing dt; turning: depths "
           "that velocities do not explain (normals that turn, particles that were shifted)",
           "booked to t - dt_before/2: the last step is booked when its velocities arrive"},
          {"t [s]", "work_particles [J]", "work_surface [J]", "penalty [J]", "damping [J]",
           "friction [J]", "relaxation [J]", "impact [J]", "uneven [J]", "turning [J]",
           "residual [J]", "contacts", "deepest [l0]"},
          start) {
    for (const PressurePatch& patch : input.coupling.patch)
        patch_.push_back({patch, MovingMean(patch.window)});
    if (!patch_.empty())
        patches_.emplace(folder + "/patches.csv", patch_notes(input.coupling.patch),
                         patch_columns(input.coupling.patch), start);
}

void Recorder::record(const RecordedStep& step, const contact::PenaltyContact& contact,
                      const std::vector<std::uint32_t>& phase) {
    const double kick = contact.kick();
    for (std::vector<Load>* loads : {&total_, &of_phase_})
        for (Load& load : *loads) load.force = load.moment = Vec::Zero();
    for (const Contact& c : contact.contacts()) {
        const Vec force = -c.force, moment = c.point.cross(force);
        const std::size_t surface = std::size_t(group_[c.facet]);
        const auto add = [&](Load& load) {
            load.force += force;
            load.moment += moment;
            load.impulse += kick * force;
        };
        add(total_[surface]);
        if (!of_phase_.empty()) add(of_phase_[surface * phases_ + phase[c.particle]]);
        deepest_ = std::max(deepest_, c.depth / contact.radius(c.particle));
    }
    for (Patch& p : patch_) {
        double force = 0;
        for (const Contact& c : contact.contacts())
            force += c.normal_force * share_in(p.patch.box, c, contact.radius(c.particle));
        p.mean.add(step.t + 0.5 * step.dt, kick, force / p.patch.area);
    }
    if (!contact.contacts().empty()) contact_time_ += step.dt;
    most_contacts_ = std::max(most_contacts_, contact.contacts().size());
    last_ = step;
    // Times of rows are multiples computed afresh; a step longer than the interval gets one row.
    if (step.t < double(next_row_) * every_ * (1 - 1e-12)) return;
    next_row_ = std::int64_t(std::floor(step.t / every_ * (1 + 1e-12))) + 1;
    write_row(step.t, step.dt, contact);
}

void Recorder::write_row(double t, double dt, const contact::PenaltyContact& contact) {
    row_t_ = t;
    row_.assign({t, dt});
    for (const std::vector<Load>* loads : {&total_, &of_phase_})
        for (const Load& load : *loads)
            for (const Vec* vector : {&load.force, &load.moment, &load.impulse})
                row_.insert(row_.end(), vector->begin(), vector->end());
    forces_.row(row_);

    const contact::InterfaceEnergy& e = contact.energy();
    double deepest = 0;
    for (const Contact& c : contact.contacts())
        deepest = std::max(deepest, c.depth / contact.radius(c.particle));
    row_.assign({t, e.work_particles, e.work_surface, e.penalty, e.damping, e.friction,
                 e.relaxation, e.impact, e.uneven, e.turning, e.residual(), double(contact.contacts().size()), deepest});
    energy_.row(row_);

    if (!patches_) return;
    row_.assign({t});
    for (const Patch& patch : patch_) row_.push_back(patch.mean.mean());
    patches_->row(row_);
}

void Recorder::finish(const contact::PenaltyContact& contact) {
    if (last_.dt > 0 && row_t_ < last_.t) write_row(last_.t, last_.dt, contact);
    flush();
}

void Recorder::flush() {
    forces_.flush();
    energy_.flush();
    if (patches_) patches_->flush();
}

double Recorder::total_force() const {
    Vec sum = Vec::Zero();
    for (const Load& load : total_) sum += load.force;
    return sum.norm();
}

}  // namespace undertow::coupler
