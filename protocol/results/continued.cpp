// Files of a run that goes on from a checkpoint: what was written after it is cut.

#include <unistd.h>

#include <cmath>

#include "checkpoint/archive.hpp"
#include "results/field_file.hpp"
#include "results/hdf5_cut.hpp"
#include "results/history.hpp"
#include "wire/errors.hpp"

namespace undertow {

void History::archive(Archive& a) {
    flush();
    std::int64_t bytes = a.reading() ? 0 : std::int64_t(::lseek(file_, 0, SEEK_END));
    a("bytes", bytes);
    if (!a.reading()) {
        ::fsync(file_);
        return;
    }
    const std::int64_t there = ::lseek(file_, 0, SEEK_END);
    if (there < bytes)
        throw InputError(path_ + " has " + std::to_string(there) + " bytes, it had " +
                         std::to_string(bytes) +
                         " at the checkpoint: it is not the file of this run; run the case anew.");
    if (::ftruncate(file_, bytes) != 0 || ::lseek(file_, 0, SEEK_END) != bytes)
        throw FileError(path_ + " cannot be cut to what it was at the checkpoint.");
}

void HistoryTimes::archive(Archive& a, double t) {
    double every = every_;
    a("every", every);
    a("next", next_);
    // another interval, or another end of the run: the next multiple
    if (a.reading() && every != every_) next_ = std::int64_t(std::floor(t / every_)) + 1;
}

namespace {

void archive_layout(Archive& a, const std::string& name,
                    std::vector<std::array<std::string, 3>>& layout) {
    std::vector<std::string> flat;
    for (const auto& field : layout) flat.insert(flat.end(), field.begin(), field.end());
    a(name, flat);
    layout.clear();
    for (std::size_t k = 0; k + 2 < flat.size(); k += 3)
        layout.push_back({flat[k], flat[k + 1], flat[k + 2]});
}

void archive_tables(Archive& a, const std::string& path, std::size_t steps) {
    std::vector<hdf5::Table> tables;
    if (!a.reading()) tables = hdf5::growing_tables(path);
    std::vector<std::string> names;
    std::vector<std::int64_t> rows;
    for (const hdf5::Table& table : tables) names.push_back(table.name), rows.push_back(table.rows);
    a("tables", names);
    a("rows", rows);
    if (!a.reading()) return;
    for (std::size_t k = 0; k < names.size(); ++k) tables.push_back({names[k], rows[k]});
    hdf5::cut(path, tables, steps);
}

}  // namespace

void ParticleFile::archive(Archive& a) {
    a("times", times_);
    a("counts", counts_);
    archive_layout(a, "layout", layout_);
    a("parts", parts_);
    a("part_start", part_start_);
    archive_tables(a, hdf_path(), times_.size());
    if (a.reading()) write_index();
}

void MeshFile::archive(Archive& a) {
    a("times", times_);
    archive_layout(a, "point_layout", point_layout_);
    archive_layout(a, "cell_layout", cell_layout_);
    std::int64_t words = std::int64_t(mixed_words_);
    a("mixed_words", words);
    mixed_words_ = std::size_t(words);
    archive_tables(a, hdf_path(), times_.size());
    if (a.reading()) write_index();
}

}  // namespace undertow
