#include "contact/detection.hpp"

#include <omp.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

namespace undertow::contact {

namespace {

// Facets within reach of one particle. A particle four times as large as its facets sees about 60.
constexpr int most_touches = 96;
constexpr int most_contacts = 4;  // of one particle: a corner of three walls, and one to spare

// Two feet are one point when they differ by less than this share of l0: round-off of positions.
constexpr double same_point = 1e-9;

// The point touched at the step before is off the plane of a neighboring facet of the same face by
// less than this share of l0; two faces that a particle can touch together are farther apart.
constexpr double same_face = 0.25;

constexpr std::uint32_t no_facet = 0xffffffffu;

}  // namespace

struct Touch {
    std::uint32_t facet;
    Foot foot;
    double side;  // [m] offset along the facet's normal
    bool free_rim;
    bool wet() const { return side >= 0 || free_rim; }
};

class TouchList {
 public:
    void clear() { count_ = 0; }
    void add(const Touch& touch) {
        if (count_ < most_touches) {
            touch_[count_++] = touch;
            return;
        }
        Touch* farthest = std::max_element(begin(), end(), [](const Touch& a, const Touch& b) {
            return a.foot.distance < b.foot.distance;
        });
        if (touch.foot.distance < farthest->foot.distance) *farthest = touch;
    }
    Touch* begin() { return touch_.data(); }
    Touch* end() { return touch_.data() + count_; }
    bool empty() const { return count_ == 0; }

