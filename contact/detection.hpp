#pragma once
// Where do particles touch the surface?
//
// A particle is a ball of radius l0 about its center. Its contacts are the local minima of the
// distance between the center and the surface:
//   flat wall      one minimum, wherever the particle sits: edges between coplanar facets never
//   count convex edge    one minimum, on the edge; the normal runs from the edge to the particle
//   concave corner one minimum on each side
// A minimum on an outline edge or corner of a facet is dropped when another facet with that edge or
// corner holds a nearer point (or the same point, and comes first). Of minima whose normals differ
// by less than 45 degrees only the deepest counts: there the penalty potential k/2 max(d_a)^2 stays
// continuous across the seam of a faceted concave surface, where a sum would count the wall twice.
//
// Side: the nearest point of all decides. If the center lies below the plane there, the particle
// has passed the surface and is pushed back out along the line to that point, d = l0 + distance, up
// to `behind` l0 below the surface. At a free edge of an open surface nothing is inside: the edge
// is round. If the nearest point says outside, facets that see the particle from behind are the far
// side of a thin body and do not act.
//
// A particle remembers its side. Between the faces of a plate thinner than l0 the nearest point may
// be on the wrong one; so where it touched at the step before is kept as a point of the surface,
// which moves along. If the nearest point lies on a face that looks the other way (or sees the
// particle from outside), and the face that was touched sees it from behind, the particle has passed
// that face and is pushed back through it. Who touches nothing has no side.

#include <memory>
#include <span>
#include <vector>

#include "contact/candidates.hpp"
#include "contact/contact_list.hpp"
#include "contact/points.hpp"
#include "contact/select_contacts.hpp"
#include "contact/surface.hpp"

namespace undertow {
class Archive;
}

namespace undertow::contact {

/// Finds the contacts of all active particles; the result does not depend on the thread count, nor
/// on what is skipped.
///
/// Particles are taken in blocks: first all pairs of particle and facet that cannot be excluded are
/// listed, then their closest points are found eight at a time, then each particle's contacts are
/// chosen among them.
///
/// Most tests end before they begin: of each candidate the distance is known that it had when the
/// particle was last looked at closely. Until particle and surface together have moved by what that
/// distance exceeds the particle's reach, the facet cannot touch. A particle that has moved by a
/// share of its radius is looked at anew.
class Detector {
 public:
    explicit Detector(DetectionRules rules = {}, int threads = 1);
    Detector(Detector&&) noexcept;
    ~Detector();

    /// The candidates were searched anew, with particles and surface where they are now.
    /// old_row[i]: the former row of active particle i, or -1 if it was not active.
    void renew(const Points& active, const Surface& surface, const CandidateList& candidates,
               std::span<const std::int64_t> old_row);

    /// contacts: ordered by particle, then depth. Returns the largest step [s] during which no
    /// particle moves by more than step_share * l0 towards a facet it may touch. Particles too slow
    /// to do so within `longest_dt` [s] are not asked: a result above it says only that much.
    double detect(const Points& active, const Surface& surface, const CandidateList& candidates,
                  double longest_dt, ContactList& contacts);
    void archive(Archive& a);

 private:
    class Work;  // what one thread needs for a block of particles
    void follow(const Surface& surface);
    double find_pairs(const Points& active, const Surface& surface,
                      const CandidateList& candidates, double longest_dt, std::size_t first,
                      std::size_t last, Work& work);
    void fetch_ahead(const Points& active, const CandidateList& candidates,
                     std::size_t first) const;
    void note_look(const Points& active, const Work& work);
    void choose(const Points& active, const Surface& surface, Work& work);

    DetectionRules rules_;
    int threads_;
    // Of each active particle, when its candidates were last looked at closely:
    std::vector<double> look_x_;        // [m] (A, 3)
    std::vector<double> look_travel_;   // [m] travel_ at that time
    std::vector<double> look_nearest_;  // [m] of its candidates, rounded down
    // Where each active particle touched at the step before; facet no_facet = nowhere.
    std::vector<std::uint32_t> side_facet_, next_side_facet_;
    std::vector<std::array<double, 4>> side_weight_, next_side_weight_;
    std::vector<float> distance_;  // [m] per candidate, at its particle's look
    std::vector<double> x_nodes_;  // [m] of the last step
    double travel_ = 0;            // [m] no node has moved farther since the search
    double node_speed_ = 0;        // [m/s] no node is faster
    std::vector<std::unique_ptr<Work>> work_;  // per thread
};

}  // namespace undertow::contact
