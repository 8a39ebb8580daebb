#include "fem_solver/contact_pairs/contact_pair.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "checkpoint/archive.hpp"
#include "fem_solver/contact_pairs/springs.hpp"
#include "fem_solver/contact_pairs/touched_surface.hpp"
#include "wire/errors.hpp"
#include "wire/number_text.hpp"

namespace undertow::fem {
namespace {

using Vector = Eigen::Vector3d;

// A node that far from the surface, in gaps, still counts as touching in the mesh: at the corner of
// a tip the distance is sqrt(2) gaps.
constexpr double near_in_gaps = 1.5;

// A node nearer to the plane of a facet than this share of its distance lies beyond the rim
// (TouchedSurface::touch).
constexpr double least_along = 0.7;

// Nodes are kept in sight that far from the surface, in gaps, unless the case says otherwise
// (`near`): until node and surface have moved by what it exceeds near_in_gaps, no search is needed.
constexpr double sight_in_gaps = 2;

Vector vector(const NodeRow& row) {
    return Vector(row.c[0], row.c[1], row.c[2]);
}
Vec3 array(const Vector& a) {
    return {a[0], a[1], a[2]};
}

// A point on one face of a shell sees what the face looks at, and what the wall stands on with its
// edge, but not what lies behind the wall: cosine of its normal and that of the surface.
constexpr double looks_away = 0.5;

/// Of immobile nodes, which have no mass.
bool is_held(const ContactSet& set, const Nodes& nodes) {
    return nodes.mass[set.surface.front()[0]] == 0;
}

ContactPoints make_points(const ContactSet& set, const Nodes& nodes, const TurningNodes* turning) {
    if (set.node_faces.offset.empty()) return ContactPoints(set.nodes, nodes);
    return ContactPoints(set.node_faces, nodes, *turning);
}

/// One node of the set, and what it remembers.
struct Toucher {
    double k = 0;                      // [N/m]
    double damping = 0;                // [N s/m] along the normal
    double reach = 0;                  // [m] g: it touches where the distance is less
    Vector friction = Vector::Zero();  // [N] t, on the node
    double normal_force = 0;           // [N] f_n
    double damping_force = 0;          // [N] part of f_n that is not k (g - phi)
    bool near_at_start = false;
    std::int32_t before = -1;  // facet that it was nearest to, -1: none
    // of the last evaluation
    Touch touch;
    bool has_touch = false, slips = false;
    double slipped = 0, damped = 0;  // [J] dissipated in the step
};

}  // namespace

struct ContactPair::State {
    ContactSet set;
    std::unique_ptr<TouchedSurface> touched;
    TouchedSurface& surface;
    ContactPoints points;
    const TurningNodes* turning;  // of shells; none
    std::vector<Toucher> toucher;
    double dt_limit;           // [s]
    double least_radius = 0;  // [m] within which a node may be pushed at the start
    int threads;

    contact::FacetCells cells;
    contact::CandidateList found;
    std::vector<std::uint32_t> first, last;            // candidates of node i in found.facet
    const std::vector<double>&x, &v;                   // of `points`
    std::vector<double> mass, radius;                  // of the set's nodes, for the search
    std::vector<double> x_searched, surface_searched;  // [m] at the last search
    int searches = 0;

    ContactTotals totals;
    double stored = 0, stored_from = 0, slipped = 0, damped = 0;  // [J]
    double softest = contact_stiffness_factor;

    State(ContactSet s, const Nodes& nodes, int n_threads, const TurningNodes* of_shells)
        : set(std::move(s)),
          touched(make_surface(nodes, of_shells)),
          surface(*touched),
          points(make_points(set, nodes, of_shells)),
          turning(of_shells),
          toucher(set.nodes.size()),
          threads(n_threads),
          x(points.x()),
          v(points.v()) {
        surface.remember_sides(set.opposite);
    }

    std::unique_ptr<TouchedSurface> make_surface(const Nodes& nodes,
                                                 const TurningNodes* of_shells) const {
        if (!set.surface_faces.offset.empty())
            return std::make_unique<TouchedSurface>(set.surface_faces, nodes, *of_shells);
        const bool is_rigid = is_held(set, nodes) || set.body >= 0;
        return std::make_unique<TouchedSurface>(
            set.surface, nodes, is_rigid ? SurfaceKind::rigid : SurfaceKind::deformable);
    }

