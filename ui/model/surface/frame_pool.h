#pragma once

#include <memory>
#include <mutex>
#include <vector>

#include "core/extract/surface_frame.h"

namespace isoslider::model {

/// Frames whose buffers are used again: a frame comes back when its last reader lets go, on
/// whatever thread. Safe from any thread.
class FramePool {
public:
    std::shared_ptr<extract::SurfaceFrame> take() {
        std::unique_ptr<extract::SurfaceFrame> frame;
        {
            const std::lock_guard lock(shelf_->mutex);
            if (!shelf_->frames.empty()) {
                frame = std::move(shelf_->frames.back());
                shelf_->frames.pop_back();
            }
        }
        if (!frame)
            frame = std::make_unique<extract::SurfaceFrame>();
        return {frame.release(), [shelf = shelf_](extract::SurfaceFrame* returned) {
                    std::unique_ptr<extract::SurfaceFrame> owned(returned);
                    owned->bricks.reset(); // the surface waits to use their memory again
                    const std::lock_guard lock(shelf->mutex);
                    if (shelf->frames.size() < kKept)
                        shelf->frames.push_back(std::move(owned));
                }};
    }

    /// Gives back the memory of frames that nobody reads.
    void clear() {
        const std::lock_guard lock(shelf_->mutex);
        shelf_->frames.clear();
    }

private:
    static constexpr std::size_t kKept = 2;
    struct Shelf {
        std::mutex mutex;
        std::vector<std::unique_ptr<extract::SurfaceFrame>> frames;
    };
    std::shared_ptr<Shelf> shelf_ = std::make_shared<Shelf>();
};

} // namespace isoslider::model
