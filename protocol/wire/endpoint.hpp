#pragma once
// Where the coupler listens: a Unix socket in a private folder, or a port of this host.

#include <string>

namespace undertow::wire {

enum class Keys { none, curve };

/// Refuses what is not offered (InputError): unknown transports, addresses other than 127.0.0.1
/// without keys, socket paths longer than the system's 107 characters.
void check_endpoint(const std::string& endpoint, Keys keys = Keys::none);

/// Holds an ipc endpoint for this process. A second bind on the same path would silently steal the
/// socket, so a lock file "<socket>.lock" beside it names the owner's pid and is locked with
/// flock(), which the system releases however the process ends.
class EndpointLock {
 public:
    /// Creates the folder (mode 0700) when it is missing; takes the lock; removes the socket a dead
    /// run left behind. Throws PeerError E_IO when another process holds the endpoint, naming its
    /// pid, and InputError when others could write to the folder. Does nothing for tcp.
    explicit EndpointLock(const std::string& endpoint, Keys keys = Keys::none);
    ~EndpointLock();  // removes the socket and the lock file
    EndpointLock(const EndpointLock&) = delete;
    EndpointLock& operator=(const EndpointLock&) = delete;

 private:
    std::string socket_path_, lock_path_;
    int descriptor_ = -1;
};

}  // namespace undertow::wire
