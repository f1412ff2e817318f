#include "core/extract/pieces/piece_measures.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <tuple>
#include <vector>

#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>

#include "core/extract/live/brick_picture.h"
#include "core/extract/pieces/surface_pieces.h"

namespace isoslider::extract {
namespace {

constexpr std::size_t kTogether = 1 << 10; // bricks between two looks at whether to stop

/// A side of triangles between two vertices, and how often it is passed up less how often down: 0 inside a piece.
template <class Vertex>
struct Side {
    Vertex low{}, high{};
    int passes = 0;
};

template <class Vertex>
Side<Vertex> sideOf(Vertex from, Vertex to) {
    return from < to ? Side<Vertex>{from, to, 1} : Side<Vertex>{to, from, -1};
}

/// Leaves the sides that are not passed as often up as down.
template <class Vertex>
void cancel(std::vector<Side<Vertex>>& sides) {
    const auto ends = [](const Side<Vertex>& side) { return std::tie(side.low, side.high); };
    std::sort(sides.begin(), sides.end(),
              [&](const Side<Vertex>& a, const Side<Vertex>& b) { return ends(a) < ends(b); });
    std::size_t count = 0;
    for (std::size_t k = 0; k < sides.size();) {
        Side<Vertex> side = sides[k];
        while (++k < sides.size() && ends(sides[k]) == ends(side))
            side.passes += sides[k].passes;
        if (side.passes != 0)
            sides[count++] = side;
    }
    sides.resize(count);
}

/// Sums over the triangles of one piece, brick by brick.
class Sums {
public:
    Sums(const SurfaceFrame& frame, std::size_t piece)
        : frame_(frame),
          piece_(static_cast<std::uint32_t>(piece)),
          toWorld_(frame.geometry.indexToWorld()),
          // About a point of the piece, so that little cancels.
          middle_(frame.pieces->pieces()[piece].edgeStart[0], frame.pieces->pieces()[piece].edgeStart[1],
                  frame.pieces->pieces()[piece].edgeStart[2]) {}

    bool isIn(std::size_t slot) const {
        const auto pieces = frame_.pieces->piecesOf(slot);
        return std::find(pieces.begin(), pieces.end(), piece_) != pieces.end();
    }
    /// `corners`: three records of the brick for each triangle; `placeOf`: of a record, in grid index units.
    template <class Corner, class PlaceOf>
    void addBrick(std::size_t slot, const Corner* corners, std::size_t count, const PlaceOf& placeOf) {
        const BrickParts& parts = *frame_.pieces->parts(slot);
        const auto pieces = frame_.pieces->piecesOf(slot);
        local_.clear();
        for (std::size_t i = 0; i + 2 < count; i += 3) {
            const std::uint16_t part = parts.partOf[corners[i]];
            if (part == BrickParts::kNone || pieces[part] != piece_)
                continue;
            const glm::dvec3 a = placeOf(corners[i]) - middle_, b = placeOf(corners[i + 1]) - middle_,
                             c = placeOf(corners[i + 2]) - middle_;
            area_ += 0.5 * glm::length(glm::cross(toWorld_ * (b - a), toWorld_ * (c - a)));
            sixVolumes_ += glm::dot(a, glm::cross(b, c));
            for (std::size_t k = 0; k < 3; ++k)
                local_.push_back(sideOf(static_cast<std::uint16_t>(corners[i + k]),
                                        static_cast<std::uint16_t>(corners[i + (k + 1) % 3])));
        }
        cancel(local_);
        for (const auto& side : local_) {
            const std::uint64_t low = nameOf(slot, side.low), high = nameOf(slot, side.high);
            open_.push_back(sideOf(low, high));
            open_.back().passes *= side.passes;
        }
        if (open_.size() > 2 * openAfterCancel_ + kTogether) { // what is open stays small
            cancel(open_);
            openAfterCancel_ = open_.size();
        }
    }
    PieceMeasures result() {
        cancel(open_);
        return {area_, sixVolumes_ / 6.0 * std::abs(glm::determinant(toWorld_)), open_.empty()};
    }

private:
    /// Of a vertex: both bricks at a face name it by its edge. Those inside cells are of one brick.
    std::uint64_t nameOf(std::size_t slot, std::uint16_t record) const {
        constexpr std::uint64_t kInside = std::uint64_t{1} << 63;
        const ClosedEdge edge = frame_.pieces->parts(slot)->edges[record];
        if (edge >= EdgeRecord<float>::kInside)
            return kInside | static_cast<std::uint64_t>(slot) << 16 | record;
        const auto origin = frame_.pieces->originOf(slot);
        const auto start = coordsOf(startOf(edge));
        const auto& dims = frame_.geometry.dims;
        std::uint64_t point = 0;
        for (std::size_t axis = 3; axis-- > 0;)
            point =
                point * static_cast<std::uint64_t>(dims[axis]) + static_cast<std::uint64_t>(origin[axis] + start[axis]);
        return 4 * point + static_cast<std::uint64_t>(axisOf(edge));
    }

    const SurfaceFrame& frame_;
    const std::uint32_t piece_;
    const glm::dmat3 toWorld_;
    const glm::dvec3 middle_;
    double area_ = 0.0, sixVolumes_ = 0.0;
    std::vector<Side<std::uint16_t>> local_;
    std::vector<Side<std::uint64_t>> open_;
    std::size_t openAfterCancel_ = 0;
};

bool addBricks(const SurfaceFrame& frame, Sums& sums, const JobControl& job) {
    const auto bricks = frame.bricks->bricks();
    std::vector<glm::vec3> places;
    for (std::size_t slot = 0; slot < bricks.size(); ++slot) {
        if (slot % kTogether == 0 && job.isStopRequested())
            return false;
        const PictureBrick& brick = bricks[slot];
        if (brick.indexCount == 0 || !sums.isIn(slot))
            continue;
        placesOf(*frame.bricks, brick, frame.isovalue, places);
        sums.addBrick(slot, frame.bricks->indices(brick), brick.indexCount,
                      [&](std::uint16_t vertex) { return glm::dvec3(places[vertex]); });
    }
    return true;
}

// The bricks' vertices and triangles lie one after the other.
bool addArrays(const SurfaceFrame& frame, Sums& sums, const JobControl& job) {
    std::vector<std::uint16_t> corners;
    std::size_t first = 0, index = 0;
    for (std::size_t slot = 0; slot < frame.pieces->slotCount(); ++slot) {
        if (slot % kTogether == 0 && job.isStopRequested())
            return false;
        if (frame.pieces->parts(slot) == nullptr)
            continue;
        const std::size_t end = first + frame.pieces->parts(slot)->partOf.size();
        corners.clear();
        for (; index < frame.indices.size() && frame.indices[index] < end; ++index)
            corners.push_back(static_cast<std::uint16_t>(frame.indices[index] - first));
        if (sums.isIn(slot))
            sums.addBrick(slot, corners.data(), corners.size(),
                          [&](std::uint16_t record) { return glm::dvec3(frame.positions[first + record]); });
        first = end;
    }
    return true;
}

} // namespace

Result<PieceMeasures> measurePiece(const SurfaceFrame& frame, std::size_t piece, const JobControl& job) {
    Sums sums(frame, piece);
    if (!(frame.bricks != nullptr ? addBricks(frame, sums, job) : addArrays(frame, sums, job)))
        return cancelledError();
    return sums.result();
}

} // namespace isoslider::extract
