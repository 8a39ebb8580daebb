#include "checkpoint/case_record.hpp"

#include <algorithm>
#include <filesystem>

#include "checkpoint/archive.hpp"
#include "checkpoint/sha256.hpp"
#include "wire/errors.hpp"

namespace undertow {

namespace {

namespace fs = std::filesystem;

bool may_change(const std::string& line) {
    static const char* const free_keys[] = {
        "time.end = ",   "output.",           "checkpoint.",           "report.",
        "case.title = ", "coupling.deadline", "coupling.join_timeout", "coupling.transport"};
    return std::any_of(std::begin(free_keys), std::end(free_keys),
                       [&](const char* key) { return line.starts_with(key); });
}

std::string key_of(const std::string& line) {
    return line.substr(0, line.find(" = "));
}

/// The lines that must agree.
std::vector<std::string> binding(std::vector<std::string> lines) {
    std::erase_if(lines, may_change);
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
    const std::vector<std::string> old = binding(then), mine = binding(now);
    const auto value_in = [](const std::vector<std::string>& lines, const std::string& key,
                             const char* with, const std::string& without) {
        const auto line = std::find_if(lines.begin(), lines.end(),
                                       [&](const std::string& l) { return key_of(l) == key; });
        return line == lines.end() ? without : with + line->substr(key.size() + 3);
    };
    const auto refuse = [&](const std::string& key) {
        throw InputError(input.file + ": " + key + value_in(mine, key, " is ", " is not there") +
                         ", but the checkpoint " + where + " was written " +
                         value_in(old, key, "with ", "without it") +
                         "; put it back, or start anew (time.end, [output] and [checkpoint] may "
                         "change).");
    };
    for (const std::string& line : mine)
        if (std::find(old.begin(), old.end(), line) == old.end()) refuse(key_of(line));
    for (const std::string& line : old)
        if (std::find(mine.begin(), mine.end(), line) == mine.end()) refuse(key_of(line));
}

}  // namespace undertow
