#pragma once
// Contact laws: a few constants, one call per contact.
//
// Effective mass of contact c between particle i and nodes a (shape weights N_a, sum 1):
//   m_c = 1 / (c_i/m_i + sum_a N_a S_a/m_a)  [kg],   S_a = sum of N_a over all contacts on node a,
//                                                    c_i = number of contacts of particle i
// With k_c <= beta m_c/dt^2 for every contact, (omega dt)^2 <= beta for the whole set, however many
// particles press on a node:
//   (sum_b N_b u_b)^2 <= sum_b N_b^2/(p_b m_b) sum_b p_b m_b u_b^2,   p_cb = N_cb/S_b, sum_c p_cb =
//   1
// (Cauchy-Schwarz, element by element). For one contact per node it is m_i m_n/(m_i + m_n) of Eq.
// 11; S_a, unlike a count of contacts, does not jump when a particle slides past a node.

// One source for a number and for lanes of numbers (T): the kernel takes eight contacts at once.

#include "contact/lanes.hpp"

namespace undertow::contact {

/// k = beta m_c/dt^2  [N/m]  [Wang 2024, Eq. 11; printed without the factor m_i, unit 1/s^2:
/// restored]
struct Eq11Stiffness {
    double beta;  // (omega dt)^2
    double dt;    // [s]
    template <typename T>
    T operator()(const T& mass, const T& /*natural*/) const {
        return beta * mass / (dt * dt);
    }
};

/// k = min(beta m_c/dt^2, chi rho c0^2 dx)  [N/m]: a contact no stiffer than the particle itself,
/// so that impact pressures belong to the fluid and not to dt.
struct FluidStiffness {
    Eq11Stiffness limit;
    double chi;
    template <typename T>
    T operator()(const T& mass, const T& natural) const {
        return smaller<T>(limit(mass, natural), chi * natural);
    }
};

/// c = min(2 sqrt(k m_c), eta' m_c/dt)  [N s/m]: critical if the stability budget allows.
/// eta' = eta + (beta - k dt^2/m_c)/2: what the stiffness leaves of beta + 2 eta goes to damping.
/// eta = 0 switches damping off.
struct NormalDamping {
    double beta, eta;
    double dt;  // [s]
    template <typename T>
    T operator()(const T& mass, const T& stiffness) const {
        if (eta <= 0) return spread<T>(0);
        const T spare = larger<T>(spread<T>(0), beta - stiffness * dt * dt / mass);
        return smaller<T>(2 * square_root(stiffness * mass), (eta + 0.5 * spare) * mass / dt);
    }
};

/// A smooth wall: mu = 0.
struct NoFriction {};

/// F_t = min(eta_t m_c v_t/dt, mu F_n)  [N]: Coulomb, viscous below the slip force so that a
/// particle at rest is held instead of being kicked to and fro.
struct CoulombFriction {
    double mu;
    double eta_t;  // <= 1: a sticking particle is slowed, never reversed
    double dt;     // [s]
    template <typename T>
    T operator()(const T& mass, const T& normal_force, const T& speed) const {
        return smaller<T>(eta_t * mass * speed / dt, mu * normal_force);
    }
};

/// F_t = alpha v_t, limited by mu F_n when mu > 0 and by the stability budget  [N]
/// [Wang 2024, Eq. 9; printed as alpha k (du/dt - v), which is no force by its units: alpha in N
/// s/m]
struct ViscousFriction {
    double alpha;  // [N s/m]
    double mu;     // 0 = no limit
    double eta_t;
    double dt;  // [s]
    template <typename T>
    T operator()(const T& mass, const T& normal_force, const T& speed) const {
        const T viscous = smaller<T>(spread<T>(alpha), eta_t * mass / dt) * speed;
        return mu > 0 ? smaller<T>(viscous, mu * normal_force) : viscous;
    }
};

}  // namespace undertow::contact
