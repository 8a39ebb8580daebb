#include "sph_solver/neighbors/drift_watch.hpp"

#include <algorithm>
#include <cmath>

#include "sph_solver/simd.hpp"

namespace undertow::sph {

namespace {

// B = R + skin + this share of R: narrow cells tell neighbors from others well, wide ones let the
// scene spread further before the coarse cells are asked.
constexpr double slack = 0.3;

}  // namespace

DriftWatch::int4 DriftWatch::load(const Packed& q) {
    int4 a;
    __builtin_memcpy(&a, &q, sizeof a);
    return a;
}

DriftWatch::Spread DriftWatch::nothing() {
    constexpr std::int32_t most = 1 << 30;  // so that differences do not overflow
    return {int4{most, most, most, most}, int4{-most, -most, -most, -most}};
}

void DriftWatch::widen(Spread& s, const Spread& by) {
    s.lo = by.lo < s.lo ? by.lo : s.lo;
    s.hi = by.hi > s.hi ? by.hi : s.hi;
}

/// Largest |d_a - d_b| of a displacement in one box and one in the other, squared; 0 if one is
/// empty.
double DriftWatch::apart(const Spread& a, const Spread& b) {
    double sum = 0;
    for (int k = 0; k < 3; ++k) {
        const double most = std::max(double(a.hi[k]) - b.lo[k], double(b.hi[k]) - a.lo[k]);
        sum += most > 0 ? most * most : 0;
    }
    return sum;
}

/// Makes cells of the places, in the order of their keys: which items each holds, and which cells
/// touch it. A place's key is (iz n[1] + iy) n[0] + ix; n: number of cells along each axis.
void DriftWatch::link(Cells& cells, const std::int64_t n[3]) {
    place_.erase(std::unique(place_.begin(), place_.end(),
                             [](const Place& a, const Place& b) {
                                 return a.key == b.key && a.item == b.item;
                             }),
                 place_.end());
    const std::int64_t all = n[0] * n[1] * n[2];
    count_.assign(all + 1, 0);
    for (const Place& p : place_) ++count_[p.key + 1];
    cell_.assign(all, -1);
    key_.clear();
    cells.first.clear();
    for (std::int64_t key = 0; key < all; ++key) {
        if (count_[key + 1] > 0) {
            cell_[key] = static_cast<int>(key_.size());
            key_.push_back(key);
            cells.first.push_back(count_[key]);
        }
        count_[key + 1] += count_[key];
    }
    cells.first.push_back(static_cast<int>(place_.size()));
    cells.group.resize(place_.size());
    for (const Place& p : place_) cells.group[count_[p.key]++] = p.item;
    cells.next_first.assign(1, 0);
    cells.next.clear();
    for (const std::int64_t own : key_) {
        const std::int64_t at[3] = {own % n[0], own / n[0] % n[1], own / n[0] / n[1]};
        std::int64_t from[3], to[3];
        for (int a = 0; a < 3; ++a)
            from[a] = std::max<std::int64_t>(0, at[a] - 1), to[a] = std::min(n[a] - 1, at[a] + 1);
        for (std::int64_t z = from[2]; z <= to[2]; ++z)
            for (std::int64_t y = from[1]; y <= to[1]; ++y)
                for (std::int64_t x = from[0]; x <= to[0]; ++x) {
                    const int cell = cell_[(z * n[1] + y) * n[0] + x];
                    if (cell >= 0) cells.next.push_back(cell);
                }
        cells.next_first.push_back(static_cast<int>(cells.next.size()));
    }
    cells.all.resize(key_.size());
    cells.fluid.resize(key_.size());
}

double DriftWatch::width(double support, double skin) {
    return skin + (1 + slack) * support;
}

void DriftWatch::start(const std::vector<Packed>& records, int fluid_count, const FixedPoint& fixed,
                       double support, double skin, const std::vector<Border>& borders,
                       double range, bool periodic) {
    const int n = static_cast<int>(records.size());
    fluid_count_ = fluid_count;
    fluid_groups_ = (fluid_count + lanes - 1) / lanes;
    const int groups = fluid_groups_ + (n - fluid_count + lanes - 1) / lanes;
    unit_ = fixed.unit, support_ = support, skin_ = skin, periodic_ = periodic;
    width_ = width(support, skin);
    borders_ = borders;
    start_.resize(n);
    group_.resize(groups);
    std::int32_t least[3] = {1 << 30, 1 << 30, 1 << 30}, most[3] = {-1 << 30, -1 << 30, -1 << 30};
    for (int i = 0; i < n; ++i) {
        start_[i] = load(records[i]);
        for (int a = 0; a < 3; ++a) {
            least[a] = std::min(least[a], start_[i][a]);
            most[a] = std::max(most[a], start_[i][a]);
        }
    }
    // a few particles thrown far must not cost memory: wider cells judge as well
    std::int64_t cells[3], coarse[3];
    for (;; width_ *= 1.26) {
        for (int a = 0; a < 3; ++a) {
            cells[a] = n ? 1 + std::int64_t((double(most[a]) - least[a]) * (unit_ / width_)) : 1;
            coarse[a] = (cells[a] + 1) / 2;
        }
        if (double(cells[0]) * double(cells[1]) * double(cells[2]) < n + 4096.0) break;
    }
    const double per_width = unit_ / width_;
    const auto key_of = [&](int i) {
        std::int64_t at[3];
        for (int a = 0; a < 3; ++a)
            at[a] = std::int64_t((double(start_[i][a]) - least[a]) * per_width);
        return (at[2] * cells[1] + at[1]) * cells[0] + at[0];
    };
    // Members of a group that stand in different cells give their box to all of these.
    place_.clear();
    for (int g = 0; g < groups; ++g) {
        const int first = g < fluid_groups_ ? g * lanes : fluid_count + (g - fluid_groups_) * lanes;
        const int last = std::min(first + lanes, g < fluid_groups_ ? fluid_count : n);
        std::int64_t before = -1;
        for (int i = first; i < last; ++i) {
            const std::int64_t key = key_of(i);
            if (key != before) place_.push_back({key, g});
            before = key;
        }
    }
    link(fine_, cells);

    find_approaches(records, fixed, range);

    place_.clear();
    for (int c = 0; c < fine_.size(); ++c) {
        const std::int64_t own = key_[c], at[3] = {own % cells[0], own / cells[0] % cells[1],
                                                   own / cells[0] / cells[1]};
        place_.push_back({(at[2] / 2 * coarse[1] + at[1] / 2) * coarse[0] + at[0] / 2, c});
    }
    link(coarse_, coarse);
}

/// How far the particles that lack a border's record stand from where they would need it.
void DriftWatch::find_approaches(const std::vector<Packed>& records, const FixedPoint& fixed,
                                 double range) {
    approach_.clear();
    const int cells = fine_.size(), borders = static_cast<int>(borders_.size());
    room_.assign(std::size_t(cells) * borders, 1e300);
#pragma omp parallel for schedule(static)
    for (int c = 0; c < cells; ++c)
        for (int k = fine_.first[c]; k < fine_.first[c + 1]; ++k) {
            const int g = fine_.group[k];
            if (g >= fluid_groups_) continue;
            for (int i = g * lanes; i < std::min((g + 1) * lanes, fluid_count_); ++i) {
                const Vec3 x = {fixed.x0 + records[i].x * unit_, fixed.y0 + records[i].y * unit_,
                                fixed.z0 + records[i].z * unit_};
                for (int b = 0; b < borders; ++b) {
                    const Border& border = borders_[b];
                    double distance = 0;
                    for (int a = 0; a < 3; ++a)
                        distance += (x[a] - border.point[a]) * border.normal[a];
                    double& room = room_[std::size_t(c) * borders + b];
                    if (distance >= range) room = std::min(room, distance - support_);
                }
            }
        }
    for (int c = 0; c < cells; ++c)
        for (int b = 0; b < borders; ++b)
            if (const double room = room_[std::size_t(c) * borders + b]; room < 3 * support_)
                approach_.push_back({c, b, room});
}

/// Boxes of the groups and of the fine cells.
void DriftWatch::measure(const std::vector<Packed>& records) {
    const int n = static_cast<int>(start_.size()), groups = static_cast<int>(group_.size()),
              cells = fine_.size();
#pragma omp parallel
    {
#pragma omp for schedule(static)
        for (int g = 0; g < groups; ++g) {
            const bool fluid = g < fluid_groups_;
            const int first = fluid ? g * lanes : fluid_count_ + (g - fluid_groups_) * lanes;
            const int last = std::min(first + lanes, fluid ? fluid_count_ : n);
            Spread s = nothing();
            for (int i = first; i < last; ++i) {
                const int4 d = load(records[i]) - start_[i];
                widen(s, {d, d});
            }
            group_[g] = s;
        }
#pragma omp for schedule(static)
        for (int c = 0; c < cells; ++c) {
            Spread all = nothing(), fluid = nothing();
            for (int k = fine_.first[c]; k < fine_.first[c + 1]; ++k) {
                const int g = fine_.group[k];
                widen(all, group_[g]);
                if (g < fluid_groups_) widen(fluid, group_[g]);
            }
            fine_.all[c] = all, fine_.fluid[c] = fluid;
        }
    }
}

/// True if two members of touching cells may have moved against each other by more than limit [m].
bool DriftWatch::neighbors_apart(const Cells& cells, double limit) const {
    const double limit2 = limit / unit_ * (limit / unit_);
    int apart_somewhere = 0;
#pragma omp parallel for schedule(static) reduction(| : apart_somewhere)
    for (int c = 0; c < cells.size(); ++c) {
        const Spread& own = cells.fluid[c];
        if (own.lo[0] > own.hi[0]) continue;  // no fluid
        for (int k = cells.next_first[c]; k < cells.next_first[c + 1]; ++k)
            apart_somewhere |= apart(own, cells.all[cells.next[k]]) > limit2;
    }
    return apart_somewhere != 0;
}

bool DriftWatch::worn(const std::vector<Packed>& records) {
    measure(records);
    if (neighbors_apart(fine_, skin_)) return true;
    for (const Approach& a : approach_) {
        const Spread& s = fine_.fluid[a.cell];
        const Vec3& n = borders_[a.border].normal;
        double least = 0;  // along the normal [m]
        for (int k = 0; k < 3; ++k) least += std::min(n[k] * s.lo[k], n[k] * s.hi[k]) * unit_;
        if (-least > a.room) return true;
    }
    const auto within = [&](double limit, const Spread& all, const Spread& fluid) {
        return apart(fluid, all) <= limit / unit_ * (limit / unit_);
    };
    Spread all = nothing(), fluid = nothing();
    for (int c = 0; c < fine_.size(); ++c) widen(all, fine_.all[c]), widen(fluid, fine_.fluid[c]);
    if (within(width(support_, skin_) - support_, all, fluid)) return false;
    if (periodic_) return true;
    for (int c = 0; c < coarse_.size(); ++c) {
        Spread a = nothing(), f = nothing();
        for (int k = coarse_.first[c]; k < coarse_.first[c + 1]; ++k) {
            widen(a, fine_.all[coarse_.group[k]]);
            widen(f, fine_.fluid[coarse_.group[k]]);
        }
        coarse_.all[c] = a, coarse_.fluid[c] = f;
    }
    return neighbors_apart(coarse_, width_ - support_) ||
           !within(2 * width_ - support_, all, fluid);
}

}  // namespace undertow::sph
