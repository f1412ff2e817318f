#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "ui/render/array_buffers.h"
#include "ui/render/brick_buffers.h"
#include "ui/render/surface_look.h"

namespace isoslider::render {

/// The surfaces that do not slide, on the GPU: each is sent once, and again where the context was lost.
/// REQUIRES for every call but abandon() and the destructor after it: the context it was made in is current.
class InactiveBuffers {
public:
    struct Entry {
        Entry(Gl& gl, GlDriver& driver) : arrays(gl, driver), bricks(gl, driver) {}
        InactiveSurface surface;
        ArrayBuffers arrays;
        BrickBuffers bricks;
        bool isTinted = false; ///< with hidden pieces
        std::uint64_t refusedBytes = 0; ///< if the card has no memory for it
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
    void upload(Entry& entry);
    void tint(Entry& entry);

    Gl& gl_;
    GlDriver& driver_;
    std::vector<std::unique_ptr<Entry>> entries_;
    std::uint64_t uploadedBefore_ = 0; ///< for those that are gone
};

} // namespace isoslider::render
