#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "ui/render/surface_buffers.h"
#include "ui/render/surface_look.h"

namespace isoslider::render {

/// The surfaces that do not slide, on the GPU.
/// REQUIRES for every call but abandon() and the destructor after it: the context it was made in is current.
class InactiveBuffers {
public:
    struct Entry {
        Entry(Gl& gl, GlDriver& driver) : buffers(gl, driver) {}
        InactiveSurface surface;
        SurfaceBuffers buffers;
    };

    InactiveBuffers(Gl& gl, GlDriver& driver) : gl_(gl), driver_(driver) {}

    /// Holds these from now on, in an order that does not depend on theirs: by isovalue, then by look.
    void show(std::span<const InactiveSurface> surfaces);
    std::span<const std::unique_ptr<Entry>> entries() const { return entries_; }
    /// Forgets everything on the GPU without a call to it: the context is gone.
    void abandon();
    std::uint64_t uploadedBytes() const;
    /// The most that was refused for one of them; 0: all are there.
    std::uint64_t refusedBytes() const;

private:
    Gl& gl_;
    GlDriver& driver_;
    std::vector<std::unique_ptr<Entry>> entries_;
    std::uint64_t uploadedBefore_ = 0; ///< for those that are gone
};

} // namespace isoslider::render
