#include "results/field_file.hpp"

#include <sys/wait.h>
#include <catch2/catch.hpp>

#include "read_back.hpp"
#include "wire/errors.hpp"

using namespace undertow;
using read_back::dataset;
using Shape = std::vector<hsize_t>;

namespace {

/// n particles whose numbers tell step and particle apart.
void append_step(ParticleFile& file, int step, std::size_t n) {
    std::vector<double> x(3 * n), v(3 * n), p(n);
    std::vector<std::int64_t> id(n);
    for (std::size_t i = 0; i < n; ++i) {
        id[i] = static_cast<std::int64_t>(100 + i);
        p[i] = 1000.0 * step + static_cast<double>(i);
        for (std::size_t k = 0; k < 3; ++k) {
            x[3 * i + k] = step + 0.25 * static_cast<double>(3 * i + k);
            v[3 * i + k] = -x[3 * i + k];
        }
    }
    file.append(0.1 * step, x, id, {{"velocity", "m/s", 3, v}, {"pressure", "Pa", 1, p}});
}

}  // namespace

TEST_CASE("particle steps of different size read back, by offset and by view") {
    read_back::Folder folder;
    ParticleFile file(folder.file("sph"));
    const std::vector<std::size_t> counts{5, 5, 3, 7};
    for (int step = 0; step < 4; ++step)
        append_step(file, step, counts[static_cast<std::size_t>(step)]);
    CHECK(file.steps() == 4);
    const std::string path = folder.file("sph.vtkhdf");

    CHECK(read_back::text_attribute(path, "/VTKHDF", "Type") == "PolyData");
    CHECK(read_back::text_attribute(path, "/VTKHDF/PointData/pressure", "unit") == "Pa");
    CHECK(dataset(path, "/VTKHDF/Points").shape == Shape{20, 3});
    CHECK(dataset(path, "/VTKHDF/Steps/PointOffsets").values == std::vector<double>{0, 5, 10, 13});
    CHECK(dataset(path, "/VTKHDF/Steps/PointDataOffsets/pressure").values ==
          std::vector<double>{0, 5, 10, 13});

    // The view of step 2 is rows 10 to 12 of the long arrays. The numbers are exact in float32.
    const auto view = dataset(path, "/Views/00002/Points");
    CHECK(view.shape == Shape{3, 3});
    CHECK(view.values == std::vector<double>{2, 2.25, 2.5, 2.75, 3, 3.25, 3.5, 3.75, 4});
    CHECK(dataset(path, "/Views/00003/PointData/pressure").values ==
          std::vector<double>{3000, 3001, 3002, 3003, 3004, 3005, 3006});
    CHECK(dataset(path, "/Views/00001/PointData/id").values ==
          std::vector<double>{100, 101, 102, 103, 104});
    CHECK(dataset(path, "/Views/00002/Vertices").values == std::vector<double>{0, 1, 2});
}

TEST_CASE("the vertex list is shared until the number of particles changes") {
    read_back::Folder folder;
    ParticleFile file(folder.file("sph"));
    append_step(file, 0, 5);
    append_step(file, 1, 5);
    append_step(file, 2, 3);
    const std::string path = folder.file("sph.vtkhdf");
    // Two topologies, of 5 and of 3 vertices; each has one more offset than cells.
    CHECK(dataset(path, "/VTKHDF/Steps/PartOffsets").values == std::vector<double>{0, 0, 1});
    CHECK(dataset(path, "/VTKHDF/NumberOfPoints").values == std::vector<double>{5, 3});
    CHECK(dataset(path, "/VTKHDF/Vertices/Connectivity").values ==
          std::vector<double>{0, 1, 2, 3, 4, 0, 1, 2});
    CHECK(dataset(path, "/VTKHDF/Vertices/Offsets").shape == Shape{10});
    CHECK(dataset(path, "/VTKHDF/Steps/CellOffsets").values ==
          std::vector<double>{0, 0, 0, 0, 0, 0, 0, 0, 5, 0, 0, 0});
}

TEST_CASE("a step without particles is a step") {
    read_back::Folder folder;
    ParticleFile file(folder.file("sph"));
    append_step(file, 0, 2);
    append_step(file, 1, 0);
    append_step(file, 2, 2);
    CHECK(dataset(folder.file("sph.vtkhdf"), "/Views/00001/Points").shape == Shape{0, 3});
    CHECK(dataset(folder.file("sph.vtkhdf"), "/Views/00002/Points").values.front() == 2);
}

