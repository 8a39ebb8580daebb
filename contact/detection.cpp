#include "contact/detection.hpp"

#include <omp.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <utility>

#include "contact/facet_lanes.hpp"
#include "contact/select_contacts.hpp"

namespace undertow::contact {

namespace {

// Particles whose pairs are listed together: their feet stay in the nearest cache.
constexpr std::size_t block = 64;

/// Largest size of f(i) over i < n, where at(i) gives eight of them; a plain loop with max stays
/// scalar as long as NaN must remain visible.
template <typename Eight, typename One>
double largest_of(std::size_t n, Eight eight, One one) {
    Lanes most{};
    std::size_t i = 0;
    for (; i + 8 <= n; i += 8) {
        const Lanes value = eight(i), size = value < 0 ? -value : value;
        most = size > most ? size : most;
    }
    double largest = 0;
    for (int lane = 0; lane < 8; ++lane) largest = std::max(largest, most[lane]);
    for (; i < n; ++i) largest = std::max(largest, std::abs(one(i)));
    return largest;
}

/// Largest size of a component.
double largest_size(std::span<const double> a) {
    return largest_of(
        a.size(), [&](std::size_t i) { return load(&a[i]); }, [&](std::size_t i) { return a[i]; });
}

/// Largest size of a component of a - b; arrays of equal length.
double largest_change(std::span<const double> a, std::span<const double> b) {
    return largest_of(
        a.size(), [&](std::size_t i) { return load(&a[i]) - load(&b[i]); },
        [&](std::size_t i) { return a[i] - b[i]; });
}

constexpr double per_component = 1.7320508075688772;  // a vector is no longer than this times its
                                                      // largest component
// A particle is looked at anew when it has moved by this share of l0: looking costs all candidates,
// not looking those that might have come near. Flat between 0.15 and 0.6 (bench_contact_cost).
constexpr double look_again = 0.3;
constexpr double float_margin = 1e-6;

/// [1/s] Largest speed of approach of a particle to its candidates, over its radius.
double approach_rate(const Points& active, const Surface& surface, std::size_t i,
                     std::span<const std::uint32_t> facets) {
    const Vec x = Vec::Map(&active.x[3 * i]), v = Vec::Map(&active.v[3 * i]);
    double fastest = 0;
    for (std::uint32_t facet : facets) {
        const FacetPlane plane = surface.plane(facet);
        const double closing = plane.normal.dot(plane.velocity - v);
        fastest = std::max(fastest, plane.normal.dot(x - plane.center) < 0 ? -closing : closing);
    }
    return fastest / active.radius[i];
}

}  // namespace

/// Eight contacts as they are chosen; what a pack is made of.
struct Detector::Work {
    std::vector<std::int32_t> particle, facet;  // per pair
    std::vector<std::uint32_t> entry;           // per pair: its place among the candidates
    std::vector<LaneFeet> feet;                 // eight pairs each
    std::size_t pairs = 0;
    struct Seen {
        std::uint32_t particle, first_pair;
        bool closely;
    };
    std::array<Seen, block + 1> seen;  // particles that have pairs, and who would come next
    int seen_count = 0;

    TouchList touches;
    ContactPack staged;
    Three<Lanes> offset, plane_normal;
    Lanes distance, sign;
    int staged_count = 0;
    ContactList contacts;

