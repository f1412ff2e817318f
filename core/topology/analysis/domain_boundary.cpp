#include "core/topology/analysis/domain_boundary.h"

#include <algorithm>
#include <bit>
#include <limits>
#include <utility>

#include <tbb/parallel_invoke.h>

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

Status DomainBoundary::add(const Part& part) {
    euler_ += part.euler;
    isManifold_ = isManifold_ && part.isManifold;
    Status status, statusBelow;
    tbb::parallel_invoke([&] { status = above_.add(part); }, [&] { statusBelow = below_.add(part); });
    return status.isOk() ? statusBelow : status;
}

Result<SideChanges> DomainBoundary::take(Side side, double span) {
    return side == Side::Above ? above_.take(span) : below_.take(span);
}

Status DomainBoundary::OneSide::add(const Part& part) {
    joins_ = graph_.side == Side::Above ? part.above : part.below;
    std::sort(joins_.begin(), joins_.end(), [](const BoundaryJoin& a, const BoundaryJoin& b) {
        return std::min(a.points[0], a.points[1]) < std::min(b.points[0], b.points[1]);
    });
    nextEdge_ = nextJoin_ = 0;
    // A few rows at a time: the first and the last layer have a whole plane of it.
    constexpr std::size_t kPoints = std::size_t{1} << 13;
    for (std::size_t begin = 0; begin < part.points.size(); begin += kPoints)
        ISO_TRY(addPoints(part, begin, std::min(part.points.size(), begin + kPoints)));
    for (; nextJoin_ < joins_.size(); ++nextJoin_)
        waiting_.push_back({joins_[nextJoin_].points, joins_[nextJoin_].isovalue, joins_[nextJoin_].cause, false});
    return {};
}

Status DomainBoundary::OneSide::addPoints(const Part& part, std::size_t begin, std::size_t end) {
    const std::size_t firstPlace = places_.size();
    for (std::size_t i = begin; i < end; ++i) {
        places_.push_back({part.points[i], part.scalars[i], static_cast<std::uint32_t>(graph_.seeds.size())});
        graph_.seeds.push_back({part.scalars[i], std::numeric_limits<double>::quiet_NaN(), part.points[i]});
    }
    const Point last = part.points[end - 1];
    for (; nextJoin_ < joins_.size(); ++nextJoin_) {
        const BoundaryJoin& join = joins_[nextJoin_];
        if (std::min(join.points[0], join.points[1]) > last)
            break;
        waiting_.push_back({join.points, join.isovalue, join.cause, false});
    }
    std::erase_if(waiting_, [&](const Waiting& link) {
        if (std::max(link.points[0], link.points[1]) > last)
            return false;
        addLink(link, *find(link.points[0]), *find(link.points[1]));
        return true;
    });
    addEdges(part, firstPlace);
    return settle();
}

// Edges come in the order of their first points; so do those along one axis in that of their second ones.
void DomainBoundary::OneSide::addEdges(const Part& part, std::size_t firstPlace) {
    const Point last = places_.back().point;
    std::size_t first = firstPlace;
    std::array<std::size_t, 3> second{firstPlace, firstPlace, firstPlace};
    const auto advance = [this](std::size_t& at, Point to) {
        while (places_[at].point < to)
            ++at;
        return places_[at];
    };
    for (; nextEdge_ < part.edges.size() && part.edges[nextEdge_].start() <= last; ++nextEdge_) {
        const Edge edge = part.edges[nextEdge_];
        const Waiting link{{edge.start(), edge.start() + part.steps[edge.axis()]}, 0.0, Cause(), true};
        if (link.points[1] <= last)
            addLink(link, advance(first, link.points[0]), advance(second[edge.axis()], link.points[1]));
        else
            waiting_.push_back(link);
    }
}

void DomainBoundary::OneSide::addLink(const Waiting& link, const Place& a, const Place& b) {
    const Place& later = comesEarlier(graph_.side, a.scalar, b.scalar) ? b : a;
    if (link.isEdge)
        graph_.links.push_back({later.scalar, Cause::vertex(later.point), a.seed, b.seed});
    else
        graph_.links.push_back({link.isovalue, link.cause, a.seed, b.seed});
}

const DomainBoundary::OneSide::Place* DomainBoundary::OneSide::find(Point point) const {
    const auto at = std::lower_bound(places_.begin(), places_.end(), point,
                                     [](const Place& place, Point to) { return place.point < to; });
    return at != places_.end() && at->point == point ? &*at : nullptr;
}

Status DomainBoundary::OneSide::settle() {
    std::vector<double> opens(graph_.seeds.size(), std::numeric_limits<double>::quiet_NaN());
    std::vector<char> isOpen(places_.size(), 0);
    for (const Waiting& link : waiting_)
        for (const Point point : link.points)
            if (const Place* const place = find(point)) {
                isOpen[static_cast<std::size_t>(place - places_.data())] = 1;
                opens[place->seed] = earlier(graph_.side, opens[place->seed], place->scalar);
            }
    ComponentHistory settled;
    const std::vector<std::uint32_t> parts = settleComponents(graph_, opens, settled, order_);
    std::size_t kept = 0;
    for (std::size_t i = 0; i < places_.size(); ++i)
        if (isOpen[i] != 0)
            places_[kept++] = {places_[i].point, places_[i].scalar, parts[places_[i].seed]};
    places_.resize(kept);
    return sums.add(settled);
}

Result<SideChanges> DomainBoundary::OneSide::take(double span) {
    ComponentHistory history;
    finishComponents(std::move(graph_), span, history);
    ISO_TRY(sums.add(history));
    return sums.take();
}

#define ISO_INSTANTIATE(Sample, Name) \
    template DomainBoundary::Part DomainBoundary::partOf(const LayerWindow<Sample>&, const LayerChanges&);
ISO_FOR_EACH_SAMPLE_TYPE(ISO_INSTANTIATE)
#undef ISO_INSTANTIATE

} // namespace isoslider::topology
