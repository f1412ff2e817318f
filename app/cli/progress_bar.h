#pragma once

#include <chrono>
#include <stop_token>
#include <string>
#include <string_view>

#include "core/base/job_control.h"

namespace isoslider::cli {

/// For people: "40 s", "3 min", "1 h 20 min"; rounded to what a forecast can be right about.
std::string durationText(double seconds);

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
    /// ", 3 min left"; empty until enough is done to tell.
    std::string timeLeft(double fraction, std::chrono::steady_clock::time_point now) const;

    bool isShown_;
    std::stop_token stop_;
    bool hasDrawn_ = false;
    std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
    std::chrono::steady_clock::time_point nextDraw_{};
};

} // namespace isoslider::cli
