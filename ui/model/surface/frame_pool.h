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
            const std::lock_guard lock(spares_->mutex);
            if (!spares_->frames.empty()) {
                frame = std::move(spares_->frames.back());
                spares_->frames.pop_back();
            }
        }
        if (!frame)
            frame = std::make_unique<extract::SurfaceFrame>();
        return {frame.release(), [spares = spares_](extract::SurfaceFrame* returned) {
                    std::unique_ptr<extract::SurfaceFrame> owned(returned);
                    owned->bricks.reset(); // the surface waits to use their memory again
                    const std::lock_guard lock(spares->mutex);
                    if (spares->frames.size() < kKept)
                        spares->frames.push_back(std::move(owned));
                }};
    }

    /// Gives back the memory of frames that are not in use.
    void clear() {
        const std::lock_guard lock(spares_->mutex);
        spares_->frames.clear();
    }

private:
    static constexpr std::size_t kKept = 2;
    struct Spares {
        std::mutex mutex;
        std::vector<std::unique_ptr<extract::SurfaceFrame>> frames;
    };
    std::shared_ptr<Spares> spares_ = std::make_shared<Spares>();
};

} // namespace isoslider::model
