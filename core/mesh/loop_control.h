#pragma once

#include <cstdint>
#include <string_view>

#include <tbb/task_group.h>

#include "core/base/job_control.h"

// How long work on meshes is stopped within a second, and reports its progress.

namespace isoslider::mesh {

/// Looks after a serial loop: every kSteps-th step it reports progress and asks whether to stop.
class LoopControl {
public:
    LoopControl(const JobControl& job, std::uint64_t total, std::string_view stage)
        : job_(job), total_(total), stage_(stage) {}

    /// False once the loop has to stop. `done` of `total` is what is reported.
    bool goesOn(std::uint64_t done) {
        constexpr std::uint64_t kSteps = std::uint64_t{1} << 15;
        if (++steps_ % kSteps != 0)
            return true;
        if (job_.isStopRequested())
            return false;
        job_.report(total_ == 0 ? 1.0 : static_cast<double>(done) / static_cast<double>(total_), stage_);
        return true;
    }

private:
    const JobControl& job_;
    std::uint64_t total_;
    std::string_view stage_;
    std::uint64_t steps_ = 0;
};

/// Runs `work`. A stop request ends the parallel algorithms in it early, with their work unfinished.
template <class Work>
void runStoppable(const JobControl& job, const Work& work) {
    tbb::task_group_context context;
    const std::stop_callback cancel(job.stop, [&context] { context.cancel_group_execution(); });
    tbb::task_group group(context);
    if (!job.isStopRequested())
        group.run_and_wait(work);
}

} // namespace isoslider::mesh
