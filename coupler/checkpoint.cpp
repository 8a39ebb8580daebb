// Checkpoints of a coupled run: the participants write theirs, the coupler its own, then the
// manifest that makes them one set.

#include <filesystem>

#include "checkpoint/archive_file.hpp"
#include "checkpoint/case_record.hpp"
#include "coupler/coupler.hpp"
#include "results/log.hpp"
#include "results/wall_clock.hpp"
#include "wire/errors.hpp"
#include "wire/number_text.hpp"

namespace undertow::coupler {

void MovingMean::archive(Archive& a) {
    a.flat<double>("ring", ring_);
    a("first", first_);
    a("count", count_);
    a("value", value_);
}

void SearchBudget::archive(Archive& a) {
    a("x_boxes", x_boxes_);
    a("x_search", x_search_);
    a("allowance", allowance_);
    a("used", used_);
    a("rate", rate_);
    a("late", late_);
}

void Recorder::archive(Archive& a) {
    const auto load = [](Load& l) {
        return std::tie(l.force[0], l.force[1], l.force[2], l.moment[0], l.moment[1], l.moment[2],
                        l.impulse[0], l.impulse[1], l.impulse[2]);
    };
    a.rows("total", total_, load);
    a.rows("of_phase", of_phase_, load);
    for (std::size_t k = 0; k < patch_.size(); ++k)
        a.object("patch/" + std::to_string(k), patch_[k].mean);
    double every = every_;
    a("every", every);
    a("next_row", next_row_);
    a("row_t", row_t_);
    a("last_t", last_.t);
    a("last_dt", last_.dt);
    if (a.reading() && every != every_)  // another interval: its next multiple
        next_row_ = std::int64_t(std::floor(last_.t / every_)) + 1;
    a("contact_time", contact_time_);
    a("deepest", deepest_);
    a("most_contacts", most_contacts_);
    a.object("forces", forces_);
    a.object("energy", energy_);
    if (patches_) a.object("patches", *patches_);
}

void RunFigures::archive(Archive& a) {
    double spent = wall();
    a("wall", spent);
    if (a.reading()) start_ += wall() - spent;
    a("steps", steps_);
    a("searches", searches_);
    a("shows", shows_);
    a("outputs", outputs_);
    a("dt_min", dt_min_);
    a("dt_max", dt_max_);
    a("dt_sum", dt_sum_);
    a("largest_force", largest_force_);
    a("momentum_residual", momentum_residual_);
    std::vector<std::string> limiters;
    std::vector<std::int64_t> counts;
    for (const auto& [limiter, count] : limited_by_)
        limiters.push_back(limiter), counts.push_back(count);
    a("limiters", limiters);
    a("limited", counts);
    if (a.reading())
        for (std::size_t k = 0; k < limiters.size(); ++k) limited_by_[limiters[k]] = counts[k];
    a.object("checkpoints", checkpoints_);
}

void Coupler::check_capabilities() const {
    if (!input_.checkpoint.present) return;
    for (const auto role : {Participants::particles, Participants::surface})
        if (!participants_.can(role, "checkpoint"))
            throw InputError(input_.file + ": [checkpoint]: " + participants_.name(role) + " (" +
                             participants_.software(role) +
                             ") cannot write checkpoints; leave the table out.");
}

void Coupler::archive(Archive& a) {
    a("step", n_);
    a("t", t_);
    a.object("participants", participants_);
    a.object("agreement", agreement_);
    a.object("contact", *contact_);
    a.object("budget", *budget_);
    a.object("figures", *figures_);
    a.object("recorder", *recorder_);
    bool pressures = pressure_ != nullptr;
    a("contact_fields", pressures);
    if (pressures != (pressure_ != nullptr))
        throw InputError(input_.file + ": output.contact_fields may not change on resume, it was " +
                         (pressures ? "true" : "false") + "; put it back, or start anew.");
    if (pressure_) a.object("pressure", *pressure_);
    a("last_dt", step_.dt);
    a("last_t1", step_.t1);
    a("last_limiter", step_.limiter);
    a("phase", phase_);
    a("late_reported", late_reported_);
}

/// Where the run begins (again) there is nothing new to keep.
bool Coupler::checkpoint_due(const std::string& reason_to_end) const {
    if (n_ == 0 || resumed_) return false;
    return clock_.due(t_) ||
           (!reason_to_end.empty() && clock_.due_at_end(reason_to_end == "interrupted"));
}

void Coupler::write_checkpoint() {
    const double start = wall_clock();
    const std::string id = checkpoint_id(n_);
    progress_.update_now(live("writing " + id));
    const std::string folder = checkpoint_folder(options_.folder, id);
    Manifest manifest{id, n_, t_, {}};
    const auto acks = participants_.write_checkpoints(n_, id);
    for (const auto role : {Participants::particles, Participants::surface}) {
        WrittenFile file{acks[role].file, acks[role].sha256, -1};
        std::error_code elsewhere;  // on another host: only who wrote it can see it
        const auto bytes = std::filesystem::file_size(folder + "/" + file.name, elsewhere);
        if (!elsewhere) file.bytes = std::int64_t(bytes);
        manifest.files.push_back({participants_.name(role), file});
    }
    const Pulse tell = [&] { participants_.still_busy("writing " + id); };
    ArchiveWriter writer(folder + "/coupler.h5", tell);
    archive_case(writer, input_, id);
    archive(writer);
    manifest.files.push_back({"coupler", writer.commit()});
    write_manifest(folder, manifest);
    prune_checkpoints(options_.folder, id, input_.checkpoint.keep, tell);
    clock_.written(t_);
    progress_.kept("checkpoints/" + id, t_);
    figures_->count_checkpoint(wall_clock() - start);
    log_info("checkpoint " + id + " at t = " + number_text(t_) + " s in " +
             number_text(wall_clock() - start, 3) + " s");
}

/// Everything is as it was when the participants' messages of this step had come; what they have
/// sent now only says that they are there.
void Coupler::resume() {
    const Pulse tell = [&] { participants_.still_busy("reading " + options_.resume); };
    const std::string path = checked_file(options_.resume, *from_, "coupler", tell);
    ArchiveReader reader(path);
    archive_case(reader, input_, path);
    archive(reader);
    if (n_ != from_->step || t_ != from_->t)
        throw InputError(path + " is of step " + std::to_string(n_) + ", its manifest of step " +
                         std::to_string(from_->step) + ": the files are of different sets.");
    step_.last = t_ >= input_.time.end;
    resumed_ = true;
    progress_.kept("checkpoints/" + from_->id, t_, written_at(options_.resume));
    log_info("resumed from " + path + " at step " + std::to_string(n_) +
             ", t = " + number_text(t_) + " s");
}

}  // namespace undertow::coupler
