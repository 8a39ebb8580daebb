#pragma once
// What a run leaves behind: fem.vtkhdf and .xdmf, energy.fem.csv, fem.history.csv,
// summary.fem.json.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "case/case.hpp"
#include "checkpoint/checkpoint_figures.hpp"
#include "fem_solver/history_files.hpp"
#include "fem_solver/settle.hpp"
#include "fem_solver/structure.hpp"
#include "results/field_file.hpp"
#include "results/history.hpp"
#include "results/summary.hpp"

namespace undertow::fem {

/// Counted by the loop, for the summary.
struct RunFigures {
    std::int64_t steps = 0;
    double t = 0;               // [s] reached
    double dt_min = 0;          // [s]
    double wall = 0, wait = 0;  // [s]
    std::string limiter;        // of the last step that was not cut short for an output
    bool complete = false;      // reached the end of the run

    CheckpointFigures checkpoints;

    void archive(Archive& a);
};

class Output {
 public:
    /// `settlement` for the summary, if the structure settled.
    Output(const std::string& folder, const Case& c, const Structure& structure,
           std::optional<Settlement> settlement = {}, FileStart start = FileStart::fresh);

    /// Fields at t; velocity is v^{n-1/2}. Nothing when these fields have been written already.
    void fields(double t, const Structure& structure);
    /// Rows of the histories when one is due; after the kick, when the energies at n are complete.
    void history(double t, const Structure& structure);
    bool row_due(double t) const { return row_times_.is_due(t) || own_histories_.row_due(t); }
    bool section_due(double t) const { return own_histories_.section_due(t); }
    /// The last rows, due or not.
    void last_history(double t, const Structure& structure);
    void summary(const RunFigures& run, const Structure& structure) const;
    void archive(Archive& a, double t);  // t [s]: now
    const std::string& folder() const { return folder_; }

 private:
    void write_rows(double t, const Structure& structure);
    void write_bodies(const Structure& structure);
    void summarize_settlement(Summary& summary, const Structure& structure) const;

    std::string folder_;
    MeshFile mesh_;
    History energy_, history_;
    HistoryFiles own_histories_;
    HistoryTimes row_times_;
    double last_row_ = -1, last_fields_ = -1;     // [s]
    double peak_energy_ = 0, worst_balance_ = 0;  // [J]
    double peak_displacement_ = 0;                // [m]
    std::vector<double> row_;
    std::optional<Settlement> settlement_;
};

}  // namespace undertow::fem
