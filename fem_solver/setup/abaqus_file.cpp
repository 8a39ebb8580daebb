#include "fem_solver/setup/abaqus_file.hpp"

#include <algorithm>
#include <charconv>
#include <iterator>

namespace undertow::fem {
namespace {

bool is_one_of(const std::string& name, std::initializer_list<const char*> names) {
    return std::find(names.begin(), names.end(), name) != names.end();
}

}  // namespace

AbaqusModel AbaqusFile::read() {
    AbaqusKeyword keyword;
    bool any = false;
    while (lines_.next_keyword(keyword)) {
        read_keyword(keyword);
        any = true;
    }
    if (!any) fail(1, "not an Abaqus input file: it has no keyword line like *NODE");
    check_element_types();
    return std::move(model_);
}

void AbaqusFile::read_keyword(const AbaqusKeyword& keyword) {
    const std::string& name = keyword.name;
    refuse_what_changes_the_mesh(keyword);
    if (name == "STEP") in_step_ = true;
    if (name == "ENDSTEP")
        in_step_ = false;
    else if (in_step_)
        skip(keyword);
    else if (name == "NODE")
        read_nodes(keyword);
    else if (name == "ELEMENT")
        read_elements(keyword);
    else if (name == "NSET" || name == "ELSET")
        read_set(keyword, name == "NSET");
    else if (name == "SURFACE")
        read_surface(keyword);
    else if (name == "PART")
        read_part(keyword);
    else if (name == "INSTANCE")
        read_instance(keyword);
    else if (name == "ENDPART" || name == "ENDINSTANCE")
        part_ = 0;
    else if (!is_one_of(name, {"HEADING", "PREPRINT", "ASSEMBLY", "ENDASSEMBLY"}))
        skip(keyword);
}

/// To pass over these would give another mesh than the file means.
void AbaqusFile::refuse_what_changes_the_mesh(const AbaqusKeyword& keyword) const {
    const std::string& name = keyword.name;
    if (name == "INCLUDE")
        fail(keyword.line,
             "*INCLUDE is not followed; put the lines of the other file into this one");
    if (is_one_of(name, {"NGEN", "NFILL", "NMAP", "NCOPY", "ELGEN", "ELCOPY", "SYSTEM", "IMPORT",
                         "PARAMETER"}))
        fail(keyword.line, "*" + name +
                               " makes or moves parts of the mesh and is not read; let the mesh "
                               "generator write all nodes and elements out");
    if (is_one_of(name, {"NODE", "ELEMENT", "NSET", "ELSET"}) && keyword.has("INPUT"))
        fail(keyword.line, "INPUT = " + keyword.value("INPUT") + " of *" + name +
                               " is not followed; put its lines into this file");
}

void AbaqusFile::skip(const AbaqusKeyword& keyword) {
    const std::string name = "*" + keyword.name;
    if (std::find(model_.skipped.begin(), model_.skipped.end(), name) == model_.skipped.end())
        model_.skipped.push_back(name);
}

std::string AbaqusFile::need(const AbaqusKeyword& keyword, const char* parameter) const {
    const std::string value = keyword.value(parameter);
    if (value.empty())
        fail(keyword.line, "*" + keyword.name + " lacks its " + parameter + " = ...");
    return value;
}

void AbaqusFile::read_part(const AbaqusKeyword& keyword) {
    part_ = model_.part.size();
    model_.part.emplace_back().name = need(keyword, "NAME");
    here().line = keyword.line;
}

void AbaqusFile::read_instance(const AbaqusKeyword& keyword) {
    model_.instances = true;
    const std::string name = need(keyword, "NAME"), part = need(keyword, "PART");
    const auto found =
        std::find_if(model_.part.begin() + 1, model_.part.end(),
                     [&](const AbaqusPart& p) { return capitals(p.name) == capitals(part); });
    if (found == model_.part.end())
        fail(keyword.line, "*INSTANCE " + name + ": there is no *PART " + part + " before it");
    if (!found->instance.empty())
        fail(keyword.line, "*INSTANCE " + name + ": the part " + part + " has the instance " +
                               found->instance +
                               " already; a part is read once, so write the second one out as a "
                               "part of its own");
    found->instance = name;
    part_ = std::size_t(found - model_.part.begin());
    std::vector<std::string_view> fields;
    if (!lines_.next_data(fields)) return;
    for (std::size_t d = 0; d < 3 && d < fields.size(); ++d)
        found->shift[d] = lines_.number(fields[d]);
    if (!lines_.next_data(fields)) return;
    if (fields.size() != 7) lines_.fail("a rotation has seven numbers: two points and an angle");
    for (std::size_t d = 0; d < 3; ++d) {
        found->a[d] = lines_.number(fields[d]);
        found->b[d] = lines_.number(fields[3 + d]);
    }
    found->angle = lines_.number(fields[6]);
    if (found->a == found->b) lines_.fail("the two points of a rotation's axis are the same");
}

void AbaqusFile::read_nodes(const AbaqusKeyword& keyword) {
    const std::string system = capitals(keyword.value("SYSTEM"));
    if (!system.empty() && system != "R")
        fail(keyword.line, "*NODE, SYSTEM = " + system +
                               ": nodes are read in rectangular coordinates alone; let the mesh "
                               "generator write them so");
    AbaqusSet* set = keyword.has("NSET") ? &set_of(true, need(keyword, "NSET")) : nullptr;
    AbaqusPart& part = here();
    std::vector<std::string_view> fields;
    while (lines_.next_data(fields)) {
        std::int64_t id = 0;
        if (fields.empty() || !AbaqusLines::whole(fields[0], id))
            lines_.fail("expected the number of a node");
        Vec3 x{};
        for (std::size_t d = 0; d < 3 && d + 1 < fields.size(); ++d)
            if (!fields[d + 1].empty()) x[d] = lines_.number(fields[d + 1]);
        if (!part.node_of_id.emplace(id, std::int32_t(part.x.size())).second)
            lines_.fail("node " + std::to_string(id) + " is defined twice");
        part.node_id.push_back(id);
        part.x.push_back(x);
        if (set) set->member.push_back({std::int32_t(part_), id, lines_.line()});
    }
}

void AbaqusFile::read_elements(const AbaqusKeyword& keyword) {
    const std::string type = capitals(need(keyword, "TYPE"));
    const AbaqusShape shape = shape_of_type(type);
    if (shape == AbaqusShape::none) {
        if (std::none_of(unknown_types_.begin(), unknown_types_.end(),
                         [&](const auto& known) { return known.first == type; }))
            unknown_types_.emplace_back(type, keyword.line);
        return;
    }
    AbaqusSet* set = keyword.has("ELSET") ? &set_of(false, need(keyword, "ELSET")) : nullptr;
    AbaqusPart& part = here();
    const std::size_t fields_needed = 1 + std::size_t(corners_of(shape));
    std::vector<std::string_view> fields, more;
    while (lines_.next_data(fields)) {
        AbaqusElement element{0, shape, {}, lines_.line()};
        while (fields.size() < fields_needed && lines_.continues() && lines_.next_data(more))
            fields.insert(fields.end(), more.begin(), more.end());
        if (fields.empty() || !AbaqusLines::whole(fields[0], element.id))
            fail(element.line, "expected the number of an element");
        const std::string what = "element " + std::to_string(element.id) + " (" + type + ")";
        if (fields.size() < fields_needed ||
            (fields.size() > fields_needed && shape != AbaqusShape::beam))
            fail(element.line, what + " has " + std::to_string(fields.size() - 1) +
                                   " nodes where there must be " +
                                   std::to_string(fields_needed - 1));
        for (std::size_t k = 1; k < fields_needed; ++k)
            if (!AbaqusLines::whole(fields[k], element.node[k - 1]))
                fail(element.line, what + ": expected the number of a node, found \"" +
                                       std::string(fields[k]) + "\"");
        if (!part.element_of_id.emplace(element.id, std::int32_t(part.element.size())).second)
            fail(element.line, what + " is defined twice");
        part.element.push_back(element);
        if (set) set->member.push_back({std::int32_t(part_), element.id, element.line});
    }
}

void AbaqusFile::check_element_types() const {
    if (unknown_types_.empty()) return;
    std::string list;
    for (const auto& [type, line] : unknown_types_)
        list += (list.empty() ? "" : ", ") + type + " (line " + std::to_string(line) + ")";
    fail(unknown_types_.front().second,
         "elements of type " + list +
             " are not read; there are 8-node hexahedra (C3D8), 4-node tetrahedra (C3D4) and "
             "4-node shells (S4), and SFM3D4, CPS4 and triangles for facets: mesh with these, of "
             "first order");
}

AbaqusSet& AbaqusFile::set_of(bool of_nodes, const std::string& name) {
    AbaqusSet& set = (of_nodes ? here().node_set : here().element_set)[capitals(name)];
    if (set.name.empty()) set.name = name;
    return set;
}

std::int32_t AbaqusFile::part_of_instance(const std::string& instance) const {
    for (std::size_t p = 1; p < model_.part.size(); ++p)
        if (capitals(model_.part[p].instance) == instance) return std::int32_t(p);
    return -1;
}

bool AbaqusFile::refer(std::string_view field, bool of_nodes, std::int32_t part,
                       std::vector<AbaqusRef>& refs, std::string& trouble) const {
    std::string name = capitals(field);
    if (const std::size_t dot = name.find('.'); dot != name.npos && part == 0)
        if (const std::int32_t other = part_of_instance(name.substr(0, dot)); other >= 0) {
            part = other;
            name.erase(0, dot + 1);
        }
    std::int64_t id = 0;
    if (AbaqusLines::whole(name, id)) {
        refs.push_back({part, id, lines_.line()});
        return true;
    }
    const auto& sets = of_nodes ? model_.part[part].node_set : model_.part[part].element_set;
    const auto found = sets.find(name);
    if (found == sets.end()) {
        trouble = "line " + std::to_string(lines_.line()) + " of the file names the set " +
                  std::string(field) + ", which there is not before it.";
        return false;
    }
    // not from a range of its own elements: a set may name itself
    for (std::size_t i = 0, n = found->second.member.size(); i < n; ++i)
        refs.push_back(AbaqusRef(found->second.member[i]));
    if (!found->second.trouble.empty()) trouble = found->second.trouble;
    return true;
}

void AbaqusFile::read_set(const AbaqusKeyword& keyword, bool of_nodes) {
    AbaqusSet& set = set_of(of_nodes, need(keyword, of_nodes ? "NSET" : "ELSET"));
    std::int32_t part = std::int32_t(part_);
    if (keyword.has("INSTANCE")) {
        part = part_of_instance(capitals(keyword.value("INSTANCE")));
        if (part < 0)
            fail(keyword.line, "there is no *INSTANCE " + keyword.value("INSTANCE") + " before it");
    }
    if (of_nodes && keyword.has("ELSET")) {  // the nodes of these elements
        std::vector<AbaqusRef> elements;
        refer(need(keyword, "ELSET"), false, part, elements, set.trouble);
        for (const AbaqusRef& ref : elements) {
            const AbaqusPart& p = model_.part[ref.part];
            const auto found = p.element_of_id.find(ref.id);
            if (found == p.element_of_id.end()) continue;
            const AbaqusElement& element = p.element[found->second];
            for (int k = 0; k < corners_of(element.shape); ++k)
                set.member.push_back({ref.part, element.node[k], keyword.line});
        }
    }
    std::vector<std::string_view> fields;
    while (lines_.next_data(fields)) {
        if (!keyword.has("GENERATE")) {
            for (std::string_view field : fields)
                if (!field.empty()) refer(field, of_nodes, part, set.member, set.trouble);
            continue;
        }
        std::int64_t first = 0, last = 0, step = 1;
        if (fields.size() < 2 || !AbaqusLines::whole(fields[0], first) ||
            !AbaqusLines::whole(fields[1], last) ||
            (fields.size() > 2 && !AbaqusLines::whole(fields[2], step)) || step < 1 || last < first)
            lines_.fail("GENERATE wants first, last >= first, step >= 1");
        // every member takes a line of nodes or elements: a longer range is a broken file
        if ((last - first) / step >
            std::int64_t(model_.part[part].element.size() + model_.part[part].x.size()))
            lines_.fail("GENERATE from " + std::to_string(first) + " to " + std::to_string(last) +
                        " holds more than the part has");
        for (std::int64_t id = first; id <= last; id += step)
            set.member.push_back({part, id, lines_.line()});
    }
}

void AbaqusFile::read_surface(const AbaqusKeyword& keyword) {
    const std::string name = need(keyword, "NAME"), type = capitals(keyword.value("TYPE"));
    if (type == "NODE") {
        AbaqusSet& set = set_of(true, name);
        std::vector<std::string_view> fields;
        while (lines_.next_data(fields))
            if (!fields.empty())
                refer(fields[0], true, std::int32_t(part_), set.member, set.trouble);
        return;
    }
    AbaqusSurface& surface = here().surface[capitals(name)];
    if (surface.name.empty()) surface.name = name;
    if ((!type.empty() && type != "ELEMENT") || keyword.has("COMBINE")) {
        surface.trouble = "it is a surface of type " + (type.empty() ? "COMBINE" : type) +
                          " at line " + std::to_string(keyword.line) +
                          "; write it as faces of elements (*SURFACE, TYPE=ELEMENT).";
        return;
    }
    std::vector<std::string_view> fields;
    while (lines_.next_data(fields)) {
        if (fields.empty() || fields[0].empty()) {
            surface.trouble = "line " + std::to_string(lines_.line()) +
                              " of the file takes all there is into it; name sets of elements.";
            continue;
        }
        AbaqusSurface::Row& row = surface.row.emplace_back();
        row.line = lines_.line();
        if (fields.size() > 1) row.face = capitals(fields[1]);
        refer(fields[0], false, std::int32_t(part_), row.elements, surface.trouble);
    }
}

}  // namespace undertow::fem
