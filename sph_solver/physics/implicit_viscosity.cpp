#include "sph_solver/physics/implicit_viscosity.hpp"

#include <algorithm>
#include <cmath>

namespace undertow::sph {

/// body(i) summed in blocks, and the blocks in order: the same bits for any number of threads.
template <class Real>
template <class Body>
double ImplicitUpdate<Real>::sum_over_particles(int n, Body&& body) {
    constexpr int block = 512;
    const int blocks = (n + block - 1) / block;
    part_.resize(blocks);
#pragma omp parallel for schedule(static)
    for (int b = 0; b < blocks; ++b) {
        double sum = 0;
        for (int i = b * block; i < std::min(n, (b + 1) * block); ++i) sum += body(i);
        part_[b] = sum;
    }
    double sum = 0;
    for (const double part : part_) sum += part;
    return sum;
}

template <class Real>
void ImplicitUpdate<Real>::solve(const PairPhysics& physics, const Neighborhood& neighbors,
                                 const MirrorPlanes& mirror, const NoSlipImages& no_slip,
                                 const Bodies& bodies, double kick, const Vec3& g,
                                 std::size_t identities, Particles& particles) {
    Particles& s = particles;
    const int n = static_cast<int>(s.size());
    if (n == 0 || !(kick > 0)) return;
    operator_.prepare(physics, neighbors, mirror, no_slip, bodies, s);
    before_.resize(identities);
    for (Field3<Real>* f : {&guess_, &change_, &residual_, &direction_, &image_}) f->resize(n);
    const Real* m = operator_.mass().data();

    // what the velocity would be with the acceleration of the step before
    const double weight = sum_over_particles(n, [&](int i) {
        const Before& b = before_[s.id[i]];
        guess_.x[i] = Real(s.vx[i] + kick * b.a[0]);
        guess_.y[i] = Real(s.vy[i] + kick * b.a[1]);
        guess_.z[i] = Real(s.vz[i] + kick * b.a[2]);
        return double(m[i]);
    });
    const double rubbed = operator_.rub(guess_, kick, image_);
    operator_.diagonal(kick, diagonal_);
    // r = m (u* + left - u) - k K u
    const double drive = sum_over_particles(n, [&](int i) {
        const Before& b = before_[s.id[i]];
        const double ax = s.ax[i] + s.fx[i] + g[0], ay = s.ay[i] + s.fy[i] + g[1],
                     az = s.az[i] + s.fz[i] + g[2];
        const double x = s.vx[i] - guess_.x[i] + b.left[0] + kick * ax,
                     y = s.vy[i] - guess_.y[i] + b.left[1] + kick * ay,
                     z = s.vz[i] - guess_.z[i] + b.left[2] + kick * az;
        residual_.x[i] = Real(m[i] * x) - image_.x[i];
        residual_.y[i] = Real(m[i] * y) - image_.y[i];
        residual_.z[i] = Real(m[i] * z) - image_.z[i];
        change_.x[i] = change_.y[i] = change_.z[i] = 0;
        return m[i] * std::max(ax * ax + ay * ay + az * az, double(b.a[0]) * b.a[0] +
                                                                double(b.a[1]) * b.a[1] +
                                                                double(b.a[2]) * b.a[2]);
    });
    // fluid in equilibrium under its own weight has next to no drive: then its weight is the
    // measure
    const double g2 = g[0] * g[0] + g[1] * g[1] + g[2] * g[2];
    const double scale2 = kick * kick * std::max(drive, 1e-4 * g2 * weight) + rubbed;

    double rz = 0;
    const auto precondition = [&](int i) {
        const Real d = 1 / diagonal_[i];
        return double(d) *
               (double(residual_.x[i]) * residual_.x[i] + double(residual_.y[i]) * residual_.y[i] +
                double(residual_.z[i]) * residual_.z[i]);
    };
    const auto unbalanced = [&] {
        return sum_over_particles(n, [&](int i) {
            return (double(residual_.x[i]) * residual_.x[i] +
                    double(residual_.y[i]) * residual_.y[i] +
                    double(residual_.z[i]) * residual_.z[i]) /
                   m[i];
        });
    };
    double left2 = unbalanced();
    const double asked2 = tolerance_ * tolerance_ * scale2;
    const double enough2 = std::max(asked2, known_digits * known_digits * left2);
    rz = sum_over_particles(n, precondition);
    int iteration = 0;
    double beta = 0;
    while (left2 > enough2 && iteration < most_iterations_) {
        ++iteration;
#pragma omp parallel for schedule(static)
        for (int i = 0; i < n; ++i) {
            const Real d = 1 / diagonal_[i], b = Real(beta);
            direction_.x[i] = d * residual_.x[i] + (beta > 0 ? b * direction_.x[i] : 0);
            direction_.y[i] = d * residual_.y[i] + (beta > 0 ? b * direction_.y[i] : 0);
            direction_.z[i] = d * residual_.z[i] + (beta > 0 ? b * direction_.z[i] : 0);
        }
        const double curvature =
            operator_.apply(direction_, ViscousOperator<Real>::Walls::still, 1, kick, image_);
        const auto alpha = Real(rz / curvature);
        const double rz_next = sum_over_particles(n, [&](int i) {
            change_.x[i] += alpha * direction_.x[i], residual_.x[i] -= alpha * image_.x[i];
            change_.y[i] += alpha * direction_.y[i], residual_.y[i] -= alpha * image_.y[i];
            change_.z[i] += alpha * direction_.z[i], residual_.z[i] -= alpha * image_.z[i];
            return precondition(i);
        });
        beta = rz_next / rz;
        rz = rz_next;
        left2 = unbalanced();
    }
    ++figures_.steps;
    figures_.iterations += iteration;
    figures_.most_iterations = std::max(figures_.most_iterations, iteration);
    if (left2 > asked2) {
        ++figures_.not_converged;
        figures_.worst_residual = std::max(figures_.worst_residual, std::sqrt(left2 / asked2));
    }
#pragma omp parallel for schedule(static)
    for (int i = 0; i < n; ++i) {
        Before& b = before_[s.id[i]];
        const double per = 1 / kick;
        const double x = per * (double(guess_.x[i]) + change_.x[i] - s.vx[i]),
                     y = per * (double(guess_.y[i]) + change_.y[i] - s.vy[i]),
                     z = per * (double(guess_.z[i]) + change_.z[i] - s.vz[i]);
        b = {{Real(x), Real(y), Real(z)},
             {residual_.x[i] / m[i], residual_.y[i] / m[i], residual_.z[i] / m[i]}};
        s.ax.set(i, x - s.fx[i] - g[0]);
        s.ay.set(i, y - s.fy[i] - g[1]);
        s.az.set(i, z - s.fz[i] - g[2]);
    }
}

template class ImplicitUpdate<float>;
template class ImplicitUpdate<double>;

}  // namespace undertow::sph
