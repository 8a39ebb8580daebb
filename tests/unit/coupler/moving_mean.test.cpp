#include "coupler/moving_mean.hpp"

#include <catch2/catch.hpp>
#include <cmath>

using undertow::coupler::MovingMean;

TEST_CASE("without a window the mean is the last value") {
    MovingMean mean(0);
    mean.add(0.1, 0.1, 5);
    mean.add(0.2, 0.1, 7);
    CHECK(mean.mean() == 7);
}

TEST_CASE("the mean of a ramp is its value half a window ago, whatever the steps") {
    MovingMean mean(0.1);
    double t = 0;
    for (int n = 0; n < 5000; ++n) {
        const double dt = 1e-3 * (1 + 0.9 * std::sin(n));
        mean.add(t + dt, dt, 3 * (t + 0.5 * dt));  // mean of 3 t over the step
        t += dt;
    }
    // The first step of the window is taken as constant: an error of its length times the slope.
    CHECK(mean.mean() == Approx(3 * (t - 0.05)).margin(3 * 2e-3 * 2e-3 / 0.1));
}

TEST_CASE("before a whole window has passed the mean runs over what there is") {
    MovingMean mean(10);
    mean.add(1, 1, 4);
    CHECK(mean.mean() == Approx(4));
    mean.add(2, 1, 8);
    CHECK(mean.mean() == Approx(6));
}

TEST_CASE("an impulse shorter than the window is never lost or counted twice") {
    MovingMean mean(0.05);
    double peak = 0;
    for (int n = 0; n < 200; ++n) {
        mean.add(1e-3 * (n + 1), 1e-3, n == 100 ? 1000 : 0);
        peak = std::max(peak, mean.mean());
    }
    CHECK(peak == Approx(1000 * 1e-3 / 0.05));
    CHECK(mean.mean() == Approx(0).margin(1e-9));
}
