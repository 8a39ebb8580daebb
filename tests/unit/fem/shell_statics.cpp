#include "shell_statics.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/SparseCholesky>
#include <algorithm>

namespace undertow::fem {
namespace {

// Far below round-off of the positions: the kernel is then exactly linear.
constexpr double tiny = 1e-40;

void corners_of(const ShellModel& model, const std::array<int, 4>& quad, double (&x)[3][4]) {
    for (int corner = 0; corner < 4; ++corner)
        for (int d = 0; d < 3; ++d) x[d][corner] = model.x[quad[corner]][d];
}

ShellFrame<double> frame_of(const double (&x)[3][4]) {
    double xi[3], eta[3], h[3], mean[3];
    mode_vectors(x, xi, eta, h, mean);
    return shell_frame(xi, eta, h);
}

}  // namespace

ShellLaw ShellModel::law() const {
    const double E = young_modulus, nu = poisson_ratio;
    return {.density = density,
            .thickness = thickness,
            .young_modulus = E,
            .poisson_ratio = nu,
            .plane_modulus = E / (1 - nu * nu),
            .shear_modulus = 5.0 / 6 * E / (2 * (1 + nu))};
}

ElasticSection ShellModel::section() const {
    return {thickness, law().plane_modulus, poisson_ratio};
}

ShellConstants<double> ShellModel::constants(const std::array<int, 4>& q) const {
    double corner[3][4];
    corners_of(*this, q, corner);
    const ShellFrame<double> frame = frame_of(corner);
    return {
        .mass = density * thickness * frame.area,
        .area = frame.area,
        .rotary = (frame.area + thickness * thickness) / 12,
        .axis_weight = {1 / (frame.l * frame.l), 1 / (frame.ex * frame.ex + frame.ey * frame.ey)},
        .omega2_reference = 0};
}

ShellModel shell_grid(int n_u, int n_v,
                      const std::function<std::array<double, 3>(double, double)>& place) {
    ShellModel model;
    for (int j = 0; j <= n_v; ++j)
        for (int i = 0; i <= n_u; ++i) model.x.push_back(place(double(i) / n_u, double(j) / n_v));
    for (int j = 0; j < n_v; ++j)
        for (int i = 0; i < n_u; ++i)
            model.quad.push_back({grid_node(n_u, i, j), grid_node(n_u, i + 1, j),
                                  grid_node(n_u, i + 1, j + 1), grid_node(n_u, i, j + 1)});
    return model;
}

ElementMatrix stiffness(const ShellModel& model, const std::array<int, 4>& quad) {
    double x[3][4];
    corners_of(model, quad, x);
    const ShellConstants<double> element = model.constants(quad);
    const ShellLaw law = model.law();
    const ElasticSection section = model.section();
    ElementMatrix K;
    for (int column = 0; column < 24; ++column) {
        double dx[3][4] = {}, dphi[3][4] = {}, f[3][4], m[3][4];
        const int corner = column / 6, d = column % 6;
        (d < 3 ? dx[d] : dphi[d - 3])[corner] = tiny;
        ShellState<double> state{};
        Resultants<double> kept{}, resultants;
        ShellReport<double> report;
        ShellFrame<double> end;
        step_shell(x, dx, dphi, element, section, law, kept, state, resultants, f, m, report, end);
        for (int row = 0; row < 24; ++row)
            K(row, column) = (row % 6 < 3 ? f[row % 6] : m[row % 6 - 3])[row / 6] / tiny;
    }
    return K;
}

Eigen::Matrix<double, 24, 1> lumped_mass(const ShellModel& model, const std::array<int, 4>& quad) {
    const ShellConstants<double> element = model.constants(quad);
    Eigen::Matrix<double, 24, 1> m;
    for (int row = 0; row < 24; ++row)
        m(row) = element.mass / 4 * (row % 6 < 3 ? 1 : element.rotary);
    return m;
}

Eigen::VectorXd internal_forces(const ShellModel& model, const Eigen::VectorXd& u) {
    Eigen::VectorXd f = Eigen::VectorXd::Zero(u.size());
    for (const auto& q : model.quad) {
        const ElementMatrix K = stiffness(model, q);
        Eigen::Matrix<double, 24, 1> v;
        for (int k = 0; k < 24; ++k) v(k) = u(6 * q[k / 6] + k % 6);
        const Eigen::Matrix<double, 24, 1> g = K * v;
        for (int k = 0; k < 24; ++k) f(6 * q[k / 6] + k % 6) += g(k);
    }
    return f;
}

Eigen::VectorXd solve(const ShellModel& model, const std::vector<int>& fixed,
                      const Eigen::VectorXd& load) {
    const int n = 6 * int(model.x.size());
    std::vector<char> held(n, 0);
    for (int k : fixed) held[k] = 1;
    std::vector<Eigen::Triplet<double>> entries;
    double softest = 1e300;
    for (const auto& q : model.quad) {
        const ElementMatrix K = stiffness(model, q);
        for (int corner = 0; corner < 4; ++corner)
            softest = std::min(softest, K.block<3, 3>(6 * corner + 3, 6 * corner + 3).trace());
        for (int r = 0; r < 24; ++r)
            for (int c = 0; c < 24; ++c) {
                const int row = 6 * q[r / 6] + r % 6, column = 6 * q[c / 6] + c % 6;
                if (!held[row] && !held[column]) entries.emplace_back(row, column, K(r, c));
            }
    }
    for (int k = 0; k < n; ++k) entries.emplace_back(k, k, held[k] ? 1 : 0);
    Eigen::SparseMatrix<double> K(n, n), with_trifle(n, n);
    K.setFromTriplets(entries.begin(), entries.end());
    // Patterns of drilling without a mean have no stiffness where shells are coplanar: a trifle for
    // the factorization, taken out again by iterating.
    for (int k = 0; k < n; ++k)
        if (!held[k] && k % 6 >= 3) entries.emplace_back(k, k, 1e-9 * softest);
    with_trifle.setFromTriplets(entries.begin(), entries.end());
    Eigen::VectorXd f = load;
    for (int k = 0; k < n; ++k)
        if (held[k]) f(k) = 0;
    const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor(with_trifle);
    Eigen::VectorXd u = factor.solve(f);
    for (int k = 0; k < 3; ++k) u += factor.solve(f - K * u);
    return u;
}

Eigen::VectorXd eigenvalues(const Eigen::MatrixXd& K) {
    return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(K, Eigen::EigenvaluesOnly).eigenvalues();
}

PlateModes find_modes(const Eigen::MatrixXd& K, const Eigen::MatrixXd& M) {
    const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> found(K, M);
    return {found.eigenvalues(), found.eigenvectors()};
}

}  // namespace undertow::fem
