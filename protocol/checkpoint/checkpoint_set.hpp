#pragma once
// A set of checkpoint files, one per program, in RESULTS/checkpoints/step_000001200. The manifest
// is written last: a folder without one is no set, and is swept away.

#include <cstdint>
#include <string>
#include <vector>

#include "checkpoint/archive_file.hpp"

namespace undertow {

struct Manifest {
    struct File {
        std::string who;  // participant: "sph"
        WrittenFile file;
    };
    std::string id;         // "step_000001200", the folder's name
    std::int64_t step = 0;  // the state before this step
    double t = 0;           // [s]
    std::vector<File> files;
};

std::string checkpoint_id(std::int64_t step);
/// RESULTS/checkpoints/ID; made if it is not there. Throws std::runtime_error (E_IO).
std::string checkpoint_folder(const std::string& results, const std::string& id);

void write_manifest(const std::string& folder, const Manifest& manifest);
/// InputError when there is none, or when it cannot be understood.
Manifest read_manifest(const std::string& folder);
/// When the set was finished [s since 1970]; 0 where it cannot be told.
std::int64_t written_at(const std::string& folder);
/// Path of the file of `who` in the set. InputError when the manifest does not know it, or its
/// bytes are not those that were written. All are read: the pulse is called meanwhile.
std::string checked_file(const std::string& folder, const Manifest& manifest,
                         const std::string& who, const Pulse& pulse = {});

/// Removes the oldest sets beyond `keep`, and what is left of sets that were never finished; the
/// set of `newest` stays. Failures are ignored: a set too many does no harm. The pulse is called
/// after each: to remove large files takes its time.
void prune_checkpoints(const std::string& results, const std::string& newest, int keep,
                       const Pulse& pulse = {});

}  // namespace undertow
