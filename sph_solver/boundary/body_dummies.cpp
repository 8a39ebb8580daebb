#include "sph_solver/boundary/body_dummies.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "sph_solver/shapes/vectors.hpp"
#include "wire/errors.hpp"

namespace undertow::sph {

namespace {

constexpr double most_cells = 2e9;  // of a body's bounds

/// A box on a lattice of its own: all cells are whole.
std::vector<Dummy> fill_box(const RigidBody& body, double dx, double depth, bool flat) {
    const Box& b = *body.body().shape.box;
    int n[3];
    double share = 1;
    for (int a = 0; a < 3; ++a) {
        const double cells = (b.max[a] - b.min[a]) / dx;
        n[a] = std::max(1, static_cast<int>(std::lround(cells)));
        if (flat && a == 1) n[a] = 1;
        // a box that is not a whole number of spacings has wider or narrower cells
        else if (std::abs(cells - n[a]) > 1e-6)
            share *= cells / n[a];
    }
    std::vector<Dummy> dummies;
    for (int iz = 0; iz < n[2]; ++iz)
        for (int iy = 0; iy < n[1]; ++iy)
            for (int ix = 0; ix < n[0]; ++ix) {
                const double part[3] = {(ix + 0.5) / n[0], (iy + 0.5) / n[1], (iz + 0.5) / n[2]};
                Vec3 x;
                for (int a = 0; a < 3; ++a) x[a] = b.min[a] + part[a] * (b.max[a] - b.min[a]);
                if (flat) x[1] = 0;
                const FromSurface from = body.at_rest(x);
                if (from.distance > -depth) dummies.push_back({x, share});
            }
    return dummies;
}

/// The solid part of a cell that the surface cuts, from 4^d samples; each counts gradually over its
/// own width, so that a plane face is met within a hundredth of a cell.
Dummy cut_cell(const RigidBody& body, const Vec3& middle, double dx, bool flat) {
    constexpr int samples = 4;
    const double width = dx / samples;
    double sum = 0;
    Vec3 moment{};
    for (int iy = 0; iy < (flat ? 1 : samples); ++iy)
        for (int ix = 0; ix < samples; ++ix)
            for (int iz = 0; iz < samples; ++iz) {
                const Vec3 offset{(ix - 1.5) * width, flat ? 0 : (iy - 1.5) * width,
                                  (iz - 1.5) * width};
                const double d = body.at_rest(middle + offset).distance;
                const double solid = std::clamp(0.5 - d / width, 0.0, 1.0);
                sum += solid;
                moment = moment + solid * offset;
            }
    Dummy dummy{middle, sum / (flat ? samples * samples : samples * samples * samples)};
    if (sum > 0) dummy.x = middle + (1 / sum) * moment;
    return dummy;
}

std::vector<Dummy> fill_lattice(const RigidBody& body, const Case& input, double depth) {
    const double dx = input.sph.spacing;
    const bool flat = input.info.dimension == 2;
    const double half_diagonal = 0.5 * dx * std::sqrt(flat ? 2.0 : 3.0);
    const Vec3 origin = input.sph.fill.empty() ? Vec3{} : input.sph.fill[0].box.min;
    // what has no ends along y is needed where the fluid may get
    Box bounds = body.bounds();
    double lo = 1e300, hi = -1e300;
    for (const Fill& f : input.sph.fill)
        lo = std::min(lo, f.box.min[1]), hi = std::max(hi, f.box.max[1]);
    if (input.sph.domain) lo = input.sph.domain->min[1], hi = input.sph.domain->max[1];
    if (std::isinf(bounds.min[1])) bounds.min[1] = lo - depth;
    if (std::isinf(bounds.max[1])) bounds.max[1] = hi + depth;

    const double outward = body.body().inside ? depth : 0;
    int first[3], last[3];
    double cells = 1;
    for (int a = 0; a < 3; ++a) {
        first[a] = static_cast<int>(std::floor((bounds.min[a] - outward - origin[a]) / dx)) - 1;
        last[a] = static_cast<int>(std::ceil((bounds.max[a] + outward - origin[a]) / dx)) + 1;
        if (flat && a == 1) first[a] = 0, last[a] = 1;
        cells *= last[a] - first[a];
    }
    if (cells > most_cells)
        throw InputError(
            fmt::format("{}: sph.body \"{}\" spans {:.3g} cells of sph.spacing = {:.4g} m; that is "
                        "more than this "
                        "version can fill. Is its scale right?",
                        input.file, body.body().name, cells, dx));
    std::vector<Dummy> dummies;
    for (int iz = first[2]; iz < last[2]; ++iz)
        for (int iy = first[1]; iy < last[1]; ++iy)
            for (int ix = first[0]; ix < last[0]; ++ix) {
                const Vec3 x{origin[0] + (ix + 0.5) * dx, flat ? 0 : origin[1] + (iy + 0.5) * dx,
                             origin[2] + (iz + 0.5) * dx};
                const FromSurface from = body.at_rest(x);
                const double beyond =
                    std::max(from.distance - half_diagonal, -from.distance - depth);
                if (beyond > 0) {  // a distance changes by no more than the way: skip cells
                    ix += static_cast<int>(beyond / dx);
                    continue;
                }
                Dummy dummy{x, 1};
                if (from.distance > -half_diagonal) {
                    dummy = cut_cell(body, x, dx, flat);
                }
                if (dummy.share > 0.01) dummies.push_back(dummy);
            }
    return dummies;
}

}  // namespace

std::vector<Dummy> place_dummies(const RigidBody& body, const Case& input) {
    const double dx = input.sph.spacing;
    double widest = dx;  // of those that meet the dummies
    for (const Fluid& f : input.sph.fluid) widest = std::max(widest, 0.5 * (dx + f.spacing));
    const double depth = 2 * input.sph.smoothing_ratio * widest;
    const Shape& shape = body.body().shape;
    const bool box = shape.box && shape.profile.empty() && !body.body().inside;
    return box ? fill_box(body, dx, depth, input.info.dimension == 2)
               : fill_lattice(body, input, depth);
}

}  // namespace undertow::sph
