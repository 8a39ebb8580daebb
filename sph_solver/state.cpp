// What a checkpoint of the fluid holds, class by class: all that steps change. Neighbor lists and
// what was found with them are saved, not found anew: they would come out in another order, or at
// another moment, and sums with them.

#include <string>

#include "checkpoint/archive.hpp"
#include "sph_solver/fluid_system.hpp"
#include "sph_solver/recorder.hpp"

namespace undertow::sph {

namespace {

void archive_sum(Archive& a, const char* name, Summed& sum) {
    if (sum.in_double())
        a.fixed(name, sum.data<double>(), sum.size());
    else
        a.fixed(name, sum.data<float>(), sum.size());
}

void archive_particles(Archive& a, Particles& p) {
    const Archive::Group group(a, "particles");
    static const char* const names[] = {"x",      "y",           "z", "vx", "vy", "vz", "drho",
                                        "energy", "rate_before", "p", "fx", "fy", "fz"};
    a("id", p.id);
    p.resize(p.id.size());
    std::size_t k = 0;
    for (std::vector<double>* values : p.reals()) a(names[k++], *values);
    a("fluid", p.fluid);
    a("viscosity", p.viscosity);
    a("shear_rate", p.shear_rate);
    archive_sum(a, "ax", p.ax);
    archive_sum(a, "ay", p.ay);
    archive_sum(a, "az", p.az);
    archive_sum(a, "drho_dt", p.drho_dt);
}

}  // namespace

void Bodies::archive(Archive& a) {
    a("moved_to", moved_to_);
    a.flat<double>("periods", periods);
    if (a.reading() && moved_to_ >= 0)
        for (RigidBody& b : body)
            if (b.moves()) b.move_to(moved_to_);
    for (const auto& [name, values] : {std::pair("x", &x),
                                       {"y", &y},
                                       {"z", &z},
                                       {"vx", &vx},
                                       {"vy", &vy},
                                       {"vz", &vz},
                                       {"p", &p},
                                       {"viscosity", &viscosity}})
        a(name, *values);
    a("fluid", fluid);
    a("fastest", fastest_);
}

void ColumnGrid::archive(Archive& a) {
    for (const auto& [name, value] : {std::pair("x0", &x0_),
                                      {"y0", &y0_},
                                      {"z0", &z0_},
                                      {"width", &width_},
                                      {"inverse_width", &inverse_width_},
                                      {"inverse_height", &inverse_height_}})
        a(name, *value);
    a("nx", nx_);
    a("ny", ny_);
    a("nz", nz_);
    a("along_y", along_y_);
}

void ClusterLists::archive(Archive& a) {
    a("count", count_);
    a("of_first_kind", of_first_kind_);
    a("part_begin", part_begin_);
    a.rows("stretch", stretch_, [](Stretch& s) { return std::tie(s.first, s.count, s.hidden); });
    a("dropped", dropped_);
    a("cut_pairs", cut_pairs_);
    const auto length = [this](int c) {  // with all its parts
        int n = count_[c];
        for (int k = 1; k < parts(c); ++k) n += stretch_[part_begin_[c] + k - 1].count;
        return n;
    };
    std::vector<int> all;
    if (!a.reading())
        for (int c = 0; c < clusters(); ++c) all.insert(all.end(), begin(c), begin(c) + length(c));
    a("lists", all);
    if (!a.reading()) return;
    all.resize(all.size() + ahead);
    if (buffer_.empty()) buffer_.resize(1);
    buffer_[0] = std::move(all);
    begin_.resize(count_.size());
    int* at = buffer_[0].data();
    for (std::size_t c = 0; c < count_.size(); ++c) {
        begin_[c] = at;
        at += length(static_cast<int>(c));
    }
}

void DriftWatch::Cells::archive(Archive& a) {
    a("first", first);
    a("group", group);
    a("next_first", next_first);
    a("next", next);
    const std::size_t cells = first.empty() ? 0 : first.size() - 1;
    all.resize(cells);  // measured at each look
    fluid.resize(cells);
}

void DriftWatch::archive(Archive& a) {
    a("fluid_count", fluid_count_);
    a("fluid_groups", fluid_groups_);
    a("periodic", periodic_);
    a("unit", unit_);
    a("support", support_);
    a("skin", skin_);
    a("width", width_);
    a.flat<std::int32_t>("start", start_);
    std::int64_t groups = std::int64_t(group_.size());
    a("groups", groups);
    group_.resize(std::size_t(groups));
    a.object("fine", fine_);
    a.object("coarse", coarse_);
    a.rows("approach", approach_, [](Approach& x) { return std::tie(x.cell, x.border, x.room); });
    a.flat<double>("borders", borders_);
}

void SmoothingLengths::archive(Archive& a) {
    a("outgrown", outgrown_);
    a("least", least_);
    a("count", count_);
    a("most_count", most_count_);
    a("ceiling", ceiling_);
    a("capped", capped_);
}

void Neighborhood::archive(Archive& a) {
    a("support", support_);
    a("skin", skin_);
    a("goes", goes_);
    a("lo", lo_);
    a("hi", hi_);
    a.object("grid", grid_);
    a.flat<double>("fixed", fixed_);
    a("fluid_count", fluid_count_);
    a.rows("extras", extras_, [](Extra& e) { return std::tie(e.source, e.mask, e.from_body); });
    a.flat<std::int32_t>("records", records_);
    a.flat<double>("exact_records", exact_.records);
    a("exact_root_viscosity", exact_.root_viscosity);
    a("exact_smoothing", exact_.smoothing);
    a("exact_gradient_correction", exact_.gradient_correction);
    a("fluid_start", fluid_start_);
    a("extra_start", extra_start_);
    a("body_targets", body_targets_);
    a.object("fluid_lists", fluid_lists_);
    if (a.reading()) marked_.lay_out(fluid_lists_);  // the sums of a step begin by marking
    a.object("body_lists", body_lists_);
    a.flat<FluidBits>("fluids", fluids_);
    a("root_viscosity", root_viscosity_);
    a("smoothing", smoothing_);
    a("listed", listed_);
    a.flat<std::uint8_t>("depth", depth_);
    a("gradient_correction", gradient_correction_);
    a.object("watch", watch_);
}

void NearWalls::archive(Archive& a) {
    const auto rubbing = [](Rubbing& r) { return std::tie(r.particle, r.wall, r.foot, r.away); };
    a.flat<double>("stress", stress_);
    a.flat<double>("coulomb", coulomb_);
    a.rows("rubbing", rubbing_, rubbing);
    a("share", share_);
    a("plane_shares", plane_shares_);
    a.rows("near", near_, rubbing);
    a("safe_until", safe_until_);
}

void Openings::archive(Archive& a) {
    for (std::size_t k = 0; k < openings_.size(); ++k)
        a.rows("passed/" + std::to_string(k), openings_[k].passed,
               [](Passed& p) { return std::tie(p.particles, p.momentum); });
    a.rows("members", members_, [](Member& m) {
        return std::tie(m.id, m.opening, m.index, m.u_ref, m.p_ref, m.p_inside, m.u_inside, m.next);
    });
    a("role", role_);
    a("near_begin", near_begin_);
    a("near", near_);
    a("put_back", put_back_);
}

void AbsorbingLayers::archive(Archive& a) {
    a.rows("members", members_, [](Member& m) { return std::tie(m.particle, m.layer); });
    a.flat<double>("slow", slow_);
    a("inside", inside_);
}

void SurfaceImages::archive(Archive& a) {
    a("quad", quad_);
    a("x", x_);
    a("placed", placed_);
    a("flat", flat_);
    a.rows("near", near_, [](Near& k) {
        return std::tie(k.particle, k.corner, k.weight_of, k.point, k.normal, k.facet, k.share, k.touches, k.distance,
                        k.backing, k.wall_speed, k.mass, k.per_mass, k.volume, k.density, k.weight,
                        k.rate, k.a, k.push);
    });
    a("slot", slot_);
    a.rows("pairs", pairs_, [](Pair& p) { return std::tie(p.a, p.b, p.record, p.n, p.lean); });
    a("block_begin", block_begin_);
    a("expected", expected_);
    a.rows("lift", lift_, [](Lift& l) { return std::tie(l.e, l.rate, l.listed); });
    a("lifted", lifted_);
    a("spacing", spacing_);
    a("stale", stale_);
}

void ThinPlates::archive(Archive& a) {
    a("quad", quad_);
    a("last_x", last_x_);
    a("support", support_);
    a("spacing", spacing_);
    a("thin", thin_);
    a("rim", rim_);
    a.rows("facet", facet_, [](Facet& f) { return std::tie(f.x, f.corners, f.rim); });
    if (a.reading()) fill_cells();
}

template <class Real>
void ImplicitUpdate<Real>::archive(Archive& a) {
    a.flat<Real>("before", before_);
    a("steps", figures_.steps);
    a("iterations", figures_.iterations);
    a("most_iterations", figures_.most_iterations);
    a("not_converged", figures_.not_converged);
    a("worst_residual", figures_.worst_residual);
}
template void ImplicitUpdate<float>::archive(Archive&);
template void ImplicitUpdate<double>::archive(Archive&);

void FluidSystem::archive(Archive& a) {
    archive_particles(a, particles);
    a.object("bodies", bodies);
    a.object("neighbors", neighbors_);
    a.object("sizes", sizes_);
    a.object("near_walls", near_walls_);
    a.object("openings", openings_);
    a.object("absorbing", absorbing_);
    a.object("surface", surface_);
    a.object("plates", plates_);
    a("cut_anew", cut_anew_);
    if (implicit_) a.object("implicit", *implicit_);
    a("heating", heating_);
    a.rows("near_planes", near_planes_, [](NearPlane& n) { return std::tie(n.particle, n.plane); });
    a("packed", packed_);
    a("shift/ux", shift_.ux);
    a("shift/uy", shift_.uy);
    a("shift/uz", shift_.uz);
    a("shift/rate", shift_.rate);
    a("shift/fastest", shift_.fastest);
    a.flat<double>("reflected", reflected_);
    a("bodies_reach", bodies_reach_);
    a("bodies_travelled", bodies_travelled_);
    a("index", index_);
    a("list_age", list_age_);
    a("reach", reach_);
    a("travelled", travelled_);
    a("shear_rate_age", shear_rate_age_);
    a("fastest", fastest_);
    a.rows("removed", removed_,
           [](Removed& r) { return std::tie(r.id, r.fluid, r.volume, r.x, r.v, r.face); });
    for (int face = 0; face < 6; ++face)
        for (std::size_t k = 0; k < physics_.fluids.size(); ++k) {
            const Archive::Group group(
                a, "departed/" + std::to_string(face) + "/" + std::to_string(k));
            a("particles", departed_[face][k].particles);
            a("momentum", departed_[face][k].momentum);
        }
    a("put_back", put_back_);
    a("rebuilds", rebuilds_);
    if (!a.reading()) return;
    const FixedPoint& fixed = neighbors_.fixed();
    const double origin[3] = {fixed.x0, fixed.y0, fixed.z0};
    mirror_.to_fixed(origin, fixed.unit, fixed_reflections_);
    no_slip_.find(neighbors_, mirror_, physics_.fluids, particles);
    if (!no_slip_.empty()) no_slip_.pack(neighbors_, mirror_);
}

void FluxMeter::archive(Archive& a) {
    a("total", total_);
    a("side", side_);
}

void GaugeFiles::archive(Archive& a, double t) {
    for (auto& [name, meter] : meters_) a.object("meters/" + name, meter);
    for (std::size_t k = 0; k < groups_.size(); ++k) {
        const Archive::Group group(a, "files/" + std::to_string(k));
        groups_[k].times.archive(a, t);
        a.object("rows", *groups_[k].file);
    }
}

void LossReport::archive(Archive& a) {
    a("seen", seen_);
    for (int face = 0; face < 6; ++face) a("said/" + std::to_string(face), said_[face]);
    a("said_put_back", said_put_back_);
}

void Recorder::archive(Archive& a, double t) {
    {
        const Archive::Group group(a, "row_times");
        row_times_.archive(a, t);
    }
    {
        const Archive::Group group(a, "gauges");
        gauges_.archive(a, t);
    }
    a.object("fields", fields_);
    if (force_file_) a.object("forces", *force_file_);
    a.object("energy", energy_file_);
    a("impulse", impulse_);
    a("last_force_t", last_force_t_);
    a("last_force", last_force_);
    a("largest_force", largest_force_);
    a("wall_force", wall_force_);
    a("last_fields", last_fields_);
    a.object("losses", losses_);
}

void RunFigures::archive(Archive& a) {
    for (const auto& [name, value] : {std::pair("neighbors", &neighbors),
                                      {"pack", &pack},
                                      {"sums", &sums},
                                      {"viscosity", &viscosity},
                                      {"contact_wait", &contact_wait},
                                      {"move", &move},
                                      {"output", &output},
                                      {"wall", &wall},
                                      {"particle_steps", &particle_steps},
                                      {"dt_min", &dt_min},
                                      {"dt_sum", &dt_sum},
                                      {"max_compression", &max_compression},
                                      {"max_speed", &max_speed}})
        a(name, *value);
    a("steps", steps);
    a("two_pass_steps", two_pass_steps);
    a.object("checkpoints", checkpoints);
}

}  // namespace undertow::sph
