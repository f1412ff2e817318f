#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/extract/pieces/surface_pieces.h"
#include "ui/model/pieces/piece_tints.h"
#include "ui/render/gl_driver.h"

namespace isoslider::render {

/// Where both surface shaders expect the tint of a vertex.
inline constexpr GLuint kTintLocation = 2;

/// Adds the tints of a brick's records. REQUIRES: the brick has triangles.
inline void addTints(const extract::SurfacePieces& pieces, std::size_t slot, std::span<const model::PieceTint> tints,
                     std::vector<model::PieceTint>& records) {
    constexpr model::PieceTint kPlain{0, 0, 0, model::kPlainPiece};
    const extract::BrickParts& parts = *pieces.parts(slot);
    const auto piecesOf = pieces.piecesOf(slot);
    for (const std::uint16_t part : parts.partOf)
        records.push_back(part == extract::BrickParts::kNone ? kPlain : tints[piecesOf[part]]);
}

} // namespace isoslider::render
