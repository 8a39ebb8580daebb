#include "wire/endpoint.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>

#include "wire/errors.hpp"

namespace undertow::wire {

namespace {

constexpr const char* ipc_prefix = "ipc://";
constexpr const char* tcp_prefix = "tcp://";

std::string reason(int error_number) {
    return std::strerror(error_number);
}

/// Only the owner may create or replace files where the socket lies: whoever can, can pose as the
/// coupler.
void prepare_folder(const std::filesystem::path& folder) {
    if (!std::filesystem::exists(folder)) {
        if (folder.has_parent_path()) std::filesystem::create_directories(folder.parent_path());
        if (mkdir(folder.c_str(), 0700) != 0 && errno != EEXIST) {
            throw PeerError("E_IO", "cannot create the folder " + folder.string() +
                                        " of the socket: " + reason(errno));
        }
    }
    struct stat status {};
    if (stat(folder.c_str(), &status) != 0 || !S_ISDIR(status.st_mode)) {
        throw InputError("the socket's folder " + folder.string() + " is not a folder");
    }
    if (status.st_uid != geteuid() || (status.st_mode & 022) != 0) {
        throw InputError("the socket's folder " + folder.string() +
                         " belongs to or can be written by others; choose a folder of your own "
                         "(chmod 700)");
    }
}

/// Opens and locks the file, and makes sure that the name still belongs to what was locked: a
/// process that ends removes its lock file, perhaps between our open() and flock().
int lock_file(const std::string& path, const std::string& endpoint) {
    for (int attempt = 0; attempt < 100; ++attempt) {
        const int descriptor = open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0600);
        if (descriptor < 0) {
            throw PeerError("E_IO", "cannot open the lock file " + path + ": " + reason(errno));
        }
        if (flock(descriptor, LOCK_EX | LOCK_NB) != 0) {
            char owner[32] = {};
            const ssize_t length = pread(descriptor, owner, sizeof owner - 1, 0);
            close(descriptor);
            throw PeerError("E_IO", "the endpoint " + endpoint + " is in use by process " +
                                        (length > 0 ? std::to_string(std::atol(owner)) : "?") +
                                        "; wait for that run, end it, or choose another endpoint");
        }
        struct stat locked {
        }, named{};
        if (fstat(descriptor, &locked) == 0 && stat(path.c_str(), &named) == 0 &&
            locked.st_ino == named.st_ino && locked.st_dev == named.st_dev) {
            return descriptor;
        }
        close(descriptor);
    }
    throw PeerError("E_IO", "cannot keep the lock file " + path);
}

}  // namespace

void check_endpoint(const std::string& endpoint, Keys keys) {
    if (endpoint.starts_with(ipc_prefix)) {
        const std::string path = endpoint.substr(std::strlen(ipc_prefix));
        if (path.empty() || path[0] == '@' || path == "*" || path.ends_with('/')) {
            throw InputError("endpoint '" + endpoint +
                             "' must name a socket file: ipc:///folder/coupler.sock");
        }
        constexpr std::size_t longest = sizeof(sockaddr_un::sun_path) - 1;
        if (path.size() > longest) {
            throw InputError("the socket path of endpoint '" + endpoint + "' has " +
                             std::to_string(path.size()) + " characters; the system takes " +
                             std::to_string(longest) + ". Choose a shorter folder");
        }
        return;
    }
    if (endpoint.starts_with(tcp_prefix)) {
        const std::string address = endpoint.substr(std::strlen(tcp_prefix));
        const std::size_t colon = address.rfind(':');
        if (colon != std::string::npos &&
            (keys == Keys::curve || address.substr(0, colon) == "127.0.0.1"))
            return;
        throw InputError("endpoint '" + endpoint +
                         "' is refused: beyond 127.0.0.1 anybody could listen and join without "
                         "CURVE keys. Make some with `undertow keys FOLDER`, copy them to the hosts, "
                         "and give every program --keys FOLDER");
    }
    throw InputError("endpoint '" + endpoint +
                     "' is unknown; use ipc:///folder/coupler.sock or tcp://127.0.0.1:PORT");
}

EndpointLock::EndpointLock(const std::string& endpoint, Keys keys) {
    check_endpoint(endpoint, keys);
    if (!endpoint.starts_with(ipc_prefix)) return;
    socket_path_ = endpoint.substr(std::strlen(ipc_prefix));
    lock_path_ = socket_path_ + ".lock";
    std::filesystem::path folder = std::filesystem::path(socket_path_).parent_path();
    if (folder.empty()) folder = ".";
    prepare_folder(folder);
    descriptor_ = lock_file(lock_path_, endpoint);

    const std::string pid = std::to_string(getpid()) + "\n";
    if (ftruncate(descriptor_, 0) != 0 ||
        pwrite(descriptor_, pid.data(), pid.size(), 0) != static_cast<ssize_t>(pid.size())) {
        const int error_number = errno;
        close(descriptor_);
        throw PeerError("E_IO",
                        "cannot write the lock file " + lock_path_ + ": " + reason(error_number));
    }
    struct stat left_behind {};
    if (lstat(socket_path_.c_str(), &left_behind) == 0) {
        if (!S_ISSOCK(left_behind.st_mode)) {
            close(descriptor_);
            throw InputError("endpoint '" + endpoint + "': the file exists and is not a socket");
        }
        unlink(socket_path_.c_str());  // of a dead run: the living hold the lock
    }
}

EndpointLock::~EndpointLock() {
    if (descriptor_ < 0) return;
    unlink(socket_path_.c_str());
    unlink(lock_path_.c_str());
    close(descriptor_);
}

}  // namespace undertow::wire
