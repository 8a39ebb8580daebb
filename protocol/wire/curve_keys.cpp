#include "wire/curve_keys.hpp"

#include <sys/stat.h>
#include <zmq.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "wire/errors.hpp"

namespace undertow::wire {

namespace {

namespace fs = std::filesystem;

/// The word after `name` ("public", "secret") in a key file.
std::string key_in(const fs::path& file, const std::string& name) {
    std::ifstream in(file);
    if (!in)
        throw InputError("the key " + file.string() +
                         " cannot be read; make keys with `undertow keys FOLDER` and copy to each "
                         "host its own .key and all .pub files.");
    std::string word, value;
    while (in >> word >> value)
        if (word == name) {
            unsigned char bytes[32];
            if (value.size() == 40 && zmq_z85_decode(bytes, value.c_str())) return value;
            break;
        }
    throw InputError(
        "the key " + file.string() + " has no line '" + name +
        " KEY' with a key of 40 characters; make new ones with `undertow keys FOLDER`.");
}

void read_own(const fs::path& file, CurveKeys& keys) {
    struct stat status {};
    if (stat(file.c_str(), &status) == 0 && (status.st_mode & 077) != 0)
        throw InputError("the secret key " + file.string() +
                         " can be read by others of this machine; chmod 600 it.");
    keys.own_public = key_in(file, "public");
    keys.own_secret = key_in(file, "secret");
}

}  // namespace

CurveKeys keys_of_coupler(const std::string& folder) {
    CurveKeys keys;
    read_own(fs::path(folder) / "coupler.key", keys);
    for (const auto& entry : fs::directory_iterator(folder))
        if (entry.path().extension() == ".pub" && entry.path().stem() != "coupler")
            keys.friends.push_back({entry.path().stem(), key_in(entry.path(), "public")});
    if (keys.friends.empty())
        throw InputError("the folder " + folder +
                         " has no participant's public key (sph.pub, fem.pub): nobody could join.");
    return keys;
}

CurveKeys keys_of_participant(const std::string& folder, const std::string& name) {
    CurveKeys keys;
    read_own(fs::path(folder) / (name + ".key"), keys);
    keys.coupler = key_in(fs::path(folder) / "coupler.pub", "public");
    return keys;
}

}  // namespace undertow::wire
