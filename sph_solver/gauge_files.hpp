#pragma once
// Gauges with their files: one file per interval, gauges.csv for output.history_every and
// gauges.every_0.01s.csv for gauges with an interval of their own.

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "case/case.hpp"
#include "results/history.hpp"
#include "sph_solver/flux_meter.hpp"

namespace undertow::sph {

class GaugeFiles {
 public:
    GaugeFiles(const Case& input, const std::string& folder, FileStart start = FileStart::fresh);

    /// Writes the rows that are due at t; to be called every step.
    void observe(double t, const FluidSystem& fluid);
    void flush();
    void archive(Archive& a, double t);  // t [s]: now
    /// Flux gauges with what went through them [m3].
    std::vector<std::pair<std::string, double>> totals() const;

 private:
    struct Group {
        HistoryTimes times;
        std::vector<std::size_t> gauges;  // indices
        std::unique_ptr<History> file;
    };
    std::vector<double> read(const SphGauge& gauge, const FluidSystem& fluid,
                             std::vector<Vec3>& wall_forces);

    std::vector<SphGauge> gauges_;
    std::vector<std::string> walls_;           // planes, then bodies
    std::map<std::string, FluxMeter> meters_;  // by gauge
    std::vector<Group> groups_;
};

}  // namespace undertow::sph
