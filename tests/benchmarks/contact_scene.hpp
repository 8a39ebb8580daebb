#pragma once
// The bucket under three layers of particles that the contact benchmarks share.

#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

namespace undertow::benchmarks {

struct Mesh {
    std::vector<double> x, v, mass;
    std::vector<std::int32_t> quad;
};

/// Side wall of radius 1 m and height 0.5 m and a lid, wet side outward.
inline Mesh bucket(double size) {
    const double radius = 1, height = 0.5;
    const int around = int(2 * M_PI * radius / size), up = int(height / size);
    Mesh mesh;
    const auto ring = [&](double r, double z) {
        for (int i = 0; i < around; ++i) {
            const double angle = 2 * M_PI * i / around;
            mesh.x.insert(mesh.x.end(), {r * std::cos(angle), r * std::sin(angle), z});
        }
    };
    for (int k = 0; k <= up; ++k) ring(radius, height * k / up);
    const int inward = int(radius / size);
    for (int k = inward - 1; k > inward / 8; --k) ring(radius * k / inward, height);
    const int rings = int(mesh.x.size()) / 3 / around;
    for (int k = 0; k + 1 < rings; ++k)
        for (int i = 0; i < around; ++i) {
            const int a = k * around + i, b = k * around + (i + 1) % around;
            mesh.quad.insert(mesh.quad.end(), {a, b, b + around, a + around});
        }
    mesh.v.assign(mesh.x.size(), 0);
    mesh.mass.assign(mesh.x.size() / 3, 0.06);
    return mesh;
}

/// Three layers along side wall and lid (one, if more than a third of the band is to touch). Of the
/// first layer as many as make up the share `touching` of the band are pressed into the surface by
/// a hundredth of the spacing, the others stand off it by a tenth.
inline std::vector<double> band_around(double spacing, double touching = 1.0 / 3) {
    std::mt19937 random(1);
    std::uniform_real_distribution<double> any(-0.05 * spacing, 0.05 * spacing);
    std::vector<double> x;
    const int layers = touching > 0.34 ? 1 : 3;
    std::uint32_t count = 0;
    for (int layer = 0; layer < layers; ++layer) {
        const auto pushed_out = [&] {  // golden ratio: evenly mixed
            const double place = 0.6180339887498949 * double(++count);
            return layer == 0 && place - std::floor(place) >= layers * touching ? 0.1 * spacing : 0;
        };
        const double out = (layer + 0.49) * spacing, r = 1 + out;
        const int around = int(2 * M_PI * r / spacing), up = int(0.5 / spacing);
        for (int k = 0; k < up; ++k)
            for (int i = 0; i < around; ++i) {
                const double angle = 2 * M_PI * i / around + any(random),
                             d = r + 0.2 * any(random) + pushed_out();
                x.insert(x.end(), {d * std::cos(angle), d * std::sin(angle),
                                   (k + 0.5) * spacing + any(random)});
            }
        const int across = int(1 / spacing);
        for (int i = -across; i <= across; ++i)
            for (int j = -across; j <= across; ++j) {
                if (std::hypot(i, j) * spacing > 1) continue;
                x.insert(x.end(), {i * spacing + any(random), j * spacing + any(random),
                                   0.5 + out + 0.2 * any(random) + pushed_out()});
            }
    }
    return x;
}

}  // namespace undertow::benchmarks
