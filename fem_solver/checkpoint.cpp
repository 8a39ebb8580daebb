// The solver's checkpoints: what the loop itself keeps, and where the file goes.

#include "checkpoint/case_record.hpp"
#include "checkpoint/checkpoint_set.hpp"
#include "fem_solver/solver.hpp"
#include "results/log.hpp"
#include "results/wall_clock.hpp"
#include "wire/errors.hpp"
#include "wire/number_text.hpp"

namespace undertow::fem {

void Solver::archive(Archive& a) {
    a("step", n_);
    a("t", t_);
    a.object("structure", structure_);
    a.object("link", link_);
    a.object("figures", figures_);
    const Archive::Group group(a, "output");
    output_.archive(a, t_);
}

WrittenFile Solver::write_checkpoint(const std::string& id) {
    const double start = wall_clock();
    figures_.wall = start - start_;
    ArchiveWriter writer(checkpoint_folder(output_.folder(), id) + "/fem.h5",
                         [&] { link_.still_busy("writing " + id); });
    archive_case(writer, case_, id);
    archive(writer);
    const WrittenFile file = writer.commit();
    log_info("checkpoint " + id + " at t = " + number_text(t_) +
             " s: " + number_text(double(file.bytes) / 1e6, 3) + " MB in " +
             number_text(wall_clock() - start, 3) + " s");
    figures_.checkpoints.count(file.bytes, wall_clock() - start);
    return file;
}

void Solver::resume(const std::string& set) {
    const Manifest manifest = read_manifest(set);
    const std::string path =
        checked_file(set, manifest, "fem", [&] { link_.still_busy("reading " + set); });
    ArchiveReader reader(path);
    archive_case(reader, case_, path);
    archive(reader);
    if (n_ != manifest.step || t_ != manifest.t)
        throw InputError(path + " is of step " + std::to_string(n_) + ", its manifest of step " +
                         std::to_string(manifest.step) + ": the files are of different sets.");
    resumed_ = true;
    line_.kept("checkpoints/" + manifest.id, t_, written_at(set));
    log_info("resumed from " + path + " at step " + std::to_string(n_) +
             ", t = " + number_text(t_) + " s");
}

}  // namespace undertow::fem
