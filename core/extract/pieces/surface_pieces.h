#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "core/base/strong_id.h"
#include "core/extract/pieces/brick_parts.h"

namespace isoslider::extract {

struct PieceTag;
/// A piece of the surface as it is followed from picture to picture; never used again for another.
using PieceId = StrongId<PieceTag, std::uint32_t>;

/// Connected triangles of the surface.
struct Piece {
    PieceId id;
    std::uint64_t triangles = 0;
    /// The smallest box of grid points that holds the edges on which its vertices lie.
    std::array<std::int32_t, 3> low{}, high{};
    /// One of its vertices: the lower grid point and the axis of the edge that it lies on.
    std::array<std::int32_t, 3> edgeStart{};
    int edgeAxis = 0;
};

/// The pieces of one picture. Triangles are connected where they share a vertex, across the borders of bricks as
/// within; so cells that only touch beside missing values are connected here, where the mesh has two vertices at one
/// place. Immutable.
class SurfacePieces {
public:
    /// Those of most triangles first.
    std::span<const Piece> pieces() const { return pieces_; }
    /// Of a brick of the picture, by its slot; null for one without triangles.
    const BrickParts* parts(std::size_t slot) const { return parts_[slot].get(); }
    std::size_t slotCount() const { return parts_.size(); }
    /// Grid coordinates of the brick's first point.
    std::array<std::int32_t, 3> originOf(std::size_t slot) const {
        const auto& place = places_[slot];
        return {kCellSide * place[0], kCellSide * place[1], kCellSide * place[2]};
    }
    /// The piece with a vertex on that edge, by its place in pieces(); none without such a vertex.
    /// O(bricks + vertices of some bricks).
    std::optional<std::size_t> pieceAt(const std::array<std::int32_t, 3>& edgeStart, int edgeAxis) const;
    /// Places in pieces(), by number of the brick's part.
    std::span<const std::uint32_t> piecesOf(std::size_t slot) const {
        return std::span(pieceOfPart_).subspan(firstPart_[slot], firstPart_[slot + 1] - firstPart_[slot]);
    }

private:
    template <class>
    friend class PieceTracker;

    std::vector<Piece> pieces_;
    std::vector<std::shared_ptr<const BrickParts>> parts_; ///< by slot
    std::vector<std::array<std::uint16_t, 3>> places_; ///< by slot, of the brick among bricks
    std::vector<std::uint32_t> firstPart_; ///< by slot, and one past the last
    std::vector<std::uint32_t> pieceOfPart_;
};

} // namespace isoslider::extract
