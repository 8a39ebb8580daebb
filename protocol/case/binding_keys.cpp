#include "case/binding_keys.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdint>
#include <cstdio>
#include <map>
#include <set>

namespace undertow {

namespace {

constexpr std::size_t longest_value = 64;        // [byte] that stands there itself
constexpr std::size_t room_in_hello = 32 << 10;  // [byte] of its 64 kB

constexpr std::array<std::string_view, 3> free_tables{"output.", "checkpoint.", "report."};
constexpr std::array<std::string_view, 5> free_keys{"time.end", "case.title", "coupling.deadline",
                                                    "coupling.join_timeout", "coupling.transport"};

std::string_view key_in(std::string_view line) {
    return line.substr(0, line.find(" = "));
}
std::string_view value_in(std::string_view line) {
    const std::size_t equals = line.find(" = ");
    return equals == line.npos ? std::string_view() : line.substr(equals + 3);
}
std::string_view table_in(std::string_view line) {
    return line.substr(0, std::min(line.find('.'), line.find(' ')));
}

std::uint64_t sum_over(std::string_view bytes, std::uint64_t sum = 0xcbf29ce484222325) {
    for (const unsigned char byte : bytes) sum = (sum ^ byte) * 0x100000001b3;
    return sum;
}
std::string sum_text(std::uint64_t sum) {
    char text[24];
    std::snprintf(text, sizeof text, "#%016llx", static_cast<unsigned long long>(sum));
    return text;
}

/// A list with one line a table?
bool is_folded(const std::vector<std::string>& lines) {
    return !lines.empty() && std::none_of(lines.begin(), lines.end(), [](const std::string& line) {
        return key_in(line).find('.') != std::string_view::npos;
    });
}

std::vector<std::string> folded(std::vector<std::string> lines) {
    std::sort(lines.begin(), lines.end());
    std::map<std::string_view, std::uint64_t> sums;
    for (const std::string& line : lines) {
        std::uint64_t& sum = sums.try_emplace(table_in(line), sum_over("")).first->second;
        sum = sum_over(line + "\n", sum);
    }
    std::vector<std::string> tables;
    for (const auto& [table, sum] : sums)
        tables.push_back(std::string(table) + " = " + sum_text(sum));
    return tables;
}

/// 1000000 and 1e6 are one number: TOML tells integers from others, a case does not.
bool same_value(const std::string& a, const std::string& b) {
    double x = 0, y = 0;
    const auto number = [](const std::string& text, double& value) {
        return std::from_chars(text.data(), text.data() + text.size(), value).ptr ==
               text.data() + text.size();
    };
    return a == b || (number(a, x) && number(b, y) && x == y);
}

/// Value by key. What comes twice, entries of one name, is one value.
std::map<std::string_view, std::string> by_key(const std::vector<std::string>& lines) {
    std::map<std::string_view, std::string> values;
    for (const std::string& line : lines) {
        const auto [place, is_new] = values.try_emplace(key_in(line));
        place->second.append(is_new ? "" : " and ").append(value_in(line));
    }
    return values;
}

}  // namespace

bool is_binding(std::string_view line) {
    const std::string_view key = key_in(line);
    return std::none_of(free_tables.begin(), free_tables.end(),
                        [&](std::string_view table) { return line.starts_with(table); }) &&
           std::find(free_keys.begin(), free_keys.end(), key) == free_keys.end();
}

std::vector<std::string> binding_keys(const Case& input) {
    std::vector<std::string> lines;
    std::size_t bytes = 0;
    for (const auto& [key, value] : input.written) {
        if (!is_binding(key)) continue;
        const bool fits = value.size() <= longest_value && value.find('\n') == value.npos;
        lines.push_back(key + " = " + (fits ? value : sum_text(sum_over(value))));
        bytes += lines.back().size() + 3;  // of its length in the header
    }
    return bytes > room_in_hello ? folded(lines) : lines;
}

std::optional<KeyDifference> first_difference(std::vector<std::string> ours,
                                              std::vector<std::string> theirs) {
    if (is_folded(ours) != is_folded(theirs)) {
        std::vector<std::string>& longer = is_folded(ours) ? theirs : ours;
        longer = folded(longer);
    }
    const auto mine = by_key(ours), other = by_key(theirs);
    std::optional<KeyDifference> first;
    std::set<std::string_view> seen;
    const auto compare = [&](const std::vector<std::string>& lines) {
        for (const std::string& line : lines) {
            const std::string_view key = key_in(line);
            if (!seen.insert(key).second) continue;
            const auto a = mine.find(key), b = other.find(key);
            if (a != mine.end() && b != other.end() && same_value(a->second, b->second)) continue;
            if (!first) {
                first.emplace().key = key;
                if (a != mine.end()) first->ours = a->second;
                if (b != other.end()) first->theirs = b->second;
            }
            ++first->count;
        }
    };
    compare(ours);
    compare(theirs);
    return first;
}

}  // namespace undertow
