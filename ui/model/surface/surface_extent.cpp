#include "ui/model/surface/surface_extent.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "ui/model/surface/clipping.h"
#include "ui/model/surface/stage.h"
#include "ui/model/surface/surface_vertices.h"

namespace isoslider::model {
namespace {

struct Box {
    glm::dvec3 low{std::numeric_limits<double>::infinity()}, high{-std::numeric_limits<double>::infinity()};

    void add(const glm::dvec3& place) {
        low = glm::min(low, place);
        high = glm::max(high, place);
    }
    bool isEmpty() const { return !(low.x <= high.x); }
    bool holds(const glm::dvec3& place) const { return glm::clamp(place, low, high) == place; }
};

Box boxOfShown(const extract::SurfaceFrame& frame, const PieceOptions& options) {
    const PieceDisplay display(*frame.pieces, frame.geometry, options);
    const auto pieces = frame.pieces->pieces();
    Box box;
    for (std::size_t piece = 0; piece < pieces.size(); ++piece)
        if (display.isShown(piece))
            for (const auto& corner : {pieces[piece].low, pieces[piece].high})
                box.add({corner[0], corner[1], corner[2]});
    return box;
}

} // namespace

Result<std::optional<SurfaceExtent>> extentOf(const extract::SurfaceFrame& frame, const PieceOptions& pieces,
                                              std::span<const glm::dvec4> cuts, const JobControl& job,
                                              const glm::dvec3& stretch) {
    const bool hidesPieces = pieces.hidesAny() && frame.pieces != nullptr;
    const Box ofPieces = hidesPieces ? boxOfShown(frame, pieces) : Box();
    const auto isShown = [&](const glm::dvec3& place) {
        return (!hidesPieces || ofPieces.holds(place)) && isWithin(cuts, place);
    };
    Box box = ofPieces;
    if (!hidesPieces || !cuts.empty()) {
        box = Box();
        const auto add = [&](const glm::dvec3& place) {
            if (isShown(place))
                box.add(place);
        };
        if (!visitVertices(frame, job, add))
            return cancelledError();
    }
    if (box.isEmpty())
        return std::optional<SurfaceExtent>();
    const glm::dvec3 middle = 0.5 * (box.low + box.high);
    const glm::dmat3 toShown(stretched(frame.geometry, stretch).indexToWorld());
    double farthest = 0.0; // squared
    const auto measure = [&](const glm::dvec3& place) {
        if (!isShown(place))
            return;
        const glm::dvec3 away = toShown * (place - middle);
        farthest = std::max(farthest, glm::dot(away, away));
    };
    if (!visitVertices(frame, job, measure))
        return cancelledError();
    return std::optional(SurfaceExtent{middle, std::sqrt(farthest)});
}

} // namespace isoslider::model
