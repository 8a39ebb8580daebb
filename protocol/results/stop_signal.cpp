#include "results/stop_signal.hpp"

#include <unistd.h>
#include <csignal>

#include "wire/errors.hpp"

namespace undertow {

namespace {

volatile std::sig_atomic_t requests = 0;
volatile std::sig_atomic_t losses = 0;

extern "C" void note_request(int) {
    requests = requests + 1;
    if (requests > 1) _exit(exit_interrupted);
}

extern "C" void note_loss(int) {
    losses = 1;
}

}  // namespace

void install_stop_signal() {
    struct sigaction action {};
    action.sa_handler = note_request;
    sigemptyset(&action.sa_mask);
    action.sa_flags = SA_RESTART;  // file writes go on; a poll() still wakes up with EINTR
    sigaction(SIGINT, &action, nullptr);
    sigaction(SIGTERM, &action, nullptr);
    action.sa_handler = note_loss;
    sigaction(SIGUSR1, &action, nullptr);
    sigset_t now{};  // the launcher holds it back until here
    sigemptyset(&now);
    sigaddset(&now, SIGUSR1);
    sigprocmask(SIG_UNBLOCK, &now, nullptr);
    // A file that grows past a limit (ulimit -f) is a failed write, said in a sentence, not a death.
    signal(SIGXFSZ, SIG_IGN);
}

bool stop_requested() {
    return requests > 0;
}

bool loss_announced() {
    return losses > 0;
}

}  // namespace undertow
