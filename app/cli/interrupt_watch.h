#pragma once

#include <signal.h>

#include <atomic>
#include <stop_token>
#include <thread>

namespace isoslider::cli {

/// Turns the first SIGINT, SIGTERM or SIGHUP into a stop request; the second ends the program there
/// and then with code 130, without its scratch folders. Signals that were ignored on entry (nohup) stay ignored.
/// REQUIRES: made in main before any other thread, so that all inherit the blocked signals.
class InterruptWatch {
public:
    InterruptWatch();
    ~InterruptWatch();
    InterruptWatch(const InterruptWatch&) = delete;
    InterruptWatch& operator=(const InterruptWatch&) = delete;

    std::stop_token stop() const { return source_.get_token(); }

private:
    void wait();

    sigset_t ignored_; ///< on entry
    std::stop_source source_;
    std::atomic<bool> isEnding_{false};
    std::thread thread_;
};

} // namespace isoslider::cli
