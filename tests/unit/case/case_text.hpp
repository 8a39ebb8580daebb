#pragma once
// Small cases written to a folder of their own.

#include <stdlib.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "case/resolved_case.hpp"
#include "wire/errors.hpp"

namespace case_text {

/// A valid coupled case; tests change one thing in it.
inline const std::string plate = R"([case]
name = "plate"
[time]
end = 1.0
[sph]
spacing = 0.1
[[sph.fluid]]
name = "water"
density = 1000
[[sph.fill]]
fluid = "water"
box = { min = [0, 0, 0], max = [1, 1, 1] }
[[sph.plane]]
name = "floor"
point = [0, 0, 0]
normal = [0, 0, 2]
[fem.block]
box = { min = [0, 0, -0.2], max = [1, 1, 0] }
divisions = [4, 4, 1]
[[fem.material]]
name = "steel"
density = 7850
young_modulus = 210e9
poisson_ratio = 0.3
[[fem.part]]
set = "block"
material = "steel"
[[fem.surface]]
name = "top"
set = "zmax"
[coupling]
damping = 0.1
)";

class File {
 public:
    explicit File(const std::string& text) {
        std::string name =
            (std::filesystem::temp_directory_path() / "undertow-case-XXXXXX").string();
        folder_ = mkdtemp(name.data());
        std::ofstream(path()) << text;
    }
    ~File() { std::filesystem::remove_all(folder_); }
    std::string path() const { return (folder_ / "case.toml").string(); }
    std::string folder() const { return folder_.string(); }

 private:
    std::filesystem::path folder_;
};

/// `text` with the first occurrence of `from` replaced.
inline std::string with(std::string text, const std::string& from, const std::string& to) {
    text.replace(text.find(from), from.size(), to);
    return text;
}

inline undertow::Case read(const std::string& text, const undertow::CaseOptions& options = {}) {
    const File file(text);
    return undertow::read_case(file.path(), options);
}

/// The sentence of the InputError, without the folder: "case.toml:6:11: ...". Empty if none.
inline std::string mistake(const std::string& text, const undertow::CaseOptions& options = {}) {
    const File file(text);
    try {
        undertow::read_case(file.path(), options);
    } catch (const undertow::InputError& error) {
        std::string sentence = error.what();
        for (std::size_t at; (at = sentence.find(file.folder())) != std::string::npos;)
            sentence.erase(at, file.folder().size() + 1);
        return sentence;
    }
    return "";
}

}  // namespace case_text
