#pragma once

#include <atomic>
#include <thread>

namespace isoslider {

/// A lock for some tens of instructions, for std::lock_guard: a waiting thread spins, and yields after a while.
class SpinLock {
public:
    void lock() {
        constexpr int kTurns = 1000;
        while (isHeld_.test_and_set(std::memory_order_acquire))
            for (int turn = 0; isHeld_.test(std::memory_order_relaxed); ++turn)
                if (turn >= kTurns)
                    std::this_thread::yield();
    }
    void unlock() { isHeld_.clear(std::memory_order_release); }

private:
    std::atomic_flag isHeld_;
};

} // namespace isoslider
