#include "fem_solver/history_files.hpp"

#include <algorithm>
#include <cmath>

namespace undertow::fem {
namespace {

std::vector<std::string> columns_of(FemHistoryKind kind) {
    switch (kind) {
        case FemHistoryKind::point:
            return {"t [s]", "ux [m]", "uy [m]", "uz [m]", "vx [m/s]", "vy [m/s]", "vz [m/s]"};
        case FemHistoryKind::set:
            return {"t [s]",    "ux [m]",   "uy [m]", "uz [m]", "vx [m/s]",
                    "vy [m/s]", "vz [m/s]", "rx [N]", "ry [N]", "rz [N]"};
        case FemHistoryKind::section:
            return {"t [s]", "fx [N]", "fy [N]", "fz [N]", "mx [N m]", "my [N m]", "mz [N m]"};
        case FemHistoryKind::contact:
            break;
    }
    return {"t [s]",  "normal [N]", "fx [N]", "fy [N]",   "fz [N]",
            "tx [N]", "ty [N]",     "tz [N]", "touching", "slipping"};
}

std::string note_of(const FemHistory& what, const Structure& structure,
                    const std::vector<std::int32_t>& nodes, std::size_t index) {
    switch (what.kind) {
        case FemHistoryKind::point: {
            const Vec3& at = structure.model().mesh.x[nodes.front()];
            double squared = 0;
            for (int d = 0; d < 3; ++d) squared += std::pow(at[d] - what.point[d], 2);
            char distance[32];
            std::snprintf(distance, sizeof distance, "%.3g", std::sqrt(squared));
            return "displacement and velocity of the node at " + point_text(at) + ", " + distance +
                   " m from the point that was asked for";
        }
        case FemHistoryKind::set:
            return "means over the " + std::to_string(nodes.size()) + " nodes of \"" + what.set +
                   "\", and the force of supports on them";
        case FemHistoryKind::section:
            return "force and moment about " + point_text(what.point) + " of " +
                   (what.set.empty() ? std::string("the side that the normal points to")
                                     : "\"" + what.set + "\"") +
                   " on the rest, through " +
                   std::to_string(structure.model().sections[index].shared_nodes()) +
                   " shared nodes";
        case FemHistoryKind::contact:
            break;
    }
    return "contact \"" + what.contact +
           "\": sum of normal forces, force on its nodes, friction in it, nodes that touch, share "
           "of them that slip";
}

/// Directions that supports hold, each once.
std::vector<std::pair<std::int32_t, int>> held_of(const Model& model,
                                                  const std::vector<std::int32_t>& nodes) {
    std::vector<std::pair<std::int32_t, int>> held;
    for (const Support& support : model.supports)
        for (std::int32_t n : support.nodes)
            for (int d = 0; d < 3; ++d)
                if (support.fixed[d] && std::binary_search(nodes.begin(), nodes.end(), n))
                    held.emplace_back(n, d);
    std::sort(held.begin(), held.end());
    held.erase(std::unique(held.begin(), held.end()), held.end());
    return held;
}

}  // namespace

HistoryFiles::HistoryFiles(const std::string& folder, const Case& c, const Structure& structure,
                           FileStart start) {
    const Model& model = structure.model();
    std::size_t sections = 0;
    for (const FemHistory& what : c.fem.history) {
        std::vector<std::int32_t> nodes;
        std::size_t index = 0;
        if (what.kind == FemHistoryKind::point) nodes = {nearest_node(model.mesh, what.point)};
        if (what.kind == FemHistoryKind::set) nodes = model.mesh.nodes_of(what.set, "fem.history");
        if (what.kind == FemHistoryKind::section) index = sections++;
        if (what.kind == FemHistoryKind::contact)
            while (model.contacts[index].name != what.contact) ++index;
        const std::string note = note_of(what, structure, nodes, index);
        file_.push_back(
            {what, HistoryTimes(what.every > 0 ? what.every : c.output.history_every, c.time.end),
             History(folder + "/fem.history." + what.name + ".csv", {note, "unfiltered"},
                     columns_of(what.kind), start),
             nodes, held_of(model, nodes), index});
    }
}

void HistoryFiles::write(double t, const Structure& structure) {
    for (File& file : file_)
        if (file.times.due(t)) write_row(file, t, structure);
}

bool HistoryFiles::row_due(double t) const {
    return std::any_of(file_.begin(), file_.end(),
                       [&](const File& file) { return file.times.is_due(t); });
}

bool HistoryFiles::section_due(double t) const {
    return std::any_of(file_.begin(), file_.end(), [&](const File& file) {
        return file.what.kind == FemHistoryKind::section && file.times.is_due(t);
    });
}

void HistoryFiles::write_last(double t, const Structure& structure) {
    for (File& file : file_) {
        const bool known =
            file.what.kind != FemHistoryKind::section || structure.sections_are_measured();
        if (file.last != t && known) write_row(file, t, structure);
        file.history.flush();
    }
}

void HistoryFiles::write_row(File& file, double t, const Structure& structure) {
    file.last = t;
    row_ = {t};
    const auto add = [&](const Vec3& v) { row_.insert(row_.end(), v.begin(), v.end()); };
    switch (file.what.kind) {
        case FemHistoryKind::point:
        case FemHistoryKind::set: {
            Vec3 u{}, v{}, r{};
            for (std::int32_t n : file.nodes) {
                const Vec3 of_node = structure.displacement(n), speed = structure.velocity(n);
                for (int d = 0; d < 3; ++d) {
                    u[d] += of_node[d] / double(file.nodes.size());
                    v[d] += speed[d] / double(file.nodes.size());
                }
            }
            add(u);
            add(v);
            if (file.what.kind == FemHistoryKind::point) break;
            const Nodes& nodes = structure.nodes();
            for (const auto& [n, d] : file.held)
                r[d] -= nodes.f[n].c[d] +
                        nodes.mass[n] * nodes.weight_share[n] * structure.model().gravity[d];
            add(r);
            break;
        }
        case FemHistoryKind::section: {
            const Wrench& force = structure.model().sections[file.index].force();
            add(force.force);
            add(force.moment);
            break;
        }
        case FemHistoryKind::contact: {
            const ContactTotals& sum = structure.pairs()[file.index].totals();
            row_.push_back(sum.normal_force);
            add(sum.force);
            add(sum.friction);
            row_.push_back(double(sum.touching));
            row_.push_back(sum.touching > 0 ? double(sum.slipping) / sum.touching : 0.0);
            break;
        }
    }
    file.history.row(row_);
}

}  // namespace undertow::fem
