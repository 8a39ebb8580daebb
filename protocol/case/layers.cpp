#include "case/layers.hpp"

#include <algorithm>

#include "case/nearest.hpp"
#include "wire/errors.hpp"

namespace undertow {

namespace {

bool removes(const Node& node) {
    return node.is(Node::Kind::flag) && !node.flag;
}

bool is_table_or_tables(const Node& node) {
    return node.is(Node::Kind::table) || (node.is(Node::Kind::array) && !node.items.empty() &&
                                          node.items.front().is(Node::Kind::table));
}

Node empty_table(const std::string& place) {
    Node table;
    table.place = table.key_place = place;
    return table;
}

void merge_tables(Node& base, const Node& overlay) {
    for (const auto& [key, value] : overlay.members) {
        Node* member = base.find(key);
        if (member && is_table_or_tables(*member) && removes(value))
            base.remove(key);
        else if (member && member->is(Node::Kind::table) && value.is(Node::Kind::table))
            merge_tables(*member, value);
        else
            base.put(key, value);
    }
}

void append_arrays(Node& base, const Node& additions, const std::string& path) {
    for (const auto& [key, value] : additions.members) {
        const std::string here = path.empty() ? key : path + "." + key;
        Node* member = base.find(key);
        if (value.is(Node::Kind::table)) {
            if (!member) member = &base.put(key, empty_table(value.place));
            append_arrays(*member, value, here);
        } else if (value.is(Node::Kind::array)) {
            if (!member)
                base.put(key, value);
            else if (member->is(Node::Kind::array))
                member->items.insert(member->items.end(), value.items.begin(), value.items.end());
            else
                throw InputError(value.key_place + ": append." + here + " adds to an array, but " +
                                 here + " is " + kind_name(*member) + " (" + member->place + ").");
        } else {
            throw InputError(value.place + ": append." + here + " = " + value_text(value) + " is " +
                             kind_name(value) +
                             ": append takes arrays only, such as "
                             "[[variant.NAME.append.sph.plane]].");
        }
    }
}

/// The entry of an array of tables called `name` or numbered so.
Node* find_entry(Node& array, const std::string& name) {
    for (Node& item : array.items)
        if (const Node* own = item.find("name"); own && own->text == name) return &item;
    const bool number = !name.empty() && std::all_of(name.begin(), name.end(), [](unsigned char c) {
        return c >= '0' && c <= '9';
    });
    if (!number || name.size() > 6) return nullptr;
    const auto index = static_cast<std::size_t>(std::stoul(name));
    return index < array.items.size() ? &array.items[index] : nullptr;
}

const Node& find_layer(const Node& document, const std::string& kind, const std::string& name) {
    const Node* layers = document.find(kind);
    const Node* layer = layers ? layers->find(name) : nullptr;
    if (layer && layer->is(Node::Kind::table)) return *layer;
    const std::vector<std::string> known = layer_names(document, kind);
    std::string file = document.place.substr(0, document.place.find(':'));
    if (known.empty())
        throw InputError(file + ": the case has no " + kind + " \"" + name + "\": it has no [" +
                         kind + ".NAME] tables at all.");
    throw InputError(file + ": the case has no " + kind + " \"" + name + "\": known are " +
                     list_text(known) + did_you_mean(name, known));
}

}  // namespace

void lay_over(Node& base, const Node& overlay) {
    Node plain = overlay;
    plain.remove("append");
    merge_tables(base, plain);
    if (const Node* additions = overlay.find("append")) append_arrays(base, *additions, "");
}

void apply_override(Node& base, const std::string& assignment) {
    const std::string place = "--set " + assignment;
    const std::size_t equals = assignment.find('=');
    if (equals == std::string::npos || equals == 0)
        throw InputError(place + ": an override reads key=value, for example sph.spacing=0.005.");
    const std::string path = assignment.substr(0, equals);
    Node value = parse_value(assignment.substr(equals + 1), place);

    Node* table = &base;
    std::size_t start = 0;
    for (std::size_t dot; (dot = path.find('.', start)) != std::string::npos; start = dot + 1) {
        const std::string key = path.substr(start, dot - start);
        Node* member = table->is(Node::Kind::array) ? find_entry(*table, key) : table->find(key);
        if (!member && table->is(Node::Kind::array))
            throw InputError(place + ": " + path.substr(0, start - 1) + " has no entry \"" + key +
                             "\"; use its name or its number from 0.");
        if (!member) member = &table->put(key, empty_table(place));
        if (!member->is(Node::Kind::table) && !member->is(Node::Kind::array))
            throw InputError(place + ": " + path.substr(0, dot) + " is " + kind_name(*member) +
                             " and holds no keys.");
        table = member;
    }
    const std::string key = path.substr(start);
    if (table->is(Node::Kind::array))
        throw InputError(place + ": " + path.substr(0, start - 1) +
                         " is an array; name a key of one entry, such as " + path.substr(0, start) +
                         "0.KEY=VALUE.");
    Node wrapper;
    wrapper.put(key, std::move(value));
    merge_tables(*table, wrapper);
}

Node resolve_layers(Node document, const CaseOptions& options) {
    Node resolved = document;
    resolved.remove("level");
    resolved.remove("variant");
    if (!options.level.empty()) lay_over(resolved, find_layer(document, "level", options.level));
    for (const std::string& variant : options.variants)
        lay_over(resolved, find_layer(document, "variant", variant));
    for (const std::string& assignment : options.set) apply_override(resolved, assignment);
    return resolved;
}

std::vector<std::string> layer_names(const Node& document, const std::string& kind) {
    std::vector<std::string> names;
    if (const Node* layers = document.find(kind))
        for (const auto& [name, layer] : layers->members)
            if (layer.is(Node::Kind::table)) names.push_back(name);
    return names;
}

}  // namespace undertow
