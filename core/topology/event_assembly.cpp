#include "core/topology/event_assembly.h"

#include <algorithm>
#include <cstdlib>
#include <limits>
#include <tuple>
#include <utility>

#include <tbb/parallel_sort.h>

namespace isoslider::topology {
namespace {

// What tells changes of one isovalue and cause apart: sorted by it as well, they lead to the same events in every run.
int restOf(const EulerChange& change) { return change.euler; }
std::pair<double, bool> restOf(const ComponentChange& change) { return {change.persistence, change.isBirth}; }
std::int64_t restOf(const ClosedChange& change) { return change.closed; }

// Takes changes of one kind in the order of isovalues that rise.
template <class Change>
class Ascending {
public:
    explicit Ascending(std::vector<Change>& changes) : changes_(changes) {
        tbb::parallel_sort(changes_.begin(), changes_.end(), [](const Change& a, const Change& b) {
            if (a.isovalue != b.isovalue)
                return a.isovalue < b.isovalue;
            return a.cause != b.cause ? a.cause < b.cause : restOf(a) < restOf(b);
        });
    }
    double isovalue() const {
        return at_ < changes_.size() ? changes_[at_].isovalue : std::numeric_limits<double>::infinity();
    }
    bool isLeft() const { return at_ < changes_.size(); }
    template <class Function>
    void takeAt(double isovalue, const Function& function) {
        for (; at_ < changes_.size() && changes_[at_].isovalue == isovalue; ++at_)
            function(changes_[at_]);
    }

private:
    std::vector<Change>& changes_;
    std::size_t at_ = 0;
};

// The place that an event is shown at: of a grid point rather than of a saddle, where most lasts, where most changes.
class Place {
public:
    void offer(Cause cause, double persistence, int changes) {
        const auto rank = std::tuple(cause.isVertex(), persistence, std::abs(changes));
        if (hasOne_ && rank <= rank_)
            return;
        hasOne_ = true;
        rank_ = rank;
        cause_ = cause;
    }
    void describe(const GridDims& dims, TopologyEvent& event) const {
        event.kind = cause_.isVertex()   ? EventKind::Vertex
                     : cause_.isInside() ? EventKind::BodySaddle
                                         : EventKind::FaceSaddle;
        const auto point = static_cast<std::int64_t>(cause_.point());
        const std::array<std::int64_t, 3> at{point % dims[0], point / dims[0] % dims[1], point / (dims[0] * dims[1])};
        for (std::size_t a = 0; a < 3; ++a)
            event.position[a] = static_cast<float>(at[a]) + (cause_.isVertex() ? 0.0f : 0.5f);
        if (event.kind == EventKind::FaceSaddle)
            event.position[static_cast<std::size_t>(cause_.face() / 2)] += cause_.face() % 2 == 0 ? -0.5f : 0.5f;
    }

private:
    bool hasOne_ = false;
    std::tuple<bool, double, int> rank_;
    Cause cause_;
};

struct EulerSum {
    std::int64_t euler = 0;
    EulerChange largest{};
    void add(const EulerChange& change) {
        if (euler == 0 || std::abs(change.euler) > std::abs(largest.euler))
            largest = change;
        euler += change.euler;
    }
};

} // namespace

std::vector<TopologyEvent> assembleEvents(EventParts parts, const GridDims& dims) {
    Ascending euler(parts.euler);
    Ascending above(parts.above.changes), below(parts.below.changes);
    Ascending closed(parts.below.closed);
    Ascending aboveOuter(parts.aboveOnBoundary.changes), belowOuter(parts.belowOnBoundary.changes);
    // Below all isovalues everything is above. Each component of the cells, and of their boundary, counts as above,
    // as below, or twice where the surface parts it.
    SurfaceCounts counts;
    std::vector<TopologyEvent> events;
    while (euler.isLeft() || above.isLeft() || below.isLeft() || closed.isLeft() || aboveOuter.isLeft() ||
           belowOuter.isLeft()) {
        TopologyEvent event;
        event.isovalue = std::min({euler.isovalue(), above.isovalue(), below.isovalue(), closed.isovalue(),
                                   aboveOuter.isovalue(), belowOuter.isovalue()});
        event.below = counts;
        Place place;
        std::array<EulerSum, 2> sums; // at grid points, at saddles
        euler.takeAt(event.isovalue,
                     [&](const EulerChange& change) { sums[change.cause.isVertex() ? 0 : 1].add(change); });
        for (const EulerSum& sum : sums) {
            counts.euler += sum.euler;
            if (sum.euler != 0)
                place.offer(sum.largest.cause, 0.0, sum.largest.euler);
        }
        // What is above shrinks: its components go where they come when the isovalue falls.
        above.takeAt(event.isovalue, [&](const ComponentChange& change) {
            ++(change.isBirth ? event.pieces.deaths : event.pieces.splits);
            counts.components += change.isBirth ? -1 : 1;
            event.persistence = std::max(event.persistence, change.persistence);
            place.offer(change.cause, change.persistence, 1);
        });
        below.takeAt(event.isovalue, [&](const ComponentChange& change) {
            ++(change.isBirth ? event.pieces.births : event.pieces.joins);
            counts.components += change.isBirth ? 1 : -1;
            event.persistence = std::max(event.persistence, change.persistence);
            place.offer(change.cause, change.persistence, 1);
        });
        closed.takeAt(event.isovalue, [&](const ClosedChange& change) {
            counts.voids += change.closed;
            place.offer(change.cause, 0.0, 0);
        });
        aboveOuter.takeAt(event.isovalue, [&](const ComponentChange& change) {
            counts.loops += change.isBirth ? -1 : 1;
            place.offer(change.cause, 0.0, 1);
        });
        belowOuter.takeAt(event.isovalue, [&](const ComponentChange& change) {
            counts.loops += change.isBirth ? 1 : -1;
            place.offer(change.cause, 0.0, 1);
        });
        event.above = counts;
        if (event.above == event.below && event.pieces == PieceChanges())
            continue;
        place.describe(dims, event);
        events.push_back(event);
    }
    return events;
}

} // namespace isoslider::topology
