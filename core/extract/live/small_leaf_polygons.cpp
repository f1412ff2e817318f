#include "core/extract/live/small_leaf_polygons.h"

#include <algorithm>
#include <array>
#include <atomic>

#include "core/extract/live/pair_cells.h"

namespace isoslider::extract {
namespace {

constexpr int kPatternPoints = 27;
constexpr int kMiddlePoint = 13; ///< whose sign matters to no polygon

/// Faces in the order of kCornersOfFaces: 2 * axis + whether it is the upper one.
constexpr std::size_t kFaces = 6;
constexpr std::array<int, kFaces> kFaceMiddles{12, 14, 10, 16, 4, 22};
constexpr std::array<unsigned, kFaces> kBesideFaces{LeavesAround::beside(-1, 0, 0), LeavesAround::beside(1, 0, 0),
                                                    LeavesAround::beside(0, -1, 0), LeavesAround::beside(0, 1, 0),
                                                    LeavesAround::beside(0, 0, -1), LeavesAround::beside(0, 0, 1)};

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
        points[split] = ((1u << kPatternPoints) - 1) & ~(1u << kMiddlePoint);
        for (std::size_t face = 0; face < kFaces; ++face)
            if ((split >> face & 1) == 0)
                points[split] &= ~(1u << kFaceMiddles[face]);
    }
    return points;
}();

// The split faces take the places of the middle and behind the signs: 32 bits in all.
constexpr std::uint32_t patternOf(std::uint32_t signs, unsigned split) {
    return (signs & kPointsThatMatter[split]) | (split & 1) << kMiddlePoint | (split >> 1) << kPatternPoints;
}
constexpr unsigned splitFacesOf(std::uint32_t pattern) {
    return (pattern >> kMiddlePoint & 1) | (pattern >> kPatternPoints) << 1;
}

unsigned signsOfCorners(std::uint32_t signs) {
    return (signs & 1) | (signs >> 1 & 2) | (signs >> 4 & 4) | (signs >> 5 & 8) | (signs >> 14 & 16) |
           (signs >> 15 & 32) | (signs >> 18 & 64) | (signs >> 19 & 128);
}

unsigned facesBesideCells(std::uint64_t unmergedAround) {
    unsigned faces = 0;
    for (std::size_t face = 0; face < kFaces; ++face)
        faces |= static_cast<unsigned>(unmergedAround >> kBesideFaces[face] & 1) << face;
    return faces;
}

/// An edge in a leaf, by 3 * its lower point of the leaf's 27 + its axis.
struct PlaceInLeaf {
    ClosedEdge fromFirst{}; ///< named from the leaf's first point on
    bool isOnLeafEdge = false; ///< else inside a face
    std::uint8_t across = 0; ///< then the leaf across that edge, as LeavesAround::beside()
    std::uint8_t faces = 0; ///< that it lies in
};
constexpr auto kPlacesInLeaf = [] {
    std::array<PlaceInLeaf, std::size_t{3} * kPatternPoints> places{};
    for (int p = 0; p < kPatternPoints; ++p)
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const std::array<int, 3> at{p % 3, p / 3 % 3, p / 9};
            PlaceInLeaf& place = places[3 * static_cast<std::size_t>(p) + axis];
            place.fromFirst = closedEdge(static_cast<int>(axis), closedPoint(at[0], at[1], at[2]));
            std::array<int, 3> across{};
            int sides = 0;
            for (std::size_t a = 0; a < 3; ++a)
                if (a != axis && at[a] != 1) {
                    ++sides;
                    across[a] = at[a] - 1;
                    place.faces = static_cast<std::uint8_t>(place.faces | 1u << (2 * a + (at[a] == 0 ? 0 : 1)));
                }
            place.isOnLeafEdge = sides == 2;
            place.across = static_cast<std::uint8_t>(LeavesAround::beside(across[0], across[1], across[2]));
        }
    return places;
}();

// Of an edge as MergedPolygon names it.
std::uint8_t placeInLeaf(std::int64_t edge, ClosedPoint first) {
    const auto at = coordsOf(ClosedPoint(static_cast<int>(edge >> 2))), from = coordsOf(first);
    return static_cast<std::uint8_t>(3 * (at[0] - from[0] + 3 * (at[1] - from[1]) + 9 * (at[2] - from[2])) +
                                     static_cast<int>(edge & 3));
}

} // namespace

// One cache line. What it holds is written once, before its pattern is.
struct alignas(64) SmallLeafPolygons::Kept {
    std::atomic<std::uint32_t> pattern{kNoPattern};
    std::uint8_t edgeCount = 0, triangleCount = 0;
    std::array<std::uint8_t, 58> bytes{}; ///< edges, then triangles; a polygon of more, which is rare, is not kept

