#include "case/case_file.hpp"

#include <cstdio>
#include <filesystem>

#include "case/layers.hpp"
#include "case/resolved_case.hpp"
#include "case/sections.hpp"
#include "case/written_keys.hpp"

namespace undertow {

namespace {

/// A case folder stands for the case.toml inside.
std::string case_path(const std::string& path) {
    if (std::filesystem::is_directory(path))
        return (std::filesystem::path(path) / "case.toml").string();
    return path;
}

/// Rules that span tables.
void check_together(const TableReader& reader, const ResolvedCase& resolved, bool has_coupling) {
    const Case& c = resolved.values;
    if (!c.sph.present && !c.fem.present)
        reader.reject("sph", "is missing, and so is fem: a case needs [sph], [fem] or both.");
    if (c.start.settle >= c.time.end) {
        char text[160];
        std::snprintf(
            text, sizeof text,
            "leaves no time for the run: time.end = %.6g s includes its settle = %.6g s; give "
            "a later end.",
            c.time.end, c.start.settle);
        reader.reject("start", text);
    }
    if (has_coupling && !resolved.coupled)
        reader.reject("coupling", std::string("couples nothing: the case has no [") +
                                      (c.sph.present ? "fem" : "sph") +
                                      "]; add it, or remove [coupling] (coupling = false in a "
                                      "variant).");
    if (resolved.coupled && c.fem.present && c.fem.surface.empty())
        reader.reject("fem",
                      "needs a [[fem.surface]]: the case has [sph] as well, and a coupled run "
                      "must know which facets the particles touch.");
    const double share = c.coupling.beta + 2 * c.coupling.damping;
    const double budget = 4 * (1 - c.fem.cfl * c.fem.cfl);
    if (resolved.coupled && share > budget) {
        char text[200];
        std::snprintf(
            text, sizeof text,
            "leaves too little stability for the contact: beta + 2 damping = %.4g must be "
            "<= 4 (1 - fem.cfl^2) = %.4g; lower coupling.beta, coupling.damping or fem.cfl.",
            share, budget);
        reader.reject("coupling", text);
    }
}

}  // namespace

ResolvedCase resolve_case(const std::string& path, const CaseOptions& options) {
    ResolvedCase resolved;
    Case& c = resolved.values;
    c.file = case_path(path);
    c.folder = std::filesystem::path(c.file).parent_path().string();
    const Node document = parse_document(c.file);
    resolved.levels = layer_names(document, "level");
    resolved.variants = layer_names(document, "variant");
    const Node root = resolve_layers(document, options);

    c.written = written_keys(root);
    TableReader reader(root, "");
    reader.require("case", "[case] with a name");
    reader.require("time", "[time] with an end");
    reader.table("case", [&](TableReader& r) { read_info(r, c.info); });
    reader.table("time", [&](TableReader& r) { read_time(r, c.time); });
    reader.table("start", [&](TableReader& r) { read_start(r, c.start); });
    reader.table("output", [&](TableReader& r) { read_output(r, c.output); });
    reader.table("checkpoint", [&](TableReader& r) { read_checkpoint(r, c.checkpoint); });
    reader.table("sph", [&](TableReader& r) { read_sph(r, c.sph, c.info); });
    reader.table("fem", [&](TableReader& r) { read_fem(r, c.fem, c.info, c.folder); });
    const bool has_coupling =
        reader.table("coupling", [&](TableReader& r) { read_coupling(r, c.coupling); });
    reader.free_form("backend");
    reader.free_form("report");
    reader.finish();
    resolved.coupled =
        c.sph.present && (c.fem.present || (has_coupling && reader.has_table("backend")));
    check_together(reader, resolved, has_coupling);

    if (reader.has_table("backend")) resolved.backend = *root.find("backend");
    if (reader.has_table("report")) resolved.report = *root.find("report");
    if (c.output.history_every == 0) c.output.history_every = c.time.end / 2000;
    return resolved;
}

Case read_case(const std::string& path, const CaseOptions& options) {
    return resolve_case(path, options).values;
}

}  // namespace undertow
