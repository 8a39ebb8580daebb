// The bytes of protocol version 1 are fixed: tests/golden/protocol_v1.

#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "../../golden/samples.hpp"
#include "wire/errors.hpp"

using namespace undertow;
using namespace undertow::wire;

namespace {

std::string read_file(const std::string& name) {
    const std::filesystem::path path = std::filesystem::path(GOLDEN_FOLDER) / (name + ".hex");
    std::ifstream file(path);
    INFO(path);
    REQUIRE(file.good());
    std::ostringstream text;
    text << file.rdbuf();
    return text.str();
}

}  // namespace

TEST_CASE("every message type has the golden bytes") {
    for (const Sample& sample : golden_samples()) {
        INFO(sample.file);
        const RawFrames golden = from_hex(read_file(sample.file));
        CHECK(to_hex(raw_frames(sample.message)) == to_hex(golden));
    }
}

TEST_CASE("the golden bytes decode and encode again to themselves") {
    for (const Sample& sample : golden_samples()) {
        INFO(sample.file);
        const RawFrames golden = from_hex(read_file(sample.file));
        const Message message = decoded(golden);
        CHECK(message.index() == sample.message.index());
        CHECK(to_hex(raw_frames(message)) == to_hex(golden));
    }
}

TEST_CASE("every golden fault is refused with its code") {
    for (const Fault& fault : golden_faults()) {
        INFO(fault.file);
        const std::string text = read_file(fault.file);
        CHECK(text.find("# expect " + fault.code + "\n") != std::string::npos);
        const RawFrames golden = from_hex(text);
        CHECK(golden == fault.frames);
        try {
            decoded(golden);
            FAIL_CHECK("decoded without an error");
        } catch (const PeerError& error) {
            CHECK(error.code == fault.code);
            INFO(error.what());
            CHECK(std::string(error.what()).size() > 20);
        }
    }
}

TEST_CASE("the golden folder holds these files and no others") {
    std::size_t n_files = 0;
    for (const auto& entry : std::filesystem::directory_iterator(GOLDEN_FOLDER)) {
        n_files += entry.path().extension() == ".hex";
    }
    CHECK(n_files == golden_samples().size() + golden_faults().size());
}
