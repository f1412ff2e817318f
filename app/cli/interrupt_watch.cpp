#include "app/cli/interrupt_watch.h"

#include <cstdlib>

#include <pthread.h>
#include <signal.h>

#include "app/cli/outcome.h"
#include "app/cli/scratch_folder.h"

namespace isoslider::cli {
namespace {

sigset_t watchedSignals() {
    sigset_t signals;
    sigemptyset(&signals);
    for (const int signal : {SIGINT, SIGTERM, SIGHUP})
        sigaddset(&signals, signal);
    return signals;
}

bool isIgnored(int signal) {
    struct sigaction action {};
    return ::sigaction(signal, nullptr, &action) == 0 && action.sa_handler == SIG_IGN;
}

} // namespace

// A thread that waits, not a handler: requesting a stop runs callbacks, which no handler may.
InterruptWatch::InterruptWatch() {
    const sigset_t signals = watchedSignals();
    sigemptyset(&ignored_);
    for (const int signal : {SIGINT, SIGTERM, SIGHUP})
        if (isIgnored(signal))
            sigaddset(&ignored_, signal);
    ::pthread_sigmask(SIG_BLOCK, &signals, nullptr);
    thread_ = std::thread([this] { wait(); });
}

InterruptWatch::~InterruptWatch() {
    isEnding_ = true;
    ::pthread_kill(thread_.native_handle(), SIGTERM);
    thread_.join();
}

void InterruptWatch::wait() {
    const sigset_t signals = watchedSignals();
    for (;;) {
        int signal = 0;
        if (::sigwait(&signals, &signal) != 0)
            continue;
        if (isEnding_)
            return;
        if (sigismember(&ignored_, signal) == 1) // a blocked signal arrives here although it is ignored
            continue;
        if (!source_.request_stop()) {
            removeScratchFolders();
            std::_Exit(static_cast<int>(ExitCode::Interrupted));
        }
    }
}

} // namespace isoslider::cli
