#include "core/extract/live/small_leaf_polygons.h"

#include <cstring>

namespace isoslider::extract {
namespace {

constexpr int kPatternPoints = 27;
constexpr std::uint32_t kMiddle = 1u << 13;

/// Faces in the order of kCornersOfFaces: 2 * axis + whether it is the upper one.
constexpr std::size_t kFaces = 6;
constexpr std::array<std::uint32_t, kFaces> kFaceMiddles{1u << 12, 1u << 14, 1u << 10, 1u << 16, 1u << 4, 1u << 22};

/// By the signs of the corners, the faces whose corners differ.
constexpr auto kCrossedFaces = [] {
    std::array<std::uint8_t, 256> crossed{};
    for (unsigned signs = 0; signs < crossed.size(); ++signs)
        for (std::size_t face = 0; face < kFaces; ++face)
            if (isFaceCrossed(signs, face))
                crossed[signs] = static_cast<std::uint8_t>(crossed[signs] | 1u << face);
    return crossed;
}();

/// By the faces that smaller leaves lie beside, the points whose signs matter: the middles of the others do not.
constexpr auto kPointsThatMatter = [] {
    std::array<std::uint32_t, 1u << kFaces> points{};
    for (unsigned split = 0; split < points.size(); ++split) {
        points[split] = (1u << kPatternPoints) - 1 - kMiddle;
        for (std::size_t face = 0; face < kFaces; ++face)
            if ((split >> face & 1) == 0)
                points[split] &= ~kFaceMiddles[face];
    }
    return points;
}();

std::uint32_t signsOfLeaf(const BitString& above, std::int64_t point) {
    std::uint32_t signs = 0;
    for (int z = 0; z < 3; ++z) {
        const auto first = static_cast<std::size_t>(point) + static_cast<std::size_t>(z * kPointStride[2]);
        std::uint64_t plane; // 21 bits from any place lie in eight bytes
        std::memcpy(&plane, reinterpret_cast<const std::byte*>(above.words.data()) + first / 8, sizeof plane);
        plane >>= first % 8;
        signs |= static_cast<std::uint32_t>((plane & 7) | (plane >> 9 & 7) << 3 | (plane >> 18 & 7) << 6) << (9 * z);
    }
    return signs;
}

unsigned signsOfCorners(std::uint32_t signs) {
    return (signs & 1) | (signs >> 1 & 2) | (signs >> 4 & 4) | (signs >> 5 & 8) | (signs >> 14 & 16) |
           (signs >> 15 & 32) | (signs >> 18 & 64) | (signs >> 19 & 128);
}

unsigned facesBesideCells(const LeavesAround& leaves, const LeafCell& leaf) {
    unsigned faces = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const std::int64_t stride = LeavesAround::cellStride(axis);
        faces |= unsigned{leaves.levelAt(leaf.cell - stride) == 0} << (2 * axis);
        faces |= unsigned{leaves.levelAt(leaf.cell + 2 * stride) == 0} << (2 * axis + 1);
    }
    return faces;
}

/// Of an edge named from a leaf's first point on: what it is in the leaf.
struct PlaceInLeaf {
    bool isOnLeafEdge = false; ///< else inside a face
    std::int16_t diagonal = 0; ///< then the cell across that edge, from the leaf's
    std::uint8_t faces = 0; ///< that it lies in
};
constexpr std::size_t kEdgeNames = 4 * (2 + 2 * kPointStride[1] + 2 * kPointStride[2]) + 3;
const std::array<PlaceInLeaf, kEdgeNames>& placesInLeaf() {
    static const auto kPlaces = [] {
        std::array<PlaceInLeaf, kEdgeNames> places{};
        for (int p = 0; p < 27; ++p)
            for (std::size_t axis = 0; axis < 3; ++axis) {
                const std::array<int, 3> at{p % 3, p / 3 % 3, p / 9};
                if (at[axis] == 2)
                    continue;
                PlaceInLeaf place;
                std::int64_t diagonal = 0;
                int sides = 0;
                for (std::size_t a = 0; a < 3; ++a) {
                    const std::int64_t stride = LeavesAround::cellStride(a);
                    if (a == axis) {
                        diagonal += at[a] * stride;
                    } else if (at[a] != 1) {
                        ++sides;
                        diagonal += at[a] == 0 ? -stride : 2 * stride;
                        place.faces = static_cast<std::uint8_t>(place.faces | 1u << (2 * a + (at[a] == 0 ? 0 : 1)));
                    }
                }
                place.isOnLeafEdge = sides == 2;
                place.diagonal = static_cast<std::int16_t>(diagonal);
                places[static_cast<std::size_t>(4 * closedPoint(at[0], at[1], at[2]).number()) + axis] = place;
            }
        return places;
    }();
    return kPlaces;
}

} // namespace

const SmallLeafPolygons::Polygon& SmallLeafPolygons::find(const LeavesAround& leaves, const LeafCell& leaf) {
    const std::uint32_t signs = signsOfLeaf(leaves.above(), leaf.point);
    const unsigned split = facesBesideCells(leaves, leaf) & kCrossedFaces[signsOfCorners(signs)];
    // Which edges are split depends on no other faces: where an edge on the border of a face is active, it is crossed.
    const std::uint64_t pattern = (signs & kPointsThatMatter[split]) | std::uint64_t{split} << kPatternPoints;
    if (table_.empty())
        table_.resize(std::size_t{1} << kTableBits);
    Polygon& polygon = table_[static_cast<std::size_t>(pattern * 0x9e3779b97f4a7c15u >> (64 - kTableBits))];
    if (polygon.pattern != pattern) {
        make(leaves, leaf, split, polygon);
        polygon.pattern = pattern;
    }
    return polygon;
}

int SmallLeafPolygons::levelOf(std::uint16_t edge, const LeavesAround& leaves, const LeafCell& leaf) {
    if ((edge & kIsSplit) != 0)
        return 0;
    return leaves.levelAt(leaf.cell + placesInLeaf()[edge].diagonal) == 0 ? 0 : 1;
}

void SmallLeafPolygons::make(const LeavesAround& leaves, const LeafCell& leaf, unsigned splitFaces, Polygon& polygon) {
    polygon_.make(leaves, leaf);
    polygon.cornerCount = static_cast<std::uint8_t>(polygon_.corners().size());
    for (std::size_t i = 0; i < polygon_.corners().size(); ++i) {
        const auto edge = static_cast<std::uint16_t>(polygon_.corners()[i] - 4 * leaf.point);
        const PlaceInLeaf& place = placesInLeaf()[edge];
        const bool isSplit = !place.isOnLeafEdge || (place.faces & splitFaces) != 0;
        polygon.edges[i] = static_cast<std::uint16_t>(edge | (isSplit ? kIsSplit : 0));
    }
    polygon.triangleCount = static_cast<std::uint8_t>(polygon_.triangles().size());
    for (std::size_t i = 0; i < polygon_.triangles().size(); ++i)
        for (std::size_t k = 0; k < 3; ++k)
            polygon.triangles[i][k] = static_cast<std::uint8_t>(polygon_.triangles()[i][k]);
}

} // namespace isoslider::extract
