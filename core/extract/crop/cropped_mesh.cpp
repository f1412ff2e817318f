#include "core/extract/crop/cropped_mesh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <unordered_map>
#include <utility>
#include <vector>

#include <glm/geometric.hpp>

#include "core/extract/crop/box_closing.h"

namespace isoslider::extract {
namespace {

constexpr std::uint32_t kGone = std::numeric_limits<std::uint32_t>::max();
constexpr std::size_t kTogether = 1 << 16; // triangles between two looks at whether to stop

/// The cells that a vertex lies in or between, both ends included.
struct CellRange {
    std::array<std::int64_t, 3> low{}, high{};
};

struct LowerEnd {
    std::array<std::int64_t, 3> point{};
    std::size_t axis = 0;
};

LowerEnd lowerEnd(EdgeId edge, const GridDims& dims) {
    const auto index = static_cast<std::int64_t>(edge / 4);
    return {{index % dims[0], index / dims[0] % dims[1], index / dims[0] / dims[1]}, edge % 4};
}

CellRange cellsOf(const SurfaceMesh& mesh, std::uint32_t vertex) {
    CellRange range;
    if (vertex >= mesh.edgeIds.size()) {
        for (std::size_t a = 0; a < 3; ++a)
            range.low[a] = range.high[a] =
                static_cast<std::int64_t>(std::floor(mesh.positions[vertex][static_cast<int>(a)]));
        return range;
    }
    const LowerEnd edge = lowerEnd(mesh.edgeIds[vertex], mesh.geometry.dims);
    for (std::size_t a = 0; a < 3; ++a) {
        range.low[a] = edge.point[a] - (a == edge.axis ? 0 : 1);
        range.high[a] = edge.point[a];
    }
    return range;
}

/// Whether the triangle is of a cell in the box. One that lies in a face between two cells may count to either: both
/// leave the same to be closed.
bool isInBox(const SurfaceMesh& mesh, const std::uint32_t* corners, const CellBox& box) {
    for (std::size_t a = 0; a < 3; ++a) {
        std::int64_t low = box.low[a], high = box.high[a] - 1;
        for (int k = 0; k < 3; ++k) {
            const CellRange cells = cellsOf(mesh, corners[k]);
            low = std::max(low, cells.low[a]);
            high = std::min(high, cells.high[a]);
        }
        if (low > high)
            return false;
    }
    return true;
}

/// The grid of the box's points.
GridGeometry geometryOf(const GridGeometry& whole, const CellBox& box) {
    GridGeometry geometry = whole;
    for (std::size_t a = 0; a < 3; ++a)
        geometry.dims[a] = box.high[a] - box.low[a] + 1;
    geometry.origin =
        glm::dvec3(whole.indexToWorld() * glm::dvec4(static_cast<double>(box.low[0]), static_cast<double>(box.low[1]),
                                                     static_cast<double>(box.low[2]), 1.0));
    return geometry;
}

/// Puts the vertices that triangles use into `result`, in their order, moved into its grid.
void takeVertices(const SurfaceMesh& mesh, const CellBox& box, SurfaceMesh& result) {
    std::vector<std::uint32_t> numbers(mesh.positions.size(), kGone);
    for (const std::uint32_t vertex : result.triangles)
        numbers[vertex] = 0;
    // Whole numbers: what is subtracted leaves no rounding.
    const glm::vec3 low(box.low[0], box.low[1], box.low[2]);
    const GridDims& dims = result.geometry.dims;
    for (std::uint32_t vertex = 0; vertex < numbers.size(); ++vertex) {
        if (numbers[vertex] == kGone)
            continue;
        numbers[vertex] = static_cast<std::uint32_t>(result.positions.size());
        result.positions.push_back(mesh.positions[vertex] - low);
        result.normals.push_back(mesh.normals[vertex]);
        if (vertex >= mesh.edgeIds.size())
            continue;
        const LowerEnd edge = lowerEnd(mesh.edgeIds[vertex], mesh.geometry.dims);
        const std::int64_t point = edge.point[0] - box.low[0] +
                                   dims[0] * (edge.point[1] - box.low[1] + dims[1] * (edge.point[2] - box.low[2]));
        result.edgeIds.push_back(4 * static_cast<EdgeId>(point) + edge.axis);
    }
    for (std::uint32_t& vertex : result.triangles)
        vertex = numbers[vertex];
}

/// Cuts triangles by one half-space after the other.
class Cutting {
public:
    explicit Cutting(SurfaceMesh& mesh) : mesh_(mesh) {}

