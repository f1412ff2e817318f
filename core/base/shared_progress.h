#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <mutex>
#include <string_view>

#include "core/base/job_control.h"

namespace isoslider {

/// Progress of work that several threads share. Whoever brings it a hundredth further reports that, unless another
/// thread is doing so: reports never overlap, never go back, and cost one addition otherwise.
class SharedProgress {
public:
    /// `job` must outlive it.
    SharedProgress(const JobControl& job, std::size_t total, std::string_view stage)
        : job_(job), total_(std::max<std::size_t>(total, 1)), stage_(stage), step_((total_ + 99) / 100) {}

    /// From any thread.
    void add(std::size_t count) {
        const std::size_t done = done_.fetch_add(count, std::memory_order_relaxed) + count;
        if (!job_.progress || done / step_ == (done - count) / step_)
            return;
        const std::unique_lock lock(mutex_, std::try_to_lock);
        if (!lock.owns_lock() || done <= reported_)
            return;
        reported_ = done;
        job_.report(std::min(1.0, static_cast<double>(done) / static_cast<double>(total_)), stage_);
    }

private:
    const JobControl& job_;
    const std::size_t total_;
    const std::string_view stage_;
    const std::size_t step_;
    std::atomic<std::size_t> done_{0};
    std::mutex mutex_;
    std::size_t reported_ = 0; ///< guarded by mutex_
};

} // namespace isoslider
