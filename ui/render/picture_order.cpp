#include "ui/render/picture_order.h"

#include <algorithm>
#include <utility>

namespace isoslider::render {

void PictureOrder::cancel() {
    const std::lock_guard lock(mutex_);
    isCancelled_ = true;
}

bool PictureOrder::isCancelled() const {
    const std::lock_guard lock(mutex_);
    return isCancelled_;
}

std::optional<QImage> PictureOrder::waitFor(std::chrono::milliseconds longest) {
    std::unique_lock lock(mutex_);
    wasSettled_.wait_for(lock, longest, [this] { return picture_.has_value(); });
    return picture_;
}

double PictureOrder::fraction() const {
    constexpr double kMost = 0.95; // an expectation may be wrong
    const std::lock_guard lock(mutex_);
    if (!begin_ || !(expectedMs_ > 0.0))
        return 0.0;
    const double elapsedMs = std::chrono::duration<double, std::milli>(Clock::now() - *begin_).count();
    return std::min(kMost, elapsedMs / expectedMs_);
}

void PictureOrder::begin(double expectedMs) {
    const std::lock_guard lock(mutex_);
    begin_ = Clock::now();
    expectedMs_ = expectedMs;
}

void PictureOrder::settle(QImage picture) {
    {
        const std::lock_guard lock(mutex_);
        if (!picture_)
            picture_ = std::move(picture);
    }
    wasSettled_.notify_all();
}

} // namespace isoslider::render
