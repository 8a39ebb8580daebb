#pragma once
// One [[fem.rigid]] with its names resolved: which elements and nodes move together, and how heavy.

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "case/case.hpp"

namespace undertow::fem {

struct RigidSet {
    std::string name;
    std::vector<std::int32_t> elements;  // of the mesh
    std::vector<std::int32_t> nodes;     // of the mesh, increasing; of no deformable element
    std::vector<double> mass;            // [kg] of `nodes`, lumped
    std::vector<double> shell_mass;      // [kg] of the first of them, of its shells alone
    std::array<bool, 6> free{};          // x, y, z, rx, ry, rz; axes of space, through the center
    std::array<bool, 3> driven{};        // x, y, z of the center that a [[fem.motion]] tells; not free
    bool turn_driven = false;            // and its turning
    double weight_mass = 0;              // [kg] on which gravity acts
    Vec3 weight_center{};                // [m]
    double added_mass = 0;               // [kg] without weight
    Vec3 added_at{};                     // [m]
};

}  // namespace undertow::fem