 private:
    std::array<Touch, most_touches> touch_;
    int count_ = 0;
};

namespace {

/// The nearest touch; of several at the same point the one that the offset faces most squarely,
/// because only that one tells the side at an edge or corner.
const Touch& nearest(TouchList& touches, double tolerance) {
    const Touch* best = touches.begin();
    for (const Touch& touch : touches)
        if (touch.foot.distance < best->foot.distance) best = &touch;
    const double reach = best->foot.distance + tolerance;
    for (const Touch& touch : touches)
        if (touch.foot.distance <= reach && std::abs(touch.side) > std::abs(best->side))
            best = &touch;
    return *best;
}

/// Does `other` have the edge or corner on which the foot of `touch` lies?
bool shares_rim(const Surface& surface, const Touch& touch, const Touch& other) {
    const std::int32_t* mine = surface.corners(touch.facet);
    const std::int32_t* theirs = surface.corners(other.facet);
    for (int k = 0; k < 4; ++k) {
        if (!(touch.foot.rim & (1 << k))) continue;
        if (std::find(theirs, theirs + 4, mine[k]) == theirs + 4) return false;
    }
    return true;
}

/// A foot inside a facet is a local minimum of the distance; one on a rim only if no neighbor there
/// comes nearer. Of equal ones the first facet stands for all.
bool is_local_minimum(const Surface& surface, TouchList& touches, const Touch& touch,
                      double tolerance) {
    if (touch.foot.rim == 0) return true;
    for (const Touch& other : touches) {
        if (other.facet == touch.facet || !shares_rim(surface, touch, other)) continue;
        if (other.foot.distance < touch.foot.distance - tolerance) return false;
        if (other.foot.distance <= touch.foot.distance + tolerance && other.facet < touch.facet &&
            other.wet())
            return false;
    }
    return true;
}

Contact make_contact(const Points& active, const Surface& surface, std::uint32_t particle,
                     const Touch& touch, double sign) {
    Contact contact;
    contact.particle = particle;
    contact.facet = touch.facet;
    contact.weight = touch.foot.weight;
    const double l0 = active.radius[particle];
    const Vec x = Vec::Map(&active.x[3 * std::size_t(particle)]);
    const Vec v = Vec::Map(&active.v[3 * std::size_t(particle)]);
    contact.point = x - touch.foot.offset;
    // With the center in the surface the offset has no direction left; the facet's normal has.
    contact.normal = touch.foot.distance > same_point * l0
                         ? Vec(sign / touch.foot.distance * touch.foot.offset)
                         : touch.foot.normal;
    contact.depth = l0 - sign * touch.foot.distance;
    Vec v_surface = Vec::Zero();
    const std::int32_t* q = surface.corners(touch.facet);
    for (int a = 0; a < 4; ++a) v_surface += touch.foot.weight[a] * surface.velocity(q[a]);
    const Vec relative = v - v_surface;
    const double along = relative.dot(contact.normal);
    contact.closing = -along;
    contact.slip = relative - along * contact.normal;
    return contact;
}

/// Does the touch see the particle squarely from behind?
bool from_behind(const Touch& touch) {
    return !touch.free_rim && touch.side < -0.7 * touch.foot.distance;
}

/// The face that the particle touched at the step before and has passed since, nullptr if none: it
/// looks the same way and holds the point that was touched.
const Touch* passed_face(const DetectionRules& rules, const Surface& surface, double l0,
                         std::uint32_t facet, const std::array<double, 4>& weight,
                         const Touch& closest, TouchList& touches, const Vec& x) {
    if (std::none_of(touches.begin(), touches.end(), from_behind)) return nullptr;
    const Vec facing = surface.plane(facet).normal;
    if (!closest.wet() && closest.foot.normal.dot(facing) > 0) return nullptr;  // no doubt
    Vec touched = Vec::Zero();
    for (int a = 0; a < 4; ++a) touched += weight[a] * surface.position(surface.corners(facet)[a]);
    const Touch* passed = nullptr;
    for (const Touch& touch : touches) {
        if (!from_behind(touch) || touch.foot.distance > rules.behind * l0) continue;
        if (touch.foot.normal.dot(facing) < 0.5) continue;
        const Vec at = x - touch.foot.offset;
        if (std::abs(touch.foot.normal.dot(touched - at)) > same_face * l0) continue;
        if (!passed || touch.foot.distance < passed->foot.distance) passed = &touch;
    }
    return passed;
}

/// Chooses the contacts of one particle among what it touches. passed: see passed_face.
void select(const DetectionRules& rules, const Points& active, const Surface& surface,
            std::uint32_t particle, const Touch& closest, const Touch* passed, TouchList& touches,
            std::vector<Contact>& contacts) {
    const double l0 = active.radius[particle], tolerance = same_point * l0;
    if (passed) {
        contacts.push_back(make_contact(active, surface, particle, *passed, -1));
        return;
    }
    if (!closest.wet()) {
        if (closest.foot.distance <= rules.behind * l0)
            contacts.push_back(make_contact(active, surface, particle, closest, -1));
        return;
    }
    std::sort(touches.begin(), touches.end(), [](const Touch& a, const Touch& b) {
        return a.foot.distance != b.foot.distance ? a.foot.distance < b.foot.distance
                                                  : a.facet < b.facet;
    });
    const std::size_t first = contacts.size();
    for (const Touch& touch : touches) {
        if (touch.foot.distance >= l0 || !touch.wet()) continue;
        if (!is_local_minimum(surface, touches, touch, tolerance)) continue;
        const Contact contact = make_contact(active, surface, particle, touch, +1);
        const bool new_wall =
            std::all_of(contacts.begin() + first, contacts.end(), [&](const Contact& taken) {
                return taken.normal.dot(contact.normal) < rules.same_normal;
            });
        if (new_wall) contacts.push_back(contact);
        if (contacts.size() - first == most_contacts) break;
    }
}

using Lanes = double __attribute__((vector_size(64)));

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

Lanes load(std::span<const double> a, std::size_t i) {
    Lanes lanes;
    std::memcpy(&lanes, &a[i], sizeof lanes);
    return lanes;
}

/// Largest size of a component.
double largest_size(std::span<const double> a) {
    return largest_of(
        a.size(), [&](std::size_t i) { return load(a, i); }, [&](std::size_t i) { return a[i]; });
}

/// Largest size of a component of a - b; arrays of equal length.
double largest_change(std::span<const double> a, std::span<const double> b) {
    return largest_of(
        a.size(), [&](std::size_t i) { return load(a, i) - load(b, i); },
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

Detector::Detector(DetectionRules rules, int threads)
    : rules_(rules), threads_(std::max(1, threads)), per_thread_(threads_) {}

void Detector::renew(const Points& active, const Surface& surface, const CandidateList& candidates,
                     std::span<const std::int64_t> old_row) {
    next_side_.resize(active.size());
    for (std::size_t i = 0; i < active.size(); ++i)
        next_side_[i] = old_row[i] >= 0 && std::size_t(old_row[i]) < side_.size()
                            ? side_[old_row[i]]
                            : Side{no_facet, {}};
    side_.swap(next_side_);
    x_nodes_.assign(surface.x().begin(), surface.x().end());
    travel_ = 0;
    distance_.assign(candidates.distance.begin(), candidates.distance.end());
    look_.resize(active.size());
    for (std::size_t i = 0; i < active.size(); ++i)
        look_[i] = {Vec::Map(&active.x[3 * i]), 0,
                    *std::min_element(distance_.begin() + candidates.start[i],
                                      distance_.begin() + candidates.start[i + 1])};
}

/// How far the surface may have moved since the last step, and how fast it is.
void Detector::follow(const Surface& surface) {
    travel_ += per_component * largest_change(surface.x(), x_nodes_);
    std::copy(surface.x().begin(), surface.x().end(), x_nodes_.begin());
    node_speed_ = per_component * largest_size(surface.v());
}

/// All facets within reach of particle i, in the order of the candidates.
void Detector::find_touches(const Points& active, const Surface& surface,
                            const CandidateList& candidates, std::size_t i, TouchList& touches) {
    const Vec x = Vec::Map(&active.x[3 * i]);
    const double l0 = active.radius[i], reach = std::max(1.0, rules_.behind) * l0;
    Look& look = look_[i];
    const double moved = (x - look.x).norm() + (travel_ - look.travel);
    if (double(look.nearest) > reach + moved) return;

    const bool closely = moved > look_again * l0;
    const float near = closely ? std::numeric_limits<float>::infinity()
                               : float((reach + moved) * (1 + float_margin));
    float nearest = std::numeric_limits<float>::infinity();
    for (std::uint32_t e = candidates.start[i]; e < candidates.start[i + 1]; ++e) {
        if (distance_[e] > near) continue;
        const std::uint32_t facet = candidates.facet[e];
        Touch touch{facet, closest_point(x, surface.shape(facet)), 0, false};
        if (closely) {
            distance_[e] = float(touch.foot.distance * (1 - float_margin));
            nearest = std::min(nearest, distance_[e]);
        }
        if (touch.foot.distance > reach) continue;
        touch.side = touch.foot.offset.dot(touch.foot.normal);
        touch.free_rim = surface.is_free_rim(facet, touch.foot.rim);
        touches.add(touch);
    }
    if (closely) look = {x, travel_, nearest};
}

double Detector::detect(const Points& active, const Surface& surface,
                        const CandidateList& candidates, double longest_dt,
                        std::vector<Contact>& contacts) {
    follow(surface);
    const std::int64_t particles = std::int64_t(active.size());
    double fastest = 0;  // [1/s] largest closing speed over l0
    contacts.clear();
#pragma omp parallel num_threads(threads_) reduction(max : fastest) if (threads_ > 1)
    {
        const int thread = omp_get_thread_num(), team = omp_get_num_threads();
        std::vector<Contact>& mine = team == 1 ? contacts : per_thread_[thread];
        mine.clear();
        TouchList touches;
        // Blocks of consecutive particles: joined in thread order they are in particle order.
        for (std::int64_t i = particles * thread / team; i < particles * (thread + 1) / team; ++i) {
            const double speed = Vec::Map(&active.v[3 * i]).norm() + node_speed_;
            if (!(speed * longest_dt <= rules_.step_share * active.radius[i]))
                fastest = std::max(
                    fastest, approach_rate(active, surface, std::size_t(i),
                                           {candidates.facet.data() + candidates.start[i],
                                            candidates.facet.data() + candidates.start[i + 1]}));
            touches.clear();
            find_touches(active, surface, candidates, std::size_t(i), touches);
            Side& side = side_[i];
            const std::size_t first = mine.size();
            if (!touches.empty()) {
                const double l0 = active.radius[i];
                const Touch& closest = nearest(touches, same_point * l0);
                const Touch* passed =
                    side.facet == no_facet
                        ? nullptr
                        : passed_face(rules_, surface, l0, side.facet, side.weight, closest,
                                      touches, Vec::Map(&active.x[3 * i]));
                select(rules_, active, surface, std::uint32_t(i), closest, passed, touches, mine);
            }
            if (mine.size() > first)
                side = {mine[first].facet, mine[first].weight};
            else
                side.facet = no_facet;
        }
    }
    if (threads_ > 1)
        for (const std::vector<Contact>& part : per_thread_)
            contacts.insert(contacts.end(), part.begin(), part.end());
    return fastest > 0 ? rules_.step_share / fastest : std::numeric_limits<double>::infinity();
}

}  // namespace undertow::contact
