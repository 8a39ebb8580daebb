#include "fem_solver/setup/abaqus_lines.hpp"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <fstream>
#include <iterator>

#include "wire/errors.hpp"

namespace undertow::fem {
namespace {

std::string_view trimmed(std::string_view text) {
    while (!text.empty() && std::isspace(static_cast<unsigned char>(text.front())))
        text.remove_prefix(1);
    while (!text.empty() && std::isspace(static_cast<unsigned char>(text.back())))
        text.remove_suffix(1);
    return text;
}

/// Fields between commas that do not stand in quotes.
void split(std::string_view text, std::vector<std::string_view>& fields) {
    fields.clear();
    bool quoted = false;
    std::size_t begin = 0;
    for (std::size_t i = 0; i <= text.size(); ++i) {
        if (i < text.size() && text[i] == '"') quoted = !quoted;
        if (i < text.size() && (quoted || text[i] != ',')) continue;
        fields.push_back(trimmed(text.substr(begin, i - begin)));
        begin = i + 1;
    }
    while (!fields.empty() && fields.back().empty()) fields.pop_back();
}

std::string without_blanks(std::string text) {
    text.erase(
        std::remove_if(text.begin(), text.end(), [](unsigned char c) { return std::isspace(c); }),
        text.end());
    return text;
}

std::string_view unquoted(std::string_view text) {
    if (text.size() >= 2 && text.front() == '"' && text.back() == '"')
        return text.substr(1, text.size() - 2);
    return text;
}

}  // namespace

std::string capitals(std::string_view text) {
    std::string all(text);
    for (char& c : all) c = char(std::toupper(static_cast<unsigned char>(c)));
    return all;
}

bool AbaqusKeyword::has(std::string_view key) const {
    return std::any_of(parameter.begin(), parameter.end(),
                       [&](const auto& p) { return p.first == key; });
}

std::string AbaqusKeyword::value(std::string_view key) const {
    for (const auto& [name, value] : parameter)
        if (name == key) return value;
    return "";
}

AbaqusLines::AbaqusLines(std::string path) : path_(std::move(path)) {
    std::ifstream file(path_, std::ios::binary);
    if (!file) throw InputError("fem.mesh: cannot open \"" + path_ + "\".");
    text_.assign(std::istreambuf_iterator<char>(file), {});
}

void AbaqusLines::fail(int line, const std::string& what) const {
    throw InputError(path_ + ":" + std::to_string(line) + ": " + what + ".");
}

bool AbaqusLines::peek(std::string_view& text) {
    while (at_ < text_.size()) {
        after_ = std::min(text_.find('\n', at_), text_.size() - 1) + 1;
        text = trimmed(std::string_view(text_).substr(at_, after_ - at_));
        if (!text.empty() && text.substr(0, 2) != "**") return true;
        pass();
    }
    return false;
}

void AbaqusLines::pass() {
    at_ = after_;
    ++peeked_;
}

bool AbaqusLines::next_keyword(AbaqusKeyword& keyword) {
    std::string_view text;
    while (peek(text) && text.front() != '*') pass();
    if (at_ >= text_.size()) return false;
    keyword = {};
    keyword.line = line_ = peeked_ + 1;
    std::string joined(text);
    pass();
    while (joined.back() == ',' && peek(text) && text.front() != '*') {
        joined += text;
        line_ = peeked_ + 1;
        pass();
    }
    std::vector<std::string_view> fields;
    split(joined, fields);
    keyword.name = without_blanks(capitals(fields[0].substr(1)));
    for (std::size_t i = 1; i < fields.size(); ++i) {
        const std::size_t equals = std::min(fields[i].find('='), fields[i].size());
        const std::string_view value =
            equals < fields[i].size() ? trimmed(fields[i].substr(equals + 1)) : "";
        keyword.parameter.emplace_back(without_blanks(capitals(fields[i].substr(0, equals))),
                                       std::string(unquoted(value)));
    }
    return true;
}

bool AbaqusLines::next_data(std::vector<std::string_view>& fields) {
    std::string_view text;
    if (!peek(text) || text.front() == '*') return false;
    line_ = peeked_ + 1;
    continues_ = text.back() == ',';
    split(text, fields);
    for (std::string_view& field : fields) field = unquoted(field);
    pass();
    return true;
}

double AbaqusLines::number(std::string_view field) const {
    std::string text(field);
    if (!text.empty() && text.front() == '+') text.erase(0, 1);
    for (char& c : text)
        if (c == 'd' || c == 'D') c = 'e';  // of Fortran
    double value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (text.empty() || error != std::errc{} || end != text.data() + text.size() ||
        !std::isfinite(value))
        fail("expected a number, found \"" + std::string(field) + "\"");
    return value;
}

bool AbaqusLines::whole(std::string_view field, std::int64_t& value) {
    if (const std::size_t dot = field.find('.');
        dot != field.npos && field.find_first_not_of('0', dot + 1) == field.npos)
        field = field.substr(0, dot);
    const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), value);
    return !field.empty() && error == std::errc{} && end == field.data() + field.size();
}

}  // namespace undertow::fem
