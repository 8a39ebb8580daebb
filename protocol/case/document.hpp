#pragma once
// A TOML document as a plain tree in which every value knows where it was written. The parser
// (toml++) stays behind document.cpp.

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace undertow {

struct Node {
    enum class Kind { table, array, text, integer, number, flag };

    // In document.cpp, where a pair of a text and a Node is whole: clang asks for that.
    Node();
    ~Node();
    Node(const Node&);
    Node(Node&&) noexcept;
    Node& operator=(const Node&);
    Node& operator=(Node&&) noexcept;

    Kind kind = Kind::table;
    std::string place;                                // "case.toml:12:11", or "--set key=value"
    std::string key_place;                            // of the key that holds this value
    std::string text;
    std::int64_t integer = 0;
    double number = 0;                                // also filled for integers
    bool flag = false;
    std::vector<Node> items;                          // of an array
    std::vector<std::pair<std::string, Node>> members;   // of a table, in the order written

    bool is(Kind k) const { return kind == k; }
    const Node* find(const std::string& key) const;
    Node* find(const std::string& key);
    /// Replaces or adds a member.
    Node& put(const std::string& key, Node value);
    void remove(const std::string& key);
};

/// "an integer", "a table", ... for messages.
std::string kind_name(const Node& node);
/// The value as TOML would write it, shortened: "0.01", "\"water\"", "[0, 0, 1]".
std::string value_text(const Node& node);

/// Throws InputError with file:line:column when the file is missing or is not TOML.
Node parse_document(const std::string& path);

/// `text` as a TOML value; what is not one is taken as a bare string. All places become `place`.
Node parse_value(const std::string& text, const std::string& place);

}  // namespace undertow
