#pragma once

#include <functional>
#include <stop_token>
#include <string_view>

#include "core/base/result.h"

namespace isoslider {

/// How long-running work reports its progress and learns that it should stop. Both members may be empty.
/// `progress` may be called from any worker thread, never from two at once.
struct JobControl {
    using ProgressFunction = std::function<void(double fraction, std::string_view stage)>;

    std::stop_token stop;
    ProgressFunction progress;

    bool isStopRequested() const { return stop.stop_requested(); }
    void report(double fraction, std::string_view stage) const {
        if (progress)
            progress(fraction, stage);
    }

    /// A share of this job: its progress from 0 to 1 is this one's from `from` to `to`. This must outlive it.
    JobControl part(double from, double to) const {
        JobControl share;
        share.stop = stop;
        if (progress)
            share.progress = [this, from, to](double f, std::string_view stage) {
                report(from + f * (to - from), stage);
            };
        return share;
    }
};

inline Error cancelledError() { return makeError(ErrorCode::Cancelled, "cancelled"); }

} // namespace isoslider
