#include "checkpoint/own_checkpoints.hpp"

namespace undertow {

bool OwnCheckpoints::due(std::int64_t n, double t, bool ending, bool interrupted) {
    if (first_ < 0) {
        first_ = n;
        clock_.written(t);
    }
    if (n == first_) return false;
    return clock_.due(t) || (ending && clock_.due_at_end(interrupted));
}

void OwnCheckpoints::complete(std::int64_t n, double t, const WrittenFile& file) {
    const std::string id = checkpoint_id(n);
    write_manifest(checkpoint_folder(results_, id), {id, n, t, {{who_, file}}});
    prune_checkpoints(results_, id, settings_.keep);
    clock_.written(t);
}

}  // namespace undertow
