// A step allocates nothing: memory is taken while lists and records find their sizes, then kept.
// This program counts every operator new of the process, so it stands apart from the other tests.

#include <atomic>
#include <catch2/catch.hpp>
#include <cstdlib>
#include <new>

#include "scenes.hpp"

namespace {

std::atomic<long> allocations{0};

}  // namespace

void* operator new(std::size_t size) {
    ++allocations;
    if (void* memory = std::malloc(size)) return memory;
    throw std::bad_alloc();
}
void* operator new(std::size_t size, std::align_val_t alignment) {
    ++allocations;
    const auto step = static_cast<std::size_t>(alignment);
    if (void* memory = std::aligned_alloc(step, (size + step - 1) / step * step)) return memory;
    throw std::bad_alloc();
}
void operator delete(void* memory) noexcept {
    std::free(memory);
}
void operator delete(void* memory, std::size_t) noexcept {
    std::free(memory);
}
void operator delete(void* memory, std::align_val_t) noexcept {
    std::free(memory);
}
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept {
    std::free(memory);
}

using namespace undertow;
using namespace undertow::sph;

namespace {

constexpr double dx = 0.05;

/// A column that collapses between walls, a gate drawn up beside it.
Case collapsing_column() {
    Case c = scenes::water_box(dx, {0.8, 0.4, 0.8});
    scenes::add_basin(c, {2.0, 0.4, 0.8});
    for (PlaneWall& plane : c.sph.plane) plane.slip = Slip::no_slip;
    Body gate;
    gate.name = "gate";
    gate.shape.box = Box{{0.8, 0, 0}, {0.9, 0.4, 1.2}};
    gate.velocity = {0, 0, 3};
    c.sph.body = {gate};
    return c;
}

struct Count {
    long with_new_list = 0, without = 0;  // allocations in steps of either kind
    long new_lists = 0;
};

/// Steps `warm_up` times, then counts over 100 steps.
Count count_over_100_steps(const Case& input, int warm_up) {
    FluidSystem fluid(input, 0.4);
    const double dt = 0.6 * dx / fluid.fluid().c0;
    double t = 0, before = 0;
    Count count;
    for (int n = -warm_up; n < 100; ++n) {
        const long earlier = allocations, lists = static_cast<long>(fluid.rebuilds());
        scenes::two_pass_step(fluid, t, dt, before);
        before = dt;
        if (n < 0) continue;
        const bool rebuilt = fluid.rebuilds() > lists;
        (rebuilt ? count.with_new_list : count.without) += allocations - earlier;
        count.new_lists += rebuilt;
    }
    return count;
}

}  // namespace

TEST_CASE("the counter sees an allocation") {
    const long earlier = allocations;
    ::operator delete(::operator new(4));  // a call the compiler must not leave out
    const long later = allocations;
    CHECK(later == earlier + 1);
}

TEST_CASE("water at rest: no step allocates after the first two") {
    Case c = scenes::water_box(dx, {0.8, 0.4, 0.8});
    scenes::add_basin(c, {0.8, 0.4, 0.8});
    const Count count = count_over_100_steps(c, 2);
    CHECK(count.with_new_list + count.without == 0);
}

// What follows the fluid (images, lists of a block of clusters) is as long as the scene makes it:
// when it outgrows its memory it takes half as much again or more, so a new list does so for a few
// of its buffers and never for all.
constexpr long growing_buffers = 10;  // per new list; 7 measured while the column collapses

TEST_CASE(
    "a collapsing column with a moving gate: only a new list that outgrows its memory allocates") {
    Case c = collapsing_column();
    c.sph.precision = GENERATE(Precision::float32, Precision::float64);
    const Count count = count_over_100_steps(c, 20);
    CHECK(count.without == 0);
    CHECK(count.new_lists > 5);
    CHECK(count.with_new_list <= growing_buffers * count.new_lists);
}

TEST_CASE("two fluids, one viscoplastic: only a new list that outgrows its memory allocates") {
    Case c = scenes::two_layers(dx, {0.8, 0.4, 0.8}, 0.3, true);
    scenes::add_basin(c, {2.0, 0.4, 0.8});
    const Count count = count_over_100_steps(c, 20);
    CHECK(count.without == 0);
    CHECK(count.new_lists >= 2);
    CHECK(count.with_new_list <= growing_buffers * count.new_lists);
}
