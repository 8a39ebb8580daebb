#include "sph_solver/gauge_files.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "sph_solver/gauges.hpp"

namespace undertow::sph {

namespace {

std::vector<std::string> columns_of(const SphGauge& gauge) {
    const std::string& name = gauge.name;
    switch (gauge.kind) {
        case SphGaugeKind::pressure:
            return {name + " [Pa]"};
        case SphGaugeKind::flux:
            return {name + " [m3/s]", name + ".total [m3]"};
        case SphGaugeKind::force:
            return {name + ".fx [N]", name + ".fy [N]", name + ".fz [N]"};
        case SphGaugeKind::front:
        case SphGaugeKind::water_level:
            break;
    }
    return {name + " [m]"};
}

}  // namespace

GaugeFiles::GaugeFiles(const Case& input, const std::string& folder, FileStart start)
    : gauges_(input.sph.gauge) {
    for (const PlaneWall& plane : input.sph.plane) walls_.push_back(plane.name);
    for (const Body& body : input.sph.body) walls_.push_back(body.name);
    std::map<double, std::vector<std::size_t>> by_interval;
    for (std::size_t k = 0; k < gauges_.size(); ++k) {
        by_interval[gauges_[k].every].push_back(k);
        if (gauges_[k].kind == SphGaugeKind::flux)
            meters_.emplace(gauges_[k].name, FluxMeter(gauges_[k]));
    }
    for (const auto& [every, members] : by_interval) {
        const double interval = every > 0 ? every : input.output.history_every;
        std::vector<std::string> columns{"t [s]"};
        for (const std::size_t k : members)
            for (const std::string& column : columns_of(gauges_[k])) columns.push_back(column);
        const std::string name =
            every > 0 ? fmt::format("/gauges.every_{}s.csv", every) : "/gauges.csv";
        groups_.push_back(
            {HistoryTimes(interval, input.time.end), members,
             std::make_unique<History>(
                 folder + name,
                 std::vector<std::string>{
                     "point gauges of the fluid, unfiltered",
                     "front: foremost particle with a neighbor + dx/2; level: sum V W = 1/2",
                     "flux: mean over h to each side; total: volume of those that went through",
                     "force: of all fluids on the wall, shear included"},
                 columns, start)});
    }
}

std::vector<double> GaugeFiles::read(const SphGauge& gauge, const FluidSystem& fluid,
                                     std::vector<Vec3>& wall_forces) {
    switch (gauge.kind) {
        case SphGaugeKind::front:
            return {front_position(fluid, gauge.direction)};
        case SphGaugeKind::pressure:
            return {interpolate(fluid, gauge.point).p};
        case SphGaugeKind::water_level:
            return {water_level(fluid, gauge.point[0], gauge.point[1])};
        case SphGaugeKind::flux: {
            const FluxMeter& meter = meters_.at(gauge.name);
            return {meter.rate(fluid), meter.total()};
        }
        case SphGaugeKind::force:
            break;
    }
    if (wall_forces.empty()) wall_forces = fluid.wall_forces();
    const std::size_t fluids = fluid.fluids().size();
    const std::size_t wall = std::find(walls_.begin(), walls_.end(), gauge.wall) - walls_.begin();
    std::vector<double> sum(3, 0.0);
    for (std::size_t k = wall * fluids; k < (wall + 1) * fluids; ++k)
        for (int a = 0; a < 3; ++a) sum[a] += wall_forces[k][a];
    return sum;
}

void GaugeFiles::observe(double t, const FluidSystem& fluid) {
    for (auto& [name, meter] : meters_) meter.count(fluid);
    std::vector<Vec3> wall_forces;  // found once, if at all
    for (Group& group : groups_) {
        if (!group.times.due(t)) continue;
        std::vector<double> row{t};
        for (const std::size_t k : group.gauges)
            for (const double value : read(gauges_[k], fluid, wall_forces)) row.push_back(value);
        group.file->row(row);
    }
}

void GaugeFiles::flush() {
    for (Group& group : groups_) group.file->flush();
}

std::vector<std::pair<std::string, double>> GaugeFiles::totals() const {
    std::vector<std::pair<std::string, double>> all;
    for (const auto& [name, meter] : meters_) all.emplace_back(name, meter.total());
    return all;
}

}  // namespace undertow::sph
