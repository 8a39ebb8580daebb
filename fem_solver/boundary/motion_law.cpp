#include "fem_solver/boundary/motion_law.hpp"

#include <algorithm>
#include <filesystem>

namespace undertow::fem {
namespace {

/// 6 s^5 - 15 s^4 + 10 s^3, s = t/ramp: no jump in velocity or acceleration.
double rise(double t, double ramp) {
    if (t >= ramp) return 1;
    const double s = std::max(0.0, t / ramp);
    return s * s * s * (10 + s * (6 * s - 15));
}

/// [s] integral of a velocity that rises as s^2 (3 - 2 s), s = t/ramp, to 1.
double run_up(double t, double ramp) {
    if (t <= 0) return 0;
    if (t >= ramp) return t - 0.5 * ramp;
    const double s = t / ramp;
    return ramp * s * s * s * (1 - 0.5 * s);
}

}  // namespace

MotionLaw::MotionLaw(const FemMotion& motion, double t_end, const std::string& folder,
                     const std::string& where)
    : law_(motion) {
    if (!motion.motion.empty())
        table_.emplace((std::filesystem::path(folder) / motion.motion).string(), t_end, where);
    turns_ = motion.angle.has_value() || (table_ && table_->has_angle());
}

MotionLaw::Place MotionLaw::operator()(double t) const {
    Place place;
    if (table_) {
        for (int d = 0; d < 3; ++d) place.shift[d] = (*table_)(d, t).x;
        place.angle = (*table_)(3, t).x;
        return place;
    }
    const double share = rise(t, law_.ramp);
    if (!law_.displacement.empty()) {
        for (int d = 0; d < 3; ++d) place.shift[d] = share * law_.displacement[d](0, 0, 0, t);
    } else {
        const double moving = run_up(t - law_.start, law_.ramp) - run_up(t - law_.stop, law_.ramp);
        for (int d = 0; d < 3; ++d) place.shift[d] = moving * law_.velocity[d];
    }
    if (law_.angle) place.angle = share * (*law_.angle)(0, 0, 0, t);
    return place;
}

}  // namespace undertow::fem
