#pragma once
// A field file as it was at a checkpoint: how long its growing tables were, and back to that.

#include <cstdint>
#include <string>
#include <vector>

namespace undertow::hdf5 {

struct Table {
    std::string name;
    std::int64_t rows = 0;
};

/// All tables that grow; the file is on the disk afterwards. InputError as File.
std::vector<Table> growing_tables(const std::string& path);

/// Cuts every growing table to the rows given, removes those that were not there, and the views of
/// steps from `steps` on. InputError when the file holds less than that.
void cut(const std::string& path, const std::vector<Table>& tables, std::size_t steps);

}  // namespace undertow::hdf5
