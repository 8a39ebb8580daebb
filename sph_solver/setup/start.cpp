#include "sph_solver/setup/start.hpp"

#include <algorithm>
#include <cmath>

namespace undertow::sph {

namespace {

/// Critical damping of the slowest standing sound wave in a column with a free surface: a quarter
/// wave, omega = pi c0/(2 H), gamma = 2 omega.   [1/s]
double critical_damping(const Case& input, double c0) {
    double low = 1e300, high = -1e300;
    for (const Fill& f : input.sph.fill) {
        low = std::min(low, f.box.min[2]);
        high = std::max(high, f.surface_level.value_or(f.box.max[2]));
    }
    return M_PI * c0 / (high - low);
}

}  // namespace

Start::Start(const Case& input, std::vector<std::int64_t> first_id, double c0)
    : settle_(input.start.settle),
      damping_(input.start.damping > 0 ? input.start.damping : critical_damping(input, c0)),
      end_(settle_) {
    for (std::size_t k = 0; k < input.sph.fill.size(); ++k) {
        const Fill& fill = input.sph.fill[k];
        if (fill.ramp == 0) continue;
        blocks_.push_back({first_id[k], first_id[k + 1], fill.velocity, fill.ramp});
        end_ = std::max(end_, settle_ + fill.ramp);
    }
}

Vec3 Start::block_velocity(int block, double t) const {
    const Block& b = blocks_[block];
    const double s = std::clamp((t - settle_) / b.ramp, 0.0, 1.0);
    const double share = s * s * (3 - 2 * s);
    return {share * b.velocity[0], share * b.velocity[1], share * b.velocity[2]};
}

void Start::constrain(double t, double dt, double kick, const Vec3& gravity,
                      Particles& particles) const {
    if (kick <= 0) return;
    const double after = t + 0.5 * dt;
    // v+ = (v + a kick)/(1 + gamma kick): implicit, whatever gamma is
    const double keep = t < settle_ ? 1 / (1 + damping_ * kick) : 1;
    Particles& s = particles;
    const int n = static_cast<int>(s.size());
    std::vector<Vec3> velocity(blocks_.size());
    for (std::size_t b = 0; b < blocks_.size(); ++b)
        velocity[b] = block_velocity(static_cast<int>(b), after);
#pragma omp parallel for schedule(static)
    for (int i = 0; i < n; ++i) {
        const Vec3 other{s.fx[i] + gravity[0], s.fy[i] + gravity[1], s.fz[i] + gravity[2]};
        const Vec3 v{s.vx[i], s.vy[i], s.vz[i]};
        Vec3 next;
        const double a[3] = {s.ax[i], s.ay[i], s.az[i]};
        for (int k = 0; k < 3; ++k) next[k] = keep * (v[k] + kick * (a[k] + other[k]));
        for (std::size_t b = 0; b < blocks_.size(); ++b)
            if (s.id[i] >= blocks_[b].first_id && s.id[i] < blocks_[b].end_id &&
                t < settle_ + blocks_[b].ramp)
                next = velocity[b];
        s.ax.set(i, (next[0] - v[0]) / kick - other[0]);
        s.ay.set(i, (next[1] - v[1]) / kick - other[1]);
        s.az.set(i, (next[2] - v[2]) / kick - other[2]);
    }
}

}  // namespace undertow::sph
