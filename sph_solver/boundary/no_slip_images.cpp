#include "sph_solver/boundary/no_slip_images.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

namespace undertow::sph {

void NoSlipImages::find(const Neighborhood& neighbors, const MirrorPlanes& mirror,
                        const std::vector<FluidLaw>& fluids, const Particles& particles) {
    images_.clear();
    listed_.clear();
    PlaneMask holding = 0;
    for (int k = 0; k < mirror.size(); ++k)
        if (mirror.plane(k).slip == Slip::no_slip) holding |= PlaneMask(1) << k;
    if (holding == 0) return;
    const std::vector<Extra>& extras = neighbors.extras();
    const int n = neighbors.fluid_count();
    image_of_.assign(extras.size(), -1);
    for (std::size_t e = 0; e < extras.size(); ++e) {
        if (extras[e].from_body || !(extras[e].mask & holding)) continue;
        const FluidLaw& fluid = fluids[particles.fluid[extras[e].source]];
        if (!fluid.resolves_walls) continue;
        image_of_[e] = static_cast<int>(images_.size());
        const PlaneMask held = extras[e].mask & holding;
        images_.push_back({n + static_cast<int>(e), extras[e].source,
                           ViscousImage(mirror, extras[e].mask, true), held,
                           std::has_single_bit(held) ? std::countr_zero(held) : -1});
    }
    if (neighbors.exact().used)
        exact_change_.resize(images_.size());
    else
        change_.resize(images_.size());
    if (images_.empty()) return;
    reflection_.resize(std::size_t(1) << mirror.size());
    for (std::size_t mask = 0; mask < reflection_.size(); ++mask)
        for (int a = 0; a < 3; ++a)
            for (int b = 0; b < 3; ++b)
                reflection_[mask][a][b] = mirror.reflection(static_cast<PlaneMask>(mask)).m[a][b];
    const ClusterLists& lists = neighbors.fluid_lists();
    begin_.assign(1, 0);
    for (int c = 0; c < lists.clusters(); ++c) {
        for (int k = 0; k < lists.parts(c); ++k) {
            const ClusterLists::Part part = lists.part(c, k);
            for (const int* at = part.begin; at != part.end; ++at)
                if (*at >= n && image_of_[*at - n] >= 0)
                    listed_.push_back({*at, image_of_[*at - n], part.hidden});
        }
        begin_.push_back(static_cast<int>(listed_.size()));
    }
}

void NoSlipImages::pack(const Neighborhood& neighbors, const MirrorPlanes& mirror) {
    if (neighbors.exact().used)
        pack_as<double>(neighbors, mirror, exact_change_);
    else
        pack_as<float>(neighbors, mirror, change_);
}

template <class Real>
void NoSlipImages::pack_as(const Neighborhood& neighbors, const MirrorPlanes& mirror,
                           std::vector<Change<Real>>& change) const {
    const Record<Real>* records = neighbors.records_in<Real>().data();
    const int n = static_cast<int>(images_.size());
#pragma omp parallel for schedule(static) if (n > 4096)
    for (int k = 0; k < n; ++k) {
        const Image& image = images_[k];
        const Record<Real>&from = records[image.source], &free = records[image.record];
        const auto& m = mirror.reflection(image.shown.mirrored).m;
        const Real v[3] = {from.vx, from.vy, from.vz};
        Real shown[3];
        for (int a = 0; a < 3; ++a)
            shown[a] = static_cast<Real>(image.shown.wall[a]) +
                       image.shown.sign *
                           (static_cast<Real>(m[a][0]) * v[0] + static_cast<Real>(m[a][1]) * v[1] +
                            static_cast<Real>(m[a][2]) * v[2]);
        change[k] = {shown[0] - free.vx, shown[1] - free.vy, shown[2] - free.vz};
    }
}

void NoSlipImages::take_wall_viscosity(const std::vector<FluidLaw>& fluids,
                                       const MirrorPlanes& mirror, double spacing,
                                       Particles& particles) const {
    Particles& s = particles;
    if (s.viscosity.empty()) return;
    for (const Image& image : images_) {
        const int i = image.source;
        const FluidLaw& fluid = fluids[s.fluid[i]];
        if (image.plane < 0 || !fluid.viscoplastic()) continue;
        const double z = mirror.distance(image.plane, s.x[i], s.y[i], s.z[i]);
        if (z >= spacing) continue;
        const PlaneWall& wall = mirror.plane(image.plane);
        const Vec3& n = wall.normal;
        Vec3 u{s.vx[i] - wall.velocity[0], s.vy[i] - wall.velocity[1], s.vz[i] - wall.velocity[2]};
        const double across = u[0] * n[0] + u[1] * n[1] + u[2] * n[2];
        for (int a = 0; a < 3; ++a) u[a] -= across * n[a];
        const double rate = std::hypot(u[0], u[1], u[2]) / std::max(z, 0.25 * spacing);
        s.viscosity[i] =
            s.ax.in_double() ? fluid.rheology(rate) : fluid.rheology(static_cast<float>(rate));
    }
}

}  // namespace undertow::sph