TEST_CASE("mesh steps share their connectivity and move their nodes") {
    read_back::Folder folder;
    const std::vector<std::int32_t> cube{0, 1, 2, 3, 4, 5, 6, 7};
    MeshFile file(folder.file("fem"), 8, {cube, {}, {}});
    std::vector<double> x{0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 0, 0, 1, 1, 0, 1, 1, 1, 1, 0, 1, 1};
    const std::vector<double> u(24, 0.5), stress{1, 2, 3, 4, 5, 6};
    for (int step = 0; step < 3; ++step) {
        file.append(0.5 * step, x, {{"displacement", "m", 3, u}}, {{"stress", "Pa", 6, stress}});
        for (double& coordinate : x) coordinate += 1;
    }
    const std::string path = folder.file("fem.vtkhdf");
    CHECK(read_back::text_attribute(path, "/VTKHDF", "Type") == "UnstructuredGrid");
    CHECK(dataset(path, "/VTKHDF/Types").values == std::vector<double>{12});
    CHECK(dataset(path, "/VTKHDF/Steps/PartOffsets").values == std::vector<double>{0, 0, 0});
    CHECK(dataset(path, "/VTKHDF/Steps/PointOffsets").values == std::vector<double>{0, 8, 16});
    CHECK(dataset(path, "/Views/Hexahedra").shape == Shape{1, 8});
    CHECK(dataset(path, "/Views/00002/Points").values.front() == 2);
    CHECK(dataset(path, "/Views/00001/CellData/stress").values == stress);
    CHECK(dataset(path, "/VTKHDF/Steps/Values").values == std::vector<double>{0, 0.5, 1});
}

TEST_CASE("a mesh of several kinds of cells lists them one after the other") {
    read_back::Folder folder;
    MeshFile file(folder.file("fem"), 10,
                  {{0, 1, 2, 3, 4, 5, 6, 7}, {4, 5, 6, 8}, {1, 2, 9, 8}});
    const std::vector<double> x(30), pressure{1, 2, 3};
    file.append(0, x, {}, {{"pressure", "Pa", 1, pressure}});
    const std::string path = folder.file("fem.vtkhdf");
    CHECK(dataset(path, "/VTKHDF/Types").values == std::vector<double>{12, 10, 9});
    CHECK(dataset(path, "/VTKHDF/Offsets").values == std::vector<double>{0, 8, 12, 16});
    CHECK(dataset(path, "/Views/Cells").values ==
          std::vector<double>{9, 0, 1, 2, 3, 4, 5, 6, 7, 6, 4, 5, 6, 8, 5, 1, 2, 9, 8});
    CHECK(dataset(path, "/Views/00000/CellData/pressure").values == pressure);
    const std::string xdmf = read_back::text(folder.file("fem.xdmf"));
    CHECK(xdmf.find("TopologyType=\"Mixed\" NumberOfElements=\"3\"") != std::string::npos);
    CHECK(xdmf.find("Dimensions=\"19\"") != std::string::npos);
}

TEST_CASE("the sidecar names the views relative to itself") {
    read_back::Folder folder;
    ParticleFile file(folder.file("sph"));
    append_step(file, 0, 5);
    append_step(file, 1, 5);
    const std::string xdmf = read_back::text(folder.file("sph.xdmf"));
    CHECK(xdmf.find(">sph.vtkhdf:/Views/00001/PointData/pressure<") != std::string::npos);
    CHECK(xdmf.find(folder.path.string()) == std::string::npos);
    CHECK(xdmf.find("<Time Value=\"0.1\"/>") != std::string::npos);
}

TEST_CASE("a reader that holds the file open does not stop the writer") {
    read_back::Folder folder;
    ParticleFile file(folder.file("sph"));
    append_step(file, 0, 5);
    int opened[2], done[2];
    REQUIRE((pipe(opened) == 0 && pipe(done) == 0));
    const pid_t reader = fork();  // another process: within one, HDF5 shares the open file
    if (reader == 0) {
        const hid_t open_file =
            H5Fopen(folder.file("sph.vtkhdf").c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
        char mark = open_file >= 0 ? 'y' : 'n';
        if (write(opened[1], &mark, 1) != 1 || read(done[0], &mark, 1) != 1) _exit(1);
        _exit(0);
    }
    char mark = 0;
    REQUIRE(read(opened[0], &mark, 1) == 1);
    CHECK(mark == 'y');
    CHECK_NOTHROW(append_step(file, 1, 5));
    REQUIRE(write(done[1], &mark, 1) == 1);
    waitpid(reader, nullptr, 0);
    for (const int end : {opened[0], opened[1], done[0], done[1]}) close(end);
    CHECK(dataset(folder.file("sph.vtkhdf"), "/Views/00001/Points").shape == Shape{5, 3});
}

TEST_CASE("a file that cannot be written is the user's error, with its name") {
    try {
        ParticleFile file("/nonexistent-folder/sph");
        FAIL("no error");
    } catch (const InputError& error) {
        CHECK(std::string(error.what()).find("/nonexistent-folder/sph.vtkhdf") !=
              std::string::npos);
    }
}

TEST_CASE("a step with other fields than the first is refused") {
    read_back::Folder folder;
    ParticleFile file(folder.file("sph"));
    append_step(file, 0, 2);
    const std::vector<double> x(6), p(2);
    const std::vector<std::int64_t> id(2);
    CHECK_THROWS_AS(file.append(1, x, id, {{"pressure", "Pa", 1, p}}), std::logic_error);
}
