#include "results/vtkhdf.hpp"

#include <algorithm>
#include <stdexcept>

namespace undertow::vtkhdf {

hsize_t chunk_rows(std::size_t rows) {
    return std::clamp<std::size_t>(rows, 64, 16384);
}

FieldLayout layout_of(const Field& field) {
    return {field.name, field.unit, std::to_string(field.components)};
}

void check_fields(const std::vector<Field>& fields, const std::vector<FieldLayout>& layout,
                  std::size_t rows) {
    if (fields.size() != layout.size())
        throw std::logic_error("an output step must have the same fields as the first one");
    for (std::size_t i = 0; i < fields.size(); ++i) {
        if (layout_of(fields[i]) != layout[i])
            throw std::logic_error("field " + fields[i].name +
                                   " differs from the first output step");
        if (fields[i].values.size() != rows * static_cast<std::size_t>(fields[i].components))
            throw std::logic_error("field " + fields[i].name + " has the wrong number of values");
    }
}

std::uint64_t room_for_step(const std::vector<Field>& fields, std::size_t rows,
                            std::size_t row_bytes) {
    // A dataset grows by whole chunks: up to one more than the rows need. Its index, view and tables
    // take 4 to 10 kB; another 64 kB stand for the tables that all have in common.
    constexpr std::uint64_t upkeep = 16 * 1024, common = 64 * 1024;
    for (const Field& field : fields) row_bytes += sizeof(float) * std::size_t(field.components);
    return (rows + chunk_rows(rows)) * row_bytes + (fields.size() + 4) * upkeep + common;
}

void create_root(hdf5::File& file, const char* type) {
    file.create_group("/VTKHDF");
    file.set_attribute("/VTKHDF", "Version", std::vector<std::int64_t>{2, 0});
    file.set_attribute("/VTKHDF", "Type", type);
    file.create_group("/VTKHDF/Steps");
    file.set_attribute("/VTKHDF/Steps", "NSteps", std::int64_t{0});
    file.create_growing("/VTKHDF/Steps/Values", H5T_IEEE_F64LE, 0, 256);
    for (const char* table : {"PartOffsets", "NumberOfParts", "PointOffsets"})
        file.create_growing(std::string("/VTKHDF/Steps/") + table, H5T_STD_I64LE, 0, 256);
}

void create_field(hdf5::File& file, const std::string& group, const FieldLayout& field,
                  std::size_t rows) {
    const auto& [name, unit, components] = field;
    const std::string dataset = "/VTKHDF/" + group + "/" + name;
    const hsize_t columns = components == "1" ? 0 : std::stoul(components);
    file.create_growing(dataset, H5T_IEEE_F32LE, columns, chunk_rows(rows));
    file.set_attribute(dataset, "unit", unit);
    file.create_growing("/VTKHDF/Steps/" + group + "Offsets/" + name, H5T_STD_I64LE, 0, 256);
}

hsize_t append_floats(hdf5::File& file, const std::string& dataset, const std::string& view,
                      std::span<const double> values, std::size_t components) {
    const std::vector<float> floats(values.begin(), values.end());
    const std::size_t rows = values.size() / components;
    const hsize_t first = file.append_rows(dataset, H5T_NATIVE_FLOAT, rows, floats.data());
    file.create_view(view, dataset, first, rows);
    return first;
}

void append_fields(hdf5::File& file, const std::string& group, std::size_t step,
                   const std::vector<Field>& fields) {
    for (const Field& field : fields) {
        const std::string place = group + "/" + field.name;
        const hsize_t first =
            append_floats(file, "/VTKHDF/" + place, view_group(step) + "/" + place, field.values,
                          static_cast<std::size_t>(field.components));
        append_numbers(file, "/VTKHDF/Steps/" + group + "Offsets/" + field.name,
                       {static_cast<std::int64_t>(first)});
    }
}

void append_numbers(hdf5::File& file, const std::string& dataset,
                    const std::vector<std::int64_t>& row) {
    // Tables of one column are one-dimensional; the four topologies of PolyData make a row of four.
    const hsize_t rows = row.size() == 4 ? 1 : row.size();
    file.append_rows(dataset, H5T_NATIVE_INT64, rows, row.data());
}

}  // namespace undertow::vtkhdf
