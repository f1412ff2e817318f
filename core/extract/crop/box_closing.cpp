#include "core/extract/crop/box_closing.h"

#include <algorithm>
#include <array>
#include <limits>
#include <unordered_map>
#include <utility>
#include <vector>

#include <glm/geometric.hpp>

namespace isoslider::extract {
namespace {

constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
constexpr const char* kOpenElsewhere =
    "the surface is open inside the box, as beside missing values, and cannot be closed";

using Point = std::array<std::int64_t, 3>;
using HalfEdge = std::pair<std::uint32_t, std::uint32_t>; // from, to

/// A side of the grid; `u` and `v` run so that u, v and outwards are right-handed.
struct Side {
    std::size_t axis, u, v;
    std::int64_t at; ///< along `axis`
    float outwards; ///< along `axis`: 1 or -1
};

std::array<Side, 6> sidesOf(const GridDims& dims) {
    std::array<Side, 6> sides{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const std::size_t next = (axis + 1) % 3, last = (axis + 2) % 3;
        sides[2 * axis] = {axis, last, next, 0, -1.0f};
        sides[2 * axis + 1] = {axis, next, last, dims[axis] - 1, 1.0f};
    }
    return sides;
}

/// One cell's face in a side: its corners counter-clockwise seen from outside, and its borders between them.
struct Square {
    std::array<Point, 4> corners;
    std::array<EdgeId, 4> borders; ///< from corner i to the next
};

class Closing {
public:
    explicit Closing(SurfaceMesh& mesh) : mesh_(mesh), sides_(sidesOf(mesh.geometry.dims)) {}

    Status close(const JobControl& job) {
        if (mesh_.triangles.empty())
            return makeError(ErrorCode::InvalidArgument, "there is no surface in the box to be closed");
        findVertices();
        findOpenEdges();
        triangles_.clear();
        for (const bool isWhole : {false, true}) { // squares that the surface crosses tell where inside is
            for (const Side& side : sides_)
                ISO_TRY(closeSide(side, isWhole, job));
            if (!isWhole)
                spreadSigns();
        }
        if (closedEdges_ != next_.size())
            return makeError(ErrorCode::InvalidArgument, kOpenElsewhere);
        mesh_.positions.insert(mesh_.positions.end(), positions_.begin(), positions_.end());
        for (const glm::vec3& normal : normals_)
            mesh_.normals.push_back(glm::normalize(normal));
        mesh_.triangles.insert(mesh_.triangles.end(), triangles_.begin(), triangles_.end());
        return {};
    }

private:
    enum class Sign : std::uint8_t { Unknown, Inside, Outside };

    std::uint64_t numberOf(const Point& p) const {
        const GridDims& dims = mesh_.geometry.dims;
        return static_cast<std::uint64_t>(p[0] + dims[0] * (p[1] + dims[1] * p[2]));
    }
    EdgeId edgeBetween(const Point& a, const Point& b) const {
        const std::size_t axis = a[0] != b[0] ? 0 : a[1] != b[1] ? 1 : 2;
        return 4 * static_cast<EdgeId>(numberOf(a[axis] < b[axis] ? a : b)) + axis;
    }
    bool isOnSide(EdgeId edge) const {
        const GridDims& dims = mesh_.geometry.dims;
        const auto index = static_cast<std::int64_t>(edge / 4);
        const Point point{index % dims[0], index / dims[0] % dims[1], index / dims[0] / dims[1]};
        for (std::size_t a = 0; a < 3; ++a)
            if (a != edge % 4 && (point[a] == 0 || point[a] == dims[a] - 1))
                return true;
        return false;
    }

    /// Vertices on edges of the sides, by edge.
    void findVertices() {
        std::vector<bool> isUsed(mesh_.positions.size(), false);
        for (const std::uint32_t vertex : mesh_.triangles)
            isUsed[vertex] = true;
        for (std::uint32_t vertex = 0; vertex < mesh_.edgeIds.size(); ++vertex)
            if (isUsed[vertex] && isOnSide(mesh_.edgeIds[vertex]))
                vertexOn_[mesh_.edgeIds[vertex]] = vertex;
    }

