#include "core/topology/analysis/boundary_part.h"

#include <bit>

#include "core/grid/scalar_type.h"

namespace isoslider::topology {
namespace {

// Whether the cells of a star hang together by faces, and those that are not there, too.
bool isManifoldStar(unsigned star) {
    const auto isOnePart = [](unsigned cells) {
        unsigned reached = cells & (~cells + 1);
        for (unsigned before = 0; before != reached;) {
            before = reached;
            for (unsigned axis = 0; axis < 3; ++axis)
                for (unsigned c = 0; c < 8; ++c)
                    if ((before >> c & 1u) != 0)
                        reached |= cells & 1u << (c ^ 1u << axis);
        }
        return reached == cells;
    };
    return isOnePart(star) && isOnePart(~star & 255u);
}

const std::array<bool, 256>& manifoldStars() {
    static const std::array<bool, 256> table = [] {
        std::array<bool, 256> is{};
        for (unsigned star = 0; star < 256; ++star)
            is[star] = isManifoldStar(star);
        return is;
    }();
    return table;
}

// Whether the edge up along an axis is of the boundary: some of the cells round it are there, not all.
bool isEdgeUp(unsigned star, std::size_t axis) {
    const unsigned round = star & kStarSides[2 * axis + 1];
    return round != 0 && round != kStarSides[2 * axis + 1];
}

} // namespace

template <class Sample>
BoundaryPart BoundaryPart::of(const LayerWindow<Sample>& window) {
    BoundaryPart part;
    const std::array<std::int64_t, 3> steps{1, window.rowStep(), window.planeStep()};
    for (std::size_t axis = 0; axis < 3; ++axis)
        part.steps[axis] = static_cast<Point>(steps[axis]);
    const std::int64_t owned = window.planeStep() * (window.ownedEnd() - window.zBegin);
    const Sample* samples = window.layer();
    // Held twice while they grow the first and the last plane's would be half as large again.
    std::array<std::int64_t, 256> counts{};
    for (std::int64_t at = 0; at < owned; ++at)
        if (const CellStar star = window.stars[static_cast<std::size_t>(at)]; star != kWholeStar) // nearly all are
            ++counts[star];
    std::size_t points = 0, edges = 0;
    for (unsigned star = 1; star < kWholeStar; ++star) {
        points += static_cast<std::size_t>(counts[star]);
        for (std::size_t axis = 0; axis < 3; ++axis)
            edges += isEdgeUp(star, axis) ? static_cast<std::size_t>(counts[star]) : 0;
    }
    part.points.reserve(points);
    part.scalars.reserve(points);
    part.edges.reserve(edges);
    for (std::int64_t at = 0; at < owned; ++at) {
        const CellStar star = window.stars[static_cast<std::size_t>(at)];
        if (star == kWholeStar || star == 0)
            continue;
        const Point point = window.firstPoint() + static_cast<Point>(at);
        part.points.push_back(point);
        part.scalars.push_back(static_cast<double>(samples[at]));
        part.isManifold = part.isManifold && manifoldStars()[star];
        ++part.euler;
        // Edges and faces that go up from here.
        for (std::size_t axis = 0; axis < 3; ++axis) {
            if (isEdgeUp(star, axis)) {
                part.edges.emplace_back(point, axis);
                --part.euler;
            }
            const unsigned beside = star & kStarSides[(2 * axis + 3) % 6] & kStarSides[(2 * axis + 5) % 6];
            part.euler += std::popcount(beside) == 1;
        }
    }
    return part;
}

void BoundaryPart::add(const StripChanges& changes) {
    above.insert(above.end(), changes.boundaryAbove.begin(), changes.boundaryAbove.end());
    below.insert(below.end(), changes.boundaryBelow.begin(), changes.boundaryBelow.end());
}

#define ISO_INSTANTIATE(Sample, Name) template BoundaryPart BoundaryPart::of(const LayerWindow<Sample>&);
ISO_FOR_EACH_SAMPLE_TYPE(ISO_INSTANTIATE)
#undef ISO_INSTANTIATE

} // namespace isoslider::topology
