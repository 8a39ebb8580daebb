#include "sph_solver/checkpoint.hpp"

#include "checkpoint/case_record.hpp"
#include "checkpoint/checkpoint_set.hpp"
#include "results/log.hpp"
#include "results/wall_clock.hpp"
#include "wire/errors.hpp"
#include "wire/number_text.hpp"

namespace undertow::sph {

void LoopState::archive(Archive& a) {
    a("step", n);
    a("t", t);
    a("dt", dt);
    a("dt_before", dt_before);
    a("two_pass", two_pass);
    a("dt_limit", dt_limit);
    a("limiter", limiter);
}

void Checkpoints::archive(Archive& a) {
    a.object("loop", loop_);
    a.object("fluid", fluid_);
    a.object("link", link_);
    a.object("figures", figures_);
    const Archive::Group group(a, "recorder");
    recorder_.archive(a, loop_.t);
}

WrittenFile Checkpoints::write(const std::string& id, double wall) {
    const double start = wall_clock();
    figures_.wall = wall;
    ArchiveWriter writer(checkpoint_folder(folder_, id) + "/sph.h5",
                         [&] { link_.still_busy("writing " + id); });
    archive_case(writer, input_, id);
    archive(writer);
    const WrittenFile file = writer.commit();
    const double took = wall_clock() - start;
    log_info("checkpoint " + id + " at t = " + number_text(loop_.t) + " s: " +
             number_text(double(file.bytes) / 1e6, 3) + " MB in " + number_text(took, 3) + " s");
    figures_.checkpoints.count(file.bytes, took);
    return file;
}

void Checkpoints::resume(const std::string& set) {
    const Manifest manifest = read_manifest(set);
    const std::string path =
        checked_file(set, manifest, "sph", [&] { link_.still_busy("reading " + set); });
    ArchiveReader reader(path);
    archive_case(reader, input_, path);
    archive(reader);
    if (loop_.n != manifest.step || loop_.t != manifest.t)
        throw InputError(path + " is of step " + std::to_string(loop_.n) +
                         ", its manifest of step " + std::to_string(manifest.step) +
                         ": the files are of different sets.");
    log_info("resumed from " + path + " at step " + std::to_string(loop_.n) +
             ", t = " + number_text(loop_.t) + " s");
}

}  // namespace undertow::sph
