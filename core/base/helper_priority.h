#pragma once

#include <tbb/task_arena.h>
#include <tbb/task_scheduler_observer.h>

#include "core/base/machine.h"

namespace isoslider {

/// While it exists, threads that help in the arena take the priority of the thread that made it, if that is lower than
/// theirs. They go back to their own where the system lets them, which takes a privilege: without it they stay low, and
/// so do other loops of TBB that they help in. Loops of moves have separate threads (worker_team.h).
class HelperPriority final : public tbb::task_scheduler_observer {
public:
    explicit HelperPriority(tbb::task_arena& arena) : task_scheduler_observer(arena), nice_(threadNice()) {
        if (nice_ > 0)
            observe(true);
    }
    ~HelperPriority() override { observe(false); }

    void on_scheduler_entry(bool isWorker) override {
        const int nice = isWorker ? threadNice() : nice_;
        if (nice >= nice_)
            return;
        usualNice_ = nice;
        setThreadNice(nice_);
    }
    void on_scheduler_exit(bool isWorker) override {
        if (isWorker && usualNice_ < nice_)
            setThreadNice(usualNice_);
    }

private:
    int nice_; ///< of the thread that made it: 0 is usual, more is lower
    inline static thread_local int usualNice_ = 0; ///< of a thread that helps
};

} // namespace isoslider
