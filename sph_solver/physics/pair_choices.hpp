#pragma once
// What sums over pairs are asked for: known to all that call them, without the loops themselves.

namespace undertow::sph {

enum class Terms { rate, force, both };

/// grad v of the continuity equation as summed, or times M^-1 (gradient_correction.hpp).
enum class Gradient { plain, corrected };

/// Of the viscous force along the line between two particles, see kernels/strain_weight.hpp.
struct StrainWeight {
    double near = 0;  // [-]
    double far = 0;   // [-]
};

}  // namespace undertow::sph
