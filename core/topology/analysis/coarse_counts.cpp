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

void CoarseCounts::Components::add(const StripComponents& layer, const std::vector<double>& bottom,
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

// ---- all of it

CoarseCounts::CoarseCounts(std::vector<double> isovalues, std::size_t boundaryPointsAtOnce)
    : isovalues_(std::move(isovalues)),
      above_(Side::Above, isovalues_, false),
      below_(Side::Below, isovalues_, false),
      voids_(Side::Below, isovalues_, true),
      boundaryAbove_(Side::Above, boundaryPointsAtOnce, {ForestStream(Side::Above, isovalues_)}),
      boundaryBelow_(Side::Below, boundaryPointsAtOnce, {ForestStream(Side::Below, isovalues_)}),
      euler_(isovalues_.size() + 1) {}

void CoarseCounts::add(const StripComponents& above, const StripComponents& below, const StripChanges& changes,
                       const BoundaryPart& boundary, const std::vector<double>& bottom,
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
    for (const ForestStream* forest : {&above_.forest, &below_.forest, &voids_.forest, &boundaryAbove_.graph().forest,
                                       &boundaryBelow_.graph().forest})
        bytes += forest->sizeBytes();
    return bytes;
}

std::vector<SurfaceCounts> CoarseCounts::finish() {
    for (Components* each : {&above_, &below_, &voids_})
        each->end();
    ForestStream &outerAbove = boundaryAbove_.graph().forest, &outerBelow = boundaryBelow_.graph().forest;
    for (ForestStream* each : {&outerAbove, &outerBelow})
        each->settle(std::vector<double>(each->nodes(), kNever));
    const auto above = above_.forest.counts(), below = below_.forest.counts(), voids = voids_.forest.counts(),
               loopsAbove = outerAbove.counts(), loopsBelow = outerBelow.counts();
    // Where the surface parts nothing, each part of what is there counts as one side or the other.
    const std::int64_t parts = above_.forest.lasting(), outerParts = outerAbove.lasting();
    std::vector<SurfaceCounts> counts(isovalues_.size());
    std::int64_t euler = 0;
    for (std::size_t i = 0; i < counts.size(); ++i) {
        euler += euler_[i];
        counts[i] = {above[i] + below[i] - parts, euler, loopsAbove[i] + loopsBelow[i] - outerParts, voids[i]};
    }
    return counts;
}

bool CoarseCounts::areExact() const {
    return isManifold_ && boundaryEuler_ == 2 * boundaryAbove_.graph().forest.lasting();
}

} // namespace isoslider::topology
