#pragma once
// Reads the keys of one table into plain variables. Each call names a known key; finish() then
// rejects what is unknown and what is missing. Every rejection is one sentence with its place.

#include <array>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "case/case.hpp"
#include "case/document.hpp"

namespace undertow {

/// What a number may be. Infinity is allowed only where `infinite` says so, NaN never.
struct Range {
    double low = -std::numeric_limits<double>::infinity();
    double high = std::numeric_limits<double>::infinity();
    bool low_open = false, high_open = false;
    const char* unit = "";
    bool infinite = false;
};

inline Range any(const char* unit = "") { return {.unit = unit}; }
inline Range positive(const char* unit = "") { return {.low = 0, .low_open = true, .unit = unit}; }
inline Range at_least(double low, const char* unit = "") { return {.low = low, .unit = unit}; }
inline Range closed(double low, double high, const char* unit = "") {
    return {.low = low, .high = high, .unit = unit};
}
inline Range above_up_to(double low, double high, const char* unit = "") {
    return {.low = low, .high = high, .low_open = true, .unit = unit};
}
inline Range between(double low, double high, const char* unit = "") {
    return {.low = low, .high = high, .low_open = true, .high_open = true, .unit = unit};
}

class TableReader {
 public:
    /// `path` is the table's name in messages: "sph", "sph.fluid.water".
    TableReader(const Node& table, std::string path) : table_(table), path_(std::move(path)) {}

    bool has(const std::string& key) const;
    bool has_text(const std::string& key) const;
    bool has_table(const std::string& key) const;
    const std::string& path() const { return path_; }

    void number(const std::string& key, double& target, const Range& range);
    void whole(const std::string& key, int& target, int low, int high);
    void flag(const std::string& key, bool& target);
    void text(const std::string& key, std::string& target);
    void vector(const std::string& key, Vec3& target, const char* unit);
    /// A formula of `variables` (of "xyzt"), or a number, which is one too.
    void formula(const std::string& key, std::optional<Expression>& target,
                 const std::string& variables, const char* unit);
    /// As vector(), but its components may be formulas: then `formulas` gets all three and `target`
    /// is 0, otherwise `formulas` stays empty.
    void vector(const std::string& key, Vec3& target, std::vector<Expression>& formulas,
                const std::string& variables, const char* unit);
    /// A direction: normalized, not zero.
    void direction(const std::string& key, Vec3& target);
    void divisions(const std::string& key, std::array<int, 3>& target);
    /// [[x, z], ...], at least three corners.
    void polygon(const std::string& key, std::vector<std::array<double, 2>>& target);
    /// [[a, b], ...], `least` to `most` rows; `meaning` of one, for messages.
    void pairs(const std::string& key, std::vector<std::array<double, 2>>& target,
               std::size_t least, std::size_t most, const std::string& meaning);
    /// [[x, y, z], ...], `count` points.
    void points(const std::string& key, std::vector<Vec3>& target, std::size_t count);
    /// { min = [...], max = [...] } with max > min in all of `axes`.
    void box(const std::string& key, Box& target, const std::string& axes = "xyz");
    /// One of `known`.
    void word(const std::string& key, std::string& target, const std::vector<std::string>& known);
    void words(const std::string& key, std::vector<std::string>& target,
               const std::vector<std::string>& known);
    template <typename Enum>
    void choice(const std::string& key, Enum& target,
                const std::vector<std::pair<std::string, Enum>>& names);
    /// Reads a sub-table if there is one; `read` may assume that finish() follows.
    bool table(const std::string& key, const std::function<void(TableReader&)>& read);
    /// Reads an array of tables, checks that "name"s differ.
    void tables(const std::string& key, const std::function<void(TableReader&)>& read);
    /// A table of any content.
    void free_form(const std::string& key) { known_.push_back(key); }

    /// Must be present; checked in finish(), after unknown keys, because a mistyped key is both.
    void require(const std::string& key, const std::string& what);
    void finish() const;

    /// "file:line:column: path.key = value `what`." at the key, or at the table if it is absent.
    [[noreturn]] void reject(const std::string& key, const std::string& what) const;

 private:
    const Node* find(const std::string& key);   // marks the key as known; `false` tables are absent
    Expression formula_of(const Node& item, const std::string& name, const std::string& variables,
                          const char* unit) const;
    std::string sub_path(const Node& item, const std::string& key, std::size_t index) const;

    const Node& table_;
    std::string path_;
    std::vector<std::string> known_;
    std::vector<std::pair<std::string, std::string>> required_;
};

template <typename Enum>
void TableReader::choice(const std::string& key, Enum& target,
                         const std::vector<std::pair<std::string, Enum>>& names) {
    std::string chosen;
    std::vector<std::string> known;
    for (const auto& [name, value] : names) known.push_back(name);
    word(key, chosen, known);
    for (const auto& [name, value] : names)
        if (name == chosen) target = value;
}

}  // namespace undertow
