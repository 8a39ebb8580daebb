#include "case/document.hpp"

#include <toml++/toml.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>

#include "wire/errors.hpp"
#include "wire/number_text.hpp"

namespace undertow {

Node::Node() = default;
Node::~Node() = default;
Node::Node(const Node&) = default;
Node::Node(Node&&) noexcept = default;
Node& Node::operator=(const Node&) = default;
Node& Node::operator=(Node&&) noexcept = default;

const Node* Node::find(const std::string& key) const {
    for (const auto& [name, value] : members)
        if (name == key) return &value;
    return nullptr;
}

Node* Node::find(const std::string& key) {
    return const_cast<Node*>(static_cast<const Node*>(this)->find(key));
}

Node& Node::put(const std::string& key, Node value) {
    if (Node* member = find(key)) return *member = std::move(value);
    return members.emplace_back(key, std::move(value)).second;
}

void Node::remove(const std::string& key) {
    std::erase_if(members, [&](const auto& member) { return member.first == key; });
}

std::string kind_name(const Node& node) {
    switch (node.kind) {
        case Node::Kind::table:
            return "a table";
        case Node::Kind::array:
            return "an array";
        case Node::Kind::text:
            return "a string";
        case Node::Kind::integer:
            return "an integer";
        case Node::Kind::number:
            return "a number";
        case Node::Kind::flag:
            return "a boolean";
    }
    return "a value";
}

std::string value_text(const Node& node) {
    switch (node.kind) {
        case Node::Kind::table:
            return "{...}";
        case Node::Kind::text:
            return '"' + node.text + '"';
        case Node::Kind::integer:
            return std::to_string(node.integer);
        case Node::Kind::number:
            return number_text(node.number, 10);
        case Node::Kind::flag:
            return node.flag ? "true" : "false";
        case Node::Kind::array:
            break;
    }
    std::string text = "[";
    for (std::size_t i = 0; i < node.items.size(); ++i) {
        if (text.size() > 40) return text + ", ...]";
        text += (i == 0 ? "" : ", ") + value_text(node.items[i]);
    }
    return text + "]";
}

namespace {

/// `fixed_place` replaces the parser's positions where they mean nothing to the user (--set).
Node convert(const toml::node& source, const std::string& file, const std::string& fixed_place) {
    const auto place_of = [&](const toml::source_region& region) {
        return fixed_place.empty() ? file + ":" + std::to_string(region.begin.line) + ":" +
                                         std::to_string(region.begin.column)
                                   : fixed_place;
    };
    Node node;
    node.place = node.key_place = place_of(source.source());
    if (const auto* table = source.as_table()) {
        for (const auto& [key, value] : *table) {
            Node& member = node.put(std::string(key.str()), convert(value, file, fixed_place));
            member.key_place = place_of(key.source());
        }
        // toml++ sorts keys; messages and listings follow the order of the file.
        std::stable_sort(node.members.begin(), node.members.end(),
                         [&](const auto& a, const auto& b) {
                             const auto position = [&](const auto& member) {
                                 return table->find(member.first)->first.source().begin;
                             };
                             return position(a) < position(b);
                         });
    } else if (const auto* array = source.as_array()) {
        node.kind = Node::Kind::array;
        for (const toml::node& item : *array)
            node.items.push_back(convert(item, file, fixed_place));
    } else if (const auto* text = source.as_string()) {
        node.kind = Node::Kind::text;
        node.text = text->get();
    } else if (const auto* integer = source.as_integer()) {
        node.kind = Node::Kind::integer;
        node.integer = integer->get();
        node.number = static_cast<double>(integer->get());
    } else if (const auto* number = source.as_floating_point()) {
        node.kind = Node::Kind::number;
        node.number = number->get();
    } else if (const auto* flag = source.as_boolean()) {
        node.kind = Node::Kind::flag;
        node.flag = flag->get();
    } else {
        throw InputError(node.place +
                         ": dates and times have no meaning in a case; use a number of "
                         "seconds.");
    }
    return node;
}

}  // namespace

Node parse_document(const std::string& path) {
    std::ifstream stream(path);
    if (!stream)
        throw InputError(path + ": the case file could not be read: " + std::strerror(errno) +
                         "; give a .toml file or a folder that holds case.toml.");
    try {
        return convert(toml::parse(stream, path), path, "");
    } catch (const toml::parse_error& error) {
        throw InputError(path + ":" + std::to_string(error.source().begin.line) + ":" +
                         std::to_string(error.source().begin.column) +
                         ": this is not valid TOML: " + std::string(error.description()) + ".");
    }
}

Node parse_value(const std::string& text, const std::string& place) {
    try {
        const toml::table table = toml::parse("value = " + text);
        if (table.size() == 1) return convert(*table.get("value"), "", place);
    } catch (const toml::parse_error&) {
    }
    Node node;
    node.kind = Node::Kind::text;
    node.place = node.key_place = place;
    node.text = text;
    return node;
}

}  // namespace undertow
