#pragma once
// Where the dummy particles of a body stand.

#include <vector>

#include "sph_solver/boundary/bodies.hpp"

namespace undertow::sph {

struct Dummy {
    Vec3 x;        // [m] in the body's place at rest
    double share;  // of dx^d
};

/// See make_bodies.
std::vector<Dummy> place_dummies(const RigidBody& body, const Case& input);

}  // namespace undertow::sph
