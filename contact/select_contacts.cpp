#include "contact/select_contacts.hpp"

#include <cmath>

namespace undertow::contact {

namespace {

// The point touched at the step before is off the plane of a neighboring facet of the same face by
// less than this share of l0; two faces that a particle can touch together are farther apart.
constexpr double same_face = 0.25;

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

/// Does the touch see the particle squarely from behind?
bool from_behind(const Touch& touch) {
    return !touch.free_rim && touch.side < -0.7 * touch.foot.distance;
}

/// The face that the particle touched at the step before and has passed since, nullptr if none: it
/// looks the same way and holds the point that was touched.
const Touch* passed_face(const DetectionRules& rules, const Surface& surface, const Ball& particle,
                         const RememberedSide& before, const Touch& closest, TouchList& touches) {
    if (before.facet == no_facet) return nullptr;
    if (std::none_of(touches.begin(), touches.end(), from_behind)) return nullptr;
    const double l0 = particle.l0;
    const Vec facing = surface.plane(before.facet).normal;
    if (!closest.wet() && closest.foot.normal.dot(facing) > 0) return nullptr;  // no doubt
    Vec touched = Vec::Zero();
    for (int a = 0; a < 4; ++a)
        touched += before.weight[a] * surface.position(surface.corners(before.facet)[a]);
    const Touch* passed = nullptr;
    for (const Touch& touch : touches) {
        if (!from_behind(touch) || touch.foot.distance > rules.behind * l0) continue;
        if (touch.foot.normal.dot(facing) < 0.5) continue;
        const Vec at = particle.x - touch.foot.offset;
        if (std::abs(touch.foot.normal.dot(touched - at)) > same_face * l0) continue;
        if (!passed || touch.foot.distance < passed->foot.distance) passed = &touch;
    }
    return passed;
}

Three<double> normal_of(const Touch& touch, double sign, double l0) {
    const Vec &o = touch.foot.offset, &n = touch.foot.normal;
    return contact_normal<double>({o[0], o[1], o[2]}, touch.foot.distance, sign, {n[0], n[1], n[2]},
                                  l0);
}

}  // namespace

void TouchList::add(const Touch& touch) {
    if (count_ < most_touches) {
        touch_[std::size_t(count_++)] = touch;
        return;
    }
    Touch* farthest = std::max_element(begin(), end(), [](const Touch& a, const Touch& b) {
        return a.foot.distance < b.foot.distance;
    });
    if (touch.foot.distance < farthest->foot.distance) *farthest = touch;
}

int select_contacts(const DetectionRules& rules, const Surface& surface, const Ball& particle,
                    const RememberedSide& before, TouchList& touches,
                    std::array<Chosen, most_contacts>& chosen) {
    const double l0 = particle.l0;
    const Touch& closest = nearest(touches, same_point * l0);
    const Touch* passed = passed_face(rules, surface, particle, before, closest, touches);
    if (passed) {
        chosen[0] = {passed, -1};
        return 1;
    }
    if (!closest.wet()) {
        chosen[0] = {&closest, -1};
        return closest.foot.distance <= rules.behind * l0 ? 1 : 0;
    }
    std::sort(touches.begin(), touches.end(), [](const Touch& a, const Touch& b) {
        return a.foot.distance != b.foot.distance ? a.foot.distance < b.foot.distance
                                                  : a.facet < b.facet;
    });
    int count = 0;
    for (const Touch& touch : touches) {
        if (touch.foot.distance >= l0 || !touch.wet()) continue;
        if (!is_local_minimum(surface, touches, touch, same_point * l0)) continue;
        const Three<double> normal = normal_of(touch, +1, l0);
        const bool new_wall =
            std::all_of(chosen.begin(), chosen.begin() + count, [&](const Chosen& taken) {
                return dot(normal_of(*taken.touch, +1, l0), normal) < rules.same_normal;
            });
        if (new_wall) chosen[count++] = {&touch, +1};
        if (count == most_contacts) break;
    }
    return count;
}

}  // namespace undertow::contact
