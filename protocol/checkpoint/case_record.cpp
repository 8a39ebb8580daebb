#include "checkpoint/case_record.hpp"

#include <algorithm>
#include <filesystem>

#include "case/binding_keys.hpp"
#include "checkpoint/archive.hpp"
#include "checkpoint/sha256.hpp"
#include "wire/errors.hpp"

namespace undertow {

namespace {

namespace fs = std::filesystem;

/// The lines that must agree.
std::vector<std::string> binding(std::vector<std::string> lines) {
    std::erase_if(lines, [](const std::string& line) { return !is_binding(line); });
    return lines;
}

}  // namespace

std::vector<std::string> record_of(const Case& input) {
    std::vector<std::string> lines;
    for (const auto& [key, value] : input.written) {
        std::string line = key + " = " + value;
        if (value.size() > 2 && value.front() == '"') {
            const fs::path named = fs::path(input.folder) / value.substr(1, value.size() - 2);
            std::error_code ignored;
            if (fs::is_regular_file(named, ignored))
                line += " (content " + sha256_of_file(named.string()) + ")";
        }
        lines.push_back(line);
    }
    return lines;
}

void archive_case(Archive& a, const Case& input, const std::string& where) {
    const std::vector<std::string> now = record_of(input);
    std::vector<std::string> then = now;
    a("case", then);
    if (!a.reading()) return;
    const auto difference = first_difference(binding(now), binding(then));
    if (!difference) return;
    throw InputError(input.file + ": " + difference->key +
                     (difference->ours ? " is " + *difference->ours : " is not there") +
                     ", but the checkpoint " + where + " was written " +
                     (difference->theirs ? "with " + *difference->theirs : "without it") +
                     "; put it back, or start anew (time.end, [output] and [checkpoint] may "
                     "change).");
}

}  // namespace undertow
