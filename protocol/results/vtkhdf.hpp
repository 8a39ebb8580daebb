#pragma once
// What the particle file and the mesh file have in common: fields that grow in /VTKHDF, one view
// per step, and the /VTKHDF/Steps tables of the transient VTKHDF 2.x layout.

#include <span>
#include <string>
#include <vector>

#include "results/field_file.hpp"
#include "results/hdf5.hpp"
#include "results/xdmf.hpp"

namespace undertow::vtkhdf {

/// Rows of a chunk: one step's worth, within bounds that suit both small meshes and many particles.
hsize_t chunk_rows(std::size_t rows);

FieldLayout layout_of(const Field& field);

/// Throws std::logic_error unless `fields` have the given layout and `rows` rows each.
void check_fields(const std::vector<Field>& fields, const std::vector<FieldLayout>& layout,
                  std::size_t rows);

/// What a step with these fields adds to a file at most, if everything else takes `row_bytes` per
/// row.  [byte]
std::uint64_t room_for_step(const std::vector<Field>& fields, std::size_t rows,
                            std::size_t row_bytes);

/// /VTKHDF with its version and type, and /VTKHDF/Steps.
void create_root(hdf5::File& file, const char* type);

/// Creates the dataset of a field in /VTKHDF/`group` and its table of offsets.
void create_field(hdf5::File& file, const std::string& group, const FieldLayout& field,
                  std::size_t rows);

/// Appends values as float32 to `dataset` and makes a view of them.
hsize_t append_floats(hdf5::File& file, const std::string& dataset, const std::string& view,
                      std::span<const double> values, std::size_t components);

/// Appends the fields of one step, their views and their offsets.
void append_fields(hdf5::File& file, const std::string& group, std::size_t step,
                   const std::vector<Field>& fields);

/// One row of a table in /VTKHDF/Steps (or any int64 table).
void append_numbers(hdf5::File& file, const std::string& dataset,
                    const std::vector<std::int64_t>& row);

}  // namespace undertow::vtkhdf
