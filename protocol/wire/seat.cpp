#include "wire/seat.hpp"

#include <algorithm>
#include <cctype>

namespace undertow::wire {

namespace {

std::string version_text(const std::array<int, 2>& version) {
    return std::to_string(version[0]) + "." + std::to_string(version[1]);
}

bool is_name(const std::string& text) {
    return !text.empty() && text.size() <= 64 &&
           std::all_of(text.begin(), text.end(), [](unsigned char c) {
               return (c < 0x80 && std::isalnum(c)) || c == '_' || c == '-' || c == '.';
           });
}

}  // namespace

Seat* find_seat_for(const Hello& hello, std::vector<Seat>& seats, Refusal& why) {
    const auto refuse = [&](const char* code, const std::string& text) -> Seat* {
        why = {code, text};
        return nullptr;
    };
    if (hello.protocol != protocol_name) {
        return refuse("E_VERSION", std::string("this coupler speaks the protocol '") +
                                       protocol_name + "', not '" + hello.protocol + "'");
    }
    if (hello.version[0] != version_major) {
        return refuse("E_VERSION", "this coupler speaks protocol " +
                                       version_text({version_major, version_minor}) + ", " +
                                       hello.name + " speaks " + version_text(hello.version));
    }
    if (!is_name(hello.name)) {
        return refuse("E_INPUT", "a participant's name is 1 to 64 letters, digits, '_', '-', '.'");
    }
    if (hello.units != "SI") {
        return refuse("E_INPUT", "units '" + hello.units + "' are not spoken here; use SI");
    }
    Seat* free = nullptr;
    bool role_is_known = false;
    for (Seat& seat : seats) {
        if (seat.name == hello.name) {
            return refuse("E_NAME_TAKEN", "a participant named '" + hello.name +
                                              "' has joined already; choose another name");
        }
        if (seat.role != hello.role) continue;
        role_is_known = true;
        if (!free && !seat.taken()) free = &seat;
    }
    if (free) return free;
    if (role_is_known)
        return refuse("E_LATE", "every place for role '" + hello.role + "' is taken");
    return refuse("E_INPUT", "role '" + hello.role + "' is not part of this run");
}

}  // namespace undertow::wire
