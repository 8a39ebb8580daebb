#include "sph_solver/boundary/plates.hpp"

#include <algorithm>
#include <cmath>

namespace undertow::sph {

Vec3 Plates::velocity(int k, double t) const {
    const PlateWall& w = walls[k];
    return t >= w.start && t < w.stop ? w.velocity : Vec3{};
}

void Plates::move_to(double t) {
    for (int d = 0; d < size(); ++d) {
        const PlateWall& w = walls[plate[d]];
        const double moving = std::clamp(t, w.start, w.stop) - w.start;
        x[d] = x0[d] + moving * w.velocity[0];
        y[d] = y0[d] + moving * w.velocity[1];
        z[d] = z0[d] + moving * w.velocity[2];
    }
}

int Plates::thin_axis(int k) const {
    const Box& b = walls[k].box;
    int axis = 0;
    for (int a = 1; a < 3; ++a)
        if (b.max[a] - b.min[a] < b.max[axis] - b.min[axis]) axis = a;
    return axis;
}

Plates make_plates(const std::vector<PlateWall>& walls, double spacing, int dimension) {
    Plates plates;
    plates.walls = walls;
    for (std::size_t k = 0; k < walls.size(); ++k) {
        const Box& b = walls[k].box;
        int n[3];
        for (int a = 0; a < 3; ++a)
            n[a] = std::max(1, static_cast<int>(std::lround((b.max[a] - b.min[a]) / spacing)));
        if (dimension == 2) n[1] = 1;
        for (int iz = 0; iz < n[2]; ++iz)
            for (int iy = 0; iy < n[1]; ++iy)
                for (int ix = 0; ix < n[0]; ++ix) {
                    const double share[3] = {(ix + 0.5) / n[0], (iy + 0.5) / n[1],
                                             (iz + 0.5) / n[2]};
                    plates.x0.push_back(b.min[0] + share[0] * (b.max[0] - b.min[0]));
                    plates.y0.push_back(dimension == 2 ? 0
                                                       : b.min[1] + share[1] * (b.max[1] - b.min[1]));
                    plates.z0.push_back(b.min[2] + share[2] * (b.max[2] - b.min[2]));
                    plates.plate.push_back(static_cast<int>(k));
                }
    }
    plates.x = plates.x0, plates.y = plates.y0, plates.z = plates.z0;
    for (auto* a : {&plates.vx, &plates.vy, &plates.vz, &plates.p}) a->resize(plates.x0.size(), 0.0);
    plates.viscosity.resize(plates.x0.size(), 0.0f);
    plates.fluid.resize(plates.x0.size(), 0);
    return plates;
}

}  // namespace undertow::sph
