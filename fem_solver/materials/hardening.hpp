#pragma once
// Yield stress over equivalent plastic strain: a line, or straight pieces between the rows of a
// table and the last value beyond them.

#include <array>
#include <limits>
#include <span>

#include "fem_solver/simd.hpp"

namespace undertow::fem {

struct Hardening {
    static constexpr int most_pieces = 16;

    double yield_stress = 0;  // [Pa] at no plastic strain
    int pieces = 1;
    // of piece i: plastic strain where it begins, its extent in plastic strain, the yield stress
    // [Pa] where it begins, its slope [Pa]
    double begin[most_pieces] = {};
    double extent[most_pieces] = {std::numeric_limits<double>::infinity()};
    double stress[most_pieces] = {};
    double slope[most_pieces] = {};

    /// yield_stress + slope eps_p
    static Hardening line(double yield_stress, double slope) {
        Hardening out;
        out.yield_stress = out.stress[0] = yield_stress;
        out.slope[0] = slope;
        return out;
    }
    /// Rows (plastic strain, yield stress [Pa]): at most 16, strains from 0 on and increasing,
    /// stresses never falling (the case reader sees to it).
    static Hardening table(std::span<const std::array<double, 2>> rows) {
        Hardening out = line(rows[0][1], 0);
        out.pieces = int(rows.size());
        for (int i = 0; i < out.pieces; ++i) {
            out.begin[i] = rows[i][0];
            out.stress[i] = rows[i][1];
            out.extent[i] = std::numeric_limits<double>::infinity();
            if (i + 1 == out.pieces) break;
            out.extent[i] = rows[i + 1][0] - rows[i][0];
            out.slope[i] = (rows[i + 1][1] - rows[i][1]) / out.extent[i];
        }
        return out;
    }

    /// [Pa] at the plastic strain e
    template <class T>
    UNDERTOW_KERNEL T strength(const T& e) const {
        if (pieces == 1) return yield_stress + slope[0] * e;
        const T zero = 0.0 * e;
        T k = yield_stress + zero;
        for (int i = 0; i < pieces; ++i)
            k += slope[i] * smaller(larger(T(e - begin[i]), zero), T(extent[i] + zero));
        return k;
    }

    /// [Pa] d strength/d eps_p at e, to the right where pieces meet
    template <class T>
    UNDERTOW_KERNEL T tangent(const T& e) const {
        const T zero = 0.0 * e;
        T h = slope[0] + zero;
        for (int i = 1; i < pieces; ++i) h = e >= begin[i] ? T(slope[i] + zero) : h;
        return h;
    }

    /// Plastic strain d >= 0 after which trial - stiffness d = strength(e + d); trial [Pa] beyond
    /// strength(e), stiffness [Pa]. The sum over the pieces of what each takes until the trial stress
    /// is used up: exact, however many pieces a step crosses.
    template <class T>
    UNDERTOW_KERNEL T flow(const T& trial, double stiffness, const T& e) const {
        if (pieces == 1) return (trial - strength(e)) / (stiffness + slope[0]);
        const T zero = 0.0 * e;
        T d = zero;
        for (int i = 0; i < pieces; ++i) {
            const T past = e - begin[i];
            const T from = larger(T(-past), zero);  // d where the piece begins to count
            const T left = larger(T(extent[i] - larger(past, zero)), zero);
            const T k = stress[i] + slope[i] * larger(past, zero);
            const T taken = (trial - stiffness * from - k) / (stiffness + slope[i]);
            d += smaller(larger(taken, zero), left);
        }
        return d;
    }
};

}  // namespace undertow::fem
