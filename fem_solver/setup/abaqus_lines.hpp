#pragma once
// An Abaqus input file line by line: keyword lines with their parameters, data lines with their
// fields; comments and empty lines are passed over, continued keyword lines joined.

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace undertow::fem {

/// "*ELEMENT, TYPE=C3D8, ELSET=Wall": names in capitals, blanks in them taken out, values as they
/// are, quotes taken off.
struct AbaqusKeyword {
    std::string name;  // "ELEMENT", "ENDPART"
    int line = 0;
    std::vector<std::pair<std::string, std::string>> parameter;

    bool has(std::string_view key) const;
    /// "" when it is not there.
    std::string value(std::string_view key) const;
};

/// In capitals: keywords and labels mean the same in small letters.
std::string capitals(std::string_view text);

class AbaqusLines {
 public:
    /// InputError when the file cannot be read.
    explicit AbaqusLines(std::string path);

    /// The next keyword line, over any data lines before it; false at the end of the file.
    bool next_keyword(AbaqusKeyword& keyword);
    /// Fields of the next data line; false when a keyword or the end comes first. Views into the
    /// file, without blanks around them; a comma at the end is followed by no field.
    bool next_data(std::vector<std::string_view>& fields);
    bool continues() const { return continues_; }  // the data line ended with a comma
    int line() const { return line_; }             // of what was read last

    double number(std::string_view field) const;
    /// A whole number, also written as 12.0; false when it is something else.
    static bool whole(std::string_view field, std::int64_t& value);

    [[noreturn]] void fail(int line, const std::string& what) const;
    [[noreturn]] void fail(const std::string& what) const { fail(line_, what); }

 private:
    /// The next line that says something; does not move.
    bool peek(std::string_view& text);
    void pass();

    std::string path_, text_;
    std::size_t at_ = 0, after_ = 0;  // where the peeked line begins, and the one after it
    int line_ = 0, peeked_ = 0;       // of what was read, and before the line at at_
    bool continues_ = false;
};

}  // namespace undertow::fem
