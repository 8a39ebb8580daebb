#include "contact/detection.hpp"

#include <omp.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace undertow::contact {

namespace {

// Facets within reach of one particle. A particle four times as large as its facets sees about 60.
constexpr int most_touches = 96;
constexpr int most_contacts = 4;  // of one particle: a corner of three walls, and one to spare

// Two feet are one point when they differ by less than this share of l0: round-off of positions.
constexpr double same_point = 1e-9;

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

/// Chooses the contacts of one particle among what it touches.
void select(const DetectionRules& rules, const Points& active, const Surface& surface,
            std::uint32_t particle, TouchList& touches, std::vector<Contact>& contacts) {
    const double l0 = active.radius[particle], tolerance = same_point * l0;
    const Touch& closest = nearest(touches, tolerance);
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

}  // namespace

Detector::Detector(DetectionRules rules, int threads)
    : rules_(rules), threads_(std::max(1, threads)), per_thread_(threads_) {}

double Detector::detect(const Points& active, const Surface& surface,
                        const CandidateList& candidates, std::vector<Contact>& contacts) {
    frame_.resize(surface.facets());
    for (std::uint32_t facet : candidates.used) frame_[facet] = surface.frame(facet);

    const std::int64_t particles = std::int64_t(active.size());
    for (std::vector<Contact>& part : per_thread_) part.clear();
    double fastest = 0;  // [1/s] largest closing speed over the distance allowed per step
#pragma omp parallel num_threads(threads_) reduction(max : fastest) if (threads_ > 1)
    {
        const int thread = omp_get_thread_num(), team = omp_get_num_threads();
        std::vector<Contact>& mine = per_thread_[thread];
        TouchList touches;
        // Blocks of consecutive particles: joined in thread order they are in particle order.
        for (std::int64_t i = particles * thread / team; i < particles * (thread + 1) / team; ++i) {
            const Vec x = Vec::Map(&active.x[3 * i]), v = Vec::Map(&active.v[3 * i]);
            const double l0 = active.radius[i];
            const double reach = std::max(1.0, rules_.behind) * l0;
            touches.clear();
            for (std::uint32_t e = candidates.start[i]; e < candidates.start[i + 1]; ++e) {
                const std::uint32_t facet = candidates.facet[e];
                const FacetFrame& frame = frame_[facet];
                const Vec from_center = x - frame.center;
                const double height = frame.normal.dot(from_center);
                const double closing = frame.normal.dot(frame.velocity - v);
                fastest = std::max(fastest, (height < 0 ? -closing : closing) / l0);
                if (frame.is_beyond(from_center, reach)) continue;
                Touch touch{facet, closest_point(x, surface.shape(facet)), 0, false};
                if (touch.foot.distance > reach) continue;
                touch.side = touch.foot.offset.dot(touch.foot.normal);
                touch.free_rim = surface.is_free_rim(facet, touch.foot.rim);
                touches.add(touch);
            }
            if (!touches.empty()) select(rules_, active, surface, std::uint32_t(i), touches, mine);
        }
    }
    contacts.clear();
    for (const std::vector<Contact>& part : per_thread_)
        contacts.insert(contacts.end(), part.begin(), part.end());
    return fastest > 0 ? rules_.step_share / fastest : std::numeric_limits<double>::infinity();
}

}  // namespace undertow::contact
