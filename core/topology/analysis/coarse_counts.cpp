#include "core/topology/analysis/coarse_counts.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <tbb/parallel_invoke.h>

#include "core/topology/analysis/link_collector.h"

namespace isoslider::topology {
namespace {

constexpr double kNever = std::numeric_limits<double>::quiet_NaN();

} // namespace

// ---- inside

CoarseCounts::Components::Components(Side side, const std::vector<double>& isovalues, bool areVoids)
    : forest(side, isovalues), side_(side) {
    if (areVoids)
        outside_ = forest.addUncounted();
}

void CoarseCounts::Components::add(const LayerComponents& layer, const std::vector<double>& bottom,
                                   const std::vector<double>& top) {
    const ForestStream::Node first = forest.nodes();
    for (const Seed& seed : layer.graph.seeds) {
        const ForestStream::Node node = forest.addNode(seed.isovalue);
        if (outside_ != ForestStream::kNone && !std::isnan(seed.reachesBoundary))
            forest.addLink(seed.reachesBoundary, node, outside_);
    }
    for (const Link& link : layer.graph.links)
        forest.addLink(link.isovalue, link.a + first, link.b + first);
    // Grid points between two layers belong to both: what they lead to above and below is one from their scalars on.
    LinkCollector between(side_);
    for (std::size_t i = 0; i < top_.size(); ++i)
        if (top_[i] != ForestStream::kNone && layer.bottom[i] != kNoSeed)
            between.add(bottom[i], Cause(), top_[i], layer.bottom[i] + first);
    for (const Link& link : between.take())
        forest.addLink(link.isovalue, link.a, link.b);
    top_.assign(layer.top.size(), ForestStream::kNone);
    std::vector<double> opens(forest.nodes(), kNever);
    for (std::size_t i = 0; i < top_.size(); ++i)
        if (layer.top[i] != kNoSeed) {
            top_[i] = layer.top[i] + first;
            opens[top_[i]] = earlier(side_, opens[top_[i]], top[i]);
        }
    settle(std::move(opens));
}

void CoarseCounts::Components::settle(std::vector<double> opens) {
    if (outside_ != ForestStream::kNone) // it is there before all else
        opens[outside_] = -std::numeric_limits<double>::infinity();
    const std::vector<ForestStream::Node> numbers = forest.settle(opens);
    for (ForestStream::Node& node : top_)
        node = node != ForestStream::kNone ? numbers[node] : node;
    if (outside_ != ForestStream::kNone)
        outside_ = numbers[outside_];
}

void CoarseCounts::Components::end() {
    top_.clear();
    settle(std::vector<double>(forest.nodes(), kNever));
}

// ---- on the boundary

CoarseCounts::OnBoundary::Place CoarseCounts::OnBoundary::find(Point point) const {
    const auto at = std::lower_bound(points_.begin(), points_.end(), point);
    if (at == points_.end() || *at != point)
        return {ForestStream::kNone, 0.0};
    return places_[static_cast<std::size_t>(at - points_.begin())];
}

// False while one of its ends is not there.
bool CoarseCounts::OnBoundary::addLink(const Waiting& link) {
    const Place a = find(link.points[0]), b = find(link.points[1]);
    if (a.node == ForestStream::kNone || b.node == ForestStream::kNone)
        return false;
    const double later = comesEarlier(side_, a.scalar, b.scalar) ? b.scalar : a.scalar;
    forest.addLink(link.isEdge ? later : link.isovalue, a.node, b.node);
    return true;
}

void CoarseCounts::OnBoundary::add(const DomainBoundary::Part& part) {
    // Of the layer before, grid points with links that wait are left.
    for (std::size_t i = 0; i < part.points.size(); ++i) {
        points_.push_back(part.points[i]);
        places_.push_back({forest.addNode(part.scalars[i]), part.scalars[i]});
    }
    std::vector<Waiting> links = std::move(waiting_);
    waiting_.clear();
    for (const auto& edge : part.edges)
        links.push_back({find(edge.start()).scalar, {edge.start(), edge.start() + part.steps[edge.axis()]}, true});
    for (const BoundaryJoin& join : side_ == Side::Above ? part.above : part.below)
        links.push_back({join.isovalue, join.points, false});
    std::vector<double> opens(forest.nodes(), kNever);
    for (const Waiting& link : links) {
        if (addLink(link))
            continue;
        waiting_.push_back(link);
        for (const Point point : link.points)
            if (const Place place = find(point); place.node != ForestStream::kNone)
                opens[place.node] = earlier(side_, opens[place.node], place.scalar);
    }
    const std::vector<ForestStream::Node> numbers = forest.settle(opens);
    std::size_t kept = 0;
    for (std::size_t i = 0; i < points_.size(); ++i)
        if (const ForestStream::Node node = numbers[places_[i].node]; node != ForestStream::kNone) {
            points_[kept] = points_[i];
            places_[kept++] = {node, places_[i].scalar};
        }
    points_.resize(kept);
    places_.resize(kept);
}

void CoarseCounts::OnBoundary::end() { forest.settle(std::vector<double>(forest.nodes(), kNever)); }

// ---- all of it

CoarseCounts::CoarseCounts(std::vector<double> isovalues)
    : isovalues_(std::move(isovalues)),
      above_(Side::Above, isovalues_, false),
      below_(Side::Below, isovalues_, false),
      voids_(Side::Below, isovalues_, true),
      boundaryAbove_(Side::Above, isovalues_),
      boundaryBelow_(Side::Below, isovalues_),
      euler_(isovalues_.size() + 1) {}

void CoarseCounts::add(const LayerComponents& above, const LayerComponents& below, const LayerChanges& changes,
                       const DomainBoundary::Part& boundary, const std::vector<double>& bottom,
                       const std::vector<double>& top) {
    tbb::parallel_invoke([&] { above_.add(above, bottom, top); }, [&] { below_.add(below, bottom, top); },
                         [&] { voids_.add(below, bottom, top); }, [&] { boundaryAbove_.add(boundary); },
                         [&] { boundaryBelow_.add(boundary); });
    boundaryEuler_ += boundary.euler;
    isManifold_ = isManifold_ && boundary.isManifold;
    for (const EulerChange& change : changes.euler) {
        const auto next = std::upper_bound(isovalues_.begin(), isovalues_.end(), change.isovalue);
        euler_[static_cast<std::size_t>(next - isovalues_.begin())] += change.euler();
    }
}

std::uint64_t CoarseCounts::sizeBytes() const {
    std::uint64_t bytes = 0;
    for (const ForestStream* forest :
         {&above_.forest, &below_.forest, &voids_.forest, &boundaryAbove_.forest, &boundaryBelow_.forest})
        bytes += forest->sizeBytes();
    return bytes;
}

std::vector<SurfaceCounts> CoarseCounts::finish() {
    for (Components* each : {&above_, &below_, &voids_})
        each->end();
    for (OnBoundary* each : {&boundaryAbove_, &boundaryBelow_})
        each->end();
    const auto above = above_.forest.counts(), below = below_.forest.counts(), voids = voids_.forest.counts(),
               outerAbove = boundaryAbove_.forest.counts(), outerBelow = boundaryBelow_.forest.counts();
    // Where the surface parts nothing, each part of what is there counts as one side or the other.
    const std::int64_t parts = above_.forest.lasting(), outerParts = boundaryAbove_.forest.lasting();
    std::vector<SurfaceCounts> counts(isovalues_.size());
    std::int64_t euler = 0;
    for (std::size_t i = 0; i < counts.size(); ++i) {
        euler += euler_[i];
        counts[i] = {above[i] + below[i] - parts, euler, outerAbove[i] + outerBelow[i] - outerParts, voids[i]};
    }
    return counts;
}

bool CoarseCounts::areExact() const { return isManifold_ && boundaryEuler_ == 2 * boundaryAbove_.forest.lasting(); }

} // namespace isoslider::topology
