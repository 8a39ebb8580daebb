#include "checkpoint/checkpoint_set.hpp"

#include <sys/stat.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "checkpoint/sha256.hpp"
#include "results/atomic_file.hpp"
#include "wire/errors.hpp"

namespace undertow {

namespace fs = std::filesystem;

namespace {

constexpr int manifest_format = 1;

std::string manifest_path(const std::string& folder) {
    return folder + "/manifest.json";
}

}  // namespace

std::string checkpoint_id(std::int64_t step) {
    char text[32];
    std::snprintf(text, sizeof text, "step_%09lld", static_cast<long long>(step));
    return text;
}

std::string checkpoint_folder(const std::string& results, const std::string& id) {
    const bool plain = !id.empty() && std::all_of(id.begin(), id.end(), [](unsigned char c) {
        return std::isalnum(c) || c == '_' || c == '-';
    });
    if (!plain)
        throw PeerError(
            "E_INPUT", "a checkpoint cannot be named '" + id + "': letters, digits, _ and - only.");
    const std::string folder = results + "/checkpoints/" + id;
    std::error_code failed;
    fs::create_directories(folder, failed);
    if (failed)
        throw std::runtime_error("E_IO: the folder " + folder +
                                 " cannot be made: " + failed.message() + ".");
    return folder;
}

void write_manifest(const std::string& folder, const Manifest& manifest) {
    nlohmann::ordered_json j;
    j["format"] = manifest_format;
    j["id"] = manifest.id;
    j["step"] = manifest.step;
    j["t"] = manifest.t;
    for (const Manifest::File& f : manifest.files)
        j["files"].push_back({{"who", f.who},
                              {"file", f.file.name},
                              {"bytes", f.file.bytes},
                              {"sha256", f.file.sha}});
    try {
        write_file_durably(manifest_path(folder), j.dump(2) + "\n");
    } catch (const InputError& error) {
        throw std::runtime_error(std::string("E_IO: ") + error.what());
    }
}

Manifest read_manifest(const std::string& folder) {
    std::ifstream stream(manifest_path(folder));
    if (!stream)
        throw InputError(folder +
                         " holds no manifest.json: this is no whole set of checkpoints; "
                         "give one of the folders in RESULTS/checkpoints that has it.");
    Manifest manifest;
    try {
        const nlohmann::json j = nlohmann::json::parse(stream);
        if (j.at("format") != manifest_format)
            throw InputError(manifest_path(folder) + " has format " + j.at("format").dump() +
                             ", this program reads " + std::to_string(manifest_format) +
                             "; resume with the version that wrote it.");
        manifest.id = j.at("id");
        manifest.step = j.at("step");
        manifest.t = j.at("t");
        for (const auto& f : j.at("files"))
            manifest.files.push_back({f.at("who"), {f.at("file"), f.at("sha256"), f.at("bytes")}});
    } catch (const nlohmann::json::exception& error) {
        throw InputError(manifest_path(folder) + " is damaged (" + error.what() +
                         "); resume from another set.");
    }
    return manifest;
}

std::int64_t written_at(const std::string& folder) {
    struct stat status {};
    return ::stat(manifest_path(folder).c_str(), &status) == 0 ? std::int64_t(status.st_mtime) : 0;
}

std::string checked_file(const std::string& folder, const Manifest& manifest,
                         const std::string& who, const Pulse& pulse) {
    const auto found = std::find_if(manifest.files.begin(), manifest.files.end(),
                                    [&](const Manifest::File& f) { return f.who == who; });
    if (found == manifest.files.end())
        throw InputError(manifest_path(folder) + " names no file of " + who +
                         ": the set was written by a run without it.");
    const WrittenFile& file = found->file;
    const std::string path = folder + "/" + fs::path(file.name).filename().string();
    std::error_code missing;
    const auto bytes = fs::file_size(path, missing);
    if (missing) throw InputError(path + " is missing from its set; resume from another set.");
    if ((file.bytes >= 0 && std::int64_t(bytes) != file.bytes) ||
        sha256_of_file(path, pulse) != file.sha)
        throw InputError(path + " is not the file that the manifest of step " +
                         std::to_string(manifest.step) +
                         " names (another size or SHA-256): it was changed, damaged or taken from "
                         "another set; resume from another set.");
    return path;
}

void prune_checkpoints(const std::string& results, const std::string& newest, int keep,
                       const Pulse& pulse) {
    std::vector<std::pair<std::int64_t, fs::path>> sets;
    std::error_code ignored;
    for (const auto& entry : fs::directory_iterator(results + "/checkpoints", ignored)) {
        const std::string name = entry.path().filename().string();
        if (name == newest || !entry.is_directory() || !name.starts_with("step_")) continue;
        if (!fs::exists(entry.path() / "manifest.json"))
            fs::remove_all(entry.path(), ignored);
        else
            try {
                sets.emplace_back(read_manifest(entry.path().string()).step, entry.path());
            } catch (const InputError&) {
                // damaged: left to the user
            }
    }
    std::sort(sets.rbegin(), sets.rend());
    for (std::size_t k = std::size_t(std::max(1, keep)) - 1; k < sets.size(); ++k) {
        // first it stops being a set, then it goes
        fs::remove(sets[k].second / "manifest.json", ignored);
        fs::remove_all(sets[k].second, ignored);
        if (pulse) pulse();
    }
}

}  // namespace undertow
