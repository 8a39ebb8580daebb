#pragma once
// Where a [[fem.motion]] has its nodes at a time.

#include <optional>
#include <string>

#include "case/case.hpp"
#include "case/motion_table.hpp"

namespace undertow::fem {

class MotionLaw {
 public:
    /// `t_end` [s] of the run, `folder` from where the table's path starts, `where` for messages.
    MotionLaw(const FemMotion& motion, double t_end, const std::string& folder,
              const std::string& where);

    /// From the place at t = 0.
    struct Place {
        Vec3 shift{};      // [m]
        double angle = 0;  // [rad] about axis() through center(), which is shifted along
    };
    Place operator()(double t) const;

    bool turns() const { return turns_; }
    const Vec3& axis() const { return law_.axis; }
    const Vec3& center() const { return law_.center; }

 private:
    FemMotion law_;
    std::optional<MotionTable> table_;
    bool turns_ = false;
};

}  // namespace undertow::fem
