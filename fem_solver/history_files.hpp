#pragma once
// [[fem.history]]: files of their own for points, sets, sections and contacts.

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "case/case.hpp"
#include "fem_solver/structure.hpp"
#include "results/history.hpp"

namespace undertow::fem {

class HistoryFiles {
 public:
    HistoryFiles(const std::string& folder, const Case& c, const Structure& structure,
                 FileStart start = FileStart::fresh);

    /// Whether any row is due at t.
    bool row_due(double t) const;
    /// Whether a row of a section is due at t: those are measured among the elements' forces.
    bool section_due(double t) const;
    /// Rows that are due at t; after the kick, when forces at n are complete.
    void write(double t, const Structure& structure);
    /// The last rows, due or not; of sections only if they were measured at t.
    void write_last(double t, const Structure& structure);
    void archive(Archive& a, double t);  // t [s]: now

 private:
    struct File {
        FemHistory what;
        HistoryTimes times;
        History history;
        std::vector<std::int32_t> nodes;                   // of a point or a set
        std::vector<std::pair<std::int32_t, int>> held{};  // node and direction that supports hold
        std::size_t index = 0;                             // of the section, of the contact pair
        double last = -1;                                  // [s]
    };
    void write_row(File& file, double t, const Structure& structure);

    std::vector<File> file_;
    std::vector<double> row_;
};

}  // namespace undertow::fem
