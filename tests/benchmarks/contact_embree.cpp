// The search for candidate facets: our cells against Embree's point query, on the scene of
// bench_contact_cost. Both find all facets within l0 + skin of each particle; the exact distance is
// ours in both (closest_point), so that only the structures are compared. One thread.
//   bench_contact_embree [facet size, default 0.0125 m] [particle spacing, default 0.0135 m]

#include <embree3/rtcore.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "clocks.hpp"
#include "contact/candidates.hpp"
#include "contact_scene.hpp"

using namespace undertow::contact;
using namespace undertow::benchmarks;

namespace {

struct Query {
    const Surface* surface;
    Vec x;
    double range;
    CandidateList* found;
};

bool test_facet(RTCPointQueryFunctionArguments* arguments) {
    const Query& query = *static_cast<Query*>(arguments->userPtr);
    const double distance =
        closest_point(query.x, query.surface->shape(arguments->primID)).distance;
    if (distance <= query.range) {
        query.found->facet.push_back(arguments->primID);
        query.found->distance.push_back(float(distance));
    }
    return false;  // the radius stays: all facets are wanted
}

}  // namespace

int main(int argc, char** argv) {
    const double size = argc > 1 ? std::atof(argv[1]) : 0.0125;
    const double spacing = argc > 2 ? std::atof(argv[2]) : 0.0135;
    const Mesh mesh = bucket(size);
    const std::vector<double> x = band_around(spacing);
    const std::size_t band = x.size() / 3;
    const double l0 = spacing / 2, skin = 0.3 * spacing, range = l0 + skin;
    const std::vector<double> radius(band, l0);
    const std::vector<std::uint64_t> id(band, 0);
    Surface surface(mesh.quad, mesh.mass);
    surface.move(mesh.x, mesh.v);

    FacetCells cells;
    CandidateList ours;
    double ours_s = 1e300;
    for (int run = 0; run < 5; ++run) {
        const double start = cpu_clock();
        cells.search({x, x, radius, radius, radius, id}, surface, skin, ours);
        ours_s = std::min(ours_s, cpu_clock() - start);
    }

    RTCDevice device = rtcNewDevice("threads=1,set_affinity=0");
    RTCScene scene = rtcNewScene(device);
    rtcSetSceneFlags(scene, RTC_SCENE_FLAG_DYNAMIC);  // positions change from search to search
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_QUAD);
    float* vertex = static_cast<float*>(rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 12, mesh.x.size() / 3));
    auto* index = static_cast<std::uint32_t*>(rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT4, 16, mesh.quad.size() / 4));
    std::copy(mesh.quad.begin(), mesh.quad.end(), index);
    rtcSetGeometryPointQueryFunction(geometry, test_facet);
    rtcAttachGeometry(scene, geometry);

    CandidateList theirs;
    double build_s = 1e300, query_s = 1e300;
    for (int run = 0; run < 5; ++run) {
        const double start = cpu_clock();
        std::copy(mesh.x.begin(), mesh.x.end(), vertex);
        rtcUpdateGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0);
        rtcCommitGeometry(geometry);
        rtcCommitScene(scene);
        const double built = cpu_clock();
        theirs.facet.clear(), theirs.distance.clear(), theirs.row.clear(),
            theirs.start.assign(1, 0);
        for (std::size_t i = 0; i < band; ++i) {
            Query query{&surface, Vec::Map(&x[3 * i]), range, &theirs};
            RTCPointQuery point{float(x[3 * i]), float(x[3 * i + 1]), float(x[3 * i + 2]), 0,
                                float(range * (1 + 1e-6))};
            RTCPointQueryContext context;
            rtcInitPointQueryContext(&context);
            const std::size_t first = theirs.facet.size();
            rtcPointQuery(scene, &point, &context, nullptr, &query);
            if (theirs.facet.size() == first) continue;
            theirs.row.push_back(std::uint32_t(i));
            theirs.start.push_back(std::uint32_t(theirs.facet.size()));
        }
        build_s = std::min(build_s, built - start);
        query_s = std::min(query_s, cpu_clock() - built);
    }
    rtcReleaseGeometry(geometry);
    rtcReleaseScene(scene);
    rtcReleaseDevice(device);

    const double per = 1e9 / double(band);
    std::printf("%zu facets, %zu band particles, range %.4g m\n", mesh.quad.size() / 4, band,
                range);
    std::printf("cells   %8.2f ms  %6.0f ns per particle, %zu candidates of %zu particles\n",
                1e3 * ours_s, ours_s * per, ours.facet.size(), ours.row.size());
    std::printf(
        "Embree  %8.2f ms  %6.0f ns per particle, %zu candidates of %zu particles "
        "(tree %.2f ms, queries %.2f ms)\n",
        1e3 * (build_s + query_s), (build_s + query_s) * per, theirs.facet.size(),
        theirs.row.size(), 1e3 * build_s, 1e3 * query_s);
}
