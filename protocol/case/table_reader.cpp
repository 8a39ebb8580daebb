#include "case/table_reader.hpp"

#include <algorithm>
#include <cmath>

#include "case/nearest.hpp"
#include "wire/errors.hpp"
#include "wire/number_text.hpp"

namespace undertow {

namespace {

std::string short_number(double value) {
    return number_text(value, 10);
}

std::string with_unit(double value, const char* unit) {
    return short_number(value) + (*unit ? " " : "") + unit;
}

/// "> 0 m", "between 0 and 1", ...
std::string range_text(const Range& range) {
    const bool low = std::isfinite(range.low), high = std::isfinite(range.high);
    if (low && high) {
        std::string text =
            "between " + short_number(range.low) + " and " + with_unit(range.high, range.unit);
        if (range.low_open && range.high_open) return text + ", both excluded";
        if (range.low_open) return text + ", " + short_number(range.low) + " excluded";
        return text;
    }
    if (low) return (range.low_open ? "> " : ">= ") + with_unit(range.low, range.unit);
    if (high) return (range.high_open ? "< " : "<= ") + with_unit(range.high, range.unit);
    return "a finite number";
}

bool within(double value, const Range& range) {
    if (std::isnan(value) || (std::isinf(value) && !range.infinite)) return false;
    return (range.low_open ? value > range.low : value >= range.low) &&
           (range.high_open ? value < range.high : value <= range.high);
}

bool is_number(const Node& node) {
    return node.is(Node::Kind::integer) || node.is(Node::Kind::number);
}

bool is_false(const Node& node) {
    return node.is(Node::Kind::flag) && !node.flag;
}

}  // namespace

bool TableReader::has(const std::string& key) const {
    return table_.find(key) != nullptr;
}

bool TableReader::has_text(const std::string& key) const {
    const Node* node = table_.find(key);
    return node && node->is(Node::Kind::text);
}

bool TableReader::has_table(const std::string& key) const {
    const Node* node = table_.find(key);
    return node && node->is(Node::Kind::table);
}

const Node* TableReader::find(const std::string& key) {
    if (std::find(known_.begin(), known_.end(), key) == known_.end()) known_.push_back(key);
    return table_.find(key);
}

void TableReader::reject(const std::string& key, const std::string& what) const {
    const Node* node = table_.find(key);
    const std::string name = path_.empty() ? key : path_ + "." + key;
    if (!node) throw InputError(table_.place + ": " + name + " " + what);
    throw InputError(node->place + ": " + name + " = " + value_text(*node) + " " + what);
}

void TableReader::number(const std::string& key, double& target, const Range& range) {
    const Node* node = find(key);
    if (!node) return;
    if (!is_number(*node)) reject(key, "is " + kind_name(*node) + ": a number is expected.");
    if (!within(node->number, range))
        reject(key, "is not allowed: it must be " + range_text(range) + ".");
    target = node->number;
}

void TableReader::whole(const std::string& key, int& target, int low, int high) {
    const Node* node = find(key);
    if (!node) return;
    if (!node->is(Node::Kind::integer))
        reject(key, "is " + kind_name(*node) + ": an integer is expected.");
    if (node->integer < low || node->integer > high)
        reject(key, "is not allowed: it must be " + std::to_string(low) + " to " +
                        std::to_string(high) + ".");
    target = static_cast<int>(node->integer);
}

void TableReader::flag(const std::string& key, bool& target) {
    const Node* node = find(key);
    if (!node) return;
    if (!node->is(Node::Kind::flag))
        reject(key, "is " + kind_name(*node) + ": true or false is expected.");
    target = node->flag;
}

void TableReader::text(const std::string& key, std::string& target) {
    const Node* node = find(key);
    if (!node) return;
    if (!node->is(Node::Kind::text))
        reject(key, "is " + kind_name(*node) + ": a string in quotes is expected.");
    if (node->text.empty()) reject(key, "is empty: a text is expected.");
    target = node->text;
}

void TableReader::vector(const std::string& key, Vec3& target, const char* unit) {
    const Node* node = find(key);
    if (!node) return;
    const bool three = node->is(Node::Kind::array) && node->items.size() == 3 &&
                       std::all_of(node->items.begin(), node->items.end(), [](const Node& item) {
                           return is_number(item) && std::isfinite(item.number);
                       });
    if (!three)
        reject(key, std::string("is not a vector: three finite numbers [x, y, z]") +
                        (*unit ? " in " : "") + unit + " are expected.");
    for (std::size_t axis = 0; axis < 3; ++axis) target[axis] = node->items[axis].number;
}

Expression TableReader::formula_of(const Node& item, const std::string& name,
                                   const std::string& variables, const char* unit) const {
    const std::string origin = item.place + ": " + (path_.empty() ? "" : path_ + ".") + name;
    if (item.is(Node::Kind::text)) return Expression(item.text, variables, origin);
    if (!is_number(item) || !std::isfinite(item.number))
        throw InputError(origin + " = " + value_text(item) + " is " + kind_name(item) +
                         ": a finite number or a formula in quotes" + (*unit ? " in " : "") + unit +
                         " is expected.");
    return Expression(number_text(item.number, 17), variables, origin);
}

void TableReader::formula(const std::string& key, std::optional<Expression>& target,
                          const std::string& variables, const char* unit) {
    if (const Node* node = find(key)) target = formula_of(*node, key, variables, unit);
}

void TableReader::vector(const std::string& key, Vec3& target, std::vector<Expression>& formulas,
                         const std::string& variables, const char* unit) {
    formulas.clear();
    const Node* node = table_.find(key);
    const bool any_text = node && node->is(Node::Kind::array) && node->items.size() == 3 &&
                          std::any_of(node->items.begin(), node->items.end(), [](const Node& item) {
                              return item.is(Node::Kind::text);
                          });
    if (!any_text) return vector(key, target, unit);
    find(key);
    target = {};
    for (std::size_t axis = 0; axis < 3; ++axis)
        formulas.push_back(formula_of(node->items[axis], key + "[" + std::to_string(axis) + "]",
                                      variables, unit));
}

void TableReader::direction(const std::string& key, Vec3& target) {
    vector(key, target, "");
    const double length = std::hypot(target[0], target[1], target[2]);
    if (length == 0) reject(key, "has no direction: at least one component must differ from 0.");
    for (double& component : target) component /= length;
}

void TableReader::divisions(const std::string& key, std::array<int, 3>& target) {
    const Node* node = find(key);
    if (!node) return;
    const bool three =
        node->is(Node::Kind::array) && node->items.size() == 3 &&
        std::all_of(node->items.begin(), node->items.end(), [](const Node& item) {
            return item.is(Node::Kind::integer) && item.integer >= 0 && item.integer <= 100000;
        });
    if (!three)
        reject(key, "is not allowed: three integers of 0 to 100000 [x, y, z] are expected.");
    for (std::size_t axis = 0; axis < 3; ++axis)
        target[axis] = static_cast<int>(node->items[axis].integer);
}

void TableReader::polygon(const std::string& key, std::vector<std::array<double, 2>>& target) {
    const Node* node = find(key);
    if (!node) return;
    const auto number = [](const Node& item) {
        return item.is(Node::Kind::integer)  ? static_cast<double>(item.integer)
               : item.is(Node::Kind::number) ? item.number
                                             : std::numeric_limits<double>::quiet_NaN();
    };
    bool allowed = node->is(Node::Kind::array) && node->items.size() >= 3;
    target.clear();
    for (std::size_t k = 0; allowed && k < node->items.size(); ++k) {
        const Node& corner = node->items[k];
        allowed = corner.is(Node::Kind::array) && corner.items.size() == 2;
        if (!allowed) break;
        target.push_back({number(corner.items[0]), number(corner.items[1])});
        allowed = std::isfinite(target.back()[0]) && std::isfinite(target.back()[1]);
    }
    if (!allowed) reject(key, "is not allowed: at least three corners [x, z] in m are expected.");
}

void TableReader::pairs(const std::string& key, std::vector<std::array<double, 2>>& target,
                        std::size_t least, std::size_t most, const std::string& meaning) {
    const Node* node = find(key);
    if (!node) return;
    const auto allowed = [](const Node& row) {
        return row.is(Node::Kind::array) && row.items.size() == 2 &&
               std::all_of(row.items.begin(), row.items.end(), [](const Node& item) {
                   return is_number(item) && std::isfinite(item.number);
               });
    };
    if (!node->is(Node::Kind::array) || node->items.size() < least || node->items.size() > most ||
        !std::all_of(node->items.begin(), node->items.end(), allowed))
        reject(key, "is not allowed: " + std::to_string(least) + " to " + std::to_string(most) +
                        " " + meaning + " are expected.");
    target.clear();
    for (const Node& row : node->items) target.push_back({row.items[0].number, row.items[1].number});
}

void TableReader::points(const std::string& key, std::vector<Vec3>& target, std::size_t count) {
    const Node* node = find(key);
    if (!node) return;
    const auto allowed = [](const Node& point) {
        return point.is(Node::Kind::array) && point.items.size() == 3 &&
               std::all_of(point.items.begin(), point.items.end(), [](const Node& item) {
                   return is_number(item) && std::isfinite(item.number);
               });
    };
    if (!node->is(Node::Kind::array) || node->items.size() != count ||
        !std::all_of(node->items.begin(), node->items.end(), allowed))
        reject(key, "is not allowed: " + std::to_string(count) +
                        " points [x, y, z] in m are expected.");
    target.clear();
    for (const Node& point : node->items)
        target.push_back({point.items[0].number, point.items[1].number, point.items[2].number});
}

void TableReader::box(const std::string& key, Box& target, const std::string& axes) {
    table(key, [&](TableReader& reader) {
        reader.require("min", "[x, y, z], its lower corner");
        reader.require("max", "[x, y, z], its upper corner");
        reader.vector("min", target.min, "m");
        reader.vector("max", target.max, "m");
        reader.finish();
        for (const char axis : axes) {
            const auto k = static_cast<std::size_t>(axis - 'x');
            if (target.max[k] <= target.min[k])
                reader.reject("max", std::string("is not allowed: its ") + axis + " must be > " +
                                         with_unit(target.min[k], "m") + ", the " + axis +
                                         " of min.");
        }
    });
}

void TableReader::word(const std::string& key, std::string& target,
                       const std::vector<std::string>& known) {
    const Node* node = find(key);
    if (!node) return;
    if (!node->is(Node::Kind::text))
        reject(key, "is " + kind_name(*node) + ": one of " + list_text(known) + " is expected.");
    if (std::find(known.begin(), known.end(), node->text) == known.end())
        reject(key,
               known.empty() ? "is not known: the case has none to name."
                             : "is not known: allowed are " + list_text(known) + did_you_mean(node->text, known));
    target = node->text;
}

void TableReader::words(const std::string& key, std::vector<std::string>& target,
                        const std::vector<std::string>& known) {
    const Node* node = find(key);
    if (!node) return;
    if (!node->is(Node::Kind::array) || node->items.empty())
        reject(key, "is not allowed: a list of " + list_text(known) + " is expected.");
    target.clear();
    for (const Node& item : node->items) {
        if (!item.is(Node::Kind::text) ||
            std::find(known.begin(), known.end(), item.text) == known.end())
            reject(key, "holds " + value_text(item) + ": allowed are " + list_text(known) +
                            did_you_mean(item.text, known));
        target.push_back(item.text);
    }
}

bool TableReader::table(const std::string& key, const std::function<void(TableReader&)>& read) {
    const Node* node = find(key);
    if (!node || is_false(*node)) return false;
    if (!node->is(Node::Kind::table))
        reject(key, "is " + kind_name(*node) + ": a table is expected" +
                        (node->is(Node::Kind::array) ? " (single brackets, [" + key + "])." : "."));
    TableReader reader(*node, path_.empty() ? key : path_ + "." + key);
    read(reader);
    reader.finish();
    return true;
}

std::string TableReader::sub_path(const Node& item, const std::string& key,
                                  std::size_t index) const {
    const Node* name = item.find("name");
    return path_ + "." + key + "." +
           (name && name->is(Node::Kind::text) ? name->text : std::to_string(index));
}

void TableReader::tables(const std::string& key, const std::function<void(TableReader&)>& read) {
    const Node* node = find(key);
    if (!node || is_false(*node)) return;
    const bool all_tables =
        node->is(Node::Kind::array) &&
        std::all_of(node->items.begin(), node->items.end(),
                    [](const Node& item) { return item.is(Node::Kind::table); });
    if (!all_tables)
        reject(key, "is " + kind_name(*node) +
                        ": an array of tables is expected (double brackets, [[" + path_ + "." +
                        key + "]]).");
    std::vector<std::string> names;
    for (std::size_t i = 0; i < node->items.size(); ++i) {
        const Node& item = node->items[i];
        TableReader reader(item, sub_path(item, key, i));
        read(reader);
        reader.finish();
        const Node* name = item.find("name");
        if (!name) continue;
        if (std::find(names.begin(), names.end(), name->text) != names.end())
            reader.reject("name",
                          "is taken: every [[" + path_ + "." + key + "]] needs a name of its own.");
        names.push_back(name->text);
    }
}

void TableReader::require(const std::string& key, const std::string& what) {
    required_.emplace_back(key, what);
}

void TableReader::finish() const {
    const std::string owner = path_.empty() ? "a case" : "[" + path_ + "]";
    for (const auto& [key, value] : table_.members) {
        if (std::find(known_.begin(), known_.end(), key) != known_.end()) continue;
        throw InputError(value.key_place + ": " + (path_.empty() ? key : path_ + "." + key) +
                         " = " + value_text(value) + " is not a key of " + owner +
                         ": allowed are " + list_text(known_) + did_you_mean(key, known_));
    }
    for (const auto& [key, what] : required_)
        if (const Node* node = table_.find(key); !node || is_false(*node))
            throw InputError(table_.place + ": " + owner + " has no " + key + ": give " + what +
                             ".");
}

}  // namespace undertow
