#include "fem_solver/elements/batched_group.hpp"

#include <cmath>

namespace undertow::fem {

ElementLaw make_law(const Part& part, const LinearElastic& moduli,
                    const BulkViscosity& viscosity) {
    const double lambda = moduli.lambda, mu = moduli.mu;
    const double nu = moduli.poisson_ratio();
    return {.inverse_density = 1 / part.density,
            .lambda = lambda,
            .mu = mu,
            .sound_speed = std::sqrt((lambda + 2 * mu) / part.density),
            .bending_modulus = 2 * mu / (1 - nu),
            .poisson_ratio = nu,
            .young_modulus = 2 * mu * (1 + nu),
            .bulk_viscosity_linear = viscosity.linear,
            .bulk_viscosity_quadratic = viscosity.quadratic};
}

double weight_share(const Part& part) {
    return part.weight_density ? *part.weight_density / part.density : 1;
}

}  // namespace undertow::fem
