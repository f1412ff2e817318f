#pragma once

#include <chrono>
#include <stop_token>
#include <string_view>

#include "core/base/job_control.h"

namespace isoslider::cli {

/// A bar on standard error while it lives; nothing at all when it is not to be shown.
class ProgressBar {
public:
    ProgressBar(bool isShown, std::stop_token stop) : isShown_(isShown), stop_(std::move(stop)) {}
    ~ProgressBar() { wipe(); }
    ProgressBar(const ProgressBar&) = delete;
    ProgressBar& operator=(const ProgressBar&) = delete;

    /// Carries the stop token too. REQUIRES: the bar outlives the job.
    JobControl job();
    /// Takes the bar off the screen; the next report draws it again.
    void wipe();

private:
    void draw(double fraction, std::string_view stage);

    bool isShown_;
    std::stop_token stop_;
    bool hasDrawn_ = false;
    std::chrono::steady_clock::time_point nextDraw_{};
};

} // namespace isoslider::cli
