#include "fem_solver/output.hpp"

#include <algorithm>
#include <cmath>

namespace undertow::fem {
namespace {

template <class Cells>
std::vector<std::int32_t> flat(const Cells& cells) {
    std::vector<std::int32_t> all;
    for (const auto& cell : cells) all.insert(all.end(), cell.begin(), cell.end());
    return all;
}

MeshCells cells_of(const Mesh& mesh) {
    return {flat(mesh.hexahedra), flat(mesh.tetrahedra), flat(mesh.shells)};
}

/// Columns of what a scene has no part of are left out.
std::vector<std::string> energy_columns(const Structure& structure) {
    std::vector<std::string> columns{"t [s]",         "kinetic [J]",        "internal [J]",
                                     "hourglass [J]", "bulk viscosity [J]", "damping [J]"};
    if (structure.elements().any_plastic()) columns.push_back("plastic [J]");
    if (!structure.model().far_field.empty()) columns.push_back("far field [J]");
    columns.insert(columns.end(), {"external work [J]", "contact work [J]"});
    if (!structure.pairs().empty())
        columns.insert(columns.end(), {"contact springs [J]", "friction [J]", "contact damping [J]"});
    if (structure.implicit())
        columns.insert(columns.end(), {"implicit inertia [J]", "implicit damping [J]", "implicit change [J]"});
    if (!structure.model().initial_velocities.empty()) columns.push_back("given at the start [J]");
    columns.push_back("balance error [J]");
    return columns;
}

std::vector<std::string> history_columns(const Structure& structure) {
    const Model& model = structure.model();
    std::vector<std::string> columns{"t [s]"};
    for (const Probe& probe : model.probes) {
        for (const char* d : {"ux", "uy", "uz"}) columns.push_back(probe.name + "." + d + " [m]");
        for (const char* d : {"vx", "vy", "vz"}) columns.push_back(probe.name + "." + d + " [m/s]");
    }
    for (const Support& support : model.supports)
        for (const char* d : {"rx", "ry", "rz"})
            columns.push_back("support " + support.name + "." + d + " [N]");
    for (const PrescribedMotion& motion : model.motions) {
        const std::string name = "motion " + motion.name();
        for (const char* d : {".ux [m]", ".uy [m]", ".uz [m]", ".angle [rad]", ".fx [N]", ".fy [N]",
                              ".fz [N]", ".mx [N m]", ".my [N m]", ".mz [N m]"})
            columns.push_back(name + d);
    }
    if (structure.elements().any_plastic()) columns.push_back("yielding elements");
    for (const RigidSet& body : model.rigid) {
        for (const char* d : {"ux", "uy", "uz"}) columns.push_back(body.name + "." + d + " [m]");
        for (const char* d : {"rx", "ry", "rz"}) columns.push_back(body.name + "." + d + " [rad]");
        for (const char* from : {".", ".load."}) {
            for (const char* d : {"fx", "fy", "fz"})
                columns.push_back(body.name + from + d + " [N]");
            for (const char* d : {"mx", "my", "mz"})
                columns.push_back(body.name + from + d + " [N m]");
        }
    }
    for (const ContactSet& contact : model.contacts)
        for (const char* what :
             {".normal [N]", ".tx [N]", ".ty [N]", ".tz [N]", ".touching", ".slipping"})
            columns.push_back(contact.name + what);
    return columns;
}

std::vector<std::string> history_notes(const Model& model) {
    std::vector<std::string> notes{
        "probes: displacement and velocity of the node nearest to the point at the start",
        "support: force of the support on the structure, unfiltered"};
    if (!model.motions.empty())
        notes.push_back(
            "motion: how far it has gone; force that it takes and its moment, about the center of "
            "turning, of a rigid body about its center of mass, inertia included, unfiltered");
    if (!model.rigid.empty()) {
        notes.push_back(
            "rigid bodies: displacement of the center of mass, rotation vector; forces on the body "
            "and moments about the center of mass:");
        notes.push_back(
            "fx to mz from contact inside the mesh, less its value at the start; load. from the "
            "coupler and pressures, as it is");
    }
    if (!model.contacts.empty())
        notes.push_back(
            "contact inside the mesh: sum of normal forces, friction on the nodes, nodes that "
            "touch, share of them that slip");
    return notes;
}

}  // namespace

Output::Output(const std::string& folder, const Case& c, const Structure& structure,
               std::optional<Settlement> settlement, FileStart start)
    : folder_(folder),
      mesh_(folder + "/fem", structure.nodes().size(), cells_of(structure.model().mesh),
            start),
      energy_(folder + "/energy.fem.csv",
              {"energies of the structure at t; what went in is external (weight, pressure) and "
               "contact work",
               "kinetic: 1/2 m v(t - dt/2).v(t + dt/2); balance error: the rest of the sum"},
              energy_columns(structure), start),
      history_(folder + "/fem.history.csv", history_notes(structure.model()),
               history_columns(structure), start),
      own_histories_(folder, c, structure, start),
      row_times_(c.output.history_every, c.time.end),
      settlement_(std::move(settlement)) {}

void Output::fields(double t, const Structure& structure) {
    if (t == last_fields_) return;
    last_fields_ = t;
    const std::size_t n_nodes = structure.nodes().size(), n_elements = structure.elements().size();
    std::vector<double> x(3 * n_nodes), u(3 * n_nodes), v(3 * n_nodes);
    for (std::size_t n = 0; n < n_nodes; ++n)
        for (int d = 0; d < 3; ++d) {
            x[3 * n + d] = structure.nodes().x[n].c[d];
            u[3 * n + d] = x[3 * n + d] - structure.nodes().x0[n].c[d];
            v[3 * n + d] = structure.nodes().v[n].c[d];
        }
    const std::vector<double> stress = structure.elements().stress();
    std::vector<double> von_mises(n_elements), pressure(n_elements);
    for (std::size_t e = 0; e < n_elements; ++e) {
        const double* s = &stress[6 * e];  // xx yy zz xy yz zx
        von_mises[e] = std::sqrt(
            0.5 * (std::pow(s[0] - s[1], 2) + std::pow(s[1] - s[2], 2) + std::pow(s[2] - s[0], 2)) +
            3 * (s[3] * s[3] + s[4] * s[4] + s[5] * s[5]));
        pressure[e] = -(s[0] + s[1] + s[2]) / 3;
    }
    const Elements::FaceStress faces = structure.elements().face_stress();
    const std::vector<double> plastic_strain = structure.elements().plastic_strain();
    std::vector<Field> of_elements{{"stress", "Pa", 6, stress},
                                   {"von_mises", "Pa", 1, von_mises},
                                   {"pressure", "Pa", 1, pressure}};
    if (!faces.top.empty()) {
        of_elements.push_back({"stress_top", "Pa", 6, faces.top});
        of_elements.push_back({"stress_bottom", "Pa", 6, faces.bottom});
    }
    if (structure.elements().any_plastic())
        of_elements.push_back({"plastic_strain", "1", 1, plastic_strain});
    if (!structure.model().strength.empty())
        of_elements.push_back({"strength", "Pa", 1, structure.model().strength});
    std::vector<Field> of_nodes{{"displacement", "m", 3, u}, {"velocity", "m/s", 3, v}};
    std::vector<double> contact_pressure(structure.pairs().empty() ? 0 : n_nodes);
    for (const ContactPair& pair : structure.pairs()) pair.add_pressure(contact_pressure);
    if (!contact_pressure.empty())
        of_nodes.push_back({"contact_pressure", "Pa", 1, contact_pressure});
    mesh_.append(t, x, of_nodes, of_elements);
}

void Output::history(double t, const Structure& structure) {
    if (row_times_.due(t)) write_rows(t, structure);
    own_histories_.write(t, structure);
}

void Output::last_history(double t, const Structure& structure) {
    if (t != last_row_) write_rows(t, structure);
    own_histories_.write_last(t, structure);
    energy_.flush();
    history_.flush();
}

void Output::write_rows(double t, const Structure& structure) {
    last_row_ = t;
    const Energies e = structure.energies();
    row_ = {t, e.kinetic, e.internal, e.hourglass, e.bulk_viscosity, e.damping};
    if (structure.elements().any_plastic()) row_.push_back(e.plastic);
    if (!structure.model().far_field.empty()) row_.push_back(e.far_field);
    row_.insert(row_.end(), {e.external, e.contact});
    if (!structure.pairs().empty())
        row_.insert(row_.end(), {e.pair_springs, e.pair_friction, e.pair_damping});
    if (structure.implicit()) row_.insert(row_.end(), {e.implicit, e.implicit_damping, e.implicit_change});
    if (!structure.model().initial_velocities.empty()) row_.push_back(e.start);
    row_.push_back(e.balance_error());
    energy_.row(row_);
    peak_energy_ = std::max({peak_energy_, e.kinetic, e.internal + e.hourglass + e.plastic,
                             std::abs(e.external), std::abs(e.contact)});
    worst_balance_ = std::max(worst_balance_, std::abs(e.balance_error()));
    peak_displacement_ = std::max(peak_displacement_, structure.largest_displacement());

    row_ = {t};
    for (const Probe& probe : structure.model().probes) {
        const Vec3 u = structure.displacement(probe.node), v = structure.velocity(probe.node);
        row_.insert(row_.end(), u.begin(), u.end());
        row_.insert(row_.end(), v.begin(), v.end());
    }
    for (const Support& support : structure.model().supports) {
        const Vec3 r = structure.reaction(support);
        row_.insert(row_.end(), r.begin(), r.end());
    }
    for (const PrescribedMotion& motion : structure.motions()) {
        const MotionLaw::Place& place = motion.place();
        const Wrench& force = motion.force();
        row_.insert(row_.end(), place.shift.begin(), place.shift.end());
        row_.push_back(place.angle);
        row_.insert(row_.end(), force.force.begin(), force.force.end());
        row_.insert(row_.end(), force.moment.begin(), force.moment.end());
    }
    if (structure.elements().any_plastic()) row_.push_back(double(structure.yielding_elements()));
    write_bodies(structure);
    history_.row(row_);
}

void Output::write_bodies(const Structure& structure) {
    for (const RigidBody& body : structure.bodies()) {
        const Wrench contact = body.contact(), load = body.load(structure.nodes());
        for (const Vec3& v : {body.displacement(), body.rotation(), contact.force, contact.moment,
                              load.force, load.moment})
            row_.insert(row_.end(), v.begin(), v.end());
    }
    for (const ContactPair& pair : structure.pairs()) {
        const ContactTotals& sum = pair.totals();
        row_.insert(row_.end(), {sum.normal_force, sum.friction[0], sum.friction[1],
                                 sum.friction[2], double(sum.touching),
                                 sum.touching > 0 ? double(sum.slipping) / sum.touching : 0.0});
    }
}

void Output::summary(const RunFigures& run, const Structure& structure) const {
    const double elements = double(structure.elements().deformable());
    const double busy = run.wall - run.wait;
    Summary s;
    s.set("complete", run.complete);
    s.set("t", run.t);
    s.set("steps", run.steps);
    s.set("elements", std::int64_t(structure.elements().size()));
    s.set("nodes", std::int64_t(structure.nodes().size()));
    s.set("wall_s", run.wall);
    s.set("wait_s", run.wait);
    s.set("element_steps_per_s", busy > 0 ? elements * double(run.steps) / busy : 0.0);
    s.set("dt_min", run.dt_min);
    s.set("dt_mean", run.steps > 0 ? run.t / double(run.steps) : 0.0);
    s.set("limiter", run.limiter);
    s.set("dt_critical_elements", 2 / structure.omega_bound());
    s.set("dt_critical", 2 / structure.omega_start());
    s.set("frequency_searches", std::int64_t(structure.frequency_searches()));
    run.checkpoints.add_to(s);
    s.set("energy_balance_error", peak_energy_ > 0 ? worst_balance_ / peak_energy_ : 0.0);
    s.set("max_displacement", peak_displacement_);
    if (const ImplicitParts* implicit = structure.implicit()) {
        s.set("implicit.unknowns", std::int64_t(implicit->unknowns()));
        s.set("implicit.factor_nonzeros", implicit->nonzeros());
        s.set("implicit.factorizations", implicit->factorizations());
        s.set("implicit.assemblies", implicit->assemblies());
        s.set("implicit.explicit_step", implicit->explicit_step());
    }
    for (const ScaledPart& part : structure.model().mass_scaling) {
        s.set("mass_scaling." + part.part + ".elements", std::int64_t(part.elements));
        s.set("mass_scaling." + part.part + ".mass", part.mass);
        s.set("mass_scaling." + part.part + ".added_mass", part.added);
    }
    if (settlement_) summarize_settlement(s, structure);
    if (structure.model().water) {
        const StaticWater::Difference& d = structure.model().water->difference();
        s.set("still_water.net_difference", d.net);
        s.set("still_water.nodal_difference", d.nodal);
    }
    for (const ContactPair& pair : structure.pairs()) {
        s.set("contact." + pair.set().name + ".nodes", std::int64_t(pair.set().nodes.size()));
        s.set("contact." + pair.set().name + ".softest", pair.softest());
        s.set("contact." + pair.set().name + ".searches", std::int64_t(pair.searches()));
    }
    s.write(folder_ + "/summary.fem.json");
}

void Output::summarize_settlement(Summary& s, const Structure& structure) const {
    s.set("settle.steps", settlement_->steps);
    s.set("settle.stops", std::int64_t(settlement_->stops));
    s.set("settle.wall_s", settlement_->wall);
    s.set("settle.residual_force", settlement_->residual);
    s.set("settle.reference_force", settlement_->reference);
    s.set("settle.body_residual", settlement_->body_residual);
    s.set("settle.max_displacement", settlement_->largest_displacement);
    for (std::size_t b = 0; b < settlement_->body_displacement.size(); ++b)
        s.set("settle." + structure.bodies()[b].set().name + ".uz",
              settlement_->body_displacement[b][2]);
}

}  // namespace undertow::fem
