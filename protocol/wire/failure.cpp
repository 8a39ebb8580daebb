#include "wire/failure.hpp"

#include <new>
#include <stdexcept>

namespace undertow {

Failure failure_of(const std::exception& error) {
    const std::string text = error.what();
    if (const auto* peer = dynamic_cast<const PeerError*>(&error))
        return {peer->code == "E_STOP" ? exit_interrupted : exit_peer, peer->code,
                peer->code + ": " + text};
    if (dynamic_cast<const StepCollapse*>(&error)) return {exit_physics, "E_DT", text};
    if (dynamic_cast<const PhysicsError*>(&error)) return {exit_physics, "E_PHYSICS", text};
    if (dynamic_cast<const FileError*>(&error)) return {exit_input, "E_IO", text};
    if (dynamic_cast<const InputError*>(&error)) return {exit_input, "E_INPUT", text};
    if (dynamic_cast<const std::logic_error*>(&error))
        return {exit_physics, "E_STATE", "internal error: " + text};
    if (dynamic_cast<const std::bad_alloc*>(&error))
        return {exit_input, "E_IO",
                "there is not enough memory (" + text + "): take a coarser spacing or mesh, or a machine "
                "with more; `undertow check CASE` estimates what a case needs."};
    return {exit_input, "E_IO", text};
}

}  // namespace undertow
