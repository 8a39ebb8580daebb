#include "case/written_keys.hpp"

#include <charconv>

namespace undertow {

namespace {

/// As few digits as name this number and no other.
std::string shortest_text(double number) {
    char text[32];
    return {text, std::to_chars(text, text + sizeof text, number).ptr};
}

/// With all its digits, where value_text() shortens.
std::string whole_text(const Node& node) {
    switch (node.kind) {
        case Node::Kind::text:
            return '"' + node.text + '"';
        case Node::Kind::integer:
            return std::to_string(node.integer);
        case Node::Kind::number:
            return shortest_text(node.number);
        case Node::Kind::flag:
            return node.flag ? "true" : "false";
        default:
            break;
    }
    std::string text = node.is(Node::Kind::array) ? "[" : "{";
    for (const Node& item : node.items) text += whole_text(item) + ", ";
    for (const auto& [key, value] : node.members) text += key + " = " + whole_text(value) + ", ";
    if (text.size() > 1) text.resize(text.size() - 2);
    return text + (node.is(Node::Kind::array) ? "]" : "}");
}

bool holds_tables(const Node& node) {
    return node.is(Node::Kind::array) && !node.items.empty() &&
           node.items.front().is(Node::Kind::table);
}

void flatten(const Node& node, const std::string& path,
             std::vector<std::pair<std::string, std::string>>& keys) {
    if (node.is(Node::Kind::table)) {
        for (const auto& [key, value] : node.members)
            flatten(value, path.empty() ? key : path + "." + key, keys);
    } else if (holds_tables(node)) {
        for (std::size_t k = 0; k < node.items.size(); ++k) {
            const Node* name = node.items[k].find("name");
            const bool named = name && name->is(Node::Kind::text);
            flatten(node.items[k], path + "." + (named ? name->text : std::to_string(k)), keys);
        }
    } else {
        keys.emplace_back(path, whole_text(node));
    }
}

}  // namespace

std::vector<std::pair<std::string, std::string>> written_keys(const Node& root) {
    std::vector<std::pair<std::string, std::string>> keys;
    flatten(root, "", keys);
    return keys;
}

}  // namespace undertow
