#include "core/extract/slices/surface_cut.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <tuple>
#include <utility>

#include <glm/geometric.hpp>
#include <tbb/parallel_for.h>

#include "core/extract/live/brick_picture.h"
#include "core/extract/pieces/surface_pieces.h"

namespace isoslider::extract {
namespace {

constexpr std::size_t kTrianglesTogether = 1u << 14;

using Segment = std::array<glm::vec3, 2>;

/// What one thread has found.
struct Found {
    std::vector<glm::vec3> points; ///< across triangles
    std::vector<Segment> edges; ///< in the plane; of both triangles that share one
};

std::tuple<float, float, float> orderOf(const glm::vec3& p) { return {p.x, p.y, p.z}; }
std::pair<std::tuple<float, float, float>, std::tuple<float, float, float>> orderOf(const Segment& segment) {
    return {orderOf(segment[0]), orderOf(segment[1])};
}

/// From the lower side whatever the order of the ends, so that triangles that share the edge have one point.
glm::vec3 crossing(const glm::dvec3& a, double sideA, const glm::dvec3& b, double sideB) {
    if (sideA > sideB)
        return crossing(b, sideB, a, sideA);
    return glm::vec3(a + (b - a) * (sideA / (sideA - sideB)));
}

void cutTriangle(const std::array<glm::vec3, 3>& corners, const std::array<double, 3>& sides, Found& found) {
    const auto onPlane = std::count(sides.begin(), sides.end(), 0.0);
    if (onPlane == 3)
        return;
    std::array<glm::vec3, 2> ends{};
    std::size_t count = 0;
    for (std::size_t i = 0; i < 3; ++i) {
        const std::size_t next = (i + 1) % 3;
        if (sides[i] == 0.0 && count < 2)
            ends[count++] = corners[i];
        else if (sides[i] * sides[next] < 0.0 && count < 2)
            ends[count++] = crossing(corners[i], sides[i], corners[next], sides[next]);
    }
    if (count < 2 || ends[0] == ends[1])
        return;
    if (onPlane < 2) {
        found.points.insert(found.points.end(), ends.begin(), ends.end());
        return;
    }
    if (orderOf(ends[1]) < orderOf(ends[0]))
        std::swap(ends[0], ends[1]);
    found.edges.push_back(ends);
}

template <class Index>
void cutTriangles(std::span<const Index> indices, std::span<const glm::vec3> places, const CutPlane& plane,
                  Found& found) {
    for (std::size_t i = 0; i + 2 < indices.size(); i += 3) {
        const std::array<glm::vec3, 3> corners{places[indices[i]], places[indices[i + 1]], places[indices[i + 2]]};
        std::array<double, 3> sides{};
        for (std::size_t k = 0; k < 3; ++k)
            sides[k] = glm::dot(plane.normal, glm::dvec3(corners[k])) - plane.offset;
        const auto [least, greatest] = std::minmax_element(sides.begin(), sides.end());
        if (*least <= 0.0 && *greatest >= 0.0)
            cutTriangle(corners, sides, found);
    }
}

bool passesThrough(const CutPlane& plane, const std::array<std::int32_t, 3>& origin) {
    const glm::dvec3 middle = glm::dvec3(origin[0], origin[1], origin[2]) + 0.5 * kCellSide;
    const double reach = 0.5 * kCellSide * glm::dot(glm::abs(plane.normal), glm::dvec3(1.0));
    // By a rounding more than the box: a plane of grid points between two bricks belongs to both.
    return std::abs(glm::dot(plane.normal, middle) - plane.offset) <= reach * (1.0 + 1e-9);
}

/// By place among the pieces of a frame; empty: all are shown.
using ShownPieces = std::vector<char>;

ShownPieces shownPieces(const SurfaceFrame& frame, const std::function<bool(std::uint32_t)>& isShown) {
    ShownPieces shown;
    if (frame.pieces && isShown)
        for (std::uint32_t piece = 0; piece < frame.pieces->pieces().size(); ++piece)
            shown.push_back(isShown(piece) ? 1 : 0);
    return shown;
}

/// Of the records of a brick.
void listShown(const SurfacePieces& pieces, std::size_t slot, const ShownPieces& shown, std::vector<char>& records) {
    const BrickParts* parts = pieces.parts(slot);
    if (parts == nullptr)
        return;
    const auto piecesOf = pieces.piecesOf(slot);
    for (const std::uint16_t part : parts->partOf)
        records.push_back(part == BrickParts::kNone ? 0 : shown[piecesOf[part]]);
}

/// The triangles whose vertices are shown.
template <class Index>
std::span<const Index> keepShown(std::span<const Index> indices, const std::vector<char>& isShown,
                                 std::vector<Index>& kept) {
    kept.clear();
    for (std::size_t i = 0; i + 2 < indices.size(); i += 3)
        if (indices[i] < isShown.size() && isShown[indices[i]] != 0)
            kept.insert(kept.end(), indices.begin() + static_cast<std::ptrdiff_t>(i),
                        indices.begin() + static_cast<std::ptrdiff_t>(i + 3));
    return kept;
}

std::vector<Found> cutBricks(const SurfaceFrame& frame, const CutPlane& plane, const JobControl& job,
                             const ShownPieces& shown) {
    const auto bricks = frame.bricks->bricks();
    std::vector<std::size_t> met;
    for (std::size_t slot = 0; slot < bricks.size(); ++slot)
        if (bricks[slot].indexCount > 0 && passesThrough(plane, bricks[slot].origin()))
            met.push_back(slot);
    std::vector<Found> found(met.size());
    tbb::parallel_for(std::size_t{0}, met.size(), [&](std::size_t i) {
        if (job.isStopRequested())
            return;
        const PictureBrick& brick = bricks[met[i]];
        thread_local std::vector<glm::vec3> places;
        placesOf(*frame.bricks, brick, frame.isovalue, places);
        std::span<const std::uint16_t> indices(frame.bricks->indices(brick), brick.indexCount);
        std::vector<char> isRecordShown;
        std::vector<std::uint16_t> kept;
        if (!shown.empty()) {
            listShown(*frame.pieces, met[i], shown, isRecordShown);
            indices = keepShown(indices, isRecordShown, kept);
        }
        cutTriangles(indices, std::span<const glm::vec3>(places), plane, found[i]);
    });
    return found;
}

std::vector<Found> cutArrays(const SurfaceFrame& frame, const CutPlane& plane, const JobControl& job,
                             const ShownPieces& shown) {
    constexpr std::size_t kIndices = 3 * kTrianglesTogether;
    std::span<const std::uint32_t> indices(frame.indices);
    std::vector<std::uint32_t> kept;
    if (!shown.empty()) { // the bricks came one after the other
        std::vector<char> vertices;
        for (std::size_t slot = 0; slot < frame.pieces->slotCount(); ++slot)
            listShown(*frame.pieces, slot, shown, vertices);
        indices = keepShown(indices, vertices, kept);
    }
    std::vector<Found> found((indices.size() + kIndices - 1) / kIndices);
    tbb::parallel_for(std::size_t{0}, found.size(), [&](std::size_t i) {
        if (!job.isStopRequested())
            cutTriangles(indices.subspan(i * kIndices, std::min(kIndices, indices.size() - i * kIndices)),
                         std::span<const glm::vec3>(frame.positions), plane, found[i]);
    });
    return found;
}

} // namespace

Result<std::vector<glm::vec3>> cutSurface(const SurfaceFrame& frame, const CutPlane& plane, const JobControl& job,
                                          const std::function<bool(std::uint32_t piece)>& isShown) {
    const ShownPieces shown = shownPieces(frame, isShown);
    const auto parts = frame.bricks ? cutBricks(frame, plane, job, shown) : cutArrays(frame, plane, job, shown);
    if (job.isStopRequested())
        return cancelledError();
    std::vector<glm::vec3> points;
    std::vector<Segment> edges;
    for (const Found& part : parts) {
        points.insert(points.end(), part.points.begin(), part.points.end());
        edges.insert(edges.end(), part.edges.begin(), part.edges.end());
    }
    std::sort(edges.begin(), edges.end(), [](const Segment& a, const Segment& b) { return orderOf(a) < orderOf(b); });
    edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
    for (const Segment& edge : edges)
        points.insert(points.end(), edge.begin(), edge.end());
    return points;
}

} // namespace isoslider::extract