    // No leaf has these: all its points would be on one side.
    static constexpr std::uint32_t kNoPattern = 0, kBeingWritten = ~std::uint32_t{0};
    static constexpr int kTableBits = 17;
    static constexpr std::size_t kPlaces = 4; ///< that a pattern may have, one behind the other
    static std::array<Kept, (std::size_t{1} << kTableBits) + kPlaces> table;
};
// Eight megabytes, of which the system hands out what is used.
constinit std::array<SmallLeafPolygons::Kept,
                     (std::size_t{1} << SmallLeafPolygons::Kept::kTableBits) + SmallLeafPolygons::Kept::kPlaces>
    SmallLeafPolygons::Kept::table;

ClosedEdge SmallLeafPolygons::edgeOf(std::uint8_t edge, const Leaf& leaf) {
    return kPlacesInLeaf[edge & ~kIsSplit].fromFirst + leaf.point.number();
}

int SmallLeafPolygons::levelOf(std::uint8_t edge, const Leaf& leaf) {
    if ((edge & kIsSplit) != 0)
        return 0;
    return (leaf.unmergedAround >> kPlacesInLeaf[edge].across & 1) != 0 ? 0 : 1;
}

auto SmallLeafPolygons::keptAt(std::uint32_t pattern) -> Kept* {
    static_assert(sizeof(Kept) == 64);
    return &Kept::table[pattern * 0x9e3779b1u >> (32 - Kept::kTableBits)];
}

auto SmallLeafPolygons::leafAt(const LeavesAround& leaves, int x, int y, int z) -> Leaf {
    Leaf leaf{closedPoint(2 * x, 2 * y, 2 * z), 0, leaves.unmergedAround(x, y, z)};
    const std::uint32_t signs = signsOfPair(leaves.above(), leaf.point);
    // Which edges are split depends on no other faces: where an edge on the border of a face is active, it is crossed.
    leaf.pattern = patternOf(signs, facesBesideCells(leaf.unmergedAround) & kCrossedFaces[signsOfCorners(signs)]);
    __builtin_prefetch(keptAt(leaf.pattern));
    return leaf;
}

auto SmallLeafPolygons::find(const LeavesAround& leaves, const Leaf& leaf) -> Polygon {
    const Kept* const first = keptAt(leaf.pattern);
    for (const Kept* kept = first; kept != first + Kept::kPlaces; ++kept) {
        const std::uint32_t its = kept->pattern.load(std::memory_order_acquire);
        if (its == leaf.pattern && its != Kept::kNoPattern)
            return {{kept->bytes.data(), kept->edgeCount},
                    {kept->bytes.data() + kept->edgeCount, std::size_t{3} * kept->triangleCount}};
        if (its == Kept::kNoPattern)
            break;
    }
    make(leaves, leaf);
    if (leaf.pattern != Kept::kNoPattern)
        keep(leaf.pattern);
    return {edges_, triangles_};
}

// Puts the polygon that was made last into the first free place of the pattern. Two threads may put the same.
void SmallLeafPolygons::keep(std::uint32_t pattern) const {
    Kept* const first = keptAt(pattern);
    if (edges_.size() + triangles_.size() > first->bytes.size())
        return;
    for (Kept* kept = first; kept != first + Kept::kPlaces; ++kept) {
        std::uint32_t none = Kept::kNoPattern;
        if (!kept->pattern.compare_exchange_strong(none, Kept::kBeingWritten, std::memory_order_relaxed))
            continue;
        kept->edgeCount = static_cast<std::uint8_t>(edges_.size());
        kept->triangleCount = static_cast<std::uint8_t>(triangles_.size() / 3);
        std::copy(triangles_.begin(), triangles_.end(), std::copy(edges_.begin(), edges_.end(), kept->bytes.begin()));
        kept->pattern.store(pattern, std::memory_order_release);
        return;
    }
}

void SmallLeafPolygons::make(const LeavesAround& leaves, const Leaf& leaf) {
    const std::int64_t first = leaf.point.number();
    polygon_.make(leaves, {first, LeavesAround::cellAt(first), 1});
    const unsigned splitFaces = splitFacesOf(leaf.pattern);
    edges_.clear();
    for (const std::int64_t edge : polygon_.corners()) {
        const std::uint8_t inLeaf = placeInLeaf(edge, leaf.point);
        const PlaceInLeaf& place = kPlacesInLeaf[inLeaf];
        const bool isSplit = !place.isOnLeafEdge || (place.faces & splitFaces) != 0;
        edges_.push_back(isSplit ? inLeaf | kIsSplit : inLeaf);
    }
    triangles_.clear();
    for (const auto& triangle : polygon_.triangles())
        for (const std::uint32_t corner : triangle)
            triangles_.push_back(static_cast<std::uint8_t>(corner));
}

} // namespace isoslider::extract
