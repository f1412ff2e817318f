#pragma once

#include <chrono>
#include <condition_variable>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>

#include "ui/model/jobs/main_thread.h"

namespace isoslider::test {

/// Stands for the window's event loop: the test's own thread runs what was posted.
class MainThreadQueue {
public:
    model::MainThread poster() {
        return [state = state_](std::function<void()> function) {
            {
                const std::lock_guard lock(state->mutex);
                state->functions.push_back(std::move(function));
            }
            state->wake.notify_all();
        };
    }

    void runAll() {
        for (auto function = take(std::chrono::milliseconds(0)); function;
             function = take(std::chrono::milliseconds(0)))
            function();
    }

    /// Runs what arrives until `isDone`; false if that takes longer than `most`.
    bool runUntil(const std::function<bool()>& isDone, std::chrono::milliseconds most = std::chrono::seconds(60)) {
        const auto end = std::chrono::steady_clock::now() + most;
        while (!isDone()) {
            if (std::chrono::steady_clock::now() > end)
                return false;
            if (auto function = take(std::chrono::milliseconds(20)))
                function();
        }
        return true;
    }

private:
    struct State {
        std::mutex mutex;
        std::condition_variable wake;
        std::deque<std::function<void()>> functions;
    };

    std::function<void()> take(std::chrono::milliseconds timeout) {
        std::unique_lock lock(state_->mutex);
        if (!state_->wake.wait_for(lock, timeout, [this] { return !state_->functions.empty(); }))
            return {};
        auto function = std::move(state_->functions.front());
        state_->functions.pop_front();
        return function;
    }

    std::shared_ptr<State> state_ = std::make_shared<State>();
};

} // namespace isoslider::test
