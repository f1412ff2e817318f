#include "core/extract/pieces/surface_hit.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include <glm/geometric.hpp>

#include "core/extract/live/brick_picture.h"
#include "core/extract/pieces/surface_pieces.h"

namespace isoslider::extract {
namespace {

constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

struct Segment {
    glm::dvec3 from, along;
};

/// Part of the way at which the segment enters a box; none if it misses it.
std::optional<double> entryOf(const Segment& segment, const glm::dvec3& low, const glm::dvec3& high) {
    double first = 0.0, last = 1.0;
    for (int axis = 0; axis < 3; ++axis) {
        if (segment.along[axis] == 0.0) {
            if (segment.from[axis] < low[axis] || segment.from[axis] > high[axis])
                return std::nullopt;
            continue;
        }
        const double a = (low[axis] - segment.from[axis]) / segment.along[axis];
        const double b = (high[axis] - segment.from[axis]) / segment.along[axis];
        first = std::max(first, std::min(a, b));
        last = std::min(last, std::max(a, b));
    }
    return first <= last ? std::optional(first) : std::nullopt;
}

/// Part of the way at which the segment meets a triangle (Moeller and Trumbore 1997), from either side.
std::optional<double> meet(const Segment& segment, const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
    const glm::dvec3 ab = b - a, ac = c - a;
    const glm::dvec3 p = glm::cross(segment.along, ac);
    const double determinant = glm::dot(ab, p);
    if (determinant == 0.0)
        return std::nullopt;
    const glm::dvec3 t = segment.from - a;
    const double u = glm::dot(t, p) / determinant;
    const glm::dvec3 q = glm::cross(t, ab);
    const double v = glm::dot(segment.along, q) / determinant;
    const double way = glm::dot(ac, q) / determinant;
    if (!(u >= 0.0 && v >= 0.0 && u + v <= 1.0 && way >= 0.0 && way <= 1.0))
        return std::nullopt;
    return way;
}

/// The nearest hit so far.
struct Nearest {
    double way = std::numeric_limits<double>::infinity();
    std::uint32_t piece = kNone;

    void take(std::optional<double> other, std::uint32_t otherPiece) {
        if (other && *other < way)
            *this = {*other, otherPiece};
    }
};

/// Of a brick's records, by number; kNone without a triangle.
std::uint32_t pieceOf(const SurfacePieces& pieces, std::size_t slot, std::size_t record) {
    const std::uint16_t part = pieces.parts(slot)->partOf[record];
    return part == BrickParts::kNone ? kNone : pieces.piecesOf(slot)[part];
}

using IsShown = std::function<bool(std::uint32_t)>;

Nearest hitBricks(const SurfaceFrame& frame, const Segment& segment, const IsShown& isShown) {
    const auto bricks = frame.bricks->bricks();
    std::vector<std::pair<double, std::size_t>> entered;
    for (std::size_t slot = 0; slot < bricks.size(); ++slot) {
        if (bricks[slot].indexCount == 0)
            continue;
        const auto origin = bricks[slot].origin();
        const glm::dvec3 low(origin[0], origin[1], origin[2]);
        if (const auto entry = entryOf(segment, low, low + glm::dvec3(kCellSide)))
            entered.push_back({*entry, slot});
    }
    std::sort(entered.begin(), entered.end());
    Nearest nearest;
    std::vector<glm::vec3> places;
    for (const auto& [entry, slot] : entered) {
        if (entry > nearest.way)
            break;
        const PictureBrick& brick = bricks[slot];
        placesOf(*frame.bricks, brick, frame.isovalue, places);
        const std::uint16_t* const corners = frame.bricks->indices(brick);
        for (std::uint32_t i = 0; i < brick.indexCount; i += 3)
            if (const std::uint32_t piece = frame.pieces ? pieceOf(*frame.pieces, slot, corners[i]) : 0; isShown(piece))
                nearest.take(meet(segment, places[corners[i]], places[corners[i + 1]], places[corners[i + 2]]), piece);
    }
    return nearest;
}

Nearest hitArrays(const SurfaceFrame& frame, const Segment& segment, const IsShown& isShown) {
    std::vector<std::uint32_t> pieces;
    if (!frame.pieces)
        pieces.resize(frame.positions.size(), 0);
    for (std::size_t slot = 0; frame.pieces && slot < frame.pieces->slotCount(); ++slot)
        if (frame.pieces->parts(slot) != nullptr)
            for (std::size_t k = 0; k < frame.pieces->parts(slot)->partOf.size(); ++k)
                pieces.push_back(pieceOf(*frame.pieces, slot, k));
    Nearest nearest;
    for (std::size_t i = 0; i + 2 < frame.indices.size(); i += 3) {
        const std::uint32_t* const corners = &frame.indices[i];
        if (corners[0] < pieces.size() && isShown(pieces[corners[0]]))
            nearest.take(
                meet(segment, frame.positions[corners[0]], frame.positions[corners[1]], frame.positions[corners[2]]),
                pieces[corners[0]]);
    }
    return nearest;
}

} // namespace

std::optional<SurfaceHit> firstHit(const SurfaceFrame& frame, const glm::dvec3& from, const glm::dvec3& to,
                                   const IsShown& isShown) {
    const Segment segment{from, to - from};
    const Nearest nearest = frame.bricks ? hitBricks(frame, segment, isShown) : hitArrays(frame, segment, isShown);
    if (nearest.piece == kNone)
        return std::nullopt;
    return SurfaceHit{from + nearest.way * segment.along, nearest.piece};
}

} // namespace isoslider::extract
