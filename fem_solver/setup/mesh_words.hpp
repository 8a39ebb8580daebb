#pragma once
// A mesh file word by word, for readers that name file and line in every complaint.

#include <charconv>
#include <cstdint>
#include <fstream>
#include <iterator>
#include <string>
#include <string_view>
#include <utility>

#include "wire/errors.hpp"

namespace undertow::fem {

/// Words of the file, one after the other, with the line they stand in.
class MeshWords {
 public:
    explicit MeshWords(std::string path) : path_(std::move(path)) {
        std::ifstream file(path_, std::ios::binary);
        if (!file) throw InputError("fem.mesh: cannot open \"" + path_ + "\".");
        text_.assign(std::istreambuf_iterator<char>(file), {});
    }
    bool skip_space() {
        while (at_ < text_.size() && (text_[at_] == ' ' || text_[at_] == '\n' ||
                                      text_[at_] == '\r' || text_[at_] == '\t'))
            if (text_[at_++] == '\n') ++line_;
        return at_ < text_.size();
    }
    std::string_view next() {
        if (!skip_space()) fail("the file ends in the middle of a section");
        const std::size_t begin = at_;
        while (at_ < text_.size() && text_[at_] > ' ') ++at_;
        return std::string_view(text_).substr(begin, at_ - begin);
    }
    std::string quoted() {
        if (!skip_space() || text_[at_] != '"') fail("expected a name in quotes");
        const std::size_t begin = ++at_;
        while (at_ < text_.size() && text_[at_] != '"' && text_[at_] != '\n') ++at_;
        if (at_ >= text_.size() || text_[at_] != '"') fail("a name lacks its closing quote");
        return text_.substr(begin, at_++ - begin);
    }
    template <class Number>
    Number number() {
        const std::string_view word = next();
        Number value{};
        const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
        if (error != std::errc{} || end != word.data() + word.size())
            fail("expected a number, found \"" + std::string(word) + "\"");
        return value;
    }
    std::int64_t integer() { return number<std::int64_t>(); }
    std::size_t count() {
        const std::int64_t n = integer();
        // every counted thing takes two characters at least: a larger count is a broken file
        if (n < 0 || std::size_t(n) > text_.size())
            fail("a count of " + std::to_string(n) + " cannot be right");
        return std::size_t(n);
    }
    void expect(std::string_view word) {
        const std::string_view found = next();
        if (found != word)
            fail("expected " + std::string(word) + ", found \"" + std::string(found) + "\"");
    }
    void skip_section(std::string_view name) {  // up to and with "$EndName"
        const std::string end = "$End" + std::string(name);
        while (skip_space())
            if (next() == end) return;
        fail("the section $" + std::string(name) + " has no " + end);
    }
    [[noreturn]] void fail(const std::string& what) const {
        throw InputError(path_ + ":" + std::to_string(line_) + ": " + what + ".");
    }

 private:
    std::string path_, text_;
    std::size_t at_ = 0;
    int line_ = 1;
};

}  // namespace undertow::fem