    void reserve(std::size_t most_pairs) {
        const std::size_t batches = most_pairs / lane_count + 1;
        if (feet.size() >= batches) return;
        feet.resize(batches);
        // keep_up_to() writes whole registers.
        for (auto* rows : {&particle, &facet}) rows->resize((batches + 2) * lane_count);
        entry.resize((batches + 2) * lane_count);
    }
    void find_feet(const Points& active, const Surface& surface);
    Touch touch(const Surface& surface, std::uint32_t pair) const;
    bool choose_quickly(const Points& active, const Surface& surface, double reach, bool had_side,
                        const Seen& seen, std::uint32_t end, std::int64_t& chosen) const;
    /// Adds a contact; `pair` is where its foot is.
    void stage(const Foot& foot, std::uint32_t particle, std::uint32_t facet, double sign);
    void stage(std::uint32_t pair);
    void finish_staged(const Points& active, const Surface& surface);
};

/// Closest points of all pairs; lanes beyond the last repeat it.
void Detector::Work::find_feet(const Points& active, const Surface& surface) {
    if (pairs == 0) return;
    for (std::size_t p = pairs; p % lane_count != 0; ++p) {
        particle[p] = particle[pairs - 1];
        facet[p] = facet[pairs - 1];
    }
    for (std::size_t p = 0; p < pairs; p += lane_count) {
        // What later ones need is fetched while these are computed.
        if (const std::size_t later = p + 2 * lane_count; later < pairs)
            fetch_nodes(surface, std::span(facet).subspan(later, lane_count));
        feet[p / lane_count] = closest_points(
            gather_three(active.x.data(), load_rows(&particle[p])), surface, load_rows(&facet[p]));
    }
}

Touch Detector::Work::touch(const Surface& surface, std::uint32_t pair) const {
    const LaneFeet& f = feet[pair / lane_count];
    const int lane = int(pair % lane_count);
    Touch touch;
    touch.facet = std::uint32_t(facet[pair]);
    touch.foot = {{f.weight[0][lane], f.weight[1][lane], f.weight[2][lane], f.weight[3][lane]},
                  {f.offset.x[lane], f.offset.y[lane], f.offset.z[lane]},
                  {f.normal.x[lane], f.normal.y[lane], f.normal.z[lane]},
                  f.distance[lane],
                  std::uint8_t(f.rim[lane])};
    touch.side = f.side[lane];
    touch.free_rim = surface.is_free_rim(touch.facet, touch.foot.rim);
    return touch;
}

/// The common case without lists: the nearest foot lies inside a facet that sees the particle from
/// the wet side, and all other feet within reach are on edges and corners of that facet, hence no
/// minima. `chosen` becomes its pair, or -1 for no contact. False: not so simple.
bool Detector::Work::choose_quickly(const Points& active, const Surface& surface, double reach,
                                    bool had_side, const Seen& it, std::uint32_t end,
                                    std::int64_t& chosen) const {
    chosen = -1;
    double least = std::numeric_limits<double>::infinity();
    int within = 0;
    for (std::uint32_t p = it.first_pair; p < end; ++p) {
        const double distance = feet[p / lane_count].distance[p % lane_count];
        if (distance > reach) continue;
        ++within;
        if (!(distance < least)) continue;
        least = distance;
        chosen = p;
    }
    if (within == 0) return true;
    if (chosen < 0) return false;
    const LaneFeet& nearest = feet[std::size_t(chosen) / lane_count];
    const int lane = int(chosen % lane_count);
    if (nearest.rim[lane] != 0 || !(nearest.side[lane] >= 0)) return false;
    const double l0 = active.radius[it.particle];
    const std::int32_t* corners = surface.corners(std::uint32_t(facet[chosen]));
    for (std::uint32_t p = it.first_pair; within > 1 && p < end; ++p) {
        const LaneFeet& other = feet[p / lane_count];
        const int its = int(p % lane_count);
        const double distance = other.distance[its];
        if (distance > reach || p == std::uint32_t(chosen)) continue;
        if (!(distance > least + same_point * l0)) return false;
        if (had_side && !(other.side[its] >= 0)) return false;
        if (distance >= l0) continue;
        const int rim = int(other.rim[its]);
        if (rim == 0) return false;
        const std::int32_t* theirs = surface.corners(std::uint32_t(facet[p]));
        for (int k = 0; k < 4; ++k)
            if (rim >> k & 1 && theirs[k] != corners[0] && theirs[k] != corners[1] &&
                theirs[k] != corners[2] && theirs[k] != corners[3])
                return false;
    }
    if (!(least < l0)) chosen = -1;
    return true;
}

void Detector::Work::stage(const Foot& foot, std::uint32_t i, std::uint32_t f, double its_sign) {
    const int lane = staged_count++;
    staged.particle[lane] = std::int32_t(i);
    staged.facet[lane] = std::int32_t(f);
    for (int a = 0; a < 4; ++a) staged.weight[a][lane] = foot.weight[a];
    offset.x[lane] = foot.offset[0], offset.y[lane] = foot.offset[1];
    offset.z[lane] = foot.offset[2];
    plane_normal.x[lane] = foot.normal[0], plane_normal.y[lane] = foot.normal[1];
    plane_normal.z[lane] = foot.normal[2];
    distance[lane] = foot.distance;
    sign[lane] = its_sign;
}

void Detector::Work::stage(std::uint32_t pair) {
    const LaneFeet& foot = feet[pair / lane_count];
    const int from = int(pair % lane_count), lane = staged_count++;
    staged.particle[lane] = particle[pair];
    staged.facet[lane] = facet[pair];
    for (int a = 0; a < 4; ++a) staged.weight[a][lane] = foot.weight[a][from];
    offset.x[lane] = foot.offset.x[from], offset.y[lane] = foot.offset.y[from];
    offset.z[lane] = foot.offset.z[from];
    plane_normal.x[lane] = foot.normal.x[from], plane_normal.y[lane] = foot.normal.y[from];
    plane_normal.z[lane] = foot.normal.z[from];
    distance[lane] = foot.distance[from];
    sign[lane] = 1;
}

/// Turns what is staged into contacts.
void Detector::Work::finish_staged(const Points& active, const Surface& surface) {
    if (staged_count == 0) return;
    for (int lane = staged_count; lane < lane_count; ++lane) {  // the last one again
        const int last = staged_count - 1;
        staged.particle[lane] = staged.particle[last];
        staged.facet[lane] = staged.facet[last];
        for (int a = 0; a < 4; ++a) staged.weight[a][lane] = staged.weight[a][last];
        for (Three<Lanes>* v : {&offset, &plane_normal})
            for (Lanes* lanes : {&v->x, &v->y, &v->z}) (*lanes)[lane] = (*lanes)[last];
        distance[lane] = distance[last];
        sign[lane] = sign[last];
    }
    const LaneCorners corners = corners_of(surface, staged.facet);
    for (int a = 0; a < 4; ++a) staged.node[a] = corners.node[a];
    const Lanes l0 = gather(active.radius.data(), staged.particle);
    const Three<Lanes> x = gather_three(active.x.data(), staged.particle);
    staged.point = x - offset;
    staged.normal = contact_normal(offset, distance, sign, plane_normal, l0);
    staged.depth = l0 - sign * distance;
    const Three<Lanes> relative = relative_velocity(gather_three(active.v.data(), staged.particle),
                                                    surface, staged.node, staged.weight);
    const Lanes along = dot(relative, staged.normal);
    staged.closing = -along;
    staged.slip = relative - along * staged.normal;
    staged.stiffness = staged.normal_force = staged.damping_force = staged.drag = spread<Lanes>(0);
    contacts.append(staged, staged_count);
    fetch_pack(contacts, contacts.packs() + 1);
    staged_count = 0;
}

Detector::Detector(DetectionRules rules, int threads)
    : rules_(rules), threads_(std::max(1, threads)) {
    for (int thread = 0; thread < threads_; ++thread) work_.push_back(std::make_unique<Work>());
}
Detector::Detector(Detector&&) noexcept = default;
Detector::~Detector() = default;

void Detector::renew(const Points& active, const Surface& surface, const CandidateList& candidates,
                     std::span<const std::int64_t> old_row) {
    next_side_facet_.assign(active.size(), no_facet);
    next_side_weight_.resize(active.size());
    for (std::size_t i = 0; i < active.size(); ++i) {
        if (old_row[i] < 0 || std::size_t(old_row[i]) >= side_facet_.size()) continue;
        next_side_facet_[i] = side_facet_[old_row[i]];
        next_side_weight_[i] = side_weight_[old_row[i]];
    }
    side_facet_.swap(next_side_facet_);
    side_weight_.swap(next_side_weight_);
    x_nodes_.assign(surface.x().begin(), surface.x().end());
    travel_ = 0;
    distance_.assign(candidates.distance.begin(), candidates.distance.end());
    look_x_.assign(active.x.begin(), active.x.end());
    look_travel_.assign(active.size(), 0);
    look_nearest_.resize(active.size());
    for (std::size_t i = 0; i < active.size(); ++i)
        look_nearest_[i] = *std::min_element(distance_.begin() + candidates.start[i],
                                             distance_.begin() + candidates.start[i + 1]);
}

/// How far the surface may have moved since the last step, and how fast it is.
void Detector::follow(const Surface& surface) {
    travel_ += per_component * largest_change(surface.x(), x_nodes_);
    std::copy(surface.x().begin(), surface.x().end(), x_nodes_.begin());
    node_speed_ = per_component * largest_size(surface.v());
}

/// Asks for what find_pairs() will read of eight particles: fifteen streams are more than the
/// machine follows by itself. g++ leaves out calls of a function that only fetches, unless it is
/// inlined.
[[gnu::always_inline]] inline void Detector::fetch_ahead(const Points& active,
                                                         const CandidateList& candidates,
                                                         std::size_t first) const {
    if (first + lane_count > active.size()) return;
    constexpr std::size_t line = 8;  // numbers
    for (const double* rows : {active.x.data(), active.v.data(), look_x_.data()})
        for (std::size_t at = 0; at < 3 * lane_count; at += line)
            __builtin_prefetch(rows + 3 * first + at);
    for (const double* numbers :
         {active.radius.data(), look_travel_.data(), look_nearest_.data()})
        __builtin_prefetch(numbers + first);
    __builtin_prefetch(&side_facet_[first], 1);
    for (std::size_t i = first; i < first + lane_count; i += 2)
        __builtin_prefetch(&side_weight_[i], 1);
    for (std::size_t e = candidates.start[first]; e < candidates.start[first + lane_count];
         e += 2 * line) {
        __builtin_prefetch(&candidates.facet[e]);
        __builtin_prefetch(&distance_[e]);
    }
}

/// Lists the pairs of a block that cannot be excluded. Returns the largest approach rate [1/s] of
/// those who are fast enough to be asked.
double Detector::find_pairs(const Points& active, const Surface& surface,
                            const CandidateList& candidates, double longest_dt, std::size_t first,
                            std::size_t last, Work& work) {
    double fastest = 0;
    work.pairs = 0;
    work.seen_count = 0;
    const double behind = std::max(1.0, rules_.behind);
    for (std::size_t i = first; i < last; i += lane_count) {
        LaneRows row;
        for (int lane = 0; lane < lane_count; ++lane)
            row[lane] = std::int32_t(std::min(i + std::size_t(lane), last - 1));
        const LaneMask here = first_lanes(int(std::min<std::size_t>(lane_count, last - i)));
        fetch_ahead(active, candidates, i + block);
        const auto three = [&](const double* rows) {
            return i + lane_count <= last ? load_three(rows, i) : gather_three(rows, row);
        };
        const Three<Lanes> x = three(active.x.data()), v = three(active.v.data()),
                           from = three(std::as_const(look_x_).data());
        const Lanes l0 = gather(active.radius.data(), row), reach = behind * l0;
        const LaneMask slow = at_most((norm(v) + node_speed_) * longest_dt, rules_.step_share * l0);
        if (const LaneMask asked = without(here, slow); any(asked))
            for (int lane = 0; lane < lane_count; ++lane)
                if (asked[lane])
                    fastest = std::max(
                        fastest,
                        approach_rate(active, surface, i + std::size_t(lane),
                                      {candidates.facet.data() + candidates.start[i + lane],
                                       candidates.facet.data() + candidates.start[i + lane + 1]}));

        const Lanes moved = norm(x - from) + (travel_ - gather(look_travel_.data(), row));
        const LaneMask idle = less(reach + moved, gather(look_nearest_.data(), row));
        const LaneMask busy = without(here, idle);
        if (any(idle))
            for (int lane = 0; lane < lane_count; ++lane)
                if (idle[lane]) side_facet_[std::size_t(row[lane])] = no_facet;
        if (!any(busy)) continue;
        const Lanes range = (reach + moved) * (1 + double(float_margin));
        const LaneMask close = less(look_again * l0, moved);
        for (int lane = 0; lane < lane_count; ++lane) {
            if (!busy[lane]) continue;
            const std::uint32_t particle = std::uint32_t(i) + std::uint32_t(lane);
            const bool closely = close[lane];
            const float near =
                closely ? std::numeric_limits<float>::infinity() : float(range[lane]);
            const std::size_t begin = work.pairs;
            const std::uint32_t e = candidates.start[particle];
            const std::size_t found =
                keep_up_to(near, &distance_[e], &candidates.facet[e], e,
                           candidates.start[particle + 1] - e, &work.facet[begin],
                           &work.entry[begin]);
            for (std::size_t q = begin; q < begin + found; ++q) {
                work.particle[q] = std::int32_t(particle);
                __builtin_prefetch(surface.corners(std::uint32_t(work.facet[q])));
            }
            work.seen[std::size_t(work.seen_count++)] = {particle, std::uint32_t(begin), closely};
            work.pairs = begin + found;
        }
    }
    work.seen[std::size_t(work.seen_count)].first_pair = std::uint32_t(work.pairs);
    return fastest;
}

/// Who was looked at closely has its distances anew.
void Detector::note_look(const Points& active, const Work& work) {
    for (int s = 0; s < work.seen_count; ++s) {
        const Work::Seen& it = work.seen[std::size_t(s)];
        if (!it.closely) continue;
        float nearest = std::numeric_limits<float>::infinity();
        for (std::uint32_t p = it.first_pair; p < work.seen[std::size_t(s) + 1].first_pair; ++p) {
            const double distance = work.feet[p / lane_count].distance[p % lane_count];
            float& kept = distance_[work.entry[p]];
            kept = float(distance * (1 - float_margin));
            nearest = std::min(nearest, kept);
        }
        std::copy_n(&active.x[3 * std::size_t(it.particle)], 3,
                    &look_x_[3 * std::size_t(it.particle)]);
        look_travel_[it.particle] = travel_;
        look_nearest_[it.particle] = nearest;
    }
}

void Detector::choose(const Points& active, const Surface& surface, Work& work) {
    std::array<Chosen, most_contacts> chosen;
    for (int s = 0; s < work.seen_count; ++s) {
        const Work::Seen& it = work.seen[std::size_t(s)];
        const std::uint32_t end = work.seen[std::size_t(s) + 1].first_pair;
        const std::uint32_t i = it.particle;
        const double l0 = active.radius[i], reach = std::max(1.0, rules_.behind) * l0;
        const std::uint32_t touched = side_facet_[i];
        side_facet_[i] = no_facet;
        std::int64_t pair;
        if (work.choose_quickly(active, surface, reach, touched != no_facet, it, end, pair)) {
            if (pair < 0) continue;
            const LaneFeet& foot = work.feet[std::size_t(pair) / lane_count];
            side_facet_[i] = std::uint32_t(work.facet[std::size_t(pair)]);
            for (int a = 0; a < 4; ++a) side_weight_[i][a] = foot.weight[a][pair % lane_count];
            work.stage(std::uint32_t(pair));
            if (work.staged_count == lane_count) work.finish_staged(active, surface);
            continue;
        }
        work.touches.clear();
        for (std::uint32_t p = it.first_pair; p < end; ++p)
            if (!(work.feet[p / lane_count].distance[p % lane_count] > reach))
                work.touches.add(work.touch(surface, p));
        const int count = select_contacts(
            rules_, surface, {Vec::Map(&active.x[3 * std::size_t(i)]), l0},
            {touched, side_weight_[i]}, work.touches, chosen);
        for (int c = 0; c < count; ++c) {
            const Touch& touch = *chosen[std::size_t(c)].touch;
            if (c == 0) side_facet_[i] = touch.facet, side_weight_[i] = touch.foot.weight;
            work.stage(touch.foot, i, touch.facet, chosen[std::size_t(c)].sign);
            if (work.staged_count == lane_count) work.finish_staged(active, surface);
        }
    }
}

double Detector::detect(const Points& active, const Surface& surface,
                        const CandidateList& candidates, double longest_dt, ContactList& contacts) {
    follow(surface);
    const std::size_t particles = active.size(), blocks = (particles + block - 1) / block;
    std::size_t most_pairs = 0;
    for (std::size_t b = 0; b < blocks; ++b)
        most_pairs = std::max<std::size_t>(
            most_pairs,
            candidates.start[std::min(particles, (b + 1) * block)] - candidates.start[b * block]);
    double fastest = 0;  // [1/s] largest closing speed over l0
#pragma omp parallel num_threads(threads_) reduction(max : fastest) if (threads_ > 1)
    {
        const int thread = omp_get_thread_num(), team = omp_get_num_threads();
        Work& work = *work_[std::size_t(thread)];
        work.reserve(most_pairs);
        if (team == 1) contacts.swap(work.contacts);  // its memory is used again
        work.contacts.clear();
        // Consecutive blocks: joined in thread order the contacts are in particle order.
        for (std::size_t b = blocks * std::size_t(thread) / std::size_t(team);
             b < blocks * std::size_t(thread + 1) / std::size_t(team); ++b) {
            fastest =
                std::max(fastest, find_pairs(active, surface, candidates, longest_dt, b * block,
                                             std::min(particles, (b + 1) * block), work));
            work.find_feet(active, surface);
            note_look(active, work);
            choose(active, surface, work);
        }
        work.finish_staged(active, surface);
        if (team == 1) {
            contacts.swap(work.contacts);
        } else {
#pragma omp barrier
            std::size_t first = 0, all = 0;
            for (int t = 0; t < team; ++t) {
                if (t == thread) first = all;
                all += work_[std::size_t(t)]->contacts.size();
            }
#pragma omp single
            contacts.resize(all);
            for (std::size_t c = 0; c < work.contacts.size(); ++c)
                contacts.copy(first + c, work.contacts, c);
        }
    }
    contacts.fill_lanes_beyond();
    return fastest > 0 ? rules_.step_share / fastest : std::numeric_limits<double>::infinity();
}

}  // namespace undertow::contact
