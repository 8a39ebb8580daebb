#pragma once
// What a long write calls every now and then, so that who waits for this program learns that it
// lives. May be empty; called often, so it decides itself how rarely something is said.

#include <functional>

namespace undertow {

using Pulse = std::function<void()>;

}  // namespace undertow
