#include "sph_solver/neighbors/neighborhood.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "sph_solver/simd.hpp"

namespace undertow::sph {

namespace {

// Cells of 1.6 dx by 0.8 dx: measured best for clusters of eight on a disordered lattice.
constexpr double cell_width = 1.6, cell_height = 0.8;   // [dx]

}  // namespace

/// Across a periodic face a particle must have its image before anything there may need it: it is the
/// pair's relative drift that the watch bounds, by B - R for those that stand B apart.
double Neighborhood::image_range(const Periodic& periodic) const {
    return periodic.axes().empty() ? support_ + skin_ : DriftWatch::width(support_, skin_);
}

void Neighborhood::lay_out_grid(const Particles& particles, const Periodic& periodic,
                                bool with_bodies) {
    const int n = static_cast<int>(particles.size());
    double x0 = 1e300, y0 = 1e300, z0 = 1e300, x1 = -1e300, y1 = -1e300, z1 = -1e300;
#pragma omp parallel for reduction(min : x0, y0, z0) reduction(max : x1, y1, z1)
    for (int i = 0; i < n; ++i) {
        x0 = std::min(x0, particles.x[i]), x1 = std::max(x1, particles.x[i]);
        y0 = std::min(y0, particles.y[i]), y1 = std::max(y1, particles.y[i]);
        z0 = std::min(z0, particles.z[i]), z1 = std::max(z1, particles.z[i]);
    }
    if (n == 0) x0 = y0 = z0 = x1 = y1 = z1 = 0;
    // dummies outside are left out: none may come near before the next rebuild
    const double margin = support_ + (with_bodies ? goes_ : 2 * skin_);
    const double lo[3] = {x0 - margin, y0 - margin, z0 - margin};
    const double hi[3] = {x1 + margin, y1 + margin, z1 + margin};
    // A few particles thrown far must not cost memory: widen the cells rather than have 16 per particle.
    double widen = 1;
    do {
        grid_.lay_out(lo, hi, widen * cell_width * spacing_, widen * cell_height * spacing_);
        widen *= 1.26;
    } while (grid_.cells() > 16 * std::int64_t(n) + (1 << 16));
    const double extent = std::max({hi[0] - lo[0], hi[1] - lo[1], hi[2] - lo[2]});
    fixed_.unit = extent / (1u << 30);
    // a whole number of units to the period: an image is then moved by it exactly
    if (!periodic.axes().empty()) {
        const double period = periodic.axes()[0].length;
        fixed_.unit = period / std::max(1.0, std::floor(period / fixed_.unit));
    }
    fixed_.inverse = 1 / fixed_.unit;
    fixed_.x0 = 0.5 * (lo[0] + hi[0]), fixed_.y0 = 0.5 * (lo[1] + hi[1]);
    fixed_.z0 = 0.5 * (lo[2] + hi[2]);
    std::copy(lo, lo + 3, lo_);
    std::copy(hi, hi + 3, hi_);
}

/// To be called by all threads of a parallel region; one array at a time, so that scratch stays small.
template <class T>
void Neighborhood::reorder(std::vector<T>& array, std::vector<T>& scratch) const {
#pragma omp single
    scratch.resize(array.size());
    const int n = static_cast<int>(order_.size()), padded = static_cast<int>(array.size());
#pragma omp for schedule(static)
    for (int k = 0; k < padded; ++k) scratch[k] = array[k < n ? order_[k] : k];
#pragma omp single
    array.swap(scratch);
}

void Neighborhood::sort(Particles& particles) {
    const int n = static_cast<int>(particles.size());
    cell_.resize(n);
#pragma omp parallel for schedule(static)
    for (int i = 0; i < n; ++i)
        cell_[i] = grid_.cell(particles.x[i], particles.y[i], particles.z[i]);
    counting_sort(cell_, grid_.cells(), order_, fluid_start_);
    const bool viscous = !particles.viscosity.empty();
    const auto reals = particles.reals();
#pragma omp parallel
    {
        for (std::vector<double>* array : reals) reorder(*array, scratch_);
        reorder(particles.id, scratch_id_);
        reorder(particles.fluid, scratch_byte_);
        if (viscous) {
            reorder(particles.viscosity, scratch_);
            reorder(particles.shear_rate, scratch_);
        }
    }
}

void Neighborhood::find_extras(const Particles& particles, const Bodies& bodies,
                               const MirrorPlanes& mirror) {
    const double range = image_range(mirror.periodic());
    const auto position = [&](const Extra& e) {
        const double x = e.from_body ? bodies.x[e.source] : particles.x[e.source];
        const double y = e.from_body ? bodies.y[e.source] : particles.y[e.source];
        const double z = e.from_body ? bodies.z[e.source] : particles.z[e.source];
        const Reflection& r = mirror.reflection(e.mask);
        return Vec3{r.m[0][0] * x + r.m[0][1] * y + r.m[0][2] * z + r.t[0],
                    r.m[1][0] * x + r.m[1][1] * y + r.m[1][2] * z + r.t[1],
                    r.m[2][0] * x + r.m[2][1] * y + r.m[2][2] * z + r.t[2]};
    };
    // A fluid that fills a part of a period has its images across the faces far away from all that
    // could need them, and out of the reach of fixed-point positions.
    const bool periodic = !mirror.periodic().axes().empty();
    const auto out_of_reach = [&](const Extra& e) {
        const Vec3 at = position(e);
        for (int a = 0; a < 3; ++a)
            if (at[a] < lo_[a] - range || at[a] > hi_[a] + range) return true;
        return false;
    };
    unsorted_extras_.clear();
    const auto add_images = [&](int source, double x, double y, double z, bool from_body) {
        masks_.clear();
        mirror.images_of(x, y, z, range, masks_);
        for (const PlaneMask mask : masks_) {
            const Extra e{source, mask, from_body};
            if (!periodic || !out_of_reach(e)) unsorted_extras_.push_back(e);
        }
    };
    // images of the fluid first: they are the sources of the bodies' extrapolation
    for (std::size_t i = 0; i < particles.size(); ++i)
        add_images(static_cast<int>(i), particles.x[i], particles.y[i], particles.z[i], false);
    for (int d = 0; d < bodies.size(); ++d) {
        if (bodies.x[d] < lo_[0] || bodies.x[d] > hi_[0] || bodies.y[d] < lo_[1] ||
            bodies.y[d] > hi_[1] || bodies.z[d] < lo_[2] || bodies.z[d] > hi_[2])
            continue;   // nothing of the fluid is near
        // behind a plane stand the images of what is before it
        if (mirror.behind(bodies.x[d], bodies.y[d], bodies.z[d])) continue;
        unsorted_extras_.push_back({d, 0, true});
        add_images(d, bodies.x[d], bodies.y[d], bodies.z[d], true);
    }

    cell_.resize(unsorted_extras_.size());
    for (std::size_t e = 0; e < unsorted_extras_.size(); ++e) {
        const Vec3 at = position(unsorted_extras_[e]);
        cell_[e] = grid_.cell(at[0], at[1], at[2]);
    }
    counting_sort(cell_, grid_.cells(), order_, extra_start_);
    extras_.resize(unsorted_extras_.size());
    for (std::size_t k = 0; k < extras_.size(); ++k) extras_[k] = unsorted_extras_[order_[k]];

    records_.resize(fluid_count_ + extras_.size());
    if (!particles.viscosity.empty()) root_viscosity_.resize(records_.size());
    if (exact_.used) {
        exact_.records.resize(records_.size());
        if (!particles.viscosity.empty()) exact_.root_viscosity.resize(records_.size());
    }
    const auto pack = [&](Packed& q, double x, double y, double z) {
        q.x = fixed_(x, fixed_.x0), q.y = fixed_(y, fixed_.y0), q.z = fixed_(z, fixed_.z0);
    };
    for (int i = 0; i < fluid_count_; ++i)
        pack(records_[i], particles.x[i], particles.y[i], particles.z[i]);
    for (std::size_t k = 0; k < extras_.size(); ++k) {
        const Vec3 at = position(extras_[k]);
        pack(records_[fluid_count_ + k], at[0], at[1], at[2]);
    }
}

void Neighborhood::find_smoothing(const Particles& particles, const SmoothingLengths& sizes) {
    const int n = static_cast<int>(records_.size());
    const float room = sizes.variable() ? static_cast<float>(SmoothingLengths::room) : 1.0f;
    smoothing_.resize(n);
    listed_.resize(n);
    if (exact_.used) exact_.smoothing.resize(n);
#pragma omp parallel for schedule(static)
    for (int j = 0; j < n; ++j) {
        const Extra* e = j < fluid_count_ ? nullptr : &extras_[j - fluid_count_];
        const int i = e ? e->source : j;
        const double h = e && e->from_body ? sizes.of_dummies()
                                           : sizes.of(particles.fluid[i], particles.drho[i]);
        smoothing_[j] = static_cast<float>(h);
        if (exact_.used) exact_.smoothing[j] = h;
        listed_[j] = smoothing_[j] * room;
    }
}

void Neighborhood::rebuild(Particles& particles, const Bodies& bodies, const MirrorPlanes& mirror,
                           const SmoothingLengths* sizes, const ThinPlates* plates) {
    fluid_count_ = static_cast<int>(particles.size());
    if (sizes && sizes->variable()) {
        support_ = 2 * SmoothingLengths::room *
                   std::max(sizes->largest_of(particles), bodies.size() ? sizes->of_dummies() : 0);
        goes_ = 1.5 * support_;
    }
    lay_out_grid(particles, mirror.periodic(), bodies.size() > 0);
    sort(particles);
    find_extras(particles, bodies, mirror);
    if (sizes) find_smoothing(particles, *sizes);
    const std::vector<float>* listed = sizes ? &listed_ : nullptr;
    const double range = support_ + skin_;
    fluid_lists_.build(grid_, fixed_, records_, 0, fluid_count_,
                       {{&fluid_start_, 0}, {&extra_start_, fluid_count_}}, range, listed, skin_);
    if (plates) plates->cut(scene(mirror, 0, fluid_count_), fluid_lists_);
    marked_.lay_out(fluid_lists_);

    borders_.clear();
    for (int k = 0; k < mirror.size(); ++k)
        borders_.push_back({mirror.plane(k).point, mirror.plane(k).normal});
    watch_.start(records_, fluid_count_, fixed_, support_, skin_, borders_,
                 image_range(mirror.periodic()), !mirror.periodic().axes().empty());

    // The bodies' dummies are targets as well: records of their own, sources only fluid and its images
    // (images of dummies are skipped in the sum).
    body_targets_.clear();
    if (bodies.size() == 0) return;
    const std::size_t records = records_.size();
    for (std::size_t k = 0; k < extras_.size(); ++k)
        if (extras_[k].from_body && extras_[k].mask == 0) {
            body_targets_.push_back(extras_[k].source);
            records_.push_back(Packed(records_[fluid_count_ + k]));
            if (sizes) listed_.push_back(listed_[fluid_count_ + k]);
        }
    body_lists_.build(grid_, fixed_, records_, static_cast<int>(records),
                      static_cast<int>(body_targets_.size()),
                      {{&fluid_start_, 0}, {&extra_start_, fluid_count_}}, range, listed, skin_);
    if (plates)
        plates->cut(scene(mirror, static_cast<int>(records), int(body_targets_.size())), body_lists_);
    records_.resize(records);   // they were there to be looked at once
}

void Neighborhood::find_fluids(const Particles& particles, FluidBits dummies) {
    const int records = static_cast<int>(records_.size()), clusters = fluid_lists_.clusters();
    record_fluid_.resize(records);
    fluids_.resize(clusters);
#pragma omp parallel
    {
#pragma omp for schedule(static)
        for (int j = 0; j < records; ++j) {
            const bool extra = j >= fluid_count_;
            const Extra* e = extra ? &extras_[j - fluid_count_] : nullptr;
            record_fluid_[j] = extra && e->from_body
                                   ? dummies
                                   : FluidBits(1u << particles.fluid[extra ? e->source : j]);
        }
#pragma omp for schedule(static)
        for (int c = 0; c < clusters; ++c) {
            FluidBits held = 0, met = 0;
            const int end = std::min(fluid_count_, (c + 1) * lanes);
            for (int i = c * lanes; i < end; ++i) held |= record_fluid_[i];
            for (int k = 0; k < fluid_lists_.parts(c); ++k) {
                const ClusterLists::Part part = fluid_lists_.part(c, k);
                for (const int* at = part.begin; at != part.end; ++at) met |= record_fluid_[*at];
            }
            fluids_[c] = {held, FluidBits(held | met)};
        }
    }
}

}  // namespace undertow::sph
