#include "results/xdmf.hpp"

#include <fmt/format.h>

#include "results/atomic_file.hpp"

namespace undertow {

namespace {

std::string item(const XdmfSeries& series, const std::string& path, const std::string& number_type,
                 int precision, const std::string& dimensions) {
    return fmt::format(
        "<DataItem NumberType=\"{}\" Precision=\"{}\" Dimensions=\"{}\" "
        "Format=\"HDF\">{}:{}</DataItem>",
        number_type, precision, dimensions, series.hdf_name, path);
}

std::string attribute(const XdmfSeries& series, const std::string& group, const FieldLayout& field,
                      const std::string& center, std::int64_t rows) {
    const auto& [name, unit, components] = field;
    const bool scalar = components == "1";
    // Six components go as a plain matrix: XDMF orders a Tensor6 differently from VTK.
    const char* type = scalar ? "Scalar" : components == "3" ? "Vector" : "Matrix";
    const std::string dimensions =
        scalar ? fmt::format("{}", rows) : fmt::format("{} {}", rows, components);
    return fmt::format(
        "        <Attribute Name=\"{}\" AttributeType=\"{}\" Center=\"{}\">{}</Attribute>\n", name,
        type, center, item(series, group + "/" + name, "Float", 4, dimensions));
}

std::string topology(const XdmfSeries& series, std::size_t step) {
    if (series.cells == 0) {
        const std::int64_t n = series.points[step];
        return fmt::format(
            "        <Topology TopologyType=\"Polyvertex\" NodesPerElement=\"1\" "
            "NumberOfElements=\"{}\">{}"
            "</Topology>\n",
            n, item(series, view_group(step) + "/Vertices", "Int", 8, fmt::format("{}", n)));
    }
    if (series.mixed_words > 0)
        return fmt::format(
            "        <Topology TopologyType=\"Mixed\" NumberOfElements=\"{}\">{}</Topology>\n",
            series.cells,
            item(series, "/Views/Cells", "Int", 8, fmt::format("{}", series.mixed_words)));
    return fmt::format(
        "        <Topology TopologyType=\"Hexahedron\" NumberOfElements=\"{}\">{}</Topology>\n",
        series.cells,
        item(series, "/Views/Hexahedra", "Int", 8, fmt::format("{} 8", series.cells)));
}

}  // namespace

std::string view_group(std::size_t step) {
    return fmt::format("/Views/{:05d}", step);
}

void write_xdmf(const std::string& path, const XdmfSeries& series) {
    std::string text =
        "<?xml version=\"1.0\" ?>\n<Xdmf Version=\"3.0\">\n  <Domain>\n"
        "    <Grid Name=\"steps\" GridType=\"Collection\" CollectionType=\"Temporal\">\n";
    for (std::size_t step = 0; step < series.times.size(); ++step) {
        const std::string group = view_group(step);
        const std::int64_t n = series.points[step];
        text += fmt::format("      <Grid Name=\"step {}\" GridType=\"Uniform\">\n", step);
        text += fmt::format("        <Time Value=\"{:.9g}\"/>\n", series.times[step]);
        text += topology(series, step);
        text += fmt::format("        <Geometry GeometryType=\"XYZ\">{}</Geometry>\n",
                            item(series, group + "/Points", "Float", 4, fmt::format("{} 3", n)));
        if (series.ids)
            text += fmt::format(
                "        <Attribute Name=\"id\" AttributeType=\"Scalar\" "
                "Center=\"Node\">{}</Attribute>\n",
                item(series, group + "/PointData/id", "Int", 8, fmt::format("{}", n)));
        for (const FieldLayout& field : series.point_fields)
            text += attribute(series, group + "/PointData", field, "Node", n);
        for (const FieldLayout& field : series.cell_fields)
            text += attribute(series, group + "/CellData", field, "Cell", series.cells);
        text += "      </Grid>\n";
    }
    text += "    </Grid>\n  </Domain>\n</Xdmf>\n";
    write_file_atomically(path, text);
}

}  // namespace undertow
