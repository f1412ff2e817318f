#pragma once

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <optional>

#include <QImage>

#include "ui/render/scene_view.h"

namespace isoslider::render {

/// One picture of a view as it was, whole, for whoever waits for it on a thread that may wait: SceneThread draws it
/// besides those that are shown. Any number of threads at once.
class PictureOrder {
public:
    /// `isTransparent`: what is drawn, without a background, which takes two pictures.
    explicit PictureOrder(SceneView view, bool isTransparent = false)
        : view_(std::move(view)), isTransparent_(isTransparent) {}

    const SceneView& view() const { return view_; }
    bool isTransparent() const { return isTransparent_; }
    /// It is not wanted any more: what is being drawn of it ends soon.
    void cancel();
    bool isCancelled() const;
    /// Once it is settled; none if it is not by then. A null image: it was cancelled, or nothing can be drawn.
    std::optional<QImage> waitFor(std::chrono::milliseconds longest);
    /// How much of it is drawn, 0 to 1, by the time that it is expected to take.
    double fraction() const;

    /// Of who draws: begins, maybe again; `expectedMs` is 0 while that is not known.
    void begin(double expectedMs);
    void settle(QImage picture);

private:
    using Clock = std::chrono::steady_clock;

    const SceneView view_;
    const bool isTransparent_;
    mutable std::mutex mutex_; ///< over all below
    std::condition_variable wasSettled_;
    std::optional<QImage> picture_;
    std::optional<Clock::time_point> begin_;
    double expectedMs_ = 0.0;
    bool isCancelled_ = false;
};

} // namespace isoslider::render