    double sight() const { return set.near > 0 ? set.near : sight_in_gaps * set.gap; }  // [m]
    /// [m] from the flat facets, before which a round surface stands by its bulge
    double seen_at_rest() const { return near_in_gaps * set.gap + surface.largest_bulge(); }
    double skin() const { return sight() - near_in_gaps * set.gap; }
    void gather(const Nodes& nodes);
    void widen(double dt);
    void search();
    double moved() const;
    bool is_out_of_reach(std::size_t i, double moved) const;
    void find_start(const Nodes& nodes);
    double surface_yields(const Nodes& nodes) const;
    double farthest_arm() const { return near_in_gaps * set.gap; }  // [m] of friction at a face
    static int faces_of(const ContactPoints& p) { return p.turn() ? 2 : 1; }  // on one node
    void set_stiffness(const Nodes& nodes, const ContactBudget& budget);
    bool find_touch(std::size_t i);
    double pressed_on(const Touch& before, std::size_t i, double dt) const;
    void evaluate_node(std::size_t i, const Vector& turn_rate, double dt, double moved);
};

void ContactPair::State::gather(const Nodes& nodes) {
    surface.follow(nodes, turning);
    points.follow(nodes, turning);
}

/// [m] by node and surface together since the search; candidates stay complete up to the skin.
double ContactPair::State::moved() const {
    const auto largest = [](std::span<const double> now, const std::vector<double>& then) {
        double squared = 0;
        for (std::size_t i = 0; i < then.size(); i += 3) {
            const double a = now[i] - then[i], b = now[i + 1] - then[i + 1],
                         c = now[i + 2] - then[i + 2];
            squared = std::max(squared, a * a + b * b + c * c);
        }
        return std::sqrt(squared);
    };
    return largest(x, x_searched) + largest(surface.facets().x(), surface_searched);
}

/// Whether a node that was before the surface cannot have come within its reach. A touch's distance
/// is measured along the surface's own normal, 0.7 of the straight line at least, less the bulge.
bool ContactPair::State::is_out_of_reach(std::size_t i, double moved) const {
    const Toucher& t = toucher[i];
    if (t.has_touch) return false;
    float nearest = std::numeric_limits<float>::infinity();
    for (std::uint32_t c = first[i]; c < last[i]; ++c)
        nearest = std::min(nearest, found.distance[c]);
    return least_along * (nearest - moved) - surface.largest_bulge() > t.reach;
}

/// Nodes pressed behind the surface stay in reach, and those that a step takes there come into it:
/// until the next search both move by less than the skin and one step.
void ContactPair::State::widen(double dt) {
    const auto speed2 = [](const double* a) { return a[0] * a[0] + a[1] * a[1] + a[2] * a[2]; };
    double of_surface = 0;
    const auto moves = surface.facets().v();
    for (std::size_t i = 0; i < moves.size(); i += 3)
        of_surface = std::max(of_surface, speed2(&moves[i]));
    of_surface = std::sqrt(of_surface);
    for (std::size_t i = 0; i < toucher.size(); ++i) {
        const double behind = toucher[i].has_touch ? -toucher[i].touch.distance : 0;
        radius[i] = seen_at_rest() + std::max(0.0, behind) +
                    2 * dt * (std::sqrt(speed2(&v[3 * i])) + of_surface);
        radius[i] = std::max(radius[i], least_radius);
    }
}

void ContactPair::State::search() {
    cells.search({x, v, mass, radius, {}, {}}, surface.facets(), skin(), found);
    std::fill(first.begin(), first.end(), 0u);
    std::fill(last.begin(), last.end(), 0u);
    for (std::size_t r = 0; r < found.row.size(); ++r) {
        first[found.row[r]] = found.start[r];
        last[found.row[r]] = found.start[r + 1];
    }
    x_searched.assign(x.begin(), x.end());
    const auto at = surface.facets().x();
    surface_searched.assign(at.begin(), at.end());
    ++searches;
}

bool ContactPair::State::find_touch(std::size_t i) {
    Toucher& t = toucher[i];
    t.has_touch = last[i] > first[i] &&
                  surface.touch(Vector(x[3 * i], x[3 * i + 1], x[3 * i + 2]),
                                {found.facet.data() + first[i], last[i] - first[i]}, t.touch,
                                t.before);
    t.before = t.has_touch ? std::int32_t(t.touch.facet) : -1;
    if (t.has_touch && points.turn() && points.normal(i).dot(t.touch.normal) > looks_away)
        t.has_touch = false;
    return t.has_touch;
}

void ContactPair::State::find_start(const Nodes& nodes) {
    const std::size_t n = set.nodes.size();
    mass.resize(n);
    for (std::size_t i = 0; i < n; ++i) mass[i] = nodes.mass[set.nodes[i]];
    radius.assign(n, seen_at_rest());
    first.resize(n);
    last.resize(n);
    gather(nodes);
    search();
    int near = 0;
    for (std::size_t i = 0; i < n; ++i) {
        Toucher& t = toucher[i];
        t.reach = set.gap;
        if (!find_touch(i) || t.touch.distance > near_in_gaps * set.gap) continue;
        if (t.touch.distance <= 0)
            throw InputError("fem.contact \"" + set.name + "\": the node at " +
                             point_text({x[3 * i], x[3 * i + 1], x[3 * i + 2]}) +
                             " of \"nodes\" lies on or behind the surface; the mesh must leave "
                             "the gap of " +
                             number_text(set.gap) + " m between the two.");
        t.reach = t.touch.distance;
        t.near_at_start = true;
        ++near;
    }
    if (near == 0 && (set.near == 0 || found.row.empty()))
        throw InputError("fem.contact \"" + set.name + "\": no node of \"nodes\" is within " +
                         (set.near > 0 ? "near = " + number_text(set.near) + " m"
                                       : "1.5 gaps (gap = " + number_text(set.gap) + " m)") +
                         " of \"surface\"; check the sets, the gap and the surface's normals. "
                         "Bodies that start apart and meet later need near, the distance in m "
                         "within which nodes are kept in sight, beyond where they start.");
}

/// [1/kg] largest S/m of a deformable surface, 0 of one that is held: S the sum of the weights of
/// feet on one node and one for feet to come. Where bodies start apart, S is also what it would be
/// if the surface were covered with the finest of them.
double ContactPair::State::surface_yields(const Nodes& nodes) const {
    const std::vector<std::int32_t>& node = surface.points().node();
    std::vector<double> sum(node.size(), 0.0);
    for (const Toucher& t : toucher)
        if (t.near_at_start)
            for (int a = 0; a < 4; ++a)
                sum[surface.facets().corners(t.touch.facet)[a]] += t.touch.weight[a];
    for (std::size_t i = 1; i < sum.size(); ++i)  // both faces of a shell hang on one node
        if (node[i] == node[i - 1]) sum[i] += sum[i - 1];
    const double to_come = set.near > 0 ? faces_of(surface.points()) * set.coverage : 0;
    double yields = 0;
    for (std::size_t i = 0; i < sum.size(); ++i)
        yields = std::max(yields, (1 + std::max(to_come, sum[i])) *
                                      surface.points().yields(i, farthest_arm(), nodes, turning));
    return yields;
}

void ContactPair::State::set_stiffness(const Nodes& nodes, const ContactBudget& budget) {
    dt_limit = budget.dt;
    const std::size_t n = set.nodes.size();
    const double of_facets = set.body >= 0 ? 0 : surface_yields(nodes);
    std::vector<double> yields(n), share(n);
    for (std::size_t i = 0; i < n; ++i) {
        yields[i] = faces_of(points) * points.yields(i, farthest_arm(), nodes, turning);
        yields[i] += set.body >= 0 ? budget.body_load / set.area[i] : of_facets;
        share[i] = std::min(budget.share[i], budget.surface_share);
    }
    const std::vector<ContactSpring> springs =
        make_contact_springs(set, yields, share, budget.dt);
    for (std::size_t i = 0; i < n; ++i) {
        toucher[i].k = springs[i].k;
        toucher[i].damping = springs[i].damping;
        softest = std::min(softest, springs[i].k / set.stiffness[i]);
    }
}

/// [m] by which a spring would be compressed after the step dt where it stood before.
double ContactPair::State::pressed_on(const Touch& before, std::size_t i, double dt) const {
    const Vector speed(v[3 * i], v[3 * i + 1], v[3 * i + 2]);
    const double parting = dt * (speed - surface.velocity(before)).dot(before.normal);
    return std::max(0.0, toucher[i].reach - before.distance - parting);
}

/// Forces of node i from the springs; `turn_rate` [rad/s] of a rigid surface, `moved` [m] since the
/// search.
void ContactPair::State::evaluate_node(std::size_t i, const Vector& turn_rate, double dt,
                                       double moved) {
    Toucher& t = toucher[i];
    t.slips = false;
    t.slipped = t.damped = 0;
    const bool out_of_reach = is_out_of_reach(i, moved);
    if (out_of_reach) t.before = -1;
    const bool touched = t.has_touch;
    const Touch before = t.touch;
    const bool touches = !out_of_reach && find_touch(i) && t.touch.distance < t.reach;
    if (!touches) {
        t.slipped = t.friction.squaredNorm() / t.k / 2;  // the spring snaps back
        // Over a rim, which it has not climbed, it loses what the spring holds after the step. One
        // that flew off so fast that no facet is near any more has got all of it.
        if (touched && !t.has_touch)
            t.slipped += 0.5 * t.k * std::pow(pressed_on(before, i, dt), 2);
        t.has_touch = false;
        t.normal_force = t.damping_force = 0;
        t.friction.setZero();
        return;
    }
    const Vector at(x[3 * i], x[3 * i + 1], x[3 * i + 2]);
    const Vector speed(v[3 * i], v[3 * i + 1], v[3 * i + 2]);
    const Vector& n = t.touch.normal;
    const Vector offset = at - surface.position(t.touch);
    // how the place turns at which both forces act: see evaluate()
    Vector spin = turn_rate;
    if (surface.points().turn())
        spin = surface.turn_rate(t.touch, turning);
    else if (points.turn() && set.body < 0)
        spin = points.turn_rate(i, turning);
    Vector slip = dt * (speed - surface.velocity(t.touch) - spin.cross(offset));
    const double parting = slip.dot(n);  // [m] in the step
    slip -= parting * n;

    const double spring = t.k * (t.reach - t.touch.distance);
    const double damping_before = t.damping_force;
    t.normal_force = std::max(0.0, spring - (dt > 0 ? t.damping * parting / dt : 0));
    t.damping_force = t.normal_force - spring;
    t.damped = -0.5 * (damping_before + t.damping_force) * parting;

    // The remembered force turns with the surface and into the present tangent plane.
    Vector old = t.friction + dt * turn_rate.cross(t.friction);
    old -= old.dot(n) * n;
    const double size = old.norm();
    if (size > 0) old *= t.friction.norm() / size;

    Vector now = old - t.k * slip;
    double limit = set.friction * t.normal_force;
    if (!set.max_friction.empty()) limit = std::min(limit, set.max_friction[i]);
    const double trial = now.norm();
    if (trial > limit) {
        const Vector returned = (limit / trial) * now;
        t.slipped = 0.5 * (old + returned).dot(now - returned) / t.k;
        now = returned;
        t.slips = true;
    }
    t.friction = now;
}

ContactPair::ContactPair(ContactSet set, const Nodes& nodes, const ContactBudget& budget,
                         int threads, const TurningNodes* turning)
    : s_(std::make_unique<State>(std::move(set), nodes, threads, turning)) {
    s_->find_start(nodes);
    s_->set_stiffness(nodes, budget);
}
ContactPair::~ContactPair() = default;
ContactPair::ContactPair(ContactPair&&) noexcept = default;

void ContactPair::balance(const NodeRows& load) {
    State& s = *s_;
    double most = 0;
    for (std::size_t i = 0; i < s.set.nodes.size(); ++i) {
        Toucher& t = s.toucher[i];
        if (!t.near_at_start) continue;
        const double push = -vector(load[s.set.nodes[i]]).dot(t.touch.normal);
        if (push > 0) t.reach += push / t.k;
        most = std::max(most, t.reach);
    }
    s.least_radius = std::max(s.seen_at_rest(), most + s.surface.largest_bulge());
    std::fill(s.radius.begin(), s.radius.end(), s.least_radius);
    s.search();
}

void ContactPair::evaluate(Nodes& nodes, std::vector<RigidBody>& bodies, double dt,
                           TurningNodes* turning) {
    State& s = *s_;
    s.gather(nodes);
    double moved = s.moved();
    if (moved > s.skin()) {
        s.widen(dt);
        s.search();
        moved = 0;
    }
    s.surface.refresh_normals();
    Vector turn_rate = Vector::Zero();
    if (s.set.body >= 0) {
        const Vec3 w = bodies[s.set.body].angular_velocity();
        turn_rate = Vector(w[0], w[1], w[2]);
    }
    const std::int64_t n = std::int64_t(s.set.nodes.size());
#pragma omp parallel for schedule(static) num_threads(s.threads) if (s.threads > 1)
    for (std::int64_t i = 0; i < n; ++i) s.evaluate_node(std::size_t(i), turn_rate, dt, moved);

    // one after the other: sums do not depend on the number of threads
    s.totals = {};
    s.stored = 0;
    for (std::int64_t i = 0; i < n; ++i) {
        const Toucher& t = s.toucher[i];
        s.slipped += t.slipped;
        s.damped += t.damped;
        if (!t.has_touch) continue;
        const Vector force = t.normal_force * t.touch.normal + t.friction;
        const double spring = t.normal_force - t.damping_force;
        s.stored += 0.5 * (spring * spring + t.friction.squaredNorm()) / t.k;
        s.totals.normal_force += t.normal_force;
        ++s.totals.touching;
        s.totals.slipping += t.slips;
        for (int d = 0; d < 3; ++d) {
            s.totals.friction[d] += t.friction[d];
            s.totals.force[d] += force[d];
        }
        // Both forces act at one place: the node's own on rigid bodies and shells, which take
        // moments, else the foot, if the node is of a shell. Solids take none on either side.
        const Vector offset = Vector::Map(&s.x[3 * i]) - s.surface.position(t.touch);
        const bool at_foot = s.points.turn() && s.set.body < 0 && !s.surface.points().turn();
        s.points.add_force(std::size_t(i), force, at_foot ? Vector(-offset) : Vector(0, 0, 0), nodes,
                           turning);
        if (s.set.body >= 0) {
            bodies[s.set.body].add_contact({s.x[3 * i], s.x[3 * i + 1], s.x[3 * i + 2]},
                                           array(-force));
            continue;
        }
        Vector rest = -force;
        const std::int32_t* q = s.surface.facets().corners(t.touch.facet);
        for (int a = 3; a >= 0; --a) {
            const Vector part = a > 0 ? Vector(-t.touch.weight[a] * force) : rest;
            rest -= part;
            s.surface.points().add_force(std::size_t(q[a]), part, offset, nodes, turning);
        }
    }
}

void ContactPair::count_from_here() {
    s_->stored_from = s_->stored;
    s_->slipped = s_->damped = 0;
}

void ContactPair::archive(Archive& a) {
    State& s = *s_;
    a.rows("toucher", s.toucher, [](Toucher& t) {
        return std::tie(t.k, t.damping, t.reach, t.friction[0], t.friction[1], t.friction[2],
                        t.normal_force, t.damping_force, t.near_at_start, t.before, t.touch.facet,
                        t.touch.weight, t.touch.normal[0], t.touch.normal[1], t.touch.normal[2],
                        t.touch.distance, t.has_touch, t.slips, t.slipped, t.damped);
    });
    a("row", s.found.row);  // candidates of the last search
    a("start", s.found.start);
    a("facet", s.found.facet);
    a("distance", s.found.distance);
    a("first", s.first);
    a("last", s.last);
    a("radius", s.radius);
    a("least_radius", s.least_radius);
    a("x_searched", s.x_searched);
    a("surface_searched", s.surface_searched);
    a("searches", s.searches);
    a("normal_force", s.totals.normal_force);
    a("force", s.totals.force);
    a("friction", s.totals.friction);
    a("touching", s.totals.touching);
    a("slipping", s.totals.slipping);
    a("stored", s.stored);
    a("stored_from", s.stored_from);
    a("slipped", s.slipped);
    a("damped", s.damped);
}

const ContactSet& ContactPair::set() const {
    return s_->set;
}
const ContactTotals& ContactPair::totals() const {
    return s_->totals;
}
void ContactPair::add_pressure(std::span<double> pressure) const {
    for (std::size_t i = 0; i < s_->toucher.size(); ++i)
        pressure[s_->set.nodes[i]] += s_->toucher[i].normal_force / s_->set.area[i];
}
double ContactPair::elastic_energy() const {
    return s_->stored - s_->stored_from;
}
double ContactPair::friction_work() const {
    return s_->slipped;
}
double ContactPair::damping_work() const {
    return s_->damped;
}
double ContactPair::largest_step() const {
    return s_->dt_limit;
}
int ContactPair::nodes_near() const {
    return int(std::count_if(s_->toucher.begin(), s_->toucher.end(),
                             [](const Toucher& t) { return t.near_at_start; }));
}
double ContactPair::softest() const {
    return s_->softest;
}
int ContactPair::searches() const {
    return s_->searches;
}

}  // namespace undertow::fem