    /// Edges of one triangle alone, turned round: as a face beyond them has them.
    void findOpenEdges() {
        std::vector<HalfEdge> edges;
        edges.reserve(mesh_.triangles.size());
        for (std::size_t i = 0; i + 2 < mesh_.triangles.size(); i += 3)
            for (std::size_t k = 0; k < 3; ++k)
                edges.emplace_back(mesh_.triangles[i + k], mesh_.triangles[i + (k + 1) % 3]);
        std::sort(edges.begin(), edges.end());
        for (const auto& [from, to] : edges)
            if (!std::binary_search(edges.begin(), edges.end(), HalfEdge(to, from)))
                next_.emplace(to, from);
    }

    Square squareAt(const Side& side, std::int64_t u, std::int64_t v) const {
        Square square{};
        for (std::size_t i = 0; i < 4; ++i) {
            Point& corner = square.corners[i];
            corner[side.axis] = side.at;
            corner[side.u] = u + (i == 1 || i == 2 ? 1 : 0);
            corner[side.v] = v + (i >= 2 ? 1 : 0);
        }
        for (std::size_t i = 0; i < 4; ++i)
            square.borders[i] = edgeBetween(square.corners[i], square.corners[(i + 1) % 4]);
        return square;
    }

    Status closeSide(const Side& side, bool isWhole, const JobControl& job) {
        const GridDims& dims = mesh_.geometry.dims;
        for (std::int64_t v = 0; v + 1 < dims[side.v]; ++v) {
            if (job.isStopRequested())
                return cancelledError();
            for (std::int64_t u = 0; u + 1 < dims[side.u]; ++u) {
                const Square square = squareAt(side, u, v);
                std::array<std::uint32_t, 4> crossings{};
                bool isCrossed = false;
                for (std::size_t i = 0; i < 4; ++i) {
                    const auto found = vertexOn_.find(square.borders[i]);
                    crossings[i] = found == vertexOn_.end() ? kNone : found->second;
                    isCrossed = isCrossed || crossings[i] != kNone;
                }
                if (isWhole && !isCrossed && signOf(square.corners[0]) == Sign::Inside)
                    addPolygon({vertexAt(square.corners[0]), vertexAt(square.corners[1]), vertexAt(square.corners[2]),
                                vertexAt(square.corners[3])});
                if (!isWhole && isCrossed)
                    ISO_TRY(closeSquare(square, crossings));
            }
        }
        return {};
    }

    /// Follows each open edge, then the square's border counter-clockwise to where the next one begins.
    Status closeSquare(const Square& square, const std::array<std::uint32_t, 4>& crossings) {
        std::array<bool, 4> isDone{};
        std::array<bool, 4> isInside{};
        for (std::size_t first = 0; first < 4; ++first) {
            if (isDone[first] || crossings[first] == kNone || endOf(crossings[first], crossings) == 4)
                continue;
            std::vector<std::uint32_t> polygon;
            for (std::size_t border = first; !isDone[border];) {
                isDone[border] = true;
                polygon.push_back(crossings[border]);
                std::size_t at = endOf(crossings[border], crossings);
                if (at == 4)
                    return makeError(ErrorCode::InvalidArgument, kOpenElsewhere);
                ++closedEdges_;
                polygon.push_back(crossings[at]);
                do {
                    at = (at + 1) % 4;
                    isInside[at] = true;
                    polygon.push_back(vertexAt(square.corners[at]));
                } while (crossings[at] == kNone);
                border = at;
                if (isDone[border] && border != first)
                    return makeError(ErrorCode::InvalidArgument, kOpenElsewhere);
            }
            addPolygon(polygon);
        }
        for (std::size_t i = 0; i < 4; ++i)
            setSign(square.corners[i], isInside[i] ? Sign::Inside : Sign::Outside);
        return {};
    }

