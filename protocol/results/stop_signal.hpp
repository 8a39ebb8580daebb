#pragma once
// Ctrl-C and SIGTERM: the first asks the loop to end in good order, the second ends at once.

namespace undertow {

/// Installs the handlers; exit code of the second signal is 130.
void install_stop_signal();
bool stop_requested();

}  // namespace undertow
