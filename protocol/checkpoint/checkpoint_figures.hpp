#pragma once
// What checkpoints cost, for the summary.

#include <cstdint>

namespace undertow {

class Archive;
class Summary;

struct CheckpointFigures {
    std::int64_t written = 0;
    double mb = 0, seconds = 0;  // of the last one [MB], of all [s]

    void count(std::int64_t bytes, double took);
    void archive(Archive& a);
    /// Nothing where none was written.
    void add_to(Summary& summary) const;
};

}  // namespace undertow
