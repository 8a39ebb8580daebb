#pragma once
// The formulas of the closest point, for one number or for lanes of numbers: facet.cpp lays the
// four pieces of one quad side by side, facet_lanes.cpp eight points and their facets.

#include "contact/lanes.hpp"

namespace undertow::contact {

/// Closest point of a triangle abc: weights, and the corners of the edge or corner that holds it.
template <typename T>
struct PieceFeet {
    T wa, wb, wc;
    T distance2;  // [m2]
    T rim;        // a = 1, b = 2, c = 4, summed; 0 = inside
};

/// By Voronoi regions; ap = p - a, and so on.  [Ericson 2005, Real-Time Collision Detection, 5.1.5]
template <typename T>
inline PieceFeet<T> closest_on_pieces(const Three<T>& ab, const Three<T>& ac, const Three<T>& ap,
                                      const Three<T>& bp, const Three<T>& cp) {
    const T d1 = dot(ab, ap), d2 = dot(ac, ap), d3 = dot(ab, bp), d4 = dot(ac, bp),
            d5 = dot(ab, cp), d6 = dot(ac, cp);
    const T va = d3 * d6 - d5 * d4, vb = d5 * d2 - d1 * d6, vc = d1 * d4 - d3 * d2;
    const T none = spread<T>(0), one = spread<T>(1);

    // Weights of b and c over a common denominator; later regions take precedence.
    T over = va + vb + vc, nb = vb, nc = vc, rim = none;
    const auto choose = [&](const auto& here, double corners, const T& b, const T& c,
                            const T& whole) {
        nb = select(here, b, nb);
        nc = select(here, c, nc);
        over = select(here, whole, over);
        rim = select(here, spread<T>(corners), rim);
    };
    const T d43 = d4 - d3, d56 = d5 - d6;
    choose(at_most(va, none) & at_most(none, d43) & at_most(none, d56), 6, d56, d43, d43 + d56);
    choose(at_most(vb, none) & at_most(none, d2) & at_most(d6, none), 5, none, d2, d2 - d6);
    choose(at_most(none, d6) & at_most(d5, d6), 4, none, one, one);
    choose(at_most(vc, none) & at_most(none, d1) & at_most(d3, none), 3, d1, none, d1 - d3);
    choose(at_most(none, d3) & at_most(d4, d3), 2, one, none, one);
    choose(at_most(d1, none) & at_most(d2, none), 1, none, none, one);

    PieceFeet<T> feet;
    const T share = one / over;
    feet.wc = nc * share;
    const auto on_bc = at_most(rim, spread<T>(6)) & at_most(spread<T>(6), rim);
    feet.wb = select(on_bc, one - feet.wc, nb * share);
    feet.wa = select(on_bc, none, one - feet.wb - feet.wc);
    const Three<T> offset = ap - feet.wb * ab - feet.wc * ac;
    feet.distance2 = dot(offset, offset);
    feet.rim = rim;
    return feet;
}

/// The offset is measured from sum_a w_a x_a itself: the weights are then exact.
template <typename T>
inline Three<T> offset_from(const Three<T>& point, const T (&weight)[4], const Three<T> (&x)[4]) {
    return point - (weight[0] * x[0] + weight[1] * x[1] + weight[2] * x[2] + weight[3] * x[3]);
}

template <typename T>
inline Three<T> unit(const Three<T>& a) {
    return (spread<T>(1) / norm(a)) * a;
}

}  // namespace undertow::contact
