#include "sph_solver/boundary/surface_images.hpp"

#include <algorithm>
#include <cmath>

#include "contact/candidates.hpp"
#include "contact/facet.hpp"
#include "contact/surface.hpp"
#include "sph_solver/kernels/kernels.hpp"
#include "sph_solver/physics/pair_terms.hpp"

namespace undertow::sph {

namespace {

// Beyond a free edge or around a sharp one the surface is no mirror: there the direction to the
// closest point departs from the facet's normal (cosine), or two particles' normals from each
// other. The mirror fades there: an image that comes and goes at once would do work.
constexpr double no_mirror = 0.7, full_mirror = 0.95, same_wall = 0.7;
// Of a contact force's length: more than this along a wall's normal, and that wall is touched.
constexpr double presses = 0.02;
// Bounds of the lift e in radii l0, its time of return in dx/c0, and its gain: see the header.
constexpr double lift_gain = 0.8, lift_low = -0.3, lift_high = 0.6, lift_return = 400;

/// 0 beyond an edge, 1 above the facet; c: cosine of the foot's direction to the normal.
double mirror_share(double c) {
    const double s = std::clamp((c - no_mirror) / (full_mirror - no_mirror), 0.0, 1.0);
    return s * s * (3 - 2 * s);
}

double dot(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

}  // namespace

void SurfaceImages::place(std::vector<std::int32_t> quad, std::vector<double> x) {
    quad_ = std::move(quad);
    x_ = std::move(x);
    placed_ = x_;
    stale_ = true;
    lift_.resize(expected_);
}

bool SurfaceImages::follow(const std::vector<std::int32_t>& quad, const std::vector<double>& x,
                           double most) {
    if (x.size() != placed_.size() || quad != quad_) return false;
    for (std::size_t k = 0; k < x.size(); k += 3) {
        const double d[3] = {x[k] - placed_[k], x[k + 1] - placed_[k + 1], x[k + 2] - placed_[k + 2]};
        if (dot(d, d) > most * most) return false;
    }
    for (Near& k : near_)
        for (int c = 0; c < 4; ++c)
            for (int a = 0; a < 3; ++a) {
                if (flat_ && a == 1) continue;
                const std::size_t at = 3 * std::size_t(k.corner[c]) + a;
                k.point[a] += k.weight_of[c] * (x[at] - x_[at]);
            }
    x_ = x;
    return true;
}

void SurfaceImages::find_near(const Particles& particles, double range, bool flat) {
    near_.clear();
    slot_.assign(particles.size(), -1);
    double lo[3] = {1e300, 1e300, 1e300}, hi[3] = {-1e300, -1e300, -1e300};
    for (const std::int32_t node : quad_)
        for (int a = 0; a < 3; ++a) {
            lo[a] = std::min(lo[a], x_[3 * std::size_t(node) + a] - range);
            hi[a] = std::max(hi[a], x_[3 * std::size_t(node) + a] + range);
        }
    std::vector<int> inside;
    std::vector<double> x, radius;
    for (std::size_t i = 0; i < particles.size(); ++i) {
        const double at[3] = {particles.x[i], particles.y[i], particles.z[i]};
        bool in = true;
        for (int a = 0; a < 3; ++a) in = in && at[a] >= lo[a] && at[a] <= hi[a];
        if (!in) continue;
        inside.push_back(static_cast<int>(i));
        x.insert(x.end(), at, at + 3);
    }
    radius.assign(inside.size(), range);
    if (inside.empty()) return;

    contact::Surface surface(quad_, std::vector<double>(x_.size() / 3, 1.0));
    const std::vector<double> at_rest(x_.size(), 0.0);
    surface.move(x_, at_rest);
    contact::FacetCells cells;
    contact::CandidateList found;
    // the search asks for positions and radii only
    cells.search({.x = x, .v = x, .mass = radius, .radius = radius, .stiffness = radius, .id = {}},
                 surface, 0, found);
    for (std::size_t c = 0; c < found.row.size(); ++c) {
        const contact::Vec at = contact::Vec::Map(&x[3 * std::size_t(found.row[c])]);
        const std::size_t first = near_.size();
        for (std::uint32_t f = found.start[c]; f < found.start[c + 1]; ++f) {
            const contact::Foot foot = contact::closest_point(at, surface.shape(found.facet[f]));
            if (!(foot.distance < range)) continue;
            const double share = mirror_share(foot.offset.dot(foot.normal) / foot.distance);
            if (!(share > 0)) continue;
            // across a seam the direction to the foot turns from one facet's normal to the next's
            contact::Vec n = foot.offset / foot.distance;
            if (flat) n.y() = 0, n.normalize();   // rounding must not push anybody out of the plane
            const contact::Vec at_foot = at - foot.distance * n;
            Near near{};
            near.particle = inside[found.row[c]];
            near.distance = foot.distance;
            near.share = share;
            for (int a = 0; a < 4; ++a) {
                near.corner[a] = quad_[4 * std::size_t(found.facet[f]) + a];
                near.weight_of[a] = foot.weight[a];
            }
            for (int a = 0; a < 3; ++a) near.point[a] = at_foot[a], near.normal[a] = n[a];
            for (int a = 0; a < 3; ++a) near.facet[a] = foot.normal[a];
            std::size_t k = first;   // in a corner a particle has several walls, of each one foot
            while (k < near_.size() && dot(near_[k].facet, near.facet) < same_wall) ++k;
            if (k == near_.size())
                near_.push_back(near);
            else if (near.distance < near_[k].distance)
                near_[k] = near;
        }
        if (near_.size() > first) slot_[inside[found.row[c]]] = static_cast<int>(first);
    }
}

/// The wall of `source` that looks the same way as `normal`: index in near_, -1 if it has none.
int SurfaceImages::same_wall_of(int source, const double normal[3]) const {
    int best = -1;
    double closest = same_wall;
    for (int b = slot_[source]; b >= 0 && b < static_cast<int>(near_.size()) &&
                                near_[b].particle == source; ++b) {
        const double c = dot(near_[b].normal, normal);
        if (c >= closest) closest = c, best = b;
    }
    return best;
}

void SurfaceImages::find_pairs(const Particles& particles, const Neighborhood& neighbors,
                               double spacing, double moves, bool flat) {
    stale_ = false;
    spacing_ = spacing;
    flat_ = flat;
    pairs_.clear();
    const double reach = neighbors.support() + 2 * moves;
    // the other one of a pair is hardly nearer to the surface than a particle that touches
    find_near(particles, reach - 0.4 * spacing, flat);
    const std::vector<Packed>& records = neighbors.records();
    const std::vector<Extra>& extras = neighbors.extras();
    const FixedPoint& fixed = neighbors.fixed();
    const ClusterLists& lists = neighbors.fluid_lists();
    const int n = neighbors.fluid_count();
    const auto height = [&](const Near& k) {
        const double d[3] = {particles.x[k.particle] - k.point[0],
                             particles.y[k.particle] - k.point[1],
                             particles.z[k.particle] - k.point[2]};
        return dot(d, k.normal);
    };
    for (int a = 0; a < static_cast<int>(near_.size()); ++a) {
        const Near& i = near_[a];
        const int own = i.particle;
        const double s_i = height(i);
        lists.for_each_seen(own, [&](int record) {
            const bool mirrored = record >= n;
            if (mirrored && extras[record - n].from_body) return;
            const int source = mirrored ? extras[record - n].source : record;
            const int b = source == own && !mirrored ? a : same_wall_of(source, i.normal);
            if (b < 0 || (!mirrored && b < a)) return;  // each pair once
            const Near& j = near_[b];
            const double d[3] = {double(records[own].x - records[record].x) * fixed.unit,
                                 double(records[own].y - records[record].y) * fixed.unit,
                                 double(records[own].z - records[record].z) * fixed.unit};
            if (mirrored) {  // at a plane that crosses the surface, not at one along it
                const double shift[3] = {(records[source].x - records[record].x) * fixed.unit,
                                         (records[source].y - records[record].y) * fixed.unit,
                                         (records[source].z - records[record].z) * fixed.unit};
                if (std::abs(dot(shift, i.normal)) > 0.1 * std::sqrt(dot(shift, shift))) return;
            }
            const double s = s_i + height(j), dn = dot(d, i.normal);
            if (dot(d, d) - dn * dn + s * s >= reach * reach) return;
            Pair pair{a, b, mirrored ? record : -1, {i.normal[0], i.normal[1], i.normal[2]}, 0};
            if (!mirrored) {
                for (int c = 0; c < 3; ++c) pair.n[c] += j.normal[c];
                const double length = std::sqrt(dot(pair.n, pair.n));
                for (double& component : pair.n) component /= length;
            }
            pairs_.push_back(pair);
        });
    }
    deal_out_pairs();
}

/// A pair writes to both its entries. Entries lie along the surface in the order of the particles: cut
/// into blocks, few pairs cross a cut; blocks run side by side, and those few afterwards.
void SurfaceImages::deal_out_pairs() {
    const std::size_t blocks = std::clamp<std::size_t>(near_.size() / 512, 1, 64);
    const auto block_of = [&](int k) { return std::size_t(k) * blocks / near_.size(); };
    const auto bucket = [&](const Pair& p) {
        const std::size_t a = block_of(p.a);
        return a == block_of(p.b) ? a : blocks;
    };
    block_begin_.assign(blocks + 2, 0);
    for (const Pair& p : pairs_) ++block_begin_[bucket(p) + 1];
    for (std::size_t b = 0; b <= blocks; ++b) block_begin_[b + 1] += block_begin_[b];
    std::vector<std::size_t> at(block_begin_.begin(), block_begin_.end() - 1);
    dealt_.resize(pairs_.size());
    for (const Pair& p : pairs_) dealt_[at[bucket(p)]++] = p;
    pairs_.swap(dealt_);
    block_begin_.pop_back();
}

template <class F>
void SurfaceImages::for_all_pairs(F&& f) {
    const int blocks = static_cast<int>(block_begin_.size()) - 1;
#pragma omp parallel for schedule(dynamic, 1)
    for (int b = 0; b < blocks; ++b)
        for (std::size_t k = block_begin_[b]; k < block_begin_[b + 1]; ++k) f(pairs_[k]);
    for (std::size_t k = block_begin_.back(); k < pairs_.size(); ++k) f(pairs_[k]);
}

/// A particle that touches backs itself. Another one is backed by the touching ones around it,
/// weight W_it; one of them a spacing away backs it fully.
template <class KernelLaw>
void SurfaceImages::find_backing(const KernelLaw& kernel, const Particles& p) {
    const int n = static_cast<int>(near_.size());
#pragma omp parallel for schedule(static)
    for (int e = 0; e < n; ++e) {
        Near& k = near_[e];
        const int i = k.particle;
        const double d[3] = {p.x[i] - k.point[0], p.y[i] - k.point[1], p.z[i] - k.point[2]};
        k.distance = dot(d, k.normal);
        k.weight = k.wall_speed = 0;
        k.rate = k.push = k.mirror = k.a[0] = k.a[1] = k.a[2] = 0;
    }
    const auto lean = [&](Near& on, const Near& touching, double w) {
        const int t = touching.particle;
        const Lift& l = lift_[p.id[t]];
        on.weight += w;
        on.wall_speed += w * ((p.vx[t] - l.rate[0]) * on.normal[0] +
                              (p.vy[t] - l.rate[1]) * on.normal[1] +
                              (p.vz[t] - l.rate[2]) * on.normal[2]);
    };
    for_all_pairs([&](Pair& pair) {
        Near &i = near_[pair.a], &j = near_[pair.b];
        pair.lean = 0;
        if (pair.record >= 0 || i.touches == j.touches) return;
        const int a = i.particle, b = j.particle;
        const double d[3] = {p.x[a] - p.x[b], p.y[a] - p.y[b], p.z[a] - p.z[b]};
        pair.lean = kernel.value(std::sqrt(dot(d, d)));
        i.touches ? lean(j, i, pair.lean) : lean(i, j, pair.lean);
    });
    const double full = kernel.value(spacing_);
    for (Near& k : near_) {
        if (k.touches) {
            k.backing = k.share;
            k.wall_speed = 0;
            lean(k, k, 1);
        } else {
            k.backing = k.share * std::min(1.0, k.weight / full);
            if (k.weight > 0) k.wall_speed /= k.weight;
        }
    }
}

void SurfaceImages::find_touching(const Particles& p) {
    for (Near& k : near_) {
        const double f[3] = {p.fx[k.particle], p.fy[k.particle], p.fz[k.particle]};
        k.touches = dot(f, k.normal) > presses * std::sqrt(dot(f, f));
    }
}

void SurfaceImages::find_lifts(const PairPhysics& physics, const Particles& p) {
    double c0 = 0;
    for (const FluidLaw& fluid : physics.fluids) c0 = std::max(c0, fluid.c0);
    const double back = c0 / (lift_return * spacing_);   // [1/s]
    // Whoever was lifted comes back, also where he no longer is above the surface: around an edge a
    // particle touches without a mirror.
    std::size_t kept = 0;
    for (const std::int64_t id : lifted_) {
        Lift& l = lift_[id];
        const bool gone = dot(l.e, l.e) < 1e-12 * spacing_ * spacing_;
        for (int c = 0; c < 3; ++c) {
            if (gone) l.e[c] = 0;
            l.rate[c] = -back * l.e[c];
        }
        l.listed = !gone;
        if (!gone) lifted_[kept++] = id;
    }
    lifted_.resize(kept);
    for (std::size_t k = 0; k < near_.size();) {
        const int i = near_[k].particle;
        bool touches = false;
        double mirrored[3] = {0, 0, 0};   // what images ask of the contact, over the mass [m/s2]
        for (; k < near_.size() && near_[k].particle == i; ++k) {
            if (!near_[k].touches) continue;
            touches = true;
            for (int c = 0; c < 3; ++c) mirrored[c] += near_[k].mirror * near_[k].normal[c];
        }
        if (!touches) continue;
        Lift& l = lift_[p.id[i]];
        const FluidLaw& fluid = physics.fluids[p.fluid[i]];
        const double l0 = 0.5 * spacing_, low = lift_low * l0, high = lift_high * l0;
        const double f[3] = {p.fx[i], p.fy[i], p.fz[i]}, force = std::sqrt(dot(f, f));
        double n[3], along = 0, mirror = 0;
        for (int c = 0; c < 3; ++c) {
            n[c] = f[c] / force;
            mirror += mirrored[c] * n[c];
            along += l.e[c] * n[c];
        }
        const double most = 0.02 * fluid.c0;
        double rate = lift_gain * spacing_ * (mirror - force) / fluid.c0;
        rate = std::clamp(rate, -most, most);
        if ((along >= high && rate > 0) || (along <= low && rate < 0)) rate = 0;
        for (int c = 0; c < 3; ++c) l.rate[c] += rate * n[c];
        if (!l.listed) lifted_.push_back(p.id[i]);
        l.listed = true;
    }
}

double SurfaceImages::advance(double dt) {
    double fastest2 = 0;
    for (const std::int64_t id : lifted_) {
        Lift& l = lift_[id];
        for (int c = 0; c < 3; ++c) l.e[c] += dt * l.rate[c];
        fastest2 = std::max(fastest2, dot(l.rate, l.rate));
    }
    return std::sqrt(fastest2);
}

/// The pair terms of pair_terms.hpp between i and j', the pressure of the image continued
/// hydrostatically. An image is of its owner's fluid.
template <class KernelLaw>
void SurfaceImages::add_pairs(const PairPhysics& physics, const KernelLaw& kernel,
                              const Neighborhood& neighbors, const Particles& p) {
    const FixedPoint& fixed = neighbors.fixed();
    const std::vector<Packed>& records = neighbors.records();
    const double h = physics.h, inverse_h = 1 / h, scale = kernel.scale() / physics.lattice_moment;
    // of the records: the sums have found the next ones already
    const ExactShown& exact = neighbors.exact();
    const bool variable = !neighbors.root_viscosity().empty();
    const auto root_mu = [&](int j) {
        return exact.used ? exact.root_viscosity[j] : double(neighbors.root_viscosity()[j]);
    };
    const double per_moment = physics.implicit_viscosity ? 0 : 2;
    const bool strain = physics.explicit_form() == ViscousForm::strain;
    for (Near& k : near_) {
        const FluidLaw& fluid = physics.fluids[p.fluid[k.particle]];
        k.mass = fluid.rho0 * fluid.volume;
        k.per_mass = 1 / k.mass;
        k.volume = exact.used ? exact.records[k.particle].volume : records[k.particle].volume;
        k.density = k.mass / k.volume;
    }
    // [a][b] for the fluids a of i and b of j
    constexpr std::size_t most = FluidTag::most;
    const std::size_t fluids = physics.fluids.size();
    double shock[most][most], mu[most][most], diffusive[most][most];   // [Pa s], [Pa s], [s/m^2]
    double weight[most][3];                                            // rho0 g [Pa/m]
    for (std::size_t a = 0; a < fluids; ++a) {
        const FluidLaw& own = physics.fluids[a];
        for (int c = 0; c < 3; ++c) weight[a][c] = own.rho0 * physics.gravity[c];
        for (std::size_t b = 0; b < fluids; ++b) {
            const FluidLaw& other = physics.fluids[b];
            const double impedance =
                a == b ? own.c0 * own.rho0 : 0.5 * (own.c0 * own.rho0 + other.c0 * other.rho0);
            shock[a][b] = physics.artificial_viscosity * h * impedance;
            mu[a][b] = a == b ? own.mu : harmonic_mean(own.mu, other.mu);
            diffusive[a][b] = a == b ? 2 * physics.density_diffusion * h / own.c0 : 0;
        }
    }
    for_all_pairs([&](const Pair& pair) {
        Near &i = near_[pair.a], &j = near_[pair.b];
        const double backing = i.backing * j.backing;
        if (!(backing > 0)) return;
        const int a = i.particle, b = j.particle;
        const bool mirrored = pair.record >= 0;
        const double* n = pair.n;
        double d[3] = {p.x[a] - p.x[b], p.y[a] - p.y[b], p.z[a] - p.z[b]};
        if (mirrored && exact.used) {
            const ExactRecord& q = exact.records[pair.record];
            d[0] = p.x[a] - q.x, d[1] = p.y[a] - q.y, d[2] = p.z[a] - q.z;
        } else if (mirrored) {
            const Packed& q = records[pair.record];
            d[0] = p.x[a] - fixed.x0 - q.x * fixed.unit;
            d[1] = p.y[a] - fixed.y0 - q.y * fixed.unit;
            d[2] = p.z[a] - fixed.z0 - q.z * fixed.unit;
        }
        const double dn = dot(d, n), s = i.distance + j.distance;
        const double r2 = dot(d, d) - dn * dn + s * s;
        if (r2 >= 4 * h * h) return;
        const double v_a[3] = {p.vx[a], p.vy[a], p.vz[a]};
        double v[3] = {p.vx[a] - p.vx[b], p.vy[a] - p.vy[b], p.vz[a] - p.vz[b]};
        if (mirrored && exact.used) {
            const ExactRecord& q = exact.records[pair.record];
            v[0] = p.vx[a] - q.vx, v[1] = p.vy[a] - q.vy, v[2] = p.vz[a] - q.vz;
        } else if (mirrored) {
            const Packed& q = records[pair.record];
            v[0] = p.vx[a] - q.vx, v[1] = p.vy[a] - q.vy, v[2] = p.vz[a] - q.vz;
        }
        const double vn = dot(v, n);
        double along[3], slip[3];  // parts of x_ij and v_ij in the tangent plane
        for (int c = 0; c < 3; ++c) along[c] = d[c] - dn * n[c], slip[c] = v[c] - vn * n[c];
        const double F =
            backing * scale * KernelLaw::template gradient_factor<double, double>(r2, inverse_h);
        // v_i + v_j along n, both seen from the wall
        const double closing = 2 * dot(v_a, n) - vn - i.wall_speed - j.wall_speed;
        const double approach = dot(slip, along) + closing * s;
        const int of_a = p.fluid[a], of_b = p.fluid[b];
        const double spread = F * approach,
                     level = F * diffusive[of_a][of_b] * (p.p[b] - p.p[a] + dot(weight[of_a], d));
        const double viscous = approach < 0 ? -shock[of_a][of_b] * approach / r2 : 0;
        const double pair_mu =
            variable ? mean_viscosity(of_a == of_b ? 1.0 : 0.0, root_mu(a), root_mu(b))
                     : mu[of_a][of_b];
        double laminar = per_moment * pair_mu * F, stress = 0;
        if (strain) {   // along x_ij', as a pressure
            stress = -per_moment * pair_mu * approach *
                     std::max(0.0, physics.strain_weight.near / r2 +
                                       physics.strain_weight.far * inverse_h * inverse_h);
            laminar = 0;
        }
        const double mean = p.p[a] + p.p[b] + viscous + stress;
        const double gn_a = dot(weight[of_a], n), gn_b = dot(weight[of_b], n);
        const double volumes = i.volume * j.volume;
        // normal: P_i = p_i + p_j - 2 s_j rho0_j g.n, of the image; along the wall their mean, so
        // that the two forces cancel
        const double P =
            mean - (of_a == of_b ? s * gn_a : i.distance * gn_a + j.distance * gn_b);
        const auto give = [&](Near& k, double sign, const Near& other, double level_k, double gn) {
            const double per_mass = volumes * k.per_mass;
            k.rate += other.volume * (level_k - k.density * spread);
            for (int c = 0; c < 3; ++c)
                k.a[c] += sign * per_mass * (F * P * along[c] - laminar * slip[c]);
            k.push += per_mass * (F * (mean - 2 * other.distance * gn) * s - laminar * closing);
            k.mirror += per_mass * F * (p.p[a] + p.p[b] - 2 * other.distance * gn) * s;
        };
        give(i, 1, j, level, gn_b);
        if (!mirrored && a != b) give(j, -1, i, -level, gn_a);
    });
}

/// -g_i to the touching particles, by their weights.
void SurfaceImages::add_reactions() {
    for_all_pairs([&](const Pair& pair) {
        if (!(pair.lean > 0)) return;
        Near &i = near_[pair.a], &j = near_[pair.b];
        Near &pushed = i.touches ? j : i, &touching = i.touches ? i : j;
        const double part = pair.lean / pushed.weight * (pushed.mass / touching.mass),
                     share = part * pushed.push;
        touching.mirror += part * pushed.mirror * dot(pushed.normal, touching.normal);
        for (int c = 0; c < 3; ++c) touching.a[c] -= share * pushed.normal[c];
    });
    for (Near& k : near_)
        if (!k.touches)
            for (int c = 0; c < 3; ++c) k.a[c] += k.push * k.normal[c];
}

void SurfaceImages::add(const PairPhysics& physics, const Neighborhood& neighbors, Terms terms,
                        Particles& particles) {
    find_touching(particles);
    if (pairs_.empty()) {
        if (terms != Terms::rate) find_lifts(physics, particles);
        return;
    }
    const auto sum = [&](const auto& kernel) {
        find_backing(kernel, particles);
        add_pairs(physics, kernel, neighbors, particles);
        if (terms != Terms::rate) add_reactions();
    };
    with_kernel(physics.kernel, physics.h, physics.dimension, sum);
    if (terms != Terms::rate) find_lifts(physics, particles);
    for (const Near& k : near_) {
        const int i = k.particle;
        if (terms != Terms::force) particles.drho_dt.add(i, k.rate);
        if (terms == Terms::rate) continue;
        particles.ax.add(i, k.a[0]);
        particles.ay.add(i, k.a[1]);
        particles.az.add(i, k.a[2]);
    }
}

}  // namespace undertow::sph