    /// The border at which the open edge from a vertex ends, among those of one square; 4: none begins there.
    std::size_t endOf(std::uint32_t from, const std::array<std::uint32_t, 4>& crossings) const {
        const auto [begin, end] = next_.equal_range(from);
        for (auto edge = begin; edge != end; ++edge)
            for (std::size_t i = 0; i < 4; ++i)
                if (crossings[i] == edge->second)
                    return i;
        return 4;
    }

    Sign signOf(const Point& point) const {
        const auto found = signs_.find(numberOf(point));
        return found == signs_.end() ? Sign::Unknown : found->second;
    }
    void setSign(const Point& point, Sign sign) {
        if (signs_.emplace(numberOf(point), sign).second)
            toSpread_.push_back(point);
    }

    /// Along the edges of the sides. Where an edge has a vertex both its ends are known by now.
    void spreadSigns() {
        if (toSpread_.empty()) // the surface does not reach the sides: they lie in it, or beside it
            setSign({0, 0, 0}, enclosedVolume() < 0.0 ? Sign::Inside : Sign::Outside);
        const GridDims& dims = mesh_.geometry.dims;
        while (!toSpread_.empty()) {
            const Point from = toSpread_.back();
            toSpread_.pop_back();
            for (std::size_t a = 0; a < 3; ++a)
                for (const std::int64_t step : {-1, 1}) {
                    Point to = from;
                    to[a] += step;
                    if (to[a] < 0 || to[a] >= dims[a])
                        continue;
                    if (!isOnSide(edgeBetween(from, to)))
                        continue;
                    setSign(to, signOf(from));
                }
        }
    }

    /// Negative where what lies inside is around the surface.
    double enclosedVolume() const {
        double volume = 0.0;
        const auto at = [&](std::size_t i) { return glm::dvec3(mesh_.positions[mesh_.triangles[i]]); };
        for (std::size_t i = 0; i + 2 < mesh_.triangles.size(); i += 3)
            volume += glm::dot(at(i), glm::cross(at(i + 1), at(i + 2)));
        return volume;
    }

    std::uint32_t vertexAt(const Point& point) {
        const auto number = static_cast<std::uint32_t>(mesh_.positions.size() + positions_.size());
        const auto [found, isNew] = vertexAtPoint_.emplace(numberOf(point), number);
        if (isNew) {
            positions_.emplace_back(point[0], point[1], point[2]);
            glm::vec3 normal(0.0f);
            for (const Side& side : sides_)
                if (point[side.axis] == side.at)
                    normal[static_cast<int>(side.axis)] += side.outwards;
            normals_.push_back(normal);
        }
        return found->second;
    }

    /// It is convex.
    void addPolygon(const std::vector<std::uint32_t>& corners) {
        for (std::size_t k = 2; k < corners.size(); ++k)
            triangles_.insert(triangles_.end(), {corners[0], corners[k - 1], corners[k]});
    }

    SurfaceMesh& mesh_;
    std::array<Side, 6> sides_;
    std::unordered_map<EdgeId, std::uint32_t> vertexOn_;
    std::unordered_multimap<std::uint32_t, std::uint32_t> next_; ///< open edges, turned round: from, to
    std::size_t closedEdges_ = 0;
    std::unordered_map<std::uint64_t, Sign> signs_; ///< of points of the sides
    std::vector<Point> toSpread_;
    std::unordered_map<std::uint64_t, std::uint32_t> vertexAtPoint_;
    std::vector<glm::vec3> positions_, normals_; ///< of the vertices at points
    std::vector<std::uint32_t> triangles_;
};

} // namespace

Status closeAtSides(SurfaceMesh& mesh, const JobControl& job) { return Closing(mesh).close(job); }

} // namespace isoslider::extract
