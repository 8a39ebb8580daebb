#include "support.hpp"

#include <cmath>
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

ShakenEnergy march_shaken(Structure& structure, int steps) {
    Nodes& nodes = structure.nodes();
    for (std::size_t n = 0; n < nodes.size(); ++n)
        for (int d = 0; d < 3; ++d)
            if (nodes.inverse_mass[n].c[d] > 0) nodes.v[n].c[d] = 1e-3 * std::sin(1e5 * n + d);
    constexpr int begin = 100;
    const int watched = steps / 100;
    ShakenEnergy found;
    march(structure, structure.stable_step().dt, steps, [&](int n) {
        const bool early = n >= begin && n < begin + watched, late = n >= steps - watched;
        if (!early && !late) return;
        const Energies e = structure.energies();
        double& largest = early ? found.early : found.late;
        const double moving = e.kinetic + e.internal + e.hourglass + e.pair_springs;
        largest = moving > largest || !std::isfinite(moving) ? moving : largest;
    });
    return found;
}

}  // namespace undertow::fem