    bool cut(const glm::dvec4& halfSpace, const JobControl& job) {
        sides_.clear();
        for (const glm::vec3& place : mesh_.positions)
            sides_.push_back(glm::dot(glm::dvec3(halfSpace), glm::dvec3(place)) + halfSpace.w);
        made_.clear();
        std::vector<std::uint32_t> kept;
        for (std::size_t i = 0; i + 2 < mesh_.triangles.size(); i += 3) {
            if (i % (3 * kTogether) == 0 && job.isStopRequested())
                return false;
            addPart(&mesh_.triangles[i], kept);
        }
        mesh_.triangles = std::move(kept);
        return true;
    }

private:
    void addPart(const std::uint32_t* corners, std::vector<std::uint32_t>& kept) {
        std::array<std::uint32_t, 4> part{};
        std::size_t count = 0;
        for (int k = 0; k < 3; ++k) {
            const std::uint32_t here = corners[k], next = corners[(k + 1) % 3];
            const bool isHere = sides_[here] >= 0.0, isNext = sides_[next] >= 0.0;
            if (isHere)
                part[count++] = here;
            if (isHere != isNext)
                part[count++] = between(here, next);
        }
        for (std::size_t k = 2; k < count; ++k)
            if (part[0] != part[k - 1] && part[k - 1] != part[k] && part[k] != part[0])
                kept.insert(kept.end(), {part[0], part[k - 1], part[k]});
    }

    /// The same whatever the order of the ends. An end on the plane is the place itself.
    std::uint32_t between(std::uint32_t a, std::uint32_t b) {
        if (a > b)
            std::swap(a, b);
        if (sides_[a] == 0.0 || sides_[b] == 0.0)
            return sides_[a] == 0.0 ? a : b;
        const auto [found, isNew] =
            made_.try_emplace(std::uint64_t{a} << 32 | b, static_cast<std::uint32_t>(mesh_.positions.size()));
        if (isNew) {
            const double t = sides_[a] / (sides_[a] - sides_[b]);
            mesh_.positions.emplace_back(glm::dvec3(mesh_.positions[a]) * (1.0 - t) +
                                         glm::dvec3(mesh_.positions[b]) * t);
            const glm::dvec3 normal = glm::dvec3(mesh_.normals[a]) * (1.0 - t) + glm::dvec3(mesh_.normals[b]) * t;
            const double size = glm::length(normal);
            mesh_.normals.push_back(size > 0.0 ? glm::vec3(normal / size) : mesh_.normals[a]);
        }
        return found->second;
    }

    SurfaceMesh& mesh_;
    std::vector<double> sides_; ///< of the vertices that were there before this half-space
    std::unordered_map<std::uint64_t, std::uint32_t> made_;
};

} // namespace

Result<SurfaceMesh> cropMesh(const SurfaceMesh& mesh, const CellBox& box, BoxSides sides, const JobControl& job) {
    if (mesh.mergeBound.limit > 0.0)
        return makeError(ErrorCode::InvalidArgument, "cells are merged; set the error to none to crop by whole cells");
    SurfaceMesh result;
    result.geometry = geometryOf(mesh.geometry, box);
    result.isovalue = mesh.isovalue;
    for (std::size_t i = 0; i + 2 < mesh.triangles.size(); i += 3) {
        if (i % (3 * kTogether) == 0 && job.isStopRequested())
            return cancelledError();
        if (isInBox(mesh, &mesh.triangles[i], box))
            result.triangles.insert(result.triangles.end(), &mesh.triangles[i], &mesh.triangles[i] + 3);
    }
    takeVertices(mesh, box, result);
    if (sides == BoxSides::Closed)
        ISO_TRY(closeAtSides(result, job));
    return result;
}

Result<SurfaceMesh> cutMesh(const SurfaceMesh& mesh, std::span<const glm::dvec4> halfSpaces, const JobControl& job) {
    SurfaceMesh result = mesh;
    result.edgeIds.clear();
    Cutting cutting(result);
    for (const glm::dvec4& halfSpace : halfSpaces)
        if (!cutting.cut(halfSpace, job))
            return cancelledError();
    return result;
}

} // namespace isoslider::extract
