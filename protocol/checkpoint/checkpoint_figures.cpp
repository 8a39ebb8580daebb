#include "checkpoint/checkpoint_figures.hpp"

#include "checkpoint/archive.hpp"
#include "results/summary.hpp"

namespace undertow {

void CheckpointFigures::count(std::int64_t bytes, double took) {
    ++written;
    mb = double(bytes) / 1e6;
    seconds += took;
}

void CheckpointFigures::archive(Archive& a) {
    a("written", written);
    a("seconds", seconds);
}

void CheckpointFigures::add_to(Summary& summary) const {
    if (written == 0) return;
    summary.set("checkpoint.written", written);
    summary.set("checkpoint.mb", mb);
    summary.set("checkpoint.s_each", seconds / double(written));
}

}  // namespace undertow
