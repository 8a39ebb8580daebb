#pragma once
// Ctrl-C and SIGTERM: the first asks the loop to end in good order, the second ends at once. SIGUSR1: one
// of the programs of this run has ended; scripts/undertow tells the coupler, which cannot see who never came.

namespace undertow {

/// Installs the handlers; exit code of the second signal is 130.
void install_stop_signal();
bool stop_requested();
bool loss_announced();  // by SIGUSR1

}  // namespace undertow
