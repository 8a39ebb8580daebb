#include "support.hpp"

#include <cstdint>

namespace undertow::fem {

Case BlockCase::settings() const {
    Case c;
    c.info.gravity = {0, 0, 0};
    c.fem.present = true;
    c.fem.block = FemBlock{{{0, 0, 0}, size}, divisions, {}, cells};
    c.fem.bulk_viscosity_linear = 0;
    c.fem.bulk_viscosity_quadratic = 0;
    c.fem.material = {{.name = "solid",
                       .kind = MaterialKind::linear_elastic,
                       .density = density,
                       .young_modulus = young_modulus,
                       .poisson_ratio = poisson_ratio}};
    c.fem.part = {{"block", "solid", element}};
    return c;
}

Part BlockCase::part(const Mesh& mesh) const {
    return {"block", mesh.volume_sets.at("block"), density,
            LinearElastic::from_young(young_modulus, poisson_ratio)};
}

void distort(Mesh& mesh, const BlockCase& block, double amount) {
    std::uint32_t state = 1;
    const auto random = [&] {
        state = state * 1664525u + 1013904223u;
        return 2.0 * state / 4294967296.0 - 1;
    };
    for (Vec3& x : mesh.x) {
        bool inside = true;
        for (int d = 0; d < 3; ++d)
            inside &= x[d] > 1e-9 * block.size[d] && x[d] < (1 - 1e-9) * block.size[d];
        if (inside)
            for (int d = 0; d < 3; ++d)
                x[d] += amount * random() * block.size[d] / block.divisions[d];
    }
}

void march(Structure& structure, double dt, int steps, const std::function<void(int)>& each) {
    for (int n = 0; n < steps; ++n) {
        structure.internal_forces();
        structure.pressure_forces(n * dt);
        structure.kick(dt);
        each(n);
        structure.drift(dt);
    }
}

}  // namespace undertow::fem
