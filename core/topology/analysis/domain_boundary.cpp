#include "core/topology/analysis/domain_boundary.h"

#include <algorithm>
#include <bit>
#include <limits>
#include <utility>

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

} // namespace

template <class Sample>
DomainBoundary::Part DomainBoundary::partOf(const LayerWindow<Sample>& window, const LayerChanges& changes) {
    Part part;
    const std::array<std::int64_t, 3> steps{1, window.rowStep(), window.planeStep()};
    for (std::size_t axis = 0; axis < 3; ++axis)
        part.steps[axis] = static_cast<Point>(steps[axis]);
    const std::int64_t owned = window.planeStep() * (window.ownedEnd() - window.zBegin);
    const Sample* const samples = window.layer();
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
            const unsigned round = star & kStarSides[2 * axis + 1];
            if (round != 0 && round != kStarSides[2 * axis + 1]) {
                part.edges.emplace_back(point, axis);
                --part.euler;
            }
            const unsigned beside = star & kStarSides[(2 * axis + 3) % 6] & kStarSides[(2 * axis + 5) % 6];
            part.euler += std::popcount(beside) == 1;
        }
    }
    part.above = changes.boundaryAbove;
    part.below = changes.boundaryBelow;
    return part;
}

void DomainBoundary::add(const Part& part) {
    const auto append = [](auto& to, const auto& from) { to.insert(to.end(), from.begin(), from.end()); };
    append(all_.points, part.points);
    append(all_.scalars, part.scalars);
    append(all_.edges, part.edges);
    append(all_.above, part.above);
    append(all_.below, part.below);
    all_.steps = part.steps;
    all_.euler += part.euler;
    all_.isManifold = all_.isManifold && part.isManifold;
}

ComponentHistory DomainBoundary::follow(Side side, double span) const {
    ComponentGraph graph;
    graph.side = side;
    // Every point is a seed: there are few.
    for (std::size_t i = 0; i < all_.points.size(); ++i)
        graph.seeds.push_back({all_.scalars[i], std::numeric_limits<double>::quiet_NaN(), all_.points[i]});
    const auto seedOf = [this](Point point) {
        const auto at = std::lower_bound(all_.points.begin(), all_.points.end(), point);
        return static_cast<std::uint32_t>(at - all_.points.begin());
    };
    // Edges come in the order of their first points; so do those along one axis in that of their second ones.
    graph.links.reserve(all_.edges.size());
    std::uint32_t first = 0;
    std::array<std::uint32_t, 3> second{};
    for (const Edge edge : all_.edges) {
        const auto advance = [this](std::uint32_t& at, Point to) {
            while (all_.points[at] < to)
                ++at;
            return at;
        };
        const std::uint32_t a = advance(first, edge.start()),
                            b = advance(second[edge.axis()], edge.start() + all_.steps[edge.axis()]);
        const std::uint32_t later = comesEarlier(side, all_.scalars[a], all_.scalars[b]) ? b : a;
        graph.links.push_back({all_.scalars[later], Cause::vertex(all_.points[later]), a, b});
    }
    for (const BoundaryJoin& join : side == Side::Above ? all_.above : all_.below)
        graph.links.push_back({join.isovalue, join.cause, seedOf(join.points[0]), seedOf(join.points[1])});
    ComponentHistory history;
    finishComponents(std::move(graph), span, history);
    return history;
}

std::uint64_t DomainBoundary::sizeBytes() const {
    return all_.points.size() * 16 + all_.edges.size() * sizeof(all_.edges[0]) +
           (all_.above.size() + all_.below.size()) * sizeof(BoundaryJoin);
}

#define ISO_INSTANTIATE(Sample, Name) \
    template DomainBoundary::Part DomainBoundary::partOf(const LayerWindow<Sample>&, const LayerChanges&);
ISO_FOR_EACH_SAMPLE_TYPE(ISO_INSTANTIATE)
#undef ISO_INSTANTIATE

} // namespace isoslider::topology
