// Writes the golden vectors: make_golden FOLDER. Run it only when a new protocol version gets its
// own folder; the files of a published version never change.

#include <fstream>
#include <iostream>

#include "samples.hpp"

int main(int argc, char** argv) {
    using namespace undertow::wire;
    if (argc != 2) {
        std::cerr << "usage: make_golden FOLDER\n";
        return 2;
    }
    const std::string folder = argv[1];
    for (const Sample& sample : golden_samples()) {
        std::ofstream(folder + "/" + sample.file + ".hex") << "# " << sample.comment << '\n'
                                                           << to_hex(raw_frames(sample.message));
    }
    for (const Fault& fault : golden_faults()) {
        std::ofstream(folder + "/" + fault.file + ".hex")
            << "# " << fault.comment << "\n# expect " << fault.code << '\n'
            << to_hex(fault.frames);
    }
}
