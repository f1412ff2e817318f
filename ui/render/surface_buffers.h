#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include <glm/mat4x4.hpp>
#include <glm/vec4.hpp>

#include "core/extract/surface_frame.h"
#include "ui/model/pieces/piece_tints.h"
#include "ui/render/array_buffers.h"
#include "ui/render/brick_buffers.h"
#include "ui/render/draft_buffers.h"

namespace isoslider::render {

/// What part of a surface is drawn.
struct SurfaceView {
    glm::dmat4 modelToClip; ///< from grid index units
    std::vector<glm::dvec4> cuts; ///< half-spaces that it lies in: dot(xyz, place) + w >= 0, grid index units
};

/// One surface on the GPU, whichever way it is kept there: as bricks, as arrays where it has none or an old card's
/// tables are too small, or as a draft. Each is sent once, when it is first drawn that way.
/// REQUIRES for every call but abandon() and the destructor after it: the context it was made in is current.
class SurfaceBuffers {
public:
    SurfaceBuffers(Gl& gl, GlDriver& driver) : arrays_(gl, driver), bricks_(gl, driver), draft_(gl, driver) {}

    /// Shows this surface from now on, or none, with its pieces coloured and hidden as `pieces` says.
    void show(std::shared_ptr<const extract::SurfaceFrame> frame, const model::PieceOptions& pieces);
    /// Sends what of the surface is not there yet; blockCells 1: all of it, else a draft as of coarsenBrick(), which
    /// only a surface with bricks has. False if the card has no memory for it: then there is nothing to draw.
    /// REQUIRES: there is a surface.
    bool prepare(int blockCells, const SurfaceView& view);

    // Of what was prepared last:
    bool isOfBricks() const { return !isDraft_ && !bricks_.isEmpty(); } ///< else arrays are drawn
    bool isTinted() const { return isDraft_ ? !tints_.empty() : isTinted_; }
    /// Sets what its vertex shader must know.
    void setUniforms(QOpenGLShaderProgram& program) const;
    /// `isStopped` is asked between parts: false if it answered true.
    bool draw(const SurfaceView& view, const std::function<bool()>& isStopped);
    /// Of its triangles, those that the last move has changed; 0 for a draft.
    double changedShare() const;
    void drawChanged();

    /// Bytes of the surface if the card has no memory for what was prepared last; else 0.
    std::uint64_t refusedBytes() const;
    /// Bytes of surfaces sent since the object was made.
    std::uint64_t uploadedBytes() const;
    /// Forgets everything on the GPU without a call to it: the context is gone.
    void abandon();

private:
    bool upload();
    bool sendTints();

    ArrayBuffers arrays_;
    BrickBuffers bricks_;
    DraftBuffers draft_;
    std::shared_ptr<const extract::SurfaceFrame> frame_;
    std::optional<model::PieceOptions> wantedTints_; ///< none: without
    std::vector<model::PieceTint> tints_; ///< by place among the frame's pieces
    bool isSent_ = false; ///< the frame, whole
    bool areTintsSent_ = false;
    bool isTinted_ = false; ///< what was sent
    bool isDraft_ = false;
    bool isRefused_ = false, isWholeRefused_ = false;
};

} // namespace isoslider::render
