// What a checkpoint of the structure holds: all that steps change, class by class. What follows
// from the case alone is made anew; rigid bodies and contact pairs keep theirs in their own files.

#include "checkpoint/archive.hpp"
#include "checkpoint/sha256.hpp"
#include "fem_solver/output.hpp"
#include "fem_solver/shells/shells.hpp"
#include "fem_solver/structure.hpp"
#include "wire/errors.hpp"

namespace undertow::fem {

void Nodes::archive(Archive& a) {
    a.flat<double>("x0", x0);
    a.flat<double>("x", x);
    a.flat<double>("v", v);
    a.flat<double>("f", f);
    a.flat<double>("inverse_mass", inverse_mass);
}

void NodalLoad::archive(Archive& a) {
    a.flat<double>("force", force);
    a("work", work);
}

void TurningNodes::archive(Archive& a) {
    a.flat<double>("omega", omega);
    a.flat<double>("moment", moment);
    a.flat<double>("inverse_inertia", inverse_inertia);
}

void Shells::archive(Archive& a) {
    batches_.archive_order(a);
    a.flat<double>("state", state_);
    a.flat<double>("resultants", resultants_);
    a.flat<double>("layers", layers_);
    a.flat<double>("axes", axes_);
    a.flat<double>("omega2", omega2_);
    std::vector<Lanes> reference(constants_.size());
    for (std::size_t b = 0; b < reference.size(); ++b)
        reference[b] = constants_[b].omega2_reference;
    a.flat<double>("omega2_reference", reference);
    for (std::size_t b = 0; b < reference.size(); ++b)
        constants_[b].omega2_reference = reference[b];
    a.object("turning", turning_);
}

void Elements::archive(Archive& a) {
    for (std::size_t k = 0; k < groups_.size(); ++k) a.object(std::to_string(k), *groups_[k]);
}

void StiffnessMatrix::archive(Archive& a) {
    a.flat<double>("value", matrix_.value);
}

void ShapeWatch::archive(Archive& a) {
    a.flat<double>("accepted", accepted_);
}

void TurningBodies::archive(Archive& a) {
    for (std::size_t b = 0; b < body_.size(); ++b) {
        const Archive::Group group(a, std::to_string(b));
        a.flat<double>("x", body_[b].x);
        a("rotation", body_[b].rotation);
    }
}

void ImplicitParts::archive(Archive& a) {
    a.object("stiffness", stiffness_);
    a.object("bodies", bodies_);
    a.object("shape", shape_);
    a("kappa", kappa_);
    a("dt_factored", dt_factored_);
    a("stretched", stretched_);
    a("small_steps", small_steps_);
    a("kicks", kicks_);
    a("factorizations", factorizations_);
    a("assemblies", assemblies_);
    a("omega_elements", omega_elements_);
    a("stress_stiffness", stress_stiffness_);
    a("change_work", change_work_);
    a("energy", energy_);
    a("damping_work", damping_work_);
    a("damping_ahead", damping_ahead_);
    // the factor is as large as all the rest together, and the same matrix gives the same bits
    if (a.reading() && kappa_ > 0) factor_.factorize(stiffness_.matrix(), mass_, kappa_);
}

void PrescribedMotion::archive(Archive& a) {
    a("now_shift", now_.shift);
    a("now_angle", now_.angle);
    a("next_shift", next_.shift);
    a("next_angle", next_.angle);
    a("force", force_.force);
    a("moment", force_.moment);
    a("work", work_);
    a("ahead", ahead_);
}

void StiffnessDamping::archive(Archive& a) {
    a.flat<double>("force", f_);
    a("dissipated", dissipated_);
}

void SectionForce::archive(Archive& a) {
    a("force", force_.force);
    a("moment", force_.moment);
}

void AbsorbingBoundary::archive(Archive& a) {
    a.flat<double>("dashpot", dashpot_);
    a.flat<double>("spring", spring_);
    a.flat<double>("inverse_mass", inverse_mass_);
    a.object("reaction", reaction_);
    a.flat<double>("reaction_start", reaction_start_);
    a.flat<double>("x_start", x_start_);
    a("released", released_);
    a("dissipated", dissipated_);
    a("ahead", ahead_);
}

void StaticWater::archive(Archive& a) {
    a.object("load", load);
    a("at", at_);
    a.flat<double>("sum", sum_);
    a.flat<double>("constant", constant_);
    a("observed", observed_);
    a("net_difference", difference_.net);
    a("nodal_difference", difference_.nodal);
}

namespace {

template <class T>
std::string_view bytes_of(const std::vector<T>& values) {
    return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}

std::string sum_of(const Mesh& mesh) {
    Sha256 sum;
    sum.add(bytes_of(mesh.x));
    sum.add(bytes_of(mesh.hexahedra));
    sum.add(bytes_of(mesh.tetrahedra));
    sum.add(bytes_of(mesh.shells));
    return sum.hex();
}

}  // namespace

void Structure::archive(Archive& a) {
    if (!a.same("mesh", sum_of(model_.mesh)))
        throw InputError("the mesh " + model_.mesh.source +
                         " is not the one that the checkpoint was written with; put it back, or "
                         "start anew.");
    a.object("nodes", nodes_);
    a.object("contact", contact_);
    a.object("elements", elements_);
    if (implicit_) a.object("implicit", *implicit_);
    for (std::size_t k = 0; k < bodies_.size(); ++k)
        a.object("bodies/" + std::to_string(k), bodies_[k]);
    for (std::size_t k = 0; k < pairs_.size(); ++k)
        a.object("pairs/" + std::to_string(k), pairs_[k]);
    a.object("far_field", model_.far_field);
    if (model_.water) a.object("water", *model_.water);
    for (std::size_t k = 0; k < model_.pressures.size(); ++k)
        a.object("pressures/" + std::to_string(k), model_.pressures[k].load);
    for (std::size_t k = 0; k < model_.tractions.size(); ++k)
        a.object("tractions/" + std::to_string(k), model_.tractions[k].load);
    for (std::size_t k = 0; k < model_.motions.size(); ++k)
        a.object("motions/" + std::to_string(k), model_.motions[k]);
    for (std::size_t k = 0; k < model_.sections.size(); ++k)
        a.object("sections/" + std::to_string(k), model_.sections[k]);
    a.object("stiffness_damping", stiffness_damping_);
    a("motions_rest", motions_rest_);
    if (!model_.initial_velocities.empty()) {
        a("launched", launched_);
        a("start_energy", start_energy_);
    }
    a("measure_sections", measure_sections_);
    a("t", t_);
    a("dt", dt_);
    a("kick_span", kick_span_);
    a.flat<double>("report", report_);
    a.flat<double>("kick", kick_);
    a("strain_work", strain_work_);
    a("hourglass_work", hourglass_work_);
    a("viscous_work", viscous_work_);
    a("plastic_work", plastic_work_);
    a("damping_work", damping_work_);
    a("damping_ahead", damping_ahead_);
    a("tightening", tightening_);
    a("omega_start", omega_start_);
    a("frequency_searches", frequency_searches_);
    a("offer", stable_.dt);
    a("limiter", stable_.limiter);
    a("named_omega2", named_omega2_);
    if (a.reading() && !faces_.empty()) faces_.follow(nodes_.x);
}

void Output::archive(Archive& a, double t) {
    a.object("mesh", mesh_);
    a.object("energy", energy_);
    a.object("history", history_);
    own_histories_.archive(a, t);
    {
        const Archive::Group group(a, "row_times");
        row_times_.archive(a, t);
    }
    a("last_row", last_row_);
    a("last_fields", last_fields_);
    a("peak_energy", peak_energy_);
    a("worst_balance", worst_balance_);
    a("peak_displacement", peak_displacement_);
    bool settled = settlement_.has_value();
    a("settled", settled);
    if (!settled) return;
    if (!settlement_) settlement_.emplace();
    a.object("settlement", *settlement_);
}

void HistoryFiles::archive(Archive& a, double t) {
    for (File& file : file_) {
        const Archive::Group group(a, "histories/" + file.what.name);
        a.object("rows", file.history);
        file.times.archive(a, t);
        a("last", file.last);
    }
}

void Settlement::archive(Archive& a) {
    a("complete", complete);
    a("steps", steps);
    a("stops", stops);
    a("residual", residual);
    a("reference", reference);
    a("body_residual", body_residual);
    a("largest_displacement", largest_displacement);
    a.flat<double>("body_displacement", body_displacement);
    a("wall", wall);
}

void RunFigures::archive(Archive& a) {
    a("steps", steps);
    a("t", t);
    a("dt_min", dt_min);
    a("wall", wall);
    a("wait", wait);
    a("limiter", limiter);
    a.object("checkpoints", checkpoints);
}

}  // namespace undertow::fem
