#pragma once
// Reports of eight elements at a time, summed and reduced over a chunk.

#include "fem_solver/elements/element_group.hpp"
#include "fem_solver/elements/element_law.hpp"

namespace undertow::fem {

/// Sums and extremes of a chunk, lane by lane.
struct LaneReport {
    Lanes strain_work = {}, hourglass_work = {}, viscous_work = {};
    Lanes omega2 = {}, stiffening = {}, compression = {};
    Lanes relative_volume = 1.0 - Lanes{};
    Lanes plastic_work = {}, yielding = {};
};

UNDERTOW_KERNEL Lanes first_lanes(const Lanes& a, int n) {
    Lanes out = {};
    for (int l = 0; l < n; ++l) out[l] = a[l];
    return out;
}

UNDERTOW_KERNEL void collect(LaneReport& sum, const ElementReport<Lanes>& r,
                             const Lanes& omega2_reference, int valid) {
    if (valid == n_lanes) {
        sum.strain_work += r.strain_work;
        sum.hourglass_work += r.hourglass_work;
        sum.viscous_work += r.viscous_work;
    } else {  // padding repeats an element: its energy counts once
        sum.strain_work += first_lanes(r.strain_work, valid);
        sum.hourglass_work += first_lanes(r.hourglass_work, valid);
        sum.viscous_work += first_lanes(r.viscous_work, valid);
    }
    sum.omega2 = larger(r.omega2, sum.omega2);
    sum.stiffening = larger(Lanes(r.omega2 / omega2_reference), sum.stiffening);
    sum.compression = larger(r.compression, sum.compression);
    sum.relative_volume = smaller(r.relative_volume, sum.relative_volume);
}

UNDERTOW_KERNEL void collect_flow(LaneReport& sum, const ElementReport<Lanes>& r, int valid) {
    sum.plastic_work += valid == n_lanes ? r.plastic_work : first_lanes(r.plastic_work, valid);
    sum.yielding += valid == n_lanes ? r.yielding : first_lanes(r.yielding, valid);
}

inline ElementsReport reduce(const LaneReport& sum) {
    return {sum_lanes(sum.strain_work),    sum_lanes(sum.hourglass_work),
            sum_lanes(sum.viscous_work),   largest_lane(sum.omega2),
            largest_lane(sum.stiffening),  smallest_lane(sum.relative_volume),
            largest_lane(sum.compression), sum_lanes(sum.plastic_work),
            sum_lanes(sum.yielding)};
}

}  // namespace undertow::fem
