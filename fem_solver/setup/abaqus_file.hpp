#pragma once
// From the lines of an Abaqus input file to an AbaqusModel.

#include <string>

#include "fem_solver/setup/abaqus_lines.hpp"
#include "fem_solver/setup/abaqus_model.hpp"

namespace undertow::fem {

class AbaqusFile {
 public:
    explicit AbaqusFile(const std::string& path) : lines_(path) {}

    /// Once. InputError with file:line.
    AbaqusModel read();
    [[noreturn]] void fail(int line, const std::string& what) const { lines_.fail(line, what); }

 private:
    void read_keyword(const AbaqusKeyword& keyword);
    void read_part(const AbaqusKeyword& keyword);
    void read_instance(const AbaqusKeyword& keyword);
    void read_nodes(const AbaqusKeyword& keyword);
    void read_elements(const AbaqusKeyword& keyword);
    void read_set(const AbaqusKeyword& keyword, bool of_nodes);
    void read_surface(const AbaqusKeyword& keyword);
    void refuse_what_changes_the_mesh(const AbaqusKeyword& keyword) const;
    void skip(const AbaqusKeyword& keyword);
    void check_element_types() const;

    AbaqusPart& here() { return model_.part[part_]; }
    std::int32_t part_of_instance(const std::string& instance) const;
    /// The elements (nodes) that a field of a set means: a number or the name of a set, perhaps
    /// "INSTANCE." before it. False, with a sentence in `trouble`, when there is no such set.
    bool refer(std::string_view field, bool of_nodes, std::int32_t part,
               std::vector<AbaqusRef>& refs, std::string& trouble) const;
    AbaqusSet& set_of(bool of_nodes, const std::string& name);
    std::string need(const AbaqusKeyword& keyword, const char* parameter) const;

    AbaqusLines lines_;
    AbaqusModel model_;
    std::size_t part_ = 0;  // that the lines are of
    bool in_step_ = false;
    std::vector<std::pair<std::string, int>> unknown_types_;  // with the line of their first
};

}  // namespace undertow::fem
